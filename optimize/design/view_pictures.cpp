// The pictures of a design's views (design_views.h), and their exposures.
#include <algorithm>
#include <cmath>

#include "burin/optimize/design/design_views.h"
#include "burin/optimize/loss/color_metrics.h"
#include "burin/optimize/loss/picture_metrics.h"

namespace burin {
namespace {

// Means of `of` over the views of each group; `groups` is their number.
template <typename Of>
std::vector<double> means_of_groups(const std::vector<WorkView>& views, std::size_t groups, const Of& of) {
  std::vector<double> sum(groups, 0.0), members(groups, 0.0);
  for (const WorkView& v : views) {
    sum[v.exposure_group] += of(v);
    members[v.exposure_group] += 1;
  }
  for (std::size_t g = 0; g < groups; ++g) sum[g] /= members[g];
  return sum;
}

}  // namespace

double fitting_exposure(std::span<const WorkView> channels, double guess) {
  if (channels.size() == 1)
    return best_exposure(channels[0].radiance, channels[0].target.picture, guess, channels[0].target.mask);
  return color_best_exposure(
      in_color(channels[0].radiance, channels[1].radiance, channels[2].radiance),
      in_color(channels[0].target.picture, channels[1].target.picture, channels[2].target.picture), guess,
      channels[0].target.mask);
}

namespace {

// The view whose exposure a channel uses, if each has its own; the channels are consecutive.
const WorkView& exposing(const WorkView& v) { return v.channels == 1 ? v : *(&v - v.channel + v.exposed_by); }

// One picture from the picture `of` each channel.
template <typename Of>
Image joined_channels(std::span<const WorkView> channels, const Of& of) {
  if (channels.size() == 1) return of(0);
  return in_color(of(0), of(1), of(2));
}

}  // namespace

Image picture_of(std::span<const WorkView> channels) {
  return joined_channels(channels, [&](std::size_t c) { return channels[c].picture; });
}

Image shown_of(std::span<const WorkView> channels, std::span<const double> exposures) {
  return joined_channels(channels, [&](std::size_t c) { return shown_picture(channels[c].radiance, exposures[c]); });
}

const Image& asked_for(const WorkView& view) { return view.wanted.data.empty() ? view.target.picture : view.wanted; }

Image target_of(std::span<const WorkView> channels) {
  return joined_channels(channels, [&](std::size_t c) { return asked_for(channels[c]); });
}

std::vector<double> best_exposures(std::span<const WorkView> channels, const std::vector<double>& log_exposure) {
  if (const auto& held = channels[0].spec.exposure) return std::vector<double>(channels.size(), *held);
  return free_exposures(channels, log_exposure);
}

std::vector<double> free_exposures(std::span<const WorkView> channels, const std::vector<double>& log_exposure) {
  std::vector<double> out;
  if (channels[0].spec.white.kind == White::Kind::each && channels.size() > 1) {
    for (const WorkView& v : channels)
      out.push_back(fitting_exposure({&exposing(v), 1}, std::exp(log_exposure[v.exposure_group])));
    return out;
  }
  const double guess = std::exp(log_exposure[channels[0].exposure_group]);
  if (channels.size() == 1)
    return {best_exposure(channels[0].radiance, asked_for(channels[0]), guess, channels[0].target.mask)};
  out.assign(channels.size(), fitting_exposure(channels, guess));
  return out;
}

void hold_exposures(const std::vector<WorkView>& views, std::vector<double>& log_exposure) {
  for (const WorkView& v : views)
    if (v.spec.exposure) log_exposure[v.exposure_group] = std::log(*v.spec.exposure);
}

std::vector<double> fitting_exposures(const std::vector<WorkView>& views, const std::vector<double>& log_exposure) {
  double together = 0;  // for the consecutive channels that share an exposure
  return means_of_groups(views, log_exposure.size(), [&](const WorkView& v) {
    if (v.spec.exposure) return std::log(*v.spec.exposure);
    const double guess = std::exp(log_exposure[v.exposure_group]);
    if (v.channels == 1 || v.spec.white.kind == White::Kind::each)
      return std::log(fitting_exposure({&exposing(v), 1}, guess));
    if (v.channel == 0) together = std::log(fitting_exposure({&v, 3}, guess));
    return together;
  });
}

std::vector<double> starting_exposures(const std::vector<WorkView>& views, std::size_t groups, double start_light) {
  std::vector<double> crossing = means_of_groups(views, groups, [](const WorkView& v) {
    double most = 0;
    for (const WorkLamp& lamp : v.lamps) most = std::max(most, mean_value(lamp.unit));
    return std::log(most * v.pitch_mm);
  });
  for (double& c : crossing) c = std::log(start_light) - c;
  hold_exposures(views, crossing);
  return crossing;
}

}  // namespace burin

#include "burin/optimize/design/view_limits.h"

#include <algorithm>
#include <array>
#include <functional>
#include <utility>

#include "burin/base/files/decimals.h"
#include "burin/optimize/design/bright_part.h"
#include "burin/optimize/design/glint.h"
#include "burin/optimize/loss/color_metrics.h"
#include "burin/scene/blur.h"
#include "burin/scene/groove_profile.h"

namespace burin {
namespace {

constexpr float kOfFace = 0.9F;  // grooves cover a little of it

double psnr_of(std::span<const WorkView> channels, const std::vector<double>& log_exposure, const Image& target) {
  return color_psnr_db(shown_of(channels, best_exposures(channels, log_exposure)), target, channels[0].target.mask);
}

// Gain of a view in dB if its radiance were changed so.
double lift_db(std::span<WorkView> channels, const std::vector<double>& log_exposure,
               const std::function<void(const WorkView&, Image& radiance)>& change) {
  const Image target = target_of(channels);
  const double before = psnr_of(channels, log_exposure, target);
  std::vector<Image> kept;
  for (WorkView& v : channels) {
    kept.push_back(v.radiance);
    change(v, v.radiance);
  }
  const double after = psnr_of(channels, log_exposure, target);
  for (std::size_t c = 0; c < channels.size(); ++c) channels[c].radiance = std::move(kept[c]);
  return std::max(0.0, after - before);
}

Image without_face(const WorkView& view, Image radiance) {
  for (std::size_t i = 0; i < radiance.data.size(); ++i)
    radiance.data[i] = std::max(0.0F, radiance.data[i] - kOfFace * view.face.data[i]);
  return radiance;
}

// Whole grooves, dimmed by the mean loss at crossings around them.
void cut_evenly(WorkView& view, const Carved& whole, Image& radiance) {
  constexpr double kAroundPx = 3;
  constexpr float kLittle = 1e-6F;
  Image uncut;
  view.renderer.forward(whole, uncut);
  uncut = without_face(view, std::move(uncut));
  const Image left = blurred(without_face(view, radiance), kAroundPx), all = blurred(uncut, kAroundPx);
  const float most = *std::max_element(all.data.begin(), all.data.end());
  for (std::size_t i = 0; i < radiance.data.size(); ++i)
    radiance.data[i] = std::min(radiance.data[i], kOfFace * view.face.data[i]) +
                       uncut.data[i] * left.data[i] / std::max(all.data[i], kLittle * most);
}

}  // namespace

ViewLimits limits_of(std::span<WorkView> channels, const std::vector<double>& log_exposure, const LyingGrooves& grooves,
                     const Bench& bench, const Board& board) {
  ViewLimits out;
  const auto lift = [&](const auto& change) { return lift_db(channels, log_exposure, change); };
  if (grooves.cuts)
    out.crossings = lift([&](const WorkView& v, Image& radiance) {
      cut_evenly(channels[static_cast<std::size_t>(v.channel)], grooves.whole, radiance);
    });
  if (std::all_of(channels.begin(), channels.end(), [](const WorkView& v) { return v.sees_lines; }))
    out.crosstalk = lift([&](const WorkView& v, Image& radiance) {
      channels[static_cast<std::size_t>(v.channel)].renderer.forward(
          seen_by(v, grooves, bright_rows(v, bench, grooves.whole.scratches)), radiance);
    });
  out.face = lift([](const WorkView& v, Image& radiance) { radiance = without_face(v, std::move(radiance)); });
  const Eigen::Vector2d middle = (board.carve_min_mm + board.carve_max_mm) / 2;
  const GrooveProfile& profile = bench.material.profile;
  const double steepest =
      wall_lean(profile, board.tool_width_um, half_width_um(profile, board.tool_width_um, bench.material.depth_um));
  out.cutoff = lift([&](const WorkView& v, Image& radiance) {
    double most = 0;
    for (const WorkLamp& lamp : v.lamps)
      most =
          std::max(most, reach(lean_at(lamp.glint, {middle.x(), middle.y(), 0}).angle, steepest, bench.material.alpha));
    if (!(most > 0)) return;
    for (std::size_t i = 0; i < radiance.data.size(); ++i) {
      const float of_face = std::min(radiance.data[i], kOfFace * v.face.data[i]);
      radiance.data[i] = of_face + (radiance.data[i] - of_face) / static_cast<float>(most);
    }
  });
  return out;
}

double pixels_limit_db(std::span<const WorkView> channels, const std::vector<double>& log_exposure,
                       const Image& coarse) {
  const Image target = target_of(channels);
  const Image without_detail = resized(coarse, target.width, target.height);
  return std::max(0.0, psnr_of(channels, log_exposure, without_detail) - psnr_of(channels, log_exposure, target));
}

Finding limits_in_words(const std::string& view, double psnr_db, const ViewLimits& limits, bool more_fit) {
  constexpr double kFelt = 0.15;  // dB
  struct Limit {
    double db;
    const char *what, *lift;
  };
  std::array<Limit, 5> all{{{limits.crossings, "grooves that cross", "a sharper tool or a larger board"},
                            {limits.crosstalk, "the other views' grooves", "places further apart"},
                            {limits.face, "the plain face", "a more polished face"},
                            {limits.cutoff, "walls that are not steep enough",
                             "deeper grooves, or eye and lamp closer to where the plain face mirrors"},
                            {limits.pixels, "the design's pixels", "more of them (--pixels)"}}};
  std::stable_sort(all.begin(), all.end(), [](const Limit& a, const Limit& b) { return a.db > b.db; });
  std::string cost;
  for (const Limit& limit : all)
    if (limit.db >= kFelt)
      cost += (cost.empty() ? "" : ", ") + std::string(limit.what) + " " + fixed(limit.db, 1) + " dB";
  const bool any = !cost.empty();
  return {FindingCode::view_limit, Finding::Severity::note, "design",
          "view " + view + " reaches " + fixed(psnr_db, 1) + " dB; " +
              (any ? "without one of these it would gain: " + cost : "the number of its scratches alone limits it"),
          any        ? std::string(all[0].lift) + " would lift it most"
          : more_fit ? "more scratches would lift it"
                     : "a larger board or a sharper tool has room for more"};
}

}  // namespace burin

// The search's input from a design's views (design_views.h): each view under each of its lights.
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <utility>

#include "burin/optimize/design/crossing_loss.h"
#include "burin/optimize/design/design_views.h"

namespace burin {
namespace {

// A view (or channel) under one of its lights as the search's input: light, unit and weight at an exposure.
StrokeAside seen_under(const WorkView& v, const WorkLamp& lamp, double log_exposure, bool from_face, int picture) {
  StrokeAside out{lamp.glint,       from_face ? v.face : v.radiance,
                  lamp.unit,        v.spec.weight * v.share * v.balance,
                  v.target.picture, picture};
  const auto e = static_cast<float>(std::exp(log_exposure));
  for (float& l : out.light.data) l *= e;
  for (float& u : out.unit.data) u *= e * static_cast<float>(v.pitch_mm);
  leave_what_crossings_do(v, out.unit);
  out.kept = v.crossings.kept;
  return out;
}

bool any_in_color(const std::vector<WorkView>& views) {
  return std::any_of(views.begin(), views.end(), [](const WorkView& v) { return v.channels > 1; });
}

// Mean light of a scratch of the best direction, for each view's lamps.
std::vector<std::vector<double>> mean_units(const std::vector<WorkView>& views) {
  std::vector<std::vector<double>> out(views.size());
  for (std::size_t i = 0; i < views.size(); ++i)
    for (const WorkLamp& lamp : views[i].lamps) out[i].push_back(mean_value(lamp.unit));
  return out;
}

// A ghost as input of the search. It gets the mask of its own picture if that differs from the view's.
StrokeAside with_its_mask(StrokeAside seen, const Image& own, const Image& mask) {
  if (own.data != mask.data) seen.mask = own;
  return seen;
}

}  // namespace

void find_ghosts(std::vector<WorkView>& views, double alpha, const Eigen::Vector2d& middle_mm) {
  constexpr double kLittle = 0.01;
  constexpr std::size_t kMost = 2;  // more bring nothing (docs/light.md)
  if (!any_in_color(views) || views.back().aside) return;
  const Eigen::Vector3d middle(middle_mm.x(), middle_mm.y(), 0);
  const std::vector<std::vector<double>> units = mean_units(views);
  for (std::size_t k = 0; k < views.size(); ++k)
    for (WorkLamp& own : views[k].lamps) {
      if (!own.leads) continue;
      const Lean at = lean_at(own.glint, middle);
      std::vector<std::pair<double, WorkGhost>> found;
      for (std::size_t i = 0; i < views.size(); ++i) {
        if (i == k || units[i].empty()) continue;
        std::pair<double, WorkGhost> most{0, {i, 0}};
        const double white = std::max(*std::max_element(units[i].begin(), units[i].end()), 1e-300);
        WorkLamp* itself = nullptr;  // the same light in another channel, which is part of the view anyway
        for (std::size_t l = 0; l < units[i].size(); ++l) {
          WorkLamp& lamp = views[i].lamps[l];
          if (views[i].of == views[k].of && lamp.light == own.light) itself = &lamp;
          const Lean lean = lean_at(lamp.glint, middle);
          const double shows = lobe(lean.angle, std::remainder(lean.azimuth - at.azimuth, std::numbers::pi), alpha) *
                               units[i][l] / white;
          if (shows > most.first) most = {shows, {i, l}};
        }
        if (itself != nullptr) {
          // A picture occurs in a view once: under its own light there, or under another with more of its scratches'
          // light.
          itself->outshone = &views[i].lamps[most.second.lamp] != itself && most.first > 0;
          if (itself->outshone) own.ghosts.push_back(most.second);
        } else if (most.first > kLittle) {
          found.push_back(most);
        }
      }
      std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
      for (std::size_t n = 0; n < std::min(kMost, found.size()); ++n) own.ghosts.push_back(found[n].second);
    }
}

std::vector<std::size_t> views_served(const std::vector<WorkView>& views) {
  std::vector<std::size_t> out;
  for (const WorkView& v : views)
    for (const WorkLamp& lamp : v.lamps)
      if (lamp.leads) out.push_back(v.of);
  return out;
}

std::vector<StrokeView> stroke_views(const std::vector<WorkView>& views, const std::vector<double>& log_exposure,
                                     bool from_face, Ghosts ghosts) {
  const bool color = any_in_color(views);
  const auto seen = [&](std::size_t i, std::size_t lamp) {
    return seen_under(views[i], views[i].lamps[lamp], log_exposure[views[i].exposure_group], from_face,
                      color ? static_cast<int>(i) : -1);
  };
  std::vector<StrokeView> out;
  // Index of a view of the spec under one of its lights.
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> place;
  // Leading lights come first, then the other pictures of each.
  for (const bool leading : {true, false})
    for (std::size_t i = 0; i < views.size(); ++i)
      for (std::size_t l = 0; l < views[i].lamps.size(); ++l) {
        const WorkView& v = views[i];
        const WorkLamp& lamp = v.lamps[l];
        if (lamp.leads != leading || (lamp.outshone && ghosts == Ghosts::count)) continue;
        StrokeAside one = seen(i, l);
        if (!leading) {
          out[place.at({v.of, lamp.light})].asides.push_back(std::move(one));
          continue;
        }
        place.emplace(std::pair{v.of, lamp.light}, out.size());
        out.push_back({std::move(one.glint),
                       std::move(one.light),
                       std::move(one.target),
                       v.target.mask,
                       std::move(one.unit),
                       one.weight,
                       {},
                       one.picture,
                       {},
                       std::move(one.kept)});
      }
  if (const Image cost = crossing_cost(views, log_exposure); !cost.data.empty())
    for (StrokeView& v : out) v.cost = cost;
  if (ghosts == Ghosts::leave_out) return out;
  for (const WorkView& v : views)
    for (const WorkLamp& lamp : v.lamps)
      for (const WorkGhost& ghost : lamp.ghosts) {
        StrokeView& in = out[place.at({v.of, lamp.light})];
        in.asides.push_back(with_its_mask(seen(ghost.view, ghost.lamp), views[ghost.view].target.mask, in.mask));
      }
  return out;
}

void balance_views(std::vector<WorkView>& views, const std::vector<double>& log_exposure, double exponent) {
  constexpr double kMost = 8;  // no view is sacrificed for another
  for (WorkView& v : views) v.balance = 1;
  if (exponent == 0) return;
  // A view's errors are those of its own pictures.
  std::vector<StrokeView> seen = stroke_views(views, log_exposure, false, Ghosts::leave_out);
  const std::vector<std::size_t> shows = views_served(views);
  std::vector<std::vector<StrokeView>> of_view(shows.empty() ? 0 : *std::max_element(shows.begin(), shows.end()) + 1);
  for (std::size_t k = 0; k < seen.size(); ++k) of_view[shows[k]].push_back(std::move(seen[k]));
  std::vector<double> log_error;
  log_error.reserve(of_view.size());
  for (const std::vector<StrokeView>& v : of_view) log_error.push_back(std::log(std::max(squared_error(v), 1e-12)));
  const double mean = std::accumulate(log_error.begin(), log_error.end(), 0.0) / static_cast<double>(log_error.size());
  for (WorkView& v : views) v.balance = std::clamp(std::exp(exponent * (log_error[v.of] - mean)), 1 / kMost, kMost);
}

}  // namespace burin

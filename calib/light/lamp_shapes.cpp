#include "burin/calib/light/lamp_shapes.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace burin {
namespace {

void add_move(const LampFit& with, const LampFit& without, std::size_t light, LampShapes& shapes) {
  Eigen::Vector3d& moved = shapes.moved_mm[light];
  moved = moved.cwiseMax((with.blocks.lamps[light].place() - without.blocks.lamps[light].place()).cwiseAbs());
}

// An area light: a plane, which shines less to the side, unless it has a spotlight's exponent.
LampFit with_area(const LampData& data, const LampShapes& shapes, std::size_t light, const LampFitOptions& options) {
  constexpr double kStart = 0.15;  // of its distance
  LampParameters from = shapes.fit.blocks;
  LampBlocks& lamp = from.lamps[light];
  lamp.area[0] = lamp.area[2] = kStart * distance_mm(data, lamp);
  if (!shapes.spot[light]) {
    lamp.spot[0] = data.center_mm.x();
    lamp.spot[1] = data.center_mm.y();
    lamp.spot[2] = kPlaneExponent;
  }
  return fit_lamp_parameters(data, from, shapes.spot, options);
}

// A brushed face, from several directions: a lamp fitted without grain may be far off.
LampFit with_grain(const LampData& data, const LampShapes& shapes, const LampFitOptions& options) {
  constexpr double kStart = 0.3;
  std::vector<LampParameters> starts;
  for (int i = 0; i < 4; ++i) {
    LampParameters& from = starts.emplace_back(shapes.fit.blocks);
    const double twice = 2 * std::numbers::pi * i / 4;
    from.grain[0] = kStart * std::cos(twice);
    from.grain[1] = kStart * std::sin(twice);
  }
  return best_lamp_fit(data, starts, shapes.spot, options);
}

// Glossy paper.
LampFit with_gloss(const LampData& data, const LampShapes& shapes, const LampFitOptions& options) {
  LampParameters from = shapes.fit.blocks;
  from.gloss[0] = 0.04;  // of a refractive index of 1.5
  from.gloss[1] = 0.3;
  return fit_lamp_parameters(data, from, shapes.spot, options);
}

}  // namespace

void try_spots(const LampData& data, const std::vector<bool>& usable, LampShapes& shapes) {
  for (std::size_t light = 0; light < usable.size(); ++light) {
    if (!usable[light] || shapes.spot[light]) continue;
    std::vector<bool> with_spot = shapes.spot;
    with_spot[light] = true;
    constexpr LampFitOptions kThinned{.stride = 10};  // a tenth of the samples chooses the start
    std::vector<LampParameters> starts;
    for (const double exponent : {2., 8., 25.}) {
      LampParameters& from = starts.emplace_back(shapes.fit.blocks);
      from.lamps[light].spot[0] = data.center_mm.x();
      from.lamps[light].spot[1] = data.center_mm.y();
      from.lamps[light].spot[2] = exponent;
    }
    const LampFit thin = best_lamp_fit(data, starts, with_spot, kThinned);
    if (!thin.usable) continue;
    LampFit best = fit_lamp_parameters(data, thin.blocks, with_spot);
    // A spotlight has three more parameters. Errors of paper and face are not independent. The threshold is therefore
    // far above a test of white noise.
    constexpr double kWorthIt = 0.9;
    if (!best.usable || !(best.cost < shapes.fit.cost)) continue;
    if (!(best.cost < kWorthIt * shapes.fit.cost)) {
      add_move(best, shapes.fit, light, shapes);
      continue;
    }
    shapes.fit = std::move(best);
    shapes.spot = with_spot;
  }
}

bool try_areas_and_coats(const LampData& data, const std::vector<bool>& usable, LampShapes& shapes) {
  // A fraction of the face's samples rejects most candidates. Absent effects would take many iterations along a valley:
  // areas of points, coats of matte paper.
  constexpr LampFitOptions kThinned{.stride = 8}, kBrief{.stride = 8, .iterations = 20};
  constexpr double kNear = 0.93;
  const std::size_t lamps = usable.size(), grain = lamps, gloss = lamps + 1;  // candidates, by number
  std::vector<bool> open = usable, refused(lamps + 2, false);
  if (shapes.fit.blocks.stray_distance_mm > 0) open.assign(lamps, false);
  open.resize(lamps + 2, true);
  // As for spotlights, the threshold is far above a test of white noise.
  const auto worth_it = [&](std::size_t k) { return k == gloss ? 0.75 : k == grain ? 0.85 : 0.9; };
  const auto is_nothing = [&](std::size_t k, const LampParameters& found) {
    constexpr double kLeastGrain = 0.02, kLeastGloss = 0.012;  // glare looks like less
    return (k == grain && std::hypot(found.grain[0], found.grain[1]) < kLeastGrain) ||
           (k == gloss && found.gloss[0] < kLeastGloss);
  };
  bool took = false;
  while (true) {
    const LampFit plain = fit_lamp_parameters(data, shapes.fit.blocks, shapes.spot, kThinned);
    std::vector<LampFit> fits(lamps + 2);
    tbb::parallel_for(std::size_t{0}, fits.size(), [&](std::size_t k) {
      if (!open[k] || refused[k]) return;
      fits[k] = k == grain   ? with_grain(data, shapes, kThinned)
                : k == gloss ? with_gloss(data, shapes, kBrief)
                             : with_area(data, shapes, k, kBrief);
    });
    LampFit thin;
    std::size_t which = grain;
    for (std::size_t k = 0; k < fits.size(); ++k) {
      LampFit& fit = fits[k];
      if (fit.usable && fit.cost < plain.cost && k < lamps) add_move(fit, plain, k, shapes);
      // All samples are used only if a fraction of them comes near to the threshold.
      if (!fit.usable || !(fit.cost < kNear * plain.cost) || !(fit.cost < thin.cost)) continue;
      thin = std::move(fit);
      which = k;
    }
    if (!thin.usable) return took;
    LampFit best = fit_lamp_parameters(data, thin.blocks, shapes.spot);
    if (!best.usable || !(best.cost < worth_it(which) * shapes.fit.cost) || is_nothing(which, best.blocks)) {
      refused[which] = true;
      continue;
    }
    shapes.fit = std::move(best);
    open[which] = false;
    refused.assign(lamps + 2, false);  // the new model may have masked others
    shapes.moved_mm.assign(lamps, Eigen::Vector3d::Zero());
    took = true;
  }
}

bool try_stray(const LampData& data, const LampParameters& by_paper, LampShapes& shapes) {
  constexpr LampFitOptions kThinned{.stride = 10, .iterations = 15};
  constexpr double kShare = 0.1, kWorthIt = 0.6;  // of the lamp's light, at first; of the cost
  const LampBlocks& lamp = by_paper.lamps.front();
  const std::vector<bool> no_spot(shapes.spot.size(), false);
  const double distance = distance_mm(data, lamp);
  std::vector<LampParameters> starts;
  for (const double lean_deg : {20., 40., 60.})
    for (int i = 0; i < 8; ++i) {
      const double tangent = std::tan(lean_deg * std::numbers::pi / 180), azimuth = 2 * std::numbers::pi * i / 8;
      LampParameters& from = starts.emplace_back(by_paper);
      from.stray_distance_mm = distance;
      from.stray[0] = tangent * std::cos(azimuth);
      from.stray[1] = tangent * std::sin(azimuth);
      from.stray[2] = lamp.log_intensity[0] - 2 * std::log(distance) + std::log(kShare);
    }
  const LampFit thin = best_lamp_fit(data, starts, no_spot, kThinned);
  if (!thin.usable) return false;
  LampFit best = fit_lamp_parameters(data, thin.blocks, no_spot);
  if (!best.usable || !(best.cost < kWorthIt * shapes.fit.cost)) return false;
  shapes.fit = std::move(best);
  shapes.spot = no_spot;
  shapes.moved_mm.assign(no_spot.size(), Eigen::Vector3d::Zero());
  return true;
}

}  // namespace burin

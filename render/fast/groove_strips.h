// burin/render/fast/groove_strips.h - scratches as the straight strips that the fast path renders: each groove, and
// behind all grooves the burrs beside those that have theirs. Frame: board, mm. docs/model.md 8.6.
//
// A wall's lean depends on its place across the groove alone, not on how deep the groove is: depth says where the
// groove ends (GrooveProfile). Burrs begin there, and move as it grows deeper.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "burin/render/fast/tile_runs.h"
#include "burin/scene/groove_profile.h"
#include "burin/scene/scratches.h"

namespace burin {

/// What a strip is of the section.
enum class SectionPart : std::uint8_t { groove, left_burr, right_burr };
inline constexpr int kSectionParts = 3;

/// One strip for each scratch; of each number one for each, or one for all.
ScratchLines lines_of(const Scratches& scratches, std::span<const float> per_mm, std::span<const float> rim,
                      std::span<const float> alpha);

struct GrooveStrips {
  /// What the strips are made of: numbers that scratches have of their own, or one for all. They belong to the caller.
  struct Shapes {
    const GrooveProfile* profile = nullptr;
    double tool_width_um = 400;  ///< what t counts in where the section has a radius of its own, whatever the widths
    std::span<const double> width_um, depth_um;
    std::span<const float> alpha;
    float burr_rim = 1;  ///< t of a burr's edge, from its middle
  };

  std::size_t grooves = 0;
  /// Of strip grooves + k: the scratch that it lies beside, and how far its middle line lies from that one's, mm: to
  /// its right (across, as in StripDirection) above 0.
  std::vector<std::uint32_t> owner;
  std::vector<double> aside_mm;

  std::size_t burrs() const { return owner.size(); }
  /// What t = 2 x / unit counts in for a groove of that width, um.
  static double unit_um(const GrooveProfile& profile, double tool_width_um, double width_um) {
    return profile.tip_radius_um > 0 ? tool_width_um : width_um;
  }
  /// The largest |t| that grooves of these shapes reach. Comes before make().
  double measure(const Shapes& shapes);
  /// Strips of scratches; both must stay where they are while the lines are read.
  ScratchLines make(const Scratches& scratches, const Shapes& shapes);

 private:
  std::vector<double> half_um_;          // of each different groove
  std::vector<Eigen::Vector2d> across_;  // of each groove, unit; without burrs or length none
  std::vector<double> x0_, y0_, x1_, y1_;
  std::vector<float> per_mm_, rim_, alpha_;
  std::vector<std::uint8_t> part_;
};

}  // namespace burin

// burin/render/fast/groove_strips.h - scratches as straight strips of the fast path: first all grooves, then the burrs
// of grooves that have them. Frame: board, mm. docs/model.md 8.6.
//
// A wall's lean depends on its position across the groove alone, not on the groove's depth. Depth sets the edges of the
// groove (GrooveProfile). Burrs begin there and move as it becomes deeper.
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

/// Part of the section that a strip represents.
enum class SectionPart : std::uint8_t { groove, left_burr, right_burr };
inline constexpr int kSectionParts = 3;

/// One strip per scratch. Each array has one number per scratch, or one for all.
ScratchLines lines_of(const Scratches& scratches, std::span<const float> per_mm, std::span<const float> rim,
                      std::span<const float> alpha);

struct GrooveStrips {
  /// Numbers of the scratches, one each or one for all. The caller owns them.
  struct Shapes {
    const GrooveProfile* profile = nullptr;
    double tool_width_um = 400;  ///< unit of t for a section with its own radius, for any width
    std::span<const double> width_um, depth_um;
    std::span<const float> alpha;
    float burr_rim = 1;  ///< t of a burr's edge, from its middle
  };

  std::size_t grooves = 0;
  /// Strip grooves + k: the index of its scratch, and the offset of its middle line from the scratch's, mm. Positive
  /// offsets are to the right (across, as in StripDirection).
  std::vector<std::uint32_t> owner;
  std::vector<double> aside_mm;

  std::size_t burrs() const { return owner.size(); }
  /// Unit of t = 2 x / unit for a groove of this width, um.
  static double unit_um(const GrooveProfile& profile, double tool_width_um, double width_um) {
    return profile.tip_radius_um > 0 ? tool_width_um : width_um;
  }
  /// The largest |t| of grooves of these shapes. Call it before make().
  double measure(const Shapes& shapes);
  /// Strips of scratches. Scratches and this object must stay in place while the lines are in use.
  ScratchLines make(const Scratches& scratches, const Shapes& shapes);

 private:
  std::vector<double> half_um_;          // of each different groove
  std::vector<Eigen::Vector2d> across_;  // of each groove, unit vector; zero without burrs or length
  std::vector<double> x0_, y0_, x1_, y1_;
  std::vector<float> per_mm_, rim_, alpha_;
  std::vector<std::uint8_t> part_;
};

}  // namespace burin

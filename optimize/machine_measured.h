// burin/optimize/machine_measured.h - what a coupon told of a machine (burin coupon): the object "measured" of a
// burin/machine file, and the depth table that follows. docs/file-formats.md, "A carving machine".
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "burin/optimize/depth_table.h"

namespace burin {

/// A number with its standard deviation.
struct MeasuredNumber {
  double value = 0, sigma = 0;
};

/// What came of one command at one speed. Nothing: the photos did not tell.
struct MeasuredCell {
  double command = 0;  ///< mm below contact or below the face, or a servo's S
  double feed_mm_min = 0, spacing_mm = 0;
  int fans = 0;  ///< carved alike, at different places and times
  std::optional<MeasuredNumber> depth_um, alpha;
};

/// What a coupon told of its machine.
struct MachineMeasured {
  int coupon = 0;
  std::string date;
  double tool_width_um = 0;
  double usual_feed_mm_min = 0, usual_spacing_mm = 0;
  std::vector<MeasuredCell> cells;
  std::optional<MeasuredNumber> repeat_depth, repeat_alpha;  ///< standard deviations of logarithms
  double wear_over_mm = 0;                                   ///< of carving
  std::optional<MeasuredNumber> wear_depth, wear_alpha;      ///< logarithms' change over it
  std::optional<MeasuredNumber> travel_depth;                ///< deeper by this share going one way than back
  double travel_towards_deg = 0;
};

/// The depth table that the cells at the usual speed and spacing make, with sigmas. Neighbors whose depths do not rise
/// with the command, within two sigmas, are taken together; empty where fewer than two rows are left, or where depths
/// fall beyond that: such a machine has no table.
DepthTable measured_table(const MachineMeasured& measured);

}  // namespace burin

// burin/optimize/machine_measured.h - a coupon's measurement of a machine (burin coupon): the object "measured" of a
// burin/machine file, and the resulting depth table. docs/file-formats.md, "A carving machine".
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

/// The result of one command at one speed. Depth or alpha is empty if the photos did not determine it.
struct MeasuredCell {
  double command = 0;  ///< mm below contact or below the face, or a servo's S
  double feed_mm_min = 0, spacing_mm = 0;
  int fans = 0;  ///< carved alike, at different places and times
  std::optional<MeasuredNumber> depth_um, alpha;
};

/// A coupon's measurement of its machine.
struct MachineMeasured {
  int coupon = 0;
  std::string date;
  double tool_width_um = 0;
  double usual_feed_mm_min = 0, usual_spacing_mm = 0;
  std::vector<MeasuredCell> cells;
  std::optional<MeasuredNumber> repeat_depth, repeat_alpha;  ///< standard deviations of logarithms
  double wear_over_mm = 0;                                   ///< carved length
  std::optional<MeasuredNumber> wear_depth, wear_alpha;      ///< change of the logarithms over wear_over_mm
  /// Relative increase of depth in one direction of travel against the other.
  std::optional<MeasuredNumber> travel_depth;
  double travel_towards_deg = 0;
};

/// The depth table from the cells at the usual speed and spacing, with sigmas. It pools neighbors whose depths do not
/// rise with the command, if they agree within two sigmas. The table is empty if depths fall by more than two sigmas,
/// or if fewer than two rows remain.
DepthTable measured_table(const MachineMeasured& measured);

}  // namespace burin

// burin/optimize/toolpath/planned_path.h - scratches as a machine will be told them, in the order it will carve them.
// Frame: the machine's (burin/optimize/machine_profile.h), mm.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "burin/optimize/toolpath/carving_order.h"
#include "burin/optimize/toolpath/face.h"
#include "burin/optimize/toolpath/workpiece.h"
#include "burin/scene/carve.h"

namespace burin {

/// One scratch as it is sent to the machine.
struct PlannedScratch {
  std::uint32_t scratch = 0;       ///< its row in the scratches, from 0
  Eigen::Vector2d from_mm, to_mm;  ///< machine coordinates, compensated
  double depth_mm = 0;             ///< below the face, positive
  double feed_mm_min = 0;          ///< along it; 0: the machine's
  double travel_z_mm = 0;          ///< Z of the way to it from the scratch before
};

struct Toolpath {
  std::vector<PlannedScratch> scratches;  ///< in carving order
  Sent sent;                              ///< the same with all columns, as told: what sent.csv holds
  std::vector<CarvingStep> order;         ///< the same order, by row of the scratches that were given
  Eigen::Vector2d min_mm, max_mm;         ///< what the tool's tip covers while carving
  double carve_mm = 0, travel_mm = 0;     ///< ways in the metal and in the air (from work zero)
  double file_order_travel_mm = 0;        ///< what the travel would be in the order of the scratches given
  Face face;                              ///< that the depths follow
  double first_z_mm = 0;                  ///< Z of a file's first way along X and Y, and of its last
  double kept_z_mm = 0;                   ///< Z while scratches are carved, of machines whose Z stays (keeps_z())
  Workpiece workpiece;                    ///< that it is carved into
  double duration_s = 0;                  ///< estimate, with acceleration, for the built-in way to carve a scratch
  bool kept_order = false;                ///< whether the order is that of the scratches given
  bool compensated = false;               ///< whether a measured map, or a machine's errors, were undone
  std::size_t already_carved = 0;         ///< rows of the scratches given that are in the metal and are left out
  double stepped_mm = 0;                  ///< the farthest that the machine's steps move an end
  std::size_t done_before = 0;            ///< scratches of the interrupted file that are done
};

}  // namespace burin

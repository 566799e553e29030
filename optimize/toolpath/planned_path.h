// burin/optimize/toolpath/planned_path.h - commanded scratches in carving order. Frame: the machine's
// (burin/optimize/machine_profile.h), mm.
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

/// One commanded scratch.
struct PlannedScratch {
  std::uint32_t scratch = 0;       ///< its row in the scratches, from 0
  Eigen::Vector2d from_mm, to_mm;  ///< machine coordinates, compensated
  double depth_mm = 0;             ///< below the face, positive
  double feed_mm_min = 0;          ///< along it; 0: the machine's
  double travel_z_mm = 0;          ///< Z of the travel from the previous scratch
};

/// Planned scratches in carving order, with commanded positions and depths.
struct Toolpath {
  std::vector<PlannedScratch> scratches;  ///< in carving order
  Sent sent;                              ///< the same with all columns: the content of sent.csv
  std::vector<CarvingStep> order;         ///< the same order, by row of the given scratches
  Eigen::Vector2d min_mm, max_mm;         ///< extent of the tool's tip while carving
  double carve_mm = 0, travel_mm = 0;     ///< lengths in the metal and in the air (from work zero)
  double file_order_travel_mm = 0;        ///< travel in the order of the given scratches
  Face face;                              ///< reference of the depths
  double first_z_mm = 0;                  ///< Z of a file's first way along X and Y, and of its last
  double kept_z_mm = 0;                   ///< Z while scratches are carved, for machines with a constant Z (keeps_z())
  Workpiece workpiece;                    ///< sheet to be carved
  double duration_s = 0;                  ///< estimate, with acceleration, for the built-in moves of a scratch
  bool kept_order = false;                ///< the order is that of the given scratches
  bool compensated = false;               ///< a measured map, or a machine's errors, were inverted
  std::size_t already_carved = 0;         ///< rows of the given scratches in the metal, left out
  double stepped_mm = 0;                  ///< largest move of an end by the machine's steps
  std::size_t done_before = 0;            ///< finished scratches of the interrupted file
};

}  // namespace burin

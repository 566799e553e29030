// tools/report/residuals.h - `residuals.vnl`, which `burin calibrate` leaves beside bench.json: what is left between
// each tag corner as found in a photo and as the solved bench predicts it. A text table as vnlog writes it: lines with
// '#' are comments but for the first, which names the columns
//   # view tag corner x_px y_px dx_px dy_px used
// (x_px, y_px): the corner as found; (dx_px, dy_px): found minus predicted; used: 0 where it was left out as an
// outlier. Pixels: the center of the top-left pixel is (0, 0).
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

namespace burin {

struct ShownResidual {
  std::string view;
  int tag = 0;
  Eigen::Vector2d q_px{0, 0}, residual_px{0, 0};
  bool left_out = false;
};

struct ResidualTable {
  std::vector<ShownResidual> corners;

  double rms_px() const;  ///< per axis, of the corners that were used; 0 if there are none
};

/// An empty table if the file does not exist. Throws Error naming the line of a broken one.
ResidualTable read_residuals(const std::filesystem::path& file);

}  // namespace burin

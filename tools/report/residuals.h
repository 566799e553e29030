// tools/report/residuals.h - reads `residuals.vnl` of `burin calibrate`, next to bench.json: residuals between the
// detected tag corners and the solved bench's predictions. It is a text table in vnlog format. Lines with '#' are
// comments, except the first, which names the columns:
//   # view tag corner x_px y_px dx_px dy_px used
// (x_px, y_px): the detected corner; (dx_px, dy_px): detected minus predicted; used: 0 for an outlier. Pixels: the
// center of the top-left pixel is (0, 0).
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

  double rms_px() const;  ///< per axis, of the used corners; 0 without any
};

/// Returns an empty table if the file does not exist. Throws Error, with the line, for a broken one.
ResidualTable read_residuals(const std::filesystem::path& file);

}  // namespace burin

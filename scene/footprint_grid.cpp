#include "burin/scene/footprint_grid.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <string>

#include "burin/base/error.h"

namespace burin {
namespace {

constexpr double kMissed = std::numeric_limits<double>::quiet_NaN();

/// Inverting a lens by its own solver costs microseconds per pixel. The solver runs only at the nodes of this lattice.
/// Between them, interpolation gives the slopes to about 0.01 px, and two Newton steps on the projection finish them.
constexpr int kLatticeStep = 32;

/// Largest residual after the first Newton step; pixels above it use the lens's own solver.
constexpr double kNewtonRest_px = 1e-3;

void check_window(const PixelWindow& window, const char* where) {
  if (window.width < 1 || window.height < 1)
    fail(where, "the window is " + std::to_string(window.width) + " x " + std::to_string(window.height) + " pixels",
         "give one that holds at least a pixel");
}

void check_surface(const Surface& surface, const char* where) {
  if (!(surface.size_mm.x() > 0 && surface.size_mm.y() > 0 && surface.size_mm.allFinite() &&
        surface.bow_mm.allFinite()))
    fail(where, "the board has no size, or its bow is not a number", "set Surface::size_mm and Surface::bow_mm");
  if (!surface.bend) return;
  if (const auto fault = fault_of(*surface.bend, surface.size_mm))
    fail(std::string(where) + ": bend." + fault->field, fault->what, fault->remedy);
}

Eigen::Vector2d slope_of(const Eigen::Vector3d& v) {
  return v.z() > 0 ? Eigen::Vector2d(v.x() / v.z(), v.y() / v.z()) : Eigen::Vector2d(kMissed, kMissed);
}

/// A pinhole, or an OpenCV model with zero distortion.
bool is_undistorted(const Lens& lens) {
  if (lens.intrinsics.size() < 4) return false;
  if (lens.model == "LENSMODEL_PINHOLE") return true;
  if (lens.model.rfind("LENSMODEL_OPENCV", 0) != 0) return false;
  return std::all_of(lens.intrinsics.begin() + 4, lens.intrinsics.end(), [](double k) { return k == 0; });
}

void invert_row(const Lens& lens, const PixelWindow& window, int row, const std::vector<int>& columns,
                const Eigen::Vector2d* above, const Eigen::Vector2d* below, double fraction, Eigen::Vector2d* slope) {
  const int n = window.width + 1;
  const auto corner_px = [&](int c) { return Eigen::Vector2d(window.x0 + c - 0.5, window.y0 + row - 0.5); };
  for (std::size_t k = 0; k + 1 < columns.size(); ++k) {
    const Eigen::Vector2d left = above[k] + fraction * (below[k] - above[k]);
    const Eigen::Vector2d right = above[k + 1] + fraction * (below[k + 1] - above[k + 1]);
    const int c0 = columns[k], c1 = columns[k + 1];
    for (int c = c0; c <= c1; ++c) slope[c] = left + (right - left) * (static_cast<double>(c - c0) / (c1 - c0));
  }

  std::vector<Eigen::Vector3d> p(n);
  std::vector<Eigen::Vector2d> q(n);
  std::vector<PixelByPoint> dq_dp;
  std::vector<double> rest_px(n);
  for (int step = 0; step < 2; ++step) {
    for (int c = 0; c < n; ++c) p[c] = {slope[c].x(), slope[c].y(), 1};
    project(lens, p, q, &dq_dp);
    for (int c = 0; c < n; ++c) {
      const Eigen::Vector2d rest = corner_px(c) - q[c];
      rest_px[c] = rest.norm();
      slope[c] += dq_dp[c].leftCols<2>().inverse() * rest;
    }
  }
  for (int c = 0; c < n; ++c) {
    if (rest_px[c] < kNewtonRest_px && slope[c].allFinite()) continue;
    const std::array<Eigen::Vector2d, 1> q_px{corner_px(c)};
    std::array<Eigen::Vector3d, 1> v;
    unproject(lens, q_px, v);
    slope[c] = slope_of(v[0]);
  }
}

std::vector<int> lattice(int count) {
  std::vector<int> nodes;
  for (int i = 0; i < count; i += kLatticeStep) nodes.push_back(i);
  if (nodes.back() != count) nodes.push_back(count);
  return nodes;
}

/// Intersection of the ray from `origin` along `direction` with the front of the face; NaN without one.
Eigen::Vector2d meet_face(const Surface& surface, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  Eigen::Vector2d missed(kMissed, kMissed);
  if (!(direction.z() < 0)) return missed;
  double lambda = -origin.z() / direction.z();  // at the plane z = 0
  if (surface.bow_mm != Eigen::Vector3d::Zero()) {
    // Along the ray, the face's height minus the ray's is a quadratic c + b s + a s^2 of the distance s from there. The
    // root that is 0 for a flat face is the hit from the front (the slope is the discriminant's root).
    const double X = 2 * (origin.x() + lambda * direction.x()) / surface.size_mm.x() - 1,
                 dX = 2 * direction.x() / surface.size_mm.x();
    const double Y = 2 * (origin.y() + lambda * direction.y()) / surface.size_mm.y() - 1,
                 dY = 2 * direction.y() / surface.size_mm.y();
    const Eigen::Vector3d& bow = surface.bow_mm;
    const double c = bow[0] * X * X + bow[1] * X * Y + bow[2] * Y * Y;
    const double b = 2 * bow[0] * X * dX + bow[1] * (X * dY + Y * dX) + 2 * bow[2] * Y * dY - direction.z();
    const double a = bow[0] * dX * dX + bow[1] * dX * dY + bow[2] * dY * dY;
    const double discriminant = b * b - 4 * a * c;
    if (!(b > 0) || !(discriminant > 0)) return missed;
    lambda -= 2 * c / (b + std::sqrt(discriminant));
  }
  if (!(lambda > 0)) return missed;
  Eigen::Vector2d p = (origin + lambda * direction).head<2>();
  if (!(p.x() >= 0 && p.y() >= 0 && p.x() <= surface.size_mm.x() && p.y() <= surface.size_mm.y())) return missed;
  return p;
}

void fill_centers(const Surface& surface, FootprintGrid& grid) {
  const int width = grid.width(), height = grid.height();
  grid.center_mm.resize(static_cast<std::size_t>(width) * height);
  grid.normal.resize(grid.center_mm.size());
  const std::optional<Cylinder> cylinder = surface.bend ? std::optional(cylinder_of(surface)) : std::nullopt;
  tbb::parallel_for(tbb::blocked_range<int>(0, height), [&](const tbb::blocked_range<int>& rows) {
    for (int r = rows.begin(); r < rows.end(); ++r) {
      for (int c = 0; c < width; ++c) {
        const auto q = footprint_corners_mm(grid, c, r);
        const Eigen::Vector2d m = 0.25 * (q[0] + q[1] + q[2] + q[3]);
        const std::size_t i = static_cast<std::size_t>(r) * width + c;
        if (cylinder) {
          const BentPlace place = bent_place(*cylinder, m);
          grid.center_mm[i] = place.position_mm;
          grid.normal[i] = place.normal;
          continue;
        }
        grid.center_mm[i] = {m.x(), m.y(), height_mm(surface, m.x(), m.y())};
        grid.normal[i] = face_normal(surface, m.x(), m.y());
      }
    }
  });
}

}  // namespace

CornerRays corner_rays(const Lens& lens, const PixelWindow& window) {
  check_window(window, "corner_rays");
  CornerRays rays;
  rays.window = window;
  const int n_columns = window.width + 1, n_rows = window.height + 1;
  rays.slope.resize(static_cast<std::size_t>(n_columns) * n_rows);

  rays.undistorted = is_undistorted(lens);
  if (rays.undistorted) {
    rays.fxycxy = {lens.intrinsics[0], lens.intrinsics[1], lens.intrinsics[2] - window.x0,
                   lens.intrinsics[3] - window.y0};
    for (int r = 0; r < n_rows; ++r)
      for (int c = 0; c < n_columns; ++c)
        rays.slope[static_cast<std::size_t>(r) * n_columns + c] = {(c - 0.5 - rays.fxycxy[2]) / rays.fxycxy[0],
                                                                   (r - 0.5 - rays.fxycxy[3]) / rays.fxycxy[1]};
    return rays;
  }

  const std::vector<int> columns = lattice(window.width), rows = lattice(window.height);
  std::vector<Eigen::Vector2d> node(columns.size() * rows.size());
  tbb::parallel_for(std::size_t{0}, rows.size(), [&](std::size_t j) {
    std::vector<Eigen::Vector2d> q(columns.size());
    std::vector<Eigen::Vector3d> v(columns.size());
    for (std::size_t i = 0; i < columns.size(); ++i) q[i] = {window.x0 + columns[i] - 0.5, window.y0 + rows[j] - 0.5};
    unproject(lens, q, v);
    for (std::size_t i = 0; i < columns.size(); ++i) node[j * columns.size() + i] = slope_of(v[i]);
  });
  tbb::parallel_for(tbb::blocked_range<int>(0, n_rows), [&](const tbb::blocked_range<int>& range) {
    for (int r = range.begin(); r < range.end(); ++r) {
      const std::size_t j = std::min<std::size_t>(r / kLatticeStep, rows.size() - 2);
      const double fraction = static_cast<double>(r - rows[j]) / (rows[j + 1] - rows[j]);
      const Eigen::Vector2d* above = &node[j * columns.size()];
      invert_row(lens, window, r, columns, above, above + columns.size(), fraction,
                 &rays.slope[static_cast<std::size_t>(r) * n_columns]);
    }
  });
  return rays;
}

FootprintGrid camera_grid(const CornerRays& rays, const Eigen::Isometry3d& T_camera_board, const Surface& surface) {
  check_surface(surface, "camera_grid");
  FootprintGrid grid;
  grid.window = rays.window;
  const Eigen::Isometry3d T_board_camera = T_camera_board.inverse();
  const Eigen::Matrix3d R = T_board_camera.linear();
  const Eigen::Vector3d origin = T_board_camera.translation();
  const std::optional<Cylinder> cylinder = surface.bend ? std::optional(cylinder_of(surface)) : std::nullopt;
  grid.corner_x_mm.resize(rays.slope.size());
  grid.corner_y_mm.resize(rays.slope.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, rays.slope.size(), 4096),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      for (std::size_t i = range.begin(); i < range.end(); ++i) {
                        const Eigen::Vector3d v(rays.slope[i].x(), rays.slope[i].y(), 1);
                        const Eigen::Vector2d p =
                            cylinder ? flat_place(*cylinder, origin, R * v).value_or(Eigen::Vector2d(kMissed, kMissed))
                                     : meet_face(surface, origin, R * v);
                        grid.corner_x_mm[i] = p.x();
                        grid.corner_y_mm[i] = p.y();
                      }
                    });
  fill_centers(surface, grid);
  if (rays.undistorted && !surface.bend && surface.bow_mm == Eigen::Vector3d::Zero()) {
    Eigen::Matrix3d K;
    K << rays.fxycxy[0], 0, rays.fxycxy[2], 0, rays.fxycxy[1], rays.fxycxy[3], 0, 0, 1;
    Eigen::Matrix3d pixel_from_board;
    pixel_from_board << T_camera_board.linear().leftCols<2>(), T_camera_board.translation();
    pixel_from_board = K * pixel_from_board;
    const Eigen::Matrix3d inverse = pixel_from_board.inverse();
    if (inverse.allFinite()) grid.board_from_pixel = inverse;
  }
  return grid;
}

FootprintGrid camera_grid(const Lens& lens, const Eigen::Isometry3d& T_camera_board, const Surface& surface,
                          const PixelWindow& window) {
  return camera_grid(corner_rays(lens, window), T_camera_board, surface);
}

FootprintGrid board_grid(const Eigen::Vector2d& min_mm, const Eigen::Vector2d& max_mm, int width, int height,
                         const Surface& surface) {
  FootprintGrid grid;
  grid.window = {0, 0, width, height};
  check_window(grid.window, "board_grid");
  check_surface(surface, "board_grid");
  const Eigen::Vector2d size = max_mm - min_mm;
  if (!(size.x() > 0 && size.y() > 0 && size.allFinite()))
    fail("board_grid", "the rectangle is empty", "max_mm must be above min_mm in x and y");
  grid.corner_x_mm.reserve(static_cast<std::size_t>(width + 1) * (height + 1));
  grid.corner_y_mm.reserve(grid.corner_x_mm.capacity());
  for (int r = 0; r <= height; ++r) {
    for (int c = 0; c <= width; ++c) {
      grid.corner_x_mm.push_back(min_mm.x() + size.x() * c / width);
      grid.corner_y_mm.push_back(max_mm.y() - size.y() * r / height);
    }
  }
  fill_centers(surface, grid);
  Eigen::Matrix3d H;
  H << size.x() / width, 0, min_mm.x() + 0.5 * size.x() / width,  //
      0, -size.y() / height, max_mm.y() - 0.5 * size.y() / height, 0, 0, 1;
  grid.board_from_pixel = H;
  return grid;
}

PixelWindow window_of(const Lens& lens, const Eigen::Isometry3d& T_camera_board, const Surface& surface,
                      const Eigen::Vector2d& min_mm, const Eigen::Vector2d& max_mm, int margin_px) {
  // The visible outline of a nearly flat face is the image of the rectangle's outline. A bent face extends further if
  // it is seen edge on, so lines from side to side are projected as well.
  constexpr int kPerSide = 256, kLines = 15;
  std::vector<Eigen::Vector3d> p;
  p.reserve(4 * kPerSide);
  bool behind = false;
  const auto look = [&](double u, double v) {
    const double x = min_mm.x() + u * (max_mm.x() - min_mm.x()), y = min_mm.y() + v * (max_mm.y() - min_mm.y());
    const Eigen::Vector3d q = T_camera_board * face_point(surface, x, y);
    if (q.z() > 1e-9)
      p.push_back(q);
    else
      behind = true;
  };
  for (int line = 1; line <= kLines && surface.bend; ++line)
    for (int i = 0; i < kPerSide; ++i) {
      look(static_cast<double>(i) / kPerSide, static_cast<double>(line) / (kLines + 1));
      look(static_cast<double>(line) / (kLines + 1), static_cast<double>(i) / kPerSide);
    }
  for (int side = 0; side < 4; ++side) {
    for (int i = 0; i < kPerSide; ++i) {
      const double s = static_cast<double>(i) / kPerSide;
      const double u = side == 0 ? s : side == 1 ? 1 : side == 2 ? 1 - s : 0;
      const double v = side == 0 ? 0 : side == 1 ? s : side == 2 ? 1 : 1 - s;
      look(u, v);
    }
  }
  if (p.empty()) return {};
  if (behind) return {0, 0, lens.width, lens.height};
  std::vector<Eigen::Vector2d> q(p.size());
  project(lens, p, q);
  Eigen::Vector2d low = q[0], high = q[0];
  for (const Eigen::Vector2d& v : q) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  if (!low.allFinite() || !high.allFinite()) return {0, 0, lens.width, lens.height};
  const auto clipped = [&](double v, int size) {
    return static_cast<int>(std::clamp(v, 0.0, static_cast<double>(size)));
  };
  const int x0 = clipped(std::floor(low.x() + 0.5) - margin_px, lens.width);
  const int y0 = clipped(std::floor(low.y() + 0.5) - margin_px, lens.height);
  const int x1 = clipped(std::floor(high.x() + 0.5) + 1 + margin_px, lens.width);
  const int y1 = clipped(std::floor(high.y() + 0.5) + 1 + margin_px, lens.height);
  if (x1 <= x0 || y1 <= y0) return {};
  return {x0, y0, x1 - x0, y1 - y0};
}

}  // namespace burin

#include "burin/scene/board_mesh.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <sstream>
#include <string>
#include <string_view>

#include "burin/base/error.h"
#include "burin/base/files/input_file.h"
#include "burin/base/limits.h"
#include "burin/scene/ray_tracer.h"

namespace burin {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Start of a ray towards a lamp above the face, relative to the mesh's extent. It exceeds float's rounding (6e-8 of
/// the extent and of the lamp's distance) and the deviation of facets from the smooth face. It is smaller than any
/// object that casts a shadow.
constexpr double kLiftOverExtent = 1e-4;

/// uv this far outside of 0 .. 1 still count as the board's rim: files have six digits.
constexpr double kRimTolerance = 1e-6;

// ---- OBJ ----

struct ObjReader {
  const std::filesystem::path& file;
  int line = 0;
  std::vector<Eigen::Vector2d> vt;
  std::vector<Eigen::Vector3d> vn;
  bool all_uv = true, all_normals = true;
  TriangleMesh mesh;

  [[noreturn]] void fail_line(const std::string& what, const std::string& remedy) const {
    fail(file.string() + ":" + std::to_string(line), what, remedy);
  }

  [[noreturn]] void fail_size(const std::string& things) const {
    fail_line("it has more " + things + " than Burin takes (" + with_commas(limit::kTriangles) + " triangles)",
              "use a coarser mesh (docs/limits.md)");
  }

  static std::vector<std::string_view> words(std::string_view text) {
    std::vector<std::string_view> list;
    constexpr std::string_view kSpace = " \t\r\f\v";
    for (;;) {
      const auto begin = text.find_first_not_of(kSpace);
      if (begin == std::string_view::npos) return list;
      text.remove_prefix(begin);
      list.push_back(text.substr(0, text.find_first_of(kSpace)));
      text.remove_prefix(list.back().size());
    }
  }

  template <int n>
  Eigen::Matrix<double, n, 1> vector(const std::vector<std::string_view>& w) const {
    if (w.size() < n + 1) {
      fail_line("'" + std::string(w[0]) + "' has " + std::to_string(w.size() - 1) + " numbers, " + std::to_string(n) +
                    " are needed",
                "export the mesh again");
    }
    Eigen::Matrix<double, n, 1> v;
    for (int i = 0; i < n; ++i) {
      const std::string_view text = w[i + 1];
      const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), v[i]);
      if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(v[i])) {
        fail_line("'" + std::string(text) + "' is not a finite number", "export the mesh again");
      }
    }
    return v;
  }

  /// OBJ indices count from 1, or backwards from the last one. -1 for an empty index ("3//2").
  std::int64_t index(std::string_view text, std::size_t count, const char* what) const {
    if (text.empty()) return -1;
    std::int64_t i = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), i);
    const auto n = static_cast<std::int64_t>(count);
    if (error != std::errc() || end != text.data() + text.size() || i == 0 || i > n || i < -n) {
      fail_line("the face names " + std::string(what) + " " + std::string(text) + ", and there are " +
                    std::to_string(count) + " before it",
                "export the mesh again");
    }
    return i > 0 ? i - 1 : n + i;
  }

  void face(const std::vector<std::string_view>& w) {
    struct Corner {
      std::uint32_t position;
      std::int64_t uv, normal;
    };
    std::vector<Corner> corners;
    for (std::size_t k = 1; k < w.size(); ++k) {
      std::array<std::string_view, 3> part;
      std::string_view rest = w[k];
      for (int i = 0; i < 3; ++i) {
        const auto slash = rest.find('/');
        part[i] = rest.substr(0, slash);
        rest = slash == std::string_view::npos ? std::string_view() : rest.substr(slash + 1);
      }
      if (part[0].empty()) fail_line("a corner of the face names no vertex", "export the mesh again");
      corners.push_back({static_cast<std::uint32_t>(index(part[0], mesh.position_mm.size(), "vertex")),
                         index(part[1], vt.size(), "uv"), index(part[2], vn.size(), "normal")});
    }
    if (corners.size() < 3) {
      fail_line("the face has " + std::to_string(corners.size()) + " corners", "a face needs at least three");
    }
    for (std::size_t k = 1; k + 1 < corners.size(); ++k) {
      const std::array<Corner, 3> t{corners[0], corners[k], corners[k + 1]};
      const auto& p = mesh.position_mm;
      const Eigen::Vector3d a = p[t[1].position] - p[t[0].position], b = p[t[2].position] - p[t[0].position];
      if (!(a.cross(b).norm() > 1e-14 * std::max(a.squaredNorm(), b.squaredNorm()))) continue;
      if (mesh.triangle.size() == limit::kTriangles) fail_size("triangles");
      mesh.triangle.push_back({t[0].position, t[1].position, t[2].position});
      mesh.line.push_back(line);
      auto& uv = mesh.uv.emplace_back();
      auto& normal = mesh.normal.emplace_back();
      for (int i = 0; i < 3; ++i) {
        uv[i] = t[i].uv < 0 ? Eigen::Vector2d(0, 0) : vt[t[i].uv];
        normal[i] = t[i].normal < 0 ? Eigen::Vector3d(0, 0, 0) : vn[t[i].normal];
        all_uv = all_uv && t[i].uv >= 0;
        all_normals = all_normals && normal[i].norm() > 0;
      }
    }
  }

  void read(std::istream& in) {
    std::string text;
    while (std::getline(in, text)) {
      ++line;
      if (text.size() > limit::kMeshLineBytes) fail_line("the line is too long", "export the mesh again, as triangles");
      const auto w = words(std::string_view(text).substr(0, text.find('#')));
      if (w.empty()) continue;
      if (std::max({mesh.position_mm.size(), vt.size(), vn.size()}) > 3 * limit::kTriangles) fail_size("vertices");
      if (w[0] == "v") mesh.position_mm.push_back(vector<3>(w));
      if (w[0] == "vt") vt.push_back(vector<2>(w));
      if (w[0] == "vn") vn.push_back(vector<3>(w));
      if (w[0] == "f") face(w);
    }
    if (!all_uv) mesh.uv.clear();
    if (!all_normals) mesh.normal.clear();
  }
};

constexpr unsigned kFace = 0;  // group of the face; occluders follow

/// Normals of each triangle's corners: the area-weighted mean of the face normals at the vertex.
std::vector<std::array<Eigen::Vector3d, 3>> smooth_normals(const TriangleMesh& mesh) {
  std::vector<Eigen::Vector3d> at_vertex(mesh.position_mm.size(), Eigen::Vector3d::Zero());
  for (const auto& t : mesh.triangle) {
    const auto& p = mesh.position_mm;
    const Eigen::Vector3d twice_area = (p[t[1]] - p[t[0]]).cross(p[t[2]] - p[t[0]]);
    for (const auto i : t) at_vertex[i] += twice_area;
  }
  std::vector<std::array<Eigen::Vector3d, 3>> normals;
  normals.reserve(mesh.triangle.size());
  for (const auto& t : mesh.triangle) {
    normals.push_back(
        {at_vertex[t[0]].stableNormalized(), at_vertex[t[1]].stableNormalized(), at_vertex[t[2]].stableNormalized()});
  }
  return normals;
}

// True if the middle of triangle i is within triangle k on the flat board, beyond rounding at its rim.
bool overlap(const TriangleMesh& face, const Eigen::Vector2d& size_mm, std::size_t i, std::size_t k) {
  const auto& uv = face.uv[k];
  const Eigen::Vector2d p = ((face.uv[i][0] + face.uv[i][1] + face.uv[i][2]) / 3).cwiseProduct(size_mm);
  const Eigen::Vector2d p0 = uv[0].cwiseProduct(size_mm), a = uv[1].cwiseProduct(size_mm) - p0,
                        b = uv[2].cwiseProduct(size_mm) - p0, q = p - p0;
  const double cross = a.x() * b.y() - a.y() * b.x();
  const double beta = (q.x() * b.y() - q.y() * b.x()) / cross, gamma = (a.x() * q.y() - a.y() * q.x()) / cross;
  constexpr double kRim = 1e-3;
  return beta > kRim && gamma > kRim && beta + gamma < 1 - kRim;
}

}  // namespace

TriangleMesh read_obj(const std::filesystem::path& file) {
  std::istringstream in(read_bytes(file, limit::kMeshBytes, "an OBJ file"));
  ObjReader reader{file, 0, {}, {}, true, true, {}};
  reader.read(in);
  if (reader.mesh.triangle.empty()) {
    fail(file.string(), "has no face with an area", "give a Wavefront OBJ file with v, vt and f lines");
  }
  return std::move(reader.mesh);
}

struct BoardMesh::State {
  TriangleMesh face;
  Eigen::Vector2d size_mm;
  double lift_mm = 0;
  RayTracer in_space;  // the face and its occluders
  RayTracer flat;      // the face's uv * size_mm in the plane z = 0

  Place place_in(unsigned triangle, const Eigen::Vector3d& barycentric) const {
    Place place{{0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
    for (int k = 0; k < 3; ++k) {
      place.board_mm += barycentric[k] * face.uv[triangle][k].cwiseProduct(size_mm);
      place.position_mm += barycentric[k] * face.position_mm[face.triangle[triangle][k]];
      place.normal += barycentric[k] * face.normal[triangle][k];
    }
    place.normal.normalize();
    // uv map the triangle's flat edges to its edges in space. The flat x direction follows from this map, projected to
    // be orthogonal to the interpolated normal.
    const Eigen::Vector2d u = (face.uv[triangle][1] - face.uv[triangle][0]).cwiseProduct(size_mm),
                          v = (face.uv[triangle][2] - face.uv[triangle][0]).cwiseProduct(size_mm);
    const auto& t = face.triangle[triangle];
    const Eigen::Vector3d a = face.position_mm[t[1]] - face.position_mm[t[0]],
                          b = face.position_mm[t[2]] - face.position_mm[t[0]];
    const Eigen::Vector3d x = (a * v.y() - b * u.y()) / (u.x() * v.y() - u.y() * v.x());
    place.x = (x - place.normal * place.normal.dot(x)).normalized();
    return place;
  }
};

BoardMesh::BoardMesh(const TriangleMesh& face, const Eigen::Vector2d& size_mm, const std::string& name,
                     std::span<const TriangleMesh> occluders)
    : state_(std::make_unique<State>(State{{}, {}, 0, RayTracer(name), RayTracer(name)})) {
  if (!(size_mm.x() > 0 && size_mm.y() > 0 && size_mm.allFinite())) {
    fail(name, "the board's size is not positive", "set size_mm in board.json");
  }
  const auto at = [&](std::size_t i) {
    return i < face.line.size() ? name + ":" + std::to_string(face.line[i]) : name;
  };
  if (face.triangle.empty()) fail(name, "the mesh has no faces", "give one with an area");
  if (face.uv.size() != face.triangle.size()) {
    fail(name, "the mesh has no uv on all of its faces",
         "export it with texture coordinates, uv = (x / width, y / height) of the flat board");
  }
  for (const auto& p : face.position_mm) {
    if (!p.allFinite()) fail(name, "a vertex is not finite", "export the mesh again");
  }
  for (std::size_t i = 0; i < face.triangle.size(); ++i) {
    for (const auto v : face.triangle[i]) {
      if (v >= face.position_mm.size())
        fail(at(i), "the face names a vertex that is not there", "export the mesh again");
    }
    const Eigen::Vector2d a = face.uv[i][1] - face.uv[i][0], b = face.uv[i][2] - face.uv[i][0];
    const double cross = a.x() * b.y() - a.y() * b.x();
    if (!(std::abs(cross) > 1e-12 * std::max(a.squaredNorm(), b.squaredNorm()))) {
      fail(at(i), "the face's uv have no area",
           "unwrap the mesh so that uv = (x / width, y / height) of the flat board");
    }
    if (cross < 0) {
      fail(at(i), "the face's uv run clockwise seen from its front, so the board would be mirrored",
           "turn the faces' order of corners, or mirror the uv");
    }
  }

  State& s = *state_;
  s.face = face;
  s.size_mm = size_mm;
  if (s.face.normal.size() != face.triangle.size()) s.face.normal = smooth_normals(face);
  Eigen::AlignedBox3d box;
  for (const auto& p : face.position_mm) box.extend(p);
  s.lift_mm = kLiftOverExtent * box.diagonal().norm();

  s.in_space.add(
      face.position_mm.size(), [&](std::size_t i) { return face.position_mm[i]; }, face.triangle);
  for (const auto& occluder : occluders) {
    if (occluder.triangle.empty()) continue;
    s.in_space.add(
        occluder.position_mm.size(), [&](std::size_t i) { return occluder.position_mm[i]; }, occluder.triangle);
  }
  s.in_space.build();

  std::vector<std::array<std::uint32_t, 3>> corners(face.triangle.size());
  for (std::uint32_t i = 0; i < corners.size(); ++i) corners[i] = {3 * i, 3 * i + 1, 3 * i + 2};
  s.flat.add(
      3 * corners.size(),
      [&](std::size_t i) {
        const Eigen::Vector2d p = face.uv[i / 3][i % 3].cwiseProduct(size_mm);
        return Eigen::Vector3d(p.x(), p.y(), 0);
      },
      corners);
  s.flat.build();
  // Each triangle must be the hit at its own middle.
  for (std::size_t i = 0; i < face.triangle.size(); ++i) {
    const Eigen::Vector2d middle = ((face.uv[i][0] + face.uv[i][1] + face.uv[i][2]) / 3).cwiseProduct(size_mm);
    const auto hit = s.flat.first_hit({middle.x(), middle.y(), 1}, {0, 0, -1});
    if (!hit || hit->triangle == i || !overlap(face, size_mm, i, hit->triangle)) continue;
    fail(at(i),
         "the mesh folds: its uv cover a place of the flat board twice, here and " +
             (hit->triangle < face.line.size() ? "at line " + std::to_string(face.line[hit->triangle])
                                               : "at face " + std::to_string(hit->triangle + 1)),
         "unwrap it so that each place of the flat board is on one face");
  }
}

BoardMesh::~BoardMesh() = default;
BoardMesh::BoardMesh(BoardMesh&&) noexcept = default;
BoardMesh& BoardMesh::operator=(BoardMesh&&) noexcept = default;

const Eigen::Vector2d& BoardMesh::size_mm() const { return state_->size_mm; }

double BoardMesh::most_stretch() const {
  const State& s = *state_;
  double most = 0;
  for (std::size_t i = 0; i < s.face.triangle.size(); ++i) {
    const auto& t = s.face.triangle[i];
    Eigen::Matrix2d flat;
    Eigen::Matrix<double, 3, 2> bent;
    for (int k = 0; k < 2; ++k) {
      flat.col(k) = (s.face.uv[i][k + 1] - s.face.uv[i][0]).cwiseProduct(s.size_mm);
      bent.col(k) = s.face.position_mm[t[k + 1]] - s.face.position_mm[t[0]];
    }
    const Eigen::Matrix<double, 3, 2> J = bent * flat.inverse();
    // Singular values of J from J^T J, whose eigenvalues have a closed form.
    const Eigen::Matrix2d M = J.transpose() * J;
    const double half = M.trace() / 2, spread = std::sqrt(std::max(0.0, half * half - M.determinant()));
    most =
        std::max({most, std::abs(std::sqrt(half + spread) - 1), std::abs(std::sqrt(std::max(0.0, half - spread)) - 1)});
  }
  return most;
}

std::optional<BoardMesh::Place> BoardMesh::first_hit(const Eigen::Vector3d& origin_mm,
                                                     const Eigen::Vector3d& direction) const {
  const State& s = *state_;
  if (!origin_mm.allFinite() || !direction.allFinite()) return std::nullopt;
  const auto hit = s.in_space.first_hit(origin_mm, direction);
  if (!hit || hit->group != kFace) return std::nullopt;
  const auto& t = s.face.triangle[hit->triangle];
  const Eigen::Vector3d p0 = s.face.position_mm[t[0]], a = s.face.position_mm[t[1]] - p0,
                        b = s.face.position_mm[t[2]] - p0;
  // In double: origin + lambda direction = p0 + beta a + gamma b, by Cramer's rule.
  const Eigen::Vector3d n = a.cross(b), o = origin_mm - p0;
  const double facing = -direction.dot(n);
  if (!(facing > 0)) return std::nullopt;  // its back
  const Eigen::Vector3d q = o.cross(direction);
  const double beta = b.dot(q) / facing, gamma = -a.dot(q) / facing;
  Place place = s.place_in(hit->triangle, {1 - beta - gamma, beta, gamma});
  const Eigen::Vector2d uv = place.board_mm.cwiseQuotient(s.size_mm);
  if (!(uv.minCoeff() >= -kRimTolerance && uv.maxCoeff() <= 1 + kRimTolerance)) return std::nullopt;
  return place;
}

std::optional<BoardMesh::Place> BoardMesh::place(const Eigen::Vector2d& board_mm) const {
  const State& s = *state_;
  if (!board_mm.allFinite()) return std::nullopt;
  const auto hit = s.flat.first_hit({board_mm.x(), board_mm.y(), 1}, {0, 0, -1});
  if (!hit) return std::nullopt;
  const auto& uv = s.face.uv[hit->triangle];
  const Eigen::Vector2d p0 = uv[0].cwiseProduct(s.size_mm), a = uv[1].cwiseProduct(s.size_mm) - p0,
                        b = uv[2].cwiseProduct(s.size_mm) - p0, q = board_mm - p0;
  const double cross = a.x() * b.y() - a.y() * b.x();
  const double beta = (q.x() * b.y() - q.y() * b.x()) / cross, gamma = (a.x() * q.y() - a.y() * q.x()) / cross;
  return s.place_in(hit->triangle, {1 - beta - gamma, beta, gamma});
}

bool BoardMesh::hidden_from(const Eigen::Vector3d& from_mm, const Eigen::Vector3d& position_mm,
                            const Eigen::Vector3d& normal) const {
  const Eigen::Vector3d start = position_mm + state_->lift_mm * normal, way = from_mm - start;
  if (!(way.dot(normal) > 0)) return true;
  return state_->in_space.is_blocked(start, way);
}

namespace {

/// Sets centers and normals from corners. Pixels with an undefined center, or one rejected by `hidden`, lose their
/// corners.
template <class Hidden>
void fill_centers(const BoardMesh& mesh, FootprintGrid& grid, const Hidden& hidden) {
  const int width = grid.width(), height = grid.height();
  const std::size_t count = static_cast<std::size_t>(width) * height;
  const Eigen::Vector3d nowhere(kNaN, kNaN, kNaN);
  grid.center_mm.assign(count, nowhere);
  grid.normal.assign(count, nowhere);
  grid.x_axis.assign(count, nowhere);
  std::vector<std::uint8_t> lost(count, 0);
  tbb::parallel_for(0, height, [&](int r) {
    for (int c = 0; c < width; ++c) {
      const auto q = footprint_corners_mm(grid, c, r);
      const Eigen::Vector2d mean = 0.25 * (q[0] + q[1] + q[2] + q[3]);
      if (!mean.allFinite()) continue;
      const std::size_t i = static_cast<std::size_t>(r) * width + c;
      const auto place = mesh.place(mean);
      lost[i] = !place || hidden(*place);
      if (lost[i]) continue;
      grid.center_mm[i] = place->position_mm;
      grid.normal[i] = place->normal;
      grid.x_axis[i] = place->x;
    }
  });
  for (int r = 0; r < height; ++r) {
    for (int c = 0; c < width; ++c) {
      if (!lost[static_cast<std::size_t>(r) * width + c]) continue;
      const std::size_t top = static_cast<std::size_t>(r) * (width + 1) + c, bottom = top + width + 1;
      for (const std::size_t i : {top, top + 1, bottom, bottom + 1}) grid.corner_x_mm[i] = grid.corner_y_mm[i] = kNaN;
    }
  }
}

}  // namespace

FootprintGrid camera_grid(const CornerRays& rays, const Eigen::Isometry3d& T_camera_board, const BoardMesh& mesh) {
  FootprintGrid grid;
  grid.window = rays.window;
  const Eigen::Isometry3d T_board_camera = T_camera_board.inverse();
  const Eigen::Vector3d origin = T_board_camera.translation();
  grid.corner_x_mm.resize(rays.slope.size());
  grid.corner_y_mm.resize(rays.slope.size());
  const int columns = grid.width() + 1;
  tbb::parallel_for(0, grid.height() + 1, [&](int r) {
    for (int c = 0; c < columns; ++c) {
      const std::size_t i = static_cast<std::size_t>(r) * columns + c;
      const Eigen::Vector3d v(rays.slope[i].x(), rays.slope[i].y(), 1);
      const auto hit = mesh.first_hit(origin, T_board_camera.linear() * v);
      grid.corner_x_mm[i] = hit ? hit->board_mm.x() : kNaN;
      grid.corner_y_mm[i] = hit ? hit->board_mm.y() : kNaN;
    }
  });
  fill_centers(mesh, grid,
               [&](const BoardMesh::Place& p) { return mesh.hidden_from(origin, p.position_mm, p.normal); });
  return grid;
}

FootprintGrid camera_grid(const Lens& lens, const Eigen::Isometry3d& T_camera_board, const BoardMesh& mesh,
                          const PixelWindow& window) {
  return camera_grid(corner_rays(lens, window), T_camera_board, mesh);
}

FootprintGrid board_grid(const Eigen::Vector2d& min_mm, const Eigen::Vector2d& max_mm, int width, int height,
                         const BoardMesh& mesh) {
  FootprintGrid grid = board_grid(min_mm, max_mm, width, height, Surface{mesh.size_mm(), {0, 0, 0}});
  fill_centers(mesh, grid, [](const BoardMesh::Place&) { return false; });
  return grid;
}

std::vector<std::uint8_t> hidden_pixels(const FootprintGrid& grid, const BoardMesh& mesh,
                                        const Eigen::Vector3d& from_mm) {
  std::vector<std::uint8_t> hidden(grid.center_mm.size(), 1);
  tbb::parallel_for(std::size_t{0}, hidden.size(), [&](std::size_t i) {
    if (grid.center_mm[i].allFinite()) hidden[i] = mesh.hidden_from(from_mm, grid.center_mm[i], grid.normal[i]);
  });
  return hidden;
}

}  // namespace burin

#include "burin/render/lanes_view.h"

#include <tbb/parallel_for.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <span>
#include <utility>

#include "burin/base/error.h"
#include "burin/base/machine_clones.h"
#include "burin/render/exact/exact_view.h"
#include "burin/scene/groove_profile.h"
#include "burin/scene/lamp_size.h"

namespace burin {
namespace {

using Eigen::Vector2d;

// One of the lamp's points at a node of the lattice: a corner of every few pixels.
struct LampThere {
  double hx = 0, hy = 0, cos_i = 1, cos_o = 1, strength = 0;  // strength: relative to the middle's
};
struct LatticeNode {
  Vector2d place_mm{0, 0};
  std::array<double, 3> factor{};   // of the lamp's middle: F intensity direct, by channel
  double base = 0, base_slope = 0;  // of the plain face, in units of `factor`
  bool is_good = false;             // lit and visible
};

struct Lattice {
  std::vector<int> xs, ys;         // positions of columns and rows, in pixels' corners
  std::size_t points = 0;          // number of the lamp's points
  std::vector<LatticeNode> nodes;  // row by row
  std::vector<LampThere> lamps;    // `points` per node

  std::size_t at(std::size_t column, std::size_t row) const { return row * xs.size() + column; }
};

// Cell of a lattice at a position in the picture, and the position in the cell. Beyond the rim: of the outermost cell.
struct InCell {
  std::size_t node;  // upper left node of the cell
  double u, v;
};
std::size_t cell_of(const std::vector<int>& lines, double at) {
  const int step = lines[1] - lines[0];
  const double cell = std::floor((at - lines[0]) / step);
  return static_cast<std::size_t>(std::clamp(cell, 0.0, static_cast<double>(lines.size() - 2)));
}
InCell in_cell(const Lattice& lattice, double x, double y) {
  const std::size_t c = cell_of(lattice.xs, x), r = cell_of(lattice.ys, y);
  return {lattice.at(c, r), (x - lattice.xs[c]) / (lattice.xs[c + 1] - lattice.xs[c]),
          (y - lattice.ys[r]) / (lattice.ys[r + 1] - lattice.ys[r])};
}
template <typename Get>
auto between(const Lattice& lattice, const InCell& cell, const Get& get) {
  const std::size_t below = cell.node + lattice.xs.size();
  using Value = std::decay_t<decltype(get(cell.node))>;
  return Value((1 - cell.v) * ((1 - cell.u) * get(cell.node) + cell.u * get(cell.node + 1)) +
               cell.v * ((1 - cell.u) * get(below) + cell.u * get(below + 1)));
}

// Value at a corner between pixels' centers (or normals), extrapolated over the rim.
template <typename Values>
Eigen::Vector3d at_corner(const Values& values, int width, int height, int x, int y) {
  struct Pair {
    int a, b;
    double of_a;
  };
  const auto pair = [](int at, int count) {
    if (count == 1) return Pair{0, 0, 1};
    if (at <= 0) return Pair{0, 1, 1.5};
    if (at >= count) return Pair{count - 1, count - 2, 1.5};
    return Pair{at - 1, at, 0.5};
  };
  const Pair px = pair(x, width), py = pair(y, height);
  const auto value = [&](int c, int r) -> const Eigen::Vector3d& {
    return values[static_cast<std::size_t>(r) * width + c];
  };
  return py.of_a * (px.of_a * value(px.a, py.a) + (1 - px.of_a) * value(px.b, py.a)) +
         (1 - py.of_a) * (px.of_a * value(px.a, py.b) + (1 - px.of_a) * value(px.b, py.b));
}

std::vector<int> lattice_lines(int count, int step) {
  std::vector<int> out;
  for (int at = 0; at < count; at += step) out.push_back(at);
  out.push_back(count);
  return out;
}

// A pixel near the picture's middle with a footprint on the face, and its size there.
struct MiddlePixel {
  Eigen::Vector3d center_mm{0, 0, 0};
  double size_mm = 1;
};
std::optional<MiddlePixel> middle_pixel(const FootprintGrid& grid) {
  for (std::size_t i = grid.center_mm.size() / 2 + grid.width() / 2; i + 1 < grid.center_mm.size(); ++i) {
    const double size_mm = (grid.center_mm[i + 1] - grid.center_mm[i]).norm();
    if (std::isfinite(size_mm) && size_mm > 0) return MiddlePixel{grid.center_mm[i], size_mm};
  }
  return std::nullopt;
}

// Step between nodes: a share of the nearest distance, of lamp or camera. Interpolated light has an error of 1e-5.
int lattice_step(const ViewScene& scene) {
  constexpr int kUsual = 4, kMost = 16;
  constexpr double kOfDistance = 0.002;
  const std::optional<MiddlePixel> pixel = middle_pixel(*scene.grid);
  if (!pixel) return kUsual;
  const double nearest_mm =
      std::min((scene.light.position_mm - pixel->center_mm).norm(), (scene.camera_center_mm - pixel->center_mm).norm());
  return std::clamp(static_cast<int>(kOfDistance * nearest_mm / pixel->size_mm), 1, kMost);
}

// Extrapolates linearly to nodes off the face or in the dark.
void continue_lattice(Lattice& lattice, std::vector<char>& known) {
  const auto columns = static_cast<std::ptrdiff_t>(lattice.xs.size()),
             rows = static_cast<std::ptrdiff_t>(lattice.ys.size());
  constexpr int kPasses = 3;
  for (int pass = 0; pass < kPasses; ++pass) {
    std::vector<char> next = known;
    for (std::ptrdiff_t r = 0; r < rows; ++r)
      for (std::ptrdiff_t c = 0; c < columns; ++c) {
        const std::size_t i = lattice.at(c, r);
        if (known[i]) continue;
        for (const auto& [dc, dr] : {std::pair(1, 0), std::pair(-1, 0), std::pair(0, 1), std::pair(0, -1)}) {
          const std::ptrdiff_t c2 = c + 2 * dc, r2 = r + 2 * dr;
          if (c2 < 0 || r2 < 0 || c2 >= columns || r2 >= rows) continue;
          const std::size_t a = lattice.at(c + dc, r + dr), b = lattice.at(c2, r2);
          if (!known[a] || !known[b]) continue;
          const auto line = [](double near, double far) { return 2 * near - far; };
          LatticeNode& to = lattice.nodes[i];
          const LatticeNode &na = lattice.nodes[a], &nb = lattice.nodes[b];
          to.place_mm = 2 * na.place_mm - nb.place_mm;
          to.factor = na.factor;
          to.base = na.base;
          to.base_slope = na.base_slope;
          for (std::size_t p = 0; p < lattice.points; ++p) {
            LampThere& lamp = lattice.lamps[i * lattice.points + p];
            const LampThere &la = lattice.lamps[a * lattice.points + p], &lb = lattice.lamps[b * lattice.points + p];
            lamp = {line(la.hx, lb.hx), line(la.hy, lb.hy), la.cos_i, la.cos_o, la.strength};
          }
          next[i] = 1;
          break;
        }
      }
    known = std::move(next);
  }
}

Lattice make_lattice(const ViewScene& scene, int channels) {
  const FootprintGrid& grid = *scene.grid;
  Lattice out;
  const int step = lattice_step(scene);
  out.xs = lattice_lines(grid.width(), step);
  out.ys = lattice_lines(grid.height(), step);
  const std::vector<LampPoint> points = lamp_points(scene.light);
  out.points = points.size();
  out.nodes.resize(out.xs.size() * out.ys.size());
  out.lamps.resize(out.nodes.size() * out.points);
  std::vector<char> known(out.nodes.size(), 0);
  Light middle = scene.light;
  middle.size = {};
  tbb::parallel_for(std::size_t{0}, out.ys.size(), [&](std::size_t r) {
    for (std::size_t c = 0; c < out.xs.size(); ++c) {
      const std::size_t i = out.at(c, r);
      LatticeNode& node = out.nodes[i];
      const Eigen::Vector3d center = at_corner(grid.center_mm, grid.width(), grid.height(), out.xs[c], out.ys[r]);
      const Eigen::Vector3d normal =
          at_corner(grid.normal, grid.width(), grid.height(), out.xs[c], out.ys[r]).normalized();
      const std::size_t corner = static_cast<std::size_t>(out.ys[r]) * (grid.width() + 1) + out.xs[c];
      node.place_mm = {grid.corner_x_mm[corner], grid.corner_y_mm[corner]};
      if (!center.allFinite() || !normal.allFinite() || !node.place_mm.allFinite()) continue;
      const auto shade = [&](const Light& light) {
        return shade_pixel(center, normal, scene.camera_center_mm, light, scene.material.base_alpha,
                           scene.material.grain);
      };
      const PixelShading p = shade(middle);
      if (!p.visible || !p.lit) continue;
      const auto factor = channel_factors(scene, p.cos_ho, channels);
      const double mean = channel_factors(scene, p.cos_ho, 1)[0] * p.direct;
      for (int k = 0; k < channels; ++k) node.factor[k] = factor[k] * p.direct;
      bool all = true;
      for (std::size_t k = 0; k < points.size(); ++k) {
        Light light = middle;
        light.position_mm += points[k].offset_mm;
        const PixelShading q = points.size() == 1 ? p : shade(light);
        if (!q.lit) {
          all = false;
          continue;
        }
        const double strength = points[k].share * channel_factors(scene, q.cos_ho, 1)[0] * q.direct / mean;
        out.lamps[i * out.points + k] = {q.h_face.x(), q.h_face.y(), q.cos_i, q.cos_o, strength};
        node.base += strength * q.base;
        node.base_slope += strength * base_slope(q, scene.material.base_alpha, scene.material.grain);
      }
      node.is_good = all;
      known[i] = 1;
    }
  });
  continue_lattice(out, known);
  for (std::size_t i = 0; i < known.size(); ++i)
    if (!known[i]) out.nodes[i].place_mm.setConstant(std::numeric_limits<double>::quiet_NaN());
  return out;
}

// Position in the picture of a place on the board, from an initial guess; and d(picture) / d(board), px / mm.
struct InPicture {
  Vector2d px{0, 0};
  Eigen::Matrix2d by_mm = Eigen::Matrix2d::Zero();
  bool is_found = false;
};
InPicture in_picture(const Lattice& lattice, const Vector2d& place_mm, const Vector2d& guess_px) {
  InPicture out;
  out.px = guess_px;
  constexpr int kMost = 40;
  constexpr double kGoodPx = 1e-6;
  for (int step = 0; step < kMost; ++step) {
    const std::size_t c = cell_of(lattice.xs, out.px.x()), r = cell_of(lattice.ys, out.px.y());
    const double w = lattice.xs[c + 1] - lattice.xs[c], h = lattice.ys[r + 1] - lattice.ys[r];
    const double u = (out.px.x() - lattice.xs[c]) / w, v = (out.px.y() - lattice.ys[r]) / h;
    const std::size_t i = lattice.at(c, r), j = i + lattice.xs.size();
    const Vector2d &a = lattice.nodes[i].place_mm, &b = lattice.nodes[i + 1].place_mm, &d = lattice.nodes[j].place_mm,
                   &e = lattice.nodes[j + 1].place_mm;
    const Vector2d here = (1 - v) * ((1 - u) * a + u * b) + v * ((1 - u) * d + u * e);
    Eigen::Matrix2d by_px;
    by_px.col(0) = ((1 - v) * (b - a) + v * (e - d)) / w;
    by_px.col(1) = ((1 - u) * (d - a) + u * (e - b)) / h;
    out.by_mm = by_px.inverse();
    const Vector2d move = out.by_mm * (place_mm - here);
    if (!move.allFinite()) return out;
    out.px += move;
    if (move.squaredNorm() < kGoodPx * kGoodPx) {
      out.is_found = true;
      return out;
    }
  }
  return out;
}

// A groove at a node along it: position along the groove and in the picture, and the motion in the picture per
// millimeter across.
struct WayNode {
  double at_mm = 0;
  Vector2d px{0, 0}, by_across{0, 0};
  Vector2d half{0, 0};  // half vector of the lamp's first point
};

// Light of lanes, one number per lane and node: of one millimeter, mm; by alpha, and by the half vector across the
// groove and along it.
struct LaneLight {
  std::vector<float> value, by_alpha, by_across, by_along;
  std::vector<float> at_rims;  // D G at the left and the right rim: gain of a groove that becomes deeper
};

struct Ways {
  std::vector<std::size_t> first;  // first node of each groove
  std::vector<WayNode> nodes;
  LaneLight light;
};

// Walls of a lane as nodes of a quadrature rule: three Gauss-Legendre nodes, in parts narrower than a lobe. Shares are
// known at the middles of lanes. Either half of a groove takes them as linear in between, up to its rim and to the
// groove's middle, where equal grooves begin to cut each other (7.10). A constant share in each lane would add up to 1
// % of light that varies within lanes. So each node's light goes to its own lane and to one beside it.
struct WallNodes {
  std::vector<float> sine, cosine, weight_mm;
  std::vector<float> beside;  // weight of the other lane
  std::vector<int> other;     // that lane, as seen from the node's: -1, 0 or 1
  std::vector<int> end;       // of each lane
  std::array<float, 2> rim_sine{}, rim_cosine{};

  void make(const GrooveProfile& profile, std::span<const Lane> lanes, double width_um, double depth_um, double alpha);
};

void WallNodes::make(const GrooveProfile& profile, std::span<const Lane> lanes, double width_um, double depth_um,
                     double alpha) {
  constexpr std::array<double, 3> kNode{-0.7745966692414834, 0, 0.7745966692414834},
      kWeight{5.0 / 18, 8.0 / 18, 5.0 / 18};
  constexpr double kPartOfLobe = 0.6;
  constexpr int kMostParts = 16;
  sine.clear(), cosine.clear(), weight_mm.clear(), beside.clear(), other.clear(), end.clear();
  const double half_um = half_width_um(profile, width_um, depth_um);
  const auto lean_at = [&](const Lane& lane, double share) {
    if (lane.part == Lane::Part::groove) return wall_lean(profile, width_um, share * half_um);
    const double from_middle = (share - 0.5) * profile.burr_width_um;
    return lane.part == Lane::Part::right_burr ? burr_lean(profile.burr_right_um, profile.burr_width_um, from_middle)
                                               : burr_lean(profile.burr_left_um, profile.burr_width_um, -from_middle);
  };
  for (std::size_t l = 0; l < lanes.size(); ++l) {
    const Lane& lane = lanes[l];
    const bool is_first = l == 0 || lanes[l - 1].part != lane.part || lane.from == 0,
               is_last = l + 1 == lanes.size() || lanes[l + 1].part != lane.part || lane.to == 0;
    const double width_of_lane_um = lane_place(lane, half_um, profile.burr_width_um).width_um;
    const double leans = std::abs(lean_at(lane, lane.to) - lean_at(lane, lane.from));
    const int parts = std::clamp(static_cast<int>(std::ceil(leans / (kPartOfLobe * alpha))), 1, kMostParts);
    for (int part = 0; part < parts; ++part)
      for (std::size_t k = 0; k < kNode.size(); ++k) {
        const double in_lane = (part + 0.5 * (1 + kNode[k])) / parts, from_middle = in_lane - 0.5;
        const double share = lane.from + (lane.to - lane.from) * in_lane;
        const double lean = lean_at(lane, share);
        sine.push_back(static_cast<float>(std::sin(lean)));
        cosine.push_back(static_cast<float>(std::cos(lean)));
        weight_mm.push_back(static_cast<float>(1e-3 * width_of_lane_um * kWeight[k] / parts));
        const int towards = from_middle < 0 ? -1 : 1;
        const bool is_rim = towards < 0 ? is_first : is_last;
        other.push_back(is_first && is_last ? 0 : is_rim ? -towards : towards);
        beside.push_back(static_cast<float>(is_rim ? -std::abs(from_middle) : std::abs(from_middle)));
      }
    end.push_back(static_cast<int>(sine.size()));
  }
  for (int side = 0; side < 2; ++side) {
    const double lean = wall_lean(profile, width_um, (side == 0 ? -1 : 1) * half_um);
    rim_sine[side] = static_cast<float>(std::sin(lean));
    rim_cosine[side] = static_cast<float>(std::cos(lean));
  }
}

// Frame of a groove on the board.
struct GroovePlace {
  Vector2d first, along, across;
  double length_mm;

  GroovePlace(const Scratches& s, std::size_t i)
      : first(s.x0_mm[i], s.y0_mm[i]),
        along(s.x1_mm[i] - s.x0_mm[i], s.y1_mm[i] - s.y0_mm[i]),
        across(0, 0),
        length_mm(along.norm()) {
    along /= length_mm;
    across = {along.y(), -along.x()};
  }
};

// Adjacent lanes that form one line of light: first .. last - 1.
struct LaneGroup {
  std::size_t first, last;
  double width_mm = 0, middle_mm = 0;  // of the whole group
};

// Fewest groups whose width in the picture is at most this share of a pixel.
std::vector<LaneGroup> groups_of(std::span<const Lane> lanes, std::span<const float> width_mm,
                                 std::span<const float> middle_mm, double px_by_mm) {
  constexpr double kWidestPx = 0.07;
  std::vector<LaneGroup> out;
  for (std::size_t l = 0; l < lanes.size(); ++l) {
    if (out.empty() || lanes[l].part != lanes[l - 1].part || px_by_mm * (out.back().width_mm + width_mm[l]) > kWidestPx)
      out.push_back({l, l});
    LaneGroup& group = out.back();
    group.last = l + 1;
    group.width_mm += width_mm[l];
    group.middle_mm += static_cast<double>(width_mm[l]) * middle_mm[l];
  }
  for (LaneGroup& group : out) group.middle_mm /= group.width_mm;
  return out;
}

// Positions of a groove's lanes. Successive grooves of one width and depth share them.
struct LaneSpots {
  double width_um = 0, depth_um = 0;
  std::vector<float> width_mm, middle_mm;  // of each lane
  double rim_by_depth_mm = 0;              // mm per um
  std::size_t groove_lanes = 0;            // number of the groove's lanes, which come first; burrs' lanes follow
  double most_aside_mm = 0;                // largest offset of the lanes' middles
  std::vector<LaneGroup> groups;

  // `px_by_mm`: scale of the picture.
  void find(const GrooveProfile& profile, std::span<const Lane> lanes, double of_width_um, double of_depth_um,
            double px_by_mm) {
    if (of_width_um == width_um && of_depth_um == depth_um) return;
    width_um = of_width_um;
    depth_um = of_depth_um;
    const double half_um = half_width_um(profile, width_um, depth_um);
    width_mm.clear(), middle_mm.clear();
    for (const Lane& lane : lanes) {
      const LanePlace place = lane_place(lane, half_um, profile.burr_width_um);
      width_mm.push_back(static_cast<float>(1e-3 * place.width_um));
      middle_mm.push_back(static_cast<float>(1e-3 * place.middle_um));
    }
    rim_by_depth_mm = 1e-3 * half_width_slope(profile, width_um, depth_um);
    groove_lanes = static_cast<std::size_t>(std::ranges::count(lanes, Lane::Part::groove, &Lane::part));
    groups = groups_of(lanes, width_mm, middle_mm, px_by_mm);
    most_aside_mm = 0;
    for (const float middle : middle_mm) most_aside_mm = std::max(most_aside_mm, std::abs<double>(middle));
  }
};

// The NDF on walls (docs/model.md 3.7) for one half vector in the groove's frame, times `scale`, and its derivatives.
struct LobeAt {
  float across, along, up, across2, along2, scale;
};
BURIN_MACHINE_CLONES void lobes_on_walls(int n, const float* sine, const float* cosine, const float* weight, LobeAt h,
                                         float* out) {
  const float y2 = h.along * h.along * h.along2;
  for (int k = 0; k < n; ++k) {
    const float m = h.across * cosine[k] + h.up * sine[k], nh = h.up * cosine[k] - h.across * sine[k];
    const float Q = m * m * h.across2 + y2 + nh * nh;
    out[k] = nh > 0 ? weight[k] * h.scale / (Q * Q) : 0.0F;
  }
}
BURIN_MACHINE_CLONES void lobe_slopes_on_walls(int n, const float* sine, const float* cosine, const float* weight,
                                               LobeAt h, float* out, float* by_alpha, float* by_across,
                                               float* by_along) {
  const float y2 = h.along * h.along * h.along2, up_by_across = -h.across / h.up, up_by_along = -h.along / h.up;
  for (int k = 0; k < n; ++k) {
    const float m = h.across * cosine[k] + h.up * sine[k], nh = h.up * cosine[k] - h.across * sine[k];
    const float rough = m * m * h.across2 + y2, Q = rough + nh * nh;
    const float D = nh > 0 ? weight[k] * h.scale / (Q * Q) : 0.0F, by_Q = -4 * D / Q;
    out[k] = D;
    by_alpha[k] = -2 * D - by_Q * rough;  // by log alpha
    by_across[k] =
        by_Q * (m * h.across2 * (cosine[k] + up_by_across * sine[k]) + nh * (up_by_across * cosine[k] - sine[k]));
    by_along[k] = by_Q * (h.along * h.along2 + up_by_along * (m * h.across2 * sine[k] + nh * cosine[k]));
  }
}

// Sums over a pixel's grooves with their derivatives. Light has derivatives by log alpha, by the half vector, by a turn
// of the grooves (total, and weighted with squares of their direction) and by lengths in a direction. Light and area
// have derivatives by a deeper rim.
enum SumOf : int {
  kSumOfLight,
  kSumOfArea,
  kSumOfAlpha,
  kSumOfHalfX,
  kSumOfHalfY,
  kSumOfTurn,
  kSumOfTurnXX,
  kSumOfTurnXY,
  kSumOfLengthXX,
  kSumOfLengthXY,
  kSumOfAreaXX,
  kSumOfAreaXY,
  kSumOfRimLight,
  kSumOfRimArea,
  kSums = 16
};

// Light and area across an edge per unit of outward shift, and their first moments along it.
struct EdgeFlux {
  float light = 0, area = 0, light_at = 0, area_at = 0;

  void operator+=(const EdgeFlux& more) {
    light += more.light;
    area += more.area;
    light_at += more.light_at;
    area_at += more.area_at;
  }
};

// Number of parallel bands of picture rows.
constexpr int kBands = 8;

struct Window {
  int x0, y0, x1, y1;
};

// A lane between two nodes of its groove: a straight line in the picture.
struct LaneLine {
  double from_mm, to_mm;
  Vector2d px, by_mm, by_across;  // at from_mm; per millimeter along, and across
};

// Clips from..to of a line to the window. `leaves_by_row`: the line leaves it through an upper or a lower row.
bool clip_line(const LaneLine& line, const Window& window, double& from, double& to, bool& leaves_by_row) {
  leaves_by_row = false;
  const std::array<double, 2> low{static_cast<double>(window.x0), static_cast<double>(window.y0)},
      high{static_cast<double>(window.x1), static_cast<double>(window.y1)};
  for (int axis = 0; axis < 2; ++axis) {
    const double rate = line.by_mm[axis];
    if (std::abs(rate) < 1e-12) {
      if (line.px[axis] < low[axis] || line.px[axis] >= high[axis]) return false;
      continue;
    }
    const double a = line.from_mm + (low[axis] - line.px[axis]) / rate,
                 b = line.from_mm + (high[axis] - line.px[axis]) / rate;
    from = std::max(from, std::min(a, b));
    if (std::max(a, b) >= to) continue;
    to = std::max(a, b);
    leaves_by_row = axis == 1;
  }
  return from < to;
}

// Walks along a line pixel by pixel: sink.chord(x, y, from, to), and sink.cross_column(line, row, at) or
// sink.cross_row(column, line, at) between pixels. The line must be within the window.
struct LineWalk {
  const LaneLine& line;
  const Window& window;
  double at, next_x, next_y, step_x, step_y;
  int x, y, way_x, way_y;

  LineWalk(const LaneLine& of, const Window& within, double from) : line(of), window(within), at(from) {
    constexpr double kNever = std::numeric_limits<double>::infinity();
    const double px = line.px.x() + (from - line.from_mm) * line.by_mm.x(),
                 py = line.px.y() + (from - line.from_mm) * line.by_mm.y();
    x = std::clamp(static_cast<int>(std::floor(px)), window.x0, window.x1 - 1);
    y = std::clamp(static_cast<int>(std::floor(py)), window.y0, window.y1 - 1);
    const double rx = line.by_mm.x(), ry = line.by_mm.y();
    step_x = rx != 0 ? 1 / std::abs(rx) : kNever;
    step_y = ry != 0 ? 1 / std::abs(ry) : kNever;
    next_x = rx > 0 ? from + (x + 1 - px) * step_x : rx < 0 ? from + (px - x) * step_x : kNever;
    next_y = ry > 0 ? from + (y + 1 - py) * step_y : ry < 0 ? from + (py - y) * step_y : kNever;
    way_x = rx > 0 ? 1 : -1;
    way_y = ry > 0 ? 1 : -1;
  }
  template <typename Sink>
  void go_to(double to, Sink& sink) {
    while (std::min(next_x, next_y) < to) {
      if (next_x < next_y) {
        if (x + way_x < window.x0 || x + way_x >= window.x1) break;
        sink.chord(x, y, at, next_x);
        sink.cross_column(way_x > 0 ? x + 1 : x, y, next_x);
        x += way_x;
        at = next_x;
        next_x += step_x;
      } else {
        if (y + way_y < window.y0 || y + way_y >= window.y1) break;
        sink.chord(x, y, at, next_y);
        sink.cross_row(x, way_y > 0 ? y + 1 : y, next_y);
        y += way_y;
        at = next_y;
        next_y += step_y;
      }
    }
    sink.chord(x, y, at, to);
    at = to;
  }
};

// Number of lines for a lane. Almost parallel to the picture's rows or columns, one line would fall into one of them
// alone.
int lines_of_lanes(const WayNode& a, const WayNode& b, double width_mm) {
  constexpr int kMost = 6;
  const Vector2d way = (b.px - a.px).cwiseAbs();
  const double drift = way.minCoeff() / std::max(way.maxCoeff(), 1e-12), wide_px = width_mm * a.by_across.norm();
  return std::clamp(static_cast<int>(std::ceil(wide_px / std::max(drift, 1e-6))), 1, kMost);
}

// Sum over lanes of their visible fractions times a number that is linear between nodes.
float shared_sum(const float* share, const float* a, const float* b, float at, std::size_t count) {
  float sum_a = 0, sum_b = 0;
  for (std::size_t l = 0; l < count; ++l) {
    sum_a += share[l] * a[l];
    sum_b += share[l] * b[l];
  }
  return sum_a + at * (sum_b - sum_a);
}

// Contributions of a groove's lanes per millimeter, by all parameters of position and direction.
struct LaneNumbers {
  float light, area, by_log_alpha, by_across, by_along;
  float turn;  // by a small turn of the groove
  float rim_light, rim_area;
};

}  // namespace

bool takes_lanes(const ViewScene& scene) { return scene.light.is_lamp() && scene.grid->x_axis.empty(); }

struct LanesView::Data {
  const ViewScene scene;
  const int channels;
  const Lattice lattice;
  const std::array<double, 3> ambient;
  const double px_by_mm;  // approximate scale of the picture

  Ways ways;
  std::vector<float> sums;  // light and area of each pixel; in find_slopes() kSums
  std::vector<EdgeFlux> columns, rows;
  std::size_t chords = 0;

  Data(const ViewScene& of, int channel_count)
      : scene(of),
        channels(channel_count),
        lattice(make_lattice(scene, channels)),
        ambient(ambient_radiance(scene, channels)),
        px_by_mm(1 / middle_pixel(*scene.grid).value_or(MiddlePixel{}).size_mm) {}

  int width() const { return scene.grid->width(); }
  int height() const { return scene.grid->height(); }
  std::size_t pixels() const { return static_cast<std::size_t>(width()) * height(); }
  double alpha_of(const Scratches& s, std::size_t i) const {
    return s.alpha.empty() ? scene.material.alpha : s.alpha[i];
  }
  double depth_of(const Scratches& s, std::size_t i) const {
    return s.depth_um.empty() ? scene.material.depth_um : s.depth_um[i];
  }
  double width_of(const Scratches& s, std::size_t i) const {
    return s.width_um.empty() ? scene.tool_width_um : s.width_um[i];
  }

  // The half vector of the lamp's first point at a position of the picture, in the face's frame.
  Vector2d half_at(const Vector2d& px) const {
    return between(lattice, in_cell(lattice, px.x(), px.y()), [&](std::size_t k) {
      const LampThere& lamp = lattice.lamps[k * lattice.points];
      return Vector2d(lamp.hx, lamp.hy);
    });
  }
  void find_way(const Scratches& s, std::size_t i, Vector2d& guess_px, std::vector<WayNode>& out) const;
  void find_ways(const LanedGrooves& of, bool slopes);
  struct LobeWork {
    WallNodes walls;
    double width_um = 0, depth_um = 0, alpha = 0;
    std::vector<float> value, by_alpha, by_across, by_along;
  };
  void find_light(const LanedGrooves& of, std::size_t i, bool slopes, LobeWork& work);
  template <typename Numbers, typename Sink>
  void walk(const LanedGrooves& of, std::size_t i, const LaneSpots& spots, const Window& window,
            const Numbers& numbers_of, Sink& sink) const;
  template <typename Body>
  void each_band(const Body& body) const;
  LaneNumbers lane_numbers(const LanedGrooves& of, const GroovePlace& place, const LaneSpots& spots, std::size_t cell,
                           const LaneGroup& group, std::size_t node, double at, double scale) const;
  void find_spots(const LanedGrooves& of, std::size_t i, LaneSpots& spots) const {
    spots.find(scene.material.profile, of.lanes.lanes, width_of(of.grooves, i), depth_of(of.grooves, i), px_by_mm);
  }
  struct Seen {
    std::array<double, 3> factor{};
    double base = 0, base_slope = 0, area_mm2 = 0;
    bool is_visible = false, is_lit = false;
  };
  Seen seen_at(std::size_t pixel) const;
  // body(row, pixel, data of the pixel), in parallel.
  template <typename Body>
  void each_lit_pixel(const Body& body) const {
    tbb::parallel_for(0, height(), [&](int y) {
      for (int x = 0; x < width(); ++x) {
        const std::size_t pixel = static_cast<std::size_t>(y) * width() + x;
        if (const Seen seen = seen_at(pixel); seen.is_lit) body(y, pixel, seen);
      }
    });
  }
};

// Nodes so close that the groove between them is straight in the picture, and light is linear.
void LanesView::Data::find_way(const Scratches& s, std::size_t i, Vector2d& guess_px, std::vector<WayNode>& out) const {
  constexpr double kStraightPx = 0.01, kOfAlpha = 0.05;
  constexpr int kMostSpans = 400;
  const GroovePlace place(s, i);
  if (!(place.length_mm > 0)) return;
  const auto node_at = [&](double share, WayNode& node) {
    const double at_mm = share * place.length_mm;
    const InPicture found = in_picture(lattice, place.first + at_mm * place.along, guess_px);
    if (!found.is_found) return false;
    guess_px = found.px;
    node = {at_mm, found.px, found.by_mm * place.across, half_at(found.px)};
    return true;
  };
  WayNode first, middle, last;
  if (!node_at(0, first) || !node_at(0.5, middle) || !node_at(1, last)) return;
  const double bent_px = (middle.px - 0.5 * (first.px + last.px)).norm(),
               turned = (last.half - first.half).norm() / (kOfAlpha * alpha_of(s, i));
  const int spans =
      std::clamp(static_cast<int>(std::ceil(std::max(std::sqrt(bent_px / kStraightPx), turned))), 1, kMostSpans);
  const std::size_t before = out.size();
  out.push_back(first);
  for (int k = 1; k < spans; ++k) {
    WayNode node;
    if (!node_at(static_cast<double>(k) / spans, node)) {
      out.resize(before);
      return;
    }
    out.push_back(node);
  }
  out.push_back(last);
}

void LanesView::Data::find_light(const LanedGrooves& of, std::size_t i, bool slopes, LobeWork& work) {
  const Scratches& s = of.grooves;
  const std::vector<Lane>& lanes = of.lanes.lanes;
  const GrooveProfile& profile = scene.material.profile;
  const double alpha = alpha_of(s, i), width_um = width_of(s, i), depth_um = depth_of(s, i);
  const double roughest = alpha * std::min(1.0, profile.across);
  if (work.width_um != width_um || work.depth_um != depth_um || work.alpha != roughest) {
    work.walls.make(profile, lanes, width_um, depth_um, roughest);
    work.width_um = width_um, work.depth_um = depth_um, work.alpha = roughest;
  }
  const WallNodes& walls = work.walls;
  const auto n = static_cast<int>(walls.sine.size());
  for (auto* v : {&work.value, &work.by_alpha, &work.by_across, &work.by_along}) v->resize(n);
  const GroovePlace place(s, i);
  const double along2 = 1 / (alpha * alpha), across2 = along2 / (profile.across * profile.across);
  LaneLight& light = ways.light;
  for (std::size_t node = ways.first[i]; node < ways.first[i + 1]; ++node) {
    const Vector2d& px = ways.nodes[node].px;
    const InCell cell = in_cell(lattice, px.x(), px.y());
    for (std::size_t point = 0; point < lattice.points; ++point) {
      const auto lamp = [&](std::size_t k) -> const LampThere& { return lattice.lamps[k * lattice.points + point]; };
      const auto value = [&](double LampThere::*of_lamp) {
        return between(lattice, cell, [&](std::size_t k) { return lamp(k).*of_lamp; });
      };
      const Vector2d h(value(&LampThere::hx), value(&LampThere::hy));
      const double strength = value(&LampThere::strength);
      const Shadowing g = shadowing(std::clamp(value(&LampThere::cos_i), 1e-3, 1.0),
                                    std::clamp(value(&LampThere::cos_o), 1e-3, 1.0), alpha);
      LobeAt at;
      at.across = static_cast<float>(h.dot(place.across));
      at.along = static_cast<float>(h.dot(place.along));
      at.up = static_cast<float>(std::sqrt(std::max(1e-6, 1 - h.squaredNorm())));
      at.across2 = static_cast<float>(across2);
      at.along2 = static_cast<float>(along2);
      at.scale = static_cast<float>(strength * g.G * along2 / (std::numbers::pi * profile.across));
      if (slopes)
        lobe_slopes_on_walls(n, walls.sine.data(), walls.cosine.data(), walls.weight_mm.data(), at, work.value.data(),
                             work.by_alpha.data(), work.by_across.data(), work.by_along.data());
      else
        lobes_on_walls(n, walls.sine.data(), walls.cosine.data(), walls.weight_mm.data(), at, work.value.data());
      const auto by_log_G = static_cast<float>(alpha * g.dG_dalpha / g.G);
      int k = 0;
      for (std::size_t l = 0; l < lanes.size(); ++l)
        for (; k < walls.end[l]; ++k) {
          const std::size_t to = node * lanes.size() + l, next = to + walls.other[k];
          const auto add = [&](std::vector<float>& sums, float number) {
            sums[next] += walls.beside[k] * number;
            sums[to] += (1 - walls.beside[k]) * number;
          };
          add(light.value, work.value[k]);
          if (!slopes) continue;
          add(light.by_alpha, work.by_alpha[k] + by_log_G * work.value[k]);
          add(light.by_across, work.by_across[k]);
          add(light.by_along, work.by_along[k]);
        }
      if (!slopes) continue;
      const std::array<float, 2> one{1, 1};
      std::array<float, 2> rims{};
      lobes_on_walls(2, walls.rim_sine.data(), walls.rim_cosine.data(), one.data(), at, rims.data());
      for (int side = 0; side < 2; ++side) light.at_rims[2 * node + side] += rims[side];
    }
  }
}

void LanesView::Data::find_ways(const LanedGrooves& of, bool slopes) {
  constexpr std::size_t kAtOnce = 256;
  const std::size_t grooves = of.grooves.size(), parts = (grooves + kAtOnce - 1) / kAtOnce,
                    lanes = of.lanes.lanes.size();
  struct Part {
    std::vector<WayNode> nodes;
    std::vector<std::size_t> count;
  };
  std::vector<Part> of_part(parts);
  const auto each_part = [&](const auto& body) {
    tbb::parallel_for(std::size_t{0}, parts,
                      [&](std::size_t part) { body(part, part * kAtOnce, std::min(grooves, (part + 1) * kAtOnce)); });
  };
  each_part([&](std::size_t part, std::size_t from, std::size_t to) {
    Vector2d guess_px(0.5 * width(), 0.5 * height());
    for (std::size_t i = from; i < to; ++i) {
      const std::size_t before = of_part[part].nodes.size();
      find_way(of.grooves, i, guess_px, of_part[part].nodes);
      if (!guess_px.allFinite()) guess_px = {0.5 * width(), 0.5 * height()};
      of_part[part].count.push_back(of_part[part].nodes.size() - before);
    }
  });
  ways.first.assign(1, 0);
  ways.nodes.clear();
  for (const Part& part : of_part) {
    for (const std::size_t count : part.count) ways.first.push_back(ways.first.back() + count);
    ways.nodes.insert(ways.nodes.end(), part.nodes.begin(), part.nodes.end());
  }
  const std::size_t numbers = ways.nodes.size() * lanes;
  ways.light.value.assign(numbers, 0);
  for (auto* v : {&ways.light.by_alpha, &ways.light.by_across, &ways.light.by_along})
    v->assign(slopes ? numbers : 0, 0);
  ways.light.at_rims.assign(slopes ? 2 * ways.nodes.size() : 0, 0);
  each_part([&](std::size_t, std::size_t from, std::size_t to) {
    LobeWork work;
    for (std::size_t i = from; i < to; ++i) find_light(of, i, slopes, work);
  });
}

// All lines of light of a groove within a window, cell by cell. numbers_of(cell, group, node, fraction of the way to
// the next node) returns the contributions per millimeter. `sink` takes the chords, with these values in sink.numbers.
template <typename Numbers, typename Sink>
void LanesView::Data::walk(const LanedGrooves& of, std::size_t i, const LaneSpots& spots, const Window& window,
                           const Numbers& numbers_of, Sink& sink) const {
  const std::size_t first = ways.first[i], last = ways.first[i + 1];
  if (last - first < 2) return;
  double low = ways.nodes[first].px.y(), high = low, most_px = 0;
  for (std::size_t node = first; node < last; ++node) {
    low = std::min(low, ways.nodes[node].px.y());
    high = std::max(high, ways.nodes[node].px.y());
    most_px = std::max(most_px, ways.nodes[node].by_across.norm());
  }
  const double aside_px = most_px * spots.most_aside_mm;
  if (high + aside_px < window.y0 || low - aside_px > window.y1) return;
  const std::size_t first_cell = of.lanes.first[i], cells = of.lanes.first[i + 1] - first_cell;
  const double cell_mm = ways.nodes[last - 1].at_mm / static_cast<double>(cells);
  for (std::size_t node = first; node + 1 < last; ++node) {
    const WayNode &a = ways.nodes[node], &b = ways.nodes[node + 1];
    const double span_mm = b.at_mm - a.at_mm;
    for (const LaneGroup& group : spots.groups) {
      const int lines = lines_of_lanes(a, b, group.width_mm);
      for (int k = 0; k < lines; ++k) {
        const double aside = group.middle_mm + ((k + 0.5) / lines - 0.5) * group.width_mm;
        const Vector2d px = a.px + aside * a.by_across;
        const LaneLine line{a.at_mm, b.at_mm, px, (b.px + aside * b.by_across - px) / span_mm,
                            0.5 * (a.by_across + b.by_across)};
        double from = a.at_mm, to = b.at_mm;
        bool leaves_by_row = false;
        if (!clip_line(line, window, from, to, leaves_by_row)) continue;
        LineWalk way(line, window, from);
        sink.begin_line(line);
        for (auto cell = static_cast<std::size_t>(from / cell_mm); cell < cells && way.at < to; ++cell) {
          const double end = cell + 1 == cells ? to : std::min(to, static_cast<double>(cell + 1) * cell_mm);
          if (!(end > way.at)) continue;
          numbers_of(first_cell + cell, group, node, (0.5 * (way.at + end) - a.at_mm) / span_mm, 1.0 / lines,
                     sink.numbers);
          way.go_to(end, sink);
        }
        if (leaves_by_row) {
          const double end_x = line.px.x() + (to - line.from_mm) * line.by_mm.x();
          sink.leave_row(std::clamp(static_cast<int>(std::floor(end_x)), window.x0, window.x1 - 1),
                         line.by_mm.y() > 0 ? window.y1 : window.y0, to);
        }
      }
    }
  }
}

// Bands of picture rows, each independent: every sum has one order for any number of threads.
template <typename Body>
void LanesView::Data::each_band(const Body& body) const {
  const int bands = std::min(kBands, height());
  tbb::parallel_for(0, bands, [&](int band) {
    body(band, Window{0, static_cast<int>(static_cast<long>(height()) * band / bands), width(),
                      static_cast<int>(static_cast<long>(height()) * (band + 1) / bands)});
  });
}

LanesView::Data::Seen LanesView::Data::seen_at(std::size_t pixel) const {
  Seen out;
  const int x = static_cast<int>(pixel % width()), y = static_cast<int>(pixel / width());
  out.area_mm2 = footprint_area_mm2(*scene.grid, pixel, footprint_corners_mm(*scene.grid, x, y));
  if (!(out.area_mm2 > 0)) return out;
  const bool is_hidden = !scene.hidden_from_light.empty() && scene.hidden_from_light[pixel] != 0;
  const InCell cell = in_cell(lattice, x + 0.5, y + 0.5);
  const auto node = [&](std::size_t k) -> const LatticeNode& { return lattice.nodes[k]; };
  const std::size_t below = cell.node + lattice.xs.size();
  if (node(cell.node).is_good && node(cell.node + 1).is_good && node(below).is_good && node(below + 1).is_good) {
    out.is_visible = true;
    out.is_lit = !is_hidden;
    if (is_hidden) return out;
    for (int c = 0; c < channels; ++c)
      out.factor[c] = between(lattice, cell, [&](std::size_t k) { return node(k).factor[c]; });
    out.base = between(lattice, cell, [&](std::size_t k) { return node(k).base; });
    out.base_slope = between(lattice, cell, [&](std::size_t k) { return node(k).base_slope; });
    return out;
  }
  const PixelShading p = shade_pixel(scene, pixel);
  out.is_visible = p.visible;
  out.is_lit = p.lit;
  if (!p.lit) return out;
  const auto factor = channel_factors(scene, p.cos_ho, channels);
  for (int c = 0; c < channels; ++c) out.factor[c] = factor[c] * p.direct;
  out.base = p.base;
  out.base_slope = base_slope(p, scene.material.base_alpha, scene.material.grain);
  return out;
}

namespace {

// Ignores edges.
struct NoEdges {
  void begin_line(const LaneLine&) {}
  void cross_column(int, int, double) {}
  void cross_row(int, int, double) {}
  void leave_row(int, int, double) {}
};

// Sums light and area of each pixel.
struct ValueSink : NoEdges {
  float* sums;
  int width;
  std::array<float, 2> numbers{};
  std::size_t chords = 0;

  ValueSink(float* of_pixels, int of_width) : sums(of_pixels), width(of_width) {}
  void chord(int x, int y, double from, double to) {
    const auto length = static_cast<float>(to - from);
    float* const at = sums + 2 * (static_cast<std::size_t>(y) * width + x);
    at[0] += length * numbers[0];
    at[1] += length * numbers[1];
    ++chords;
  }
};

}  // namespace

LanesView::LanesView(const ViewScene& scene, int channels) : data_(std::make_unique<Data>(scene, channels)) {}
LanesView::~LanesView() = default;

std::size_t LanesView::chord_count() const { return data_->chords; }

void LanesView::forward(const LanedGrooves& of, bool keep_slopes, Image& radiance) {
  Data& d = *data_;
  d.find_ways(of, keep_slopes);
  d.sums.assign(2 * d.pixels(), 0);
  if (radiance.width != d.width() || radiance.height != d.height() || radiance.channels != d.channels)
    radiance = Image(d.width(), d.height(), d.channels);
  const std::size_t lanes = of.lanes.lanes.size();
  std::array<std::size_t, kBands> chords{};
  d.each_band([&](int band, const Window& window) {
    LaneSpots spots;
    ValueSink sink(d.sums.data(), d.width());
    const std::vector<float>& light = d.ways.light.value;
    for (std::size_t i = 0; i < of.grooves.size(); ++i) {
      d.find_spots(of, i, spots);
      d.walk(
          of, i, spots, window,
          [&](std::size_t cell, const LaneGroup& group, std::size_t node, double at, double scale,
              std::array<float, 2>& to) {
            const std::size_t count = group.last - group.first;
            const float* const share = &of.lanes.share[cell * lanes + group.first];
            const float* const a = &light[node * lanes + group.first];
            const float* const width = &spots.width_mm[group.first];
            to[0] = static_cast<float>(scale) * shared_sum(share, a, a + lanes, static_cast<float>(at), count);
            to[1] = static_cast<float>(scale) * shared_sum(share, width, width, 0, count);
          },
          sink);
    }
    chords[band] = sink.chords;
    for (int y = window.y0; y < window.y1; ++y)
      for (int x = 0; x < d.width(); ++x) {
        const std::size_t pixel = static_cast<std::size_t>(y) * d.width() + x;
        float* const to = &radiance.data[pixel * d.channels];
        std::fill_n(to, d.channels, 0.0F);
        const Data::Seen seen = d.seen_at(pixel);
        if (!seen.is_visible) continue;
        const double covered = std::min(1.0, d.sums[2 * pixel + 1] / seen.area_mm2),
                     lobes = seen.is_lit ? d.sums[2 * pixel] / seen.area_mm2 + (1 - covered) * seen.base : 0;
        for (int c = 0; c < d.channels; ++c) to[c] = static_cast<float>(seen.factor[c] * lobes + d.ambient[c]);
      }
  });
  d.chords = std::accumulate(chords.begin(), chords.end(), std::size_t{0});
}

namespace {

// Sums a pixel's numbers (SumOf), and the flux across its edges.
struct SlopeSink {
  float* sums;
  EdgeFlux *columns, *rows, *upwards;
  int width;
  std::array<float, kSums> numbers{};
  const LaneLine* line = nullptr;
  float inv_rate_x = 0, inv_rate_y = 0;

  void begin_line(const LaneLine& of) {
    line = &of;
    inv_rate_x = of.by_mm.x() != 0 ? static_cast<float>(1 / std::abs(of.by_mm.x())) : 0;
    inv_rate_y = of.by_mm.y() != 0 ? static_cast<float>(1 / std::abs(of.by_mm.y())) : 0;
  }
  void chord(int x, int y, double from, double to) {
    const auto length = static_cast<float>(to - from);
    float* const sum = sums + kSums * (static_cast<std::size_t>(y) * width + x);
    for (int k = 0; k < kSums; ++k) sum[k] += length * numbers[k];
  }
  void add(EdgeFlux& edge, double along_edge, float inv_rate) const {
    const auto share = static_cast<float>(along_edge);
    const float light = inv_rate * numbers[kSumOfLight], area = inv_rate * numbers[kSumOfArea];
    edge += {light, area, share * light, share * area};
  }
  void cross_column(int x, int y, double at) const {
    const double py = line->px.y() + (at - line->from_mm) * line->by_mm.y();
    add(columns[static_cast<std::size_t>(y) * (width + 1) + x], std::clamp(py - y, 0.0, 1.0), inv_rate_x);
  }
  void cross_row(int x, int y, double at) const { add_row(rows[static_cast<std::size_t>(y) * width + x], x, at); }
  void add_row(EdgeFlux& edge, int x, double at) const {
    const double px = line->px.x() + (at - line->from_mm) * line->by_mm.x();
    add(edge, std::clamp(px - x, 0.0, 1.0), inv_rate_y);
  }
  // Upwards into another band, which owns this row of edges.
  void leave_row(int x, int y, double at) const {
    if (line->by_mm.y() > 0) return cross_row(x, y, at);
    add_row(upwards[x], x, at);
  }
};

}  // namespace

// Contributions of a group's lanes in a cell, between two nodes of the groove, times `scale`. The derivative by depth
// is per um of the shared depth.
LaneNumbers LanesView::Data::lane_numbers(const LanedGrooves& of, const GroovePlace& place, const LaneSpots& spots,
                                          std::size_t cell, const LaneGroup& group, std::size_t node, double at,
                                          double scale) const {
  const std::size_t lanes = of.lanes.lanes.size(), count = group.last - group.first, from = cell * lanes + group.first,
                    to = node * lanes + group.first;
  const auto f = static_cast<float>(at), times = static_cast<float>(scale);
  const auto sum = [&](const std::vector<float>& shares, const std::vector<float>& numbers) {
    return times * shared_sum(&shares[from], &numbers[to], &numbers[to + lanes], f, count);
  };
  const float* const width = &spots.width_mm[group.first];
  const auto width_of = [&](const std::vector<float>& shares) {
    return times * shared_sum(&shares[from], width, width, 0, count);
  };
  const std::vector<float>& share = of.lanes.share;
  LaneNumbers out{};
  out.light = sum(share, ways.light.value);
  out.area = width_of(share);
  out.by_log_alpha = sum(share, ways.light.by_alpha);
  out.by_across = sum(share, ways.light.by_across);
  out.by_along = sum(share, ways.light.by_along);
  const Vector2d h = (1 - at) * ways.nodes[node].half + at * ways.nodes[node + 1].half;
  // A turn of the groove turns h in the opposite direction in its frame.
  out.turn = static_cast<float>(out.by_across * h.dot(place.along) - out.by_along * h.dot(place.across));
  const auto rim = static_cast<float>(scale * spots.depth_um / scene.material.depth_um * spots.rim_by_depth_mm);
  for (int side = 0; side < 2; ++side) {
    const std::size_t outermost = side == 0 ? 0 : spots.groove_lanes - 1;
    if (outermost < group.first || outermost >= group.last) continue;
    const float* const at_rims = &ways.light.at_rims[2 * node + side];
    const float grows = rim * share[cell * lanes + outermost];
    out.rim_light += grows * (at_rims[0] + f * (at_rims[2] - at_rims[0]));
    out.rim_area += grows;
  }
  if (of.lanes.share_by_depth.empty()) return out;
  const auto unit = static_cast<float>(1 / scene.material.depth_um);
  out.rim_light += unit * sum(of.lanes.share_by_depth, ways.light.value);
  out.rim_area += unit * width_of(of.lanes.share_by_depth);
  return out;
}

void LanesView::find_slopes(const LanedGrooves& of) {
  Data& d = *data_;
  d.find_ways(of, true);
  d.sums.assign(kSums * d.pixels(), 0);
  d.columns.assign(static_cast<std::size_t>(d.width() + 1) * d.height(), {});
  d.rows.assign(static_cast<std::size_t>(d.width()) * (d.height() + 1), {});
  std::vector<EdgeFlux> upwards(static_cast<std::size_t>(kBands) * d.width());  // through the uppermost edges of bands
  d.each_band([&](int band, const Window& window) {
    LaneSpots spots;
    SlopeSink sink{d.sums.data(), d.columns.data(), d.rows.data(), &upwards[static_cast<std::size_t>(band) * d.width()],
                   d.width()};
    // by the log of a groove's own alpha, in units of the shared one
    const double by_alpha = 1 / d.scene.material.alpha;
    for (std::size_t i = 0; i < of.grooves.size(); ++i) {
      d.find_spots(of, i, spots);
      const GroovePlace place(of.grooves, i);
      const Vector2d &u = place.along, &across = place.across;
      d.walk(
          of, i, spots, window,
          [&](std::size_t cell, const LaneGroup& group, std::size_t node, double at, double scale,
              std::array<float, kSums>& to) {
            const LaneNumbers n = d.lane_numbers(of, place, spots, cell, group, node, at, scale);
            const std::array<double, kSums> numbers{n.light,
                                                    n.area,
                                                    by_alpha * n.by_log_alpha,
                                                    n.by_across * across.x() + n.by_along * u.x(),
                                                    n.by_across * across.y() + n.by_along * u.y(),
                                                    n.turn,
                                                    n.turn * u.x() * u.x(),
                                                    n.turn * u.x() * u.y(),
                                                    n.light * u.x() * u.x(),
                                                    n.light * u.x() * u.y(),
                                                    n.area * u.x() * u.x(),
                                                    n.area * u.x() * u.y(),
                                                    n.rim_light,
                                                    n.rim_area,
                                                    0,
                                                    0};
            for (int k = 0; k < kSums; ++k) to[k] = static_cast<float>(numbers[k]);
          },
          sink);
    }
  });
  d.each_band([&](int band, const Window& window) {
    for (int x = 0; x < d.width(); ++x)
      d.rows[static_cast<std::size_t>(window.y0) * d.width() + x] +=
          upwards[static_cast<std::size_t>(band) * d.width() + x];
  });
}

namespace {

// Gradient of E by one groove, from E's gradient by each pixel's light and area.
struct GradientSink {
  const float *by_light, *by_area;
  int width;
  double length_mm;
  LaneNumbers numbers{};
  double across_x = 0, across_y = 0;  // px per millimeter across, over px per millimeter along
  double by_alpha = 0, by_depth = 0, by_turn = 0, by_across = 0, by_across_along = 0, by_first = 0, by_last = 0;

  void begin_line(const LaneLine& line) {
    across_x = line.by_mm.x() != 0 ? line.by_across.x() / std::abs(line.by_mm.x()) : 0;
    across_y = line.by_mm.y() != 0 ? line.by_across.y() / std::abs(line.by_mm.y()) : 0;
  }
  double at_pixel(std::size_t pixel, double light, double area) const {
    return by_light[pixel] * light + by_area[pixel] * area;
  }
  void chord(int x, int y, double from, double to) {
    constexpr double kRounding_mm = 1e-9;
    const std::size_t pixel = static_cast<std::size_t>(y) * width + x;
    const double length = to - from;
    by_alpha += length * by_light[pixel] * numbers.by_log_alpha;
    by_turn += length * by_light[pixel] * numbers.turn;
    by_depth += length * at_pixel(pixel, numbers.rim_light, numbers.rim_area);
    if (from <= 0) by_first += at_pixel(pixel, numbers.light, numbers.area);
    if (to >= length_mm - kRounding_mm) by_last += at_pixel(pixel, numbers.light, numbers.area);
  }
  void cross(std::size_t before, std::size_t after, double t, double rate) {
    const double flux =
        rate * (at_pixel(after, numbers.light, numbers.area) - at_pixel(before, numbers.light, numbers.area));
    by_across += flux;
    by_across_along += flux * t / length_mm;
  }
  void cross_column(int x, int y, double t) {
    const std::size_t after = static_cast<std::size_t>(y) * width + x;
    cross(after - 1, after, t, across_x);
  }
  void cross_row(int x, int y, double t) {
    const std::size_t after = static_cast<std::size_t>(y) * width + x;
    cross(after - width, after, t, across_y);
  }
  void leave_row(int, int, double) {}
};

struct LightSink : NoEdges {
  const float* by_light;
  int width;
  float numbers = 0;
  double sum = 0;

  LightSink(const float* of_pixels, int of_width) : by_light(of_pixels), width(of_width) {}
  void chord(int x, int y, double from, double to) {
    sum += (to - from) * by_light[static_cast<std::size_t>(y) * width + x] * numbers;
  }
};

}  // namespace

void LanesView::backward(const LanedGrooves& of, const Image& dE_dradiance, ScratchGradients& gradients) const {
  const Data& d = *data_;
  if (d.ways.light.by_alpha.size() != d.ways.light.value.size())
    fail("ViewRenderer::backward", "there is no Jacobian", "call forward_with_jacobian() first");
  std::vector<float> by_light(d.pixels(), 0), by_area(d.pixels(), 0);
  std::vector<double> by_base_alpha(d.height(), 0);
  d.each_lit_pixel([&](int y, std::size_t pixel, const Data::Seen& seen) {
    double by_lobes = 0;
    for (int c = 0; c < d.channels; ++c) by_lobes += dE_dradiance.data[pixel * d.channels + c] * seen.factor[c];
    const double covered = std::min(1.0, d.sums[2 * pixel + 1] / seen.area_mm2);
    by_light[pixel] = static_cast<float>(by_lobes / seen.area_mm2);
    if (covered < 1) by_area[pixel] = static_cast<float>(-by_lobes * seen.base / seen.area_mm2);
    by_base_alpha[y] += by_lobes * (1 - covered) * seen.base_slope;
  });
  gradients.shared_base_alpha =
      std::accumulate(by_base_alpha.begin(), by_base_alpha.end(), gradients.shared_base_alpha);
  const std::size_t grooves = of.grooves.size();
  constexpr std::size_t kAtOnce = 64;
  const Window whole{0, 0, d.width(), d.height()};
  std::vector<Eigen::Array2d> shared((grooves + kAtOnce - 1) / kAtOnce, Eigen::Array2d::Zero());
  tbb::parallel_for(std::size_t{0}, shared.size(), [&](std::size_t part) {
    LaneSpots spots;
    for (std::size_t i = part * kAtOnce; i < std::min(grooves, (part + 1) * kAtOnce); ++i) {
      d.find_spots(of, i, spots);
      const GroovePlace place(of.grooves, i);
      GradientSink sink{by_light.data(), by_area.data(), d.width(), place.length_mm};
      d.walk(
          of, i, spots, whole,
          [&](std::size_t cell, const LaneGroup& group, std::size_t node, double at, double scale, LaneNumbers& to) {
            to = d.lane_numbers(of, place, spots, cell, group, node, at, scale);
          },
          sink);
      const double by_alpha = sink.by_alpha / d.alpha_of(of.grooves, i),
                   by_depth = sink.by_depth * d.scene.material.depth_um / spots.depth_um,
                   turn = sink.by_turn / place.length_mm, second = sink.by_across_along - turn,
                   first = sink.by_across - sink.by_across_along + turn;
      const Vector2d by_first = first * place.across - sink.by_first * place.along,
                     by_last = second * place.across + sink.by_last * place.along;
      gradients.x0_mm[i] += by_first.x();
      gradients.y0_mm[i] += by_first.y();
      gradients.x1_mm[i] += by_last.x();
      gradients.y1_mm[i] += by_last.y();
      gradients.depth_um[i] += by_depth;
      gradients.alpha[i] += by_alpha;
      shared[part] += Eigen::Array2d(by_depth, by_alpha);
    }
  });
  for (const Eigen::Array2d& part : shared) {
    gradients.shared_depth_um += part[0];
    gradients.shared_alpha += part[1];
  }
}

void LanesView::add_contributions(const LanedGrooves& of, std::vector<double>& contribution) const {
  const Data& d = *data_;
  std::vector<float> by_light(d.pixels(), 0);
  d.each_lit_pixel([&](int, std::size_t pixel, const Data::Seen& seen) {
    const double mean = std::accumulate(seen.factor.begin(), seen.factor.begin() + d.channels, 0.0) / d.channels;
    by_light[pixel] = static_cast<float>(mean / seen.area_mm2);
  });
  const std::size_t lanes = of.lanes.lanes.size();
  const Window whole{0, 0, d.width(), d.height()};
  tbb::parallel_for(std::size_t{0}, of.grooves.size(), [&](std::size_t i) {
    LaneSpots spots;
    d.find_spots(of, i, spots);
    LightSink sink(by_light.data(), d.width());
    d.walk(
        of, i, spots, whole,
        [&](std::size_t cell, const LaneGroup& group, std::size_t node, double at, double scale, float& to) {
          const float* const a = &d.ways.light.value[node * lanes + group.first];
          to = static_cast<float>(scale) * shared_sum(&of.lanes.share[cell * lanes + group.first], a, a + lanes,
                                                      static_cast<float>(at), group.last - group.first);
        },
        sink);
    contribution[i] += sink.sum;
  });
}

GrooveSums LanesView::sums_of(std::size_t pixel, const PixelShading& p, const std::array<Vector2d, 4>& corners_mm,
                              double area_mm2) const {
  const Data& d = *data_;
  const float* const sum = &d.sums[kSums * pixel];
  GrooveSums out;
  out.light_mm2 = sum[kSumOfLight];
  out.area_mm2 = sum[kSumOfArea];
  if (!(out.area_mm2 > 0)) return out;
  const double base = out.area_mm2 < area_mm2 ? p.base : 0;
  out.depth_um = sum[kSumOfRimLight] - base * sum[kSumOfRimArea];
  out.alpha = sum[kSumOfAlpha];
  out.h_face = {sum[kSumOfHalfX], sum[kSumOfHalfY], 0};
  const Shadowing g = shadowing(p.cos_i, p.cos_o, d.scene.material.alpha);
  out.cos_i = out.light_mm2 * g.dG_dcos_i / g.G;
  out.cos_o = out.light_mm2 * g.dG_dcos_o / g.G;

  // Edges that move outwards.
  const int x = static_cast<int>(pixel % d.width()), y = static_cast<int>(pixel / d.width());
  Eigen::Matrix2d by_px;
  by_px.col(0) = 0.5 * (corners_mm[1] + corners_mm[2] - corners_mm[0] - corners_mm[3]);
  by_px.col(1) = 0.5 * (corners_mm[2] + corners_mm[3] - corners_mm[0] - corners_mm[1]);
  const Eigen::Matrix2d by_mm = by_px.inverse();
  const Vector2d to_x = by_mm.row(0), to_y = by_mm.row(1);
  const auto add = [&](const EdgeFlux& edge, const Vector2d& outwards, int first, int second) {
    const double whole = edge.light - base * edge.area, at = edge.light_at - base * edge.area_at;
    out.corner_mm[first] += (whole - at) * outwards;
    out.corner_mm[second] += at * outwards;
  };
  const std::size_t column = static_cast<std::size_t>(y) * (d.width() + 1) + x;
  add(d.columns[column], -to_x, 0, 3);
  add(d.columns[column + 1], to_x, 1, 2);
  add(d.rows[pixel], -to_y, 0, 1);
  add(d.rows[pixel + d.width()], to_y, 3, 2);

  // Light is fixed to positions, not to grooves: the half vector does not change as an edge moves.
  Eigen::Matrix2d half_by_px;
  for (int axis = 0; axis < 2; ++axis) {
    const Vector2d step(axis == 0 ? 0.5 : 0, axis == 0 ? 0 : 0.5), here(x + 0.5, y + 0.5);
    half_by_px.col(axis) = d.half_at(here + step) - d.half_at(here - step);
  }
  const Vector2d by_place = (half_by_px * by_mm).transpose() * out.h_face.head<2>();
  for (Vector2d& corner : out.corner_mm) corner -= 0.25 * by_place;

  // Mapped grooves: the footprint is mapped inversely, and the grooves become longer and turn.
  const Vector2d middle = 0.25 * (corners_mm[0] + corners_mm[1] + corners_mm[2] + corners_mm[3]);
  Vector2d shift(0, 0);
  Eigen::Matrix2d by_map = Eigen::Matrix2d::Zero();
  for (int k = 0; k < 4; ++k) {
    shift -= out.corner_mm[k];
    by_map -= out.corner_mm[k] * (corners_mm[k] - middle).transpose();
  }
  const double xx = sum[kSumOfLengthXX] - base * sum[kSumOfAreaXX], xy = sum[kSumOfLengthXY] - base * sum[kSumOfAreaXY],
               yy = out.light_mm2 - base * out.area_mm2 - xx;
  const double turn_xx = sum[kSumOfTurnXX], turn_xy = sum[kSumOfTurnXY], turn_yy = sum[kSumOfTurn] - turn_xx;
  by_map(0, 0) += xx - turn_xy;
  by_map(0, 1) += xy - turn_yy;
  by_map(1, 0) += xy + turn_xx;
  by_map(1, 1) += yy + turn_xy;
  for (int row = 0; row < 2; ++row) {
    for (int k = 0; k < 2; ++k) out.affine[3 * row + k] = shift[row] * middle[k] + by_map(row, k);
    out.affine[3 * row + 2] = shift[row];
  }
  return out;
}

}  // namespace burin

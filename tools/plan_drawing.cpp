#include "tools/plan_drawing.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>
#include <vector>

#include "burin/base/files/svg.h"

namespace burin {
namespace {

constexpr double kPage = 900, kMargin = 46;  // SVG units
constexpr const char* kInk = "#1f2328";
constexpr const char* kSoft = "#6e7781";
constexpr const char* kLampColor = "#bf8700";
constexpr const char* kCameraColor = "#0969da";

// One of the two projections: mm (right, up) to the page.
struct PlanFrame {
  Eigen::Vector2d low, high;  // mm
  double scale = 1, top = 0;

  Eigen::Vector2d at(const Eigen::Vector2d& p) const {
    return {kMargin + (p.x() - low.x()) * scale, top + (high.y() - p.y()) * scale};
  }
  double height() const { return (high.y() - low.y()) * scale; }
};

std::string text(const Eigen::Vector2d& p, const std::string& what, const char* color, const char* anchor, int size) {
  return svg_words(p, what, anchor, fmt::format("fill=\"{}\" font-size=\"{}\"", color, size));
}

std::string line(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const char* color, double width, bool dashed) {
  return svg_line(
      a, b,
      fmt::format("stroke=\"{}\" stroke-width=\"{}\"{}", color, width, dashed ? " stroke-dasharray=\"5 4\"" : ""));
}

std::string star(const Eigen::Vector2d& c, double radius) {
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i < 16; ++i) {
    const double r = i % 2 == 0 ? radius : 0.45 * radius, a = i * std::numbers::pi / 8;
    points.emplace_back(c.x() + r * std::cos(a), c.y() + r * std::sin(a));
  }
  return svg_polygon(points, fmt::format("fill=\"{}\"", kLampColor));
}

// Returns a length of 1, 2 or 5 times a power of ten, about a sixth of the page.
double ruler_mm(double scale) {
  const double wanted = kPage / 6 / scale, power = std::pow(10, std::floor(std::log10(wanted)));
  return power * (wanted > 5 * power ? 5 : wanted > 2 * power ? 2 : 1);
}

}  // namespace

std::string plan_drawing(const Plan& plan, const Board& board) {
  std::vector<Eigen::Vector3d> cameras;
  for (const PlannedShot& shot : plan.shots) cameras.push_back(shot.camera.center_mm());
  std::set<std::size_t> lamps;
  for (const PlannedShot& shot : plan.shots) lamps.insert(shot.light);
  const Eigen::Vector3d middle(board.size_mm.x() / 2, board.size_mm.y() / 2, 0);

  Eigen::Vector3d low(0, 0, 0), high(board.size_mm.x(), board.size_mm.y(), 0);
  const auto include = [&](const Eigen::Vector3d& p) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  };
  for (const Eigen::Vector3d& p : cameras) include(p);
  for (const std::size_t lamp : lamps) include(plan.bench.lights[lamp].position_mm);
  const double pad = 0.06 * (high - low).norm();
  low -= Eigen::Vector3d::Constant(pad);
  high += Eigen::Vector3d::Constant(pad);
  const double scale = (kPage - 2 * kMargin) / (high.x() - low.x());
  PlanFrame above{low.head<2>(), high.head<2>(), scale, kMargin + 14};
  PlanFrame side{{low.x(), std::min(low.z(), 0.0)}, {high.x(), high.z()}, scale, 0};
  side.top = above.top + above.height() + 56;
  const double page_height = std::round(side.top + side.height() + kMargin);

  std::string svg = "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n";
  svg += text({kMargin, 30}, "From above: the board's lower edge is towards you", kInk, "start", 17);
  svg += text({kMargin, side.top - 14}, "From the lower edge: heights above the face", kInk, "start", 17);

  // The board.
  const Eigen::Vector2d corner = above.at({0, board.size_mm.y()});
  svg += fmt::format(
      "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"#eaeef2\" stroke=\"{}\"/>\n",
      corner.x(), corner.y(), board.size_mm.x() * scale, board.size_mm.y() * scale, kInk);
  for (const Tag& tag : board.tags.list) {
    std::vector<Eigen::Vector2d> corners;
    for (const Eigen::Vector2d& p : tag_corners_mm(tag)) corners.push_back(above.at(p));
    svg += svg_polygon(corners, "fill=\"#8c959f\"");
  }
  svg += line(side.at({0, 0}), side.at({board.size_mm.x(), 0}), kInk, 5, false);

  // Lamps, then cameras: number, line of sight; dashed for a camera on its side.
  const auto both = [&](const Eigen::Vector3d& p) {
    return std::array<Eigen::Vector2d, 2>{above.at(p.head<2>()), side.at({p.x(), p.z()})};
  };
  const auto middles = both(middle);
  for (const std::size_t lamp : lamps) {
    const Light& light = plan.bench.lights[lamp];
    for (const Eigen::Vector2d& p : both(light.position_mm)) {
      svg += star(p, 12);
      svg += text(p + Eigen::Vector2d(0, -16), light.id, kLampColor, "middle", 13);
    }
  }
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const auto places = both(cameras[i]);
    for (int view = 0; view < 2; ++view)
      svg += line(places[view], middles[view], kCameraColor, 0.8, plan.shots[i].camera.roll_rad > 0.1);
  }
  for (std::size_t i = 0; i < cameras.size(); ++i)
    for (const Eigen::Vector2d& p : both(cameras[i])) {
      svg += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"11\" fill=\"{}\"/>\n", p.x(), p.y(), kCameraColor);
      svg += text(p + Eigen::Vector2d(0, 4.5), std::to_string(i + 1), "white", "middle", 13);
    }
  const double ruler = ruler_mm(scale);
  const Eigen::Vector2d end(kPage - kMargin, above.top + above.height() + 6);
  svg += line(end - Eigen::Vector2d(ruler * scale, 0), end, kSoft, 3, false);
  svg += text(end + Eigen::Vector2d(0, 17), fmt::format("{:.0f} mm", ruler), kSoft, "end", 13);
  return svg_drawing({kPage, page_height},
                     fmt::format("width=\"{:.0f}\" height=\"{:.0f}\" font-family=\"sans-serif\"", kPage, page_height),
                     svg);
}

}  // namespace burin

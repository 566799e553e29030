#include "tools/new/lay_out.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "burin/base/error.h"
#include "burin/optimize/layout/tag_layout.h"
#include "burin/optimize/layout/view_places.h"
#include "burin/scene/look_at.h"

namespace burin {
namespace {

constexpr double kDepth_um = 14;     // depth of a drag bit; others only if half vectors tilt further
constexpr double kFace_alpha = 0.1;  // polished or fine satin, as a background for glints
constexpr double kFurthest_mm = 10e3;

Eigen::Vector3d board_middle(const Board& board) { return {board.size_mm.x() / 2, board.size_mm.y() / 2, 0}; }

std::vector<Eigen::Vector2d> seen(const Lens& lens, const Eigen::Vector3d& eye_mm, const Board& board,
                                  const std::vector<Eigen::Vector2d>& places) {
  const Eigen::Isometry3d T = look_at(eye_mm, board_middle(board));
  std::vector<Eigen::Vector3d> p;
  p.reserve(places.size());
  for (const Eigen::Vector2d& place : places) p.push_back(T * Eigen::Vector3d(place.x(), place.y(), 0));
  std::vector<Eigen::Vector2d> q(p.size());
  project(lens, p, q);
  return q;
}

// Returns the shortest side of a tag in the photos.
double smallest_tag_px(const Lens& lens, const std::vector<Eigen::Vector3d>& eyes, const Board& board) {
  double least = INFINITY;
  for (const Eigen::Vector3d& eye : eyes)
    for (const Tag& tag : board.tags.list) {
      const auto corners = tag_corners_mm(tag);
      const std::vector<Eigen::Vector2d> q = seen(lens, eye, board, {corners.begin(), corners.end()});
      for (std::size_t k = 0; k < 4; ++k) least = std::min(least, (q[k] - q[(k + 1) % 4]).norm());
    }
  return least;
}

// Returns the factor by which the photo would have to be wider to show the whole board with a small margin.
double crowding(const Lens& lens, const std::vector<Eigen::Vector3d>& eyes, const Board& board) {
  const Eigen::Vector2d size = board.size_mm;
  double most = 0;
  for (const Eigen::Vector3d& eye : eyes)
    for (const Eigen::Vector2d& q : seen(lens, eye, board, {{0, 0}, {size.x(), 0}, {0, size.y()}, size})) {
      constexpr double kRoom = 1.06;
      most = std::max(most, kRoom * std::abs(q.x() / (0.5 * lens.width) - 1));
      most = std::max(most, kRoom * std::abs(q.y() / (0.5 * lens.height) - 1));
    }
  return most;
}

// Returns the smallest side that the detector finds: two and a half pixels per module of a 41h12. The detector halves
// photos above 4 megapixels (burin/capture/tags/tag_detector.h).
double needed_px(const Lens& lens) {
  constexpr double kFound = 13, kHalvedAbove = 4e6;
  return static_cast<double>(lens.width) * lens.height > kHalvedAbove ? 2 * kFound : kFound;
}

// Chooses eyes at that distance for the shallowest glinting grooves; nothing if no groove glints.
std::optional<std::vector<Eigen::Vector3d>> places_at(double stand_mm, const BenchWishes& wanted,
                                                      const Eigen::Vector3d& lamp_mm, Board& board) {
  for (const double depth_um : {kDepth_um, 16.0, 18.0, 20.0}) {
    const PlaceQuestion question{
        wanted.views,        lamp_mm, stand_mm, board.carve_min_mm, board.carve_max_mm, board.tool_width_um, depth_um,
        board.material.alpha};
    auto eyes = view_places(question);
    if (!eyes) continue;
    board.material.depth_um = depth_um;
    for (Eigen::Vector3d& eye : *eyes) eye = eye.array().round();
    return eyes;
  }
  return std::nullopt;
}

// Lays the bench out at one distance; nothing if no groove can glint.
std::optional<LaidOutBench> laid_out_at(double stand_mm, double tag_mm, const BenchWishes& wanted) {
  LaidOutBench bench;
  bench.stand_mm = stand_mm;
  bench.lamp_mm = lamp_position_mm(wanted.lamp, wanted.board_mm, stand_mm);
  bench.board = board_with_tags(wanted.board_mm, tag_mm);
  bench.board.material.base_alpha = kFace_alpha;
  auto eyes = places_at(stand_mm, wanted, bench.lamp_mm, bench.board);
  if (!eyes) return std::nullopt;
  bench.eyes_mm = *eyes;
  bench.tag_px = smallest_tag_px(wanted.camera.lens, bench.eyes_mm, bench.board);
  return bench;
}

std::string meters(double mm) { return fmt::format("{:.2f} m", std::ceil(mm / 10) / 100); }

[[noreturn]] void fail_without_glint(const BenchWishes& wanted, double stand_mm) {
  const TagSizes tags = tag_sizes(wanted.board_mm);
  const std::string where = fmt::format("a board of {:g} x {:g} mm, seen from {}", wanted.board_mm.x(),
                                        wanted.board_mm.y(), meters(stand_mm));
  double further = stand_mm;
  while (further < kFurthest_mm) {
    if (laid_out_at(further, tags.usual_mm, wanted))
      fail(where, "is too near: no grooves glint all over it for every picture",
           "stand at least " + meters(further) + " away (--stand), or show fewer pictures");
    further *= 1.1;
  }
  fail(where, "cannot show its pictures under that lamp: no grooves glint all over it for each of them",
       "hang the lamp further away and about 40 degrees to the side, as --lamp above does, or show fewer pictures");
}

// Reports problems in the photos and their remedies.
void find_shortfalls(const BenchWishes& wanted, LaidOutBench& bench) {
  const Lens& lens = wanted.camera.lens;
  const double crowded = crowding(lens, bench.eyes_mm, bench.board), needed = needed_px(lens);
  if (crowded > 1)
    bench.findings.push_back(make_warning(
        FindingCode::coverage, "from " + meters(bench.stand_mm) + " the camera sees only a part of the board",
        "stand about " + meters(bench.stand_mm * crowded) + " away (--stand), or use a wider lens"));
  if (bench.tag_px < needed)
    bench.findings.push_back(make_warning(
        FindingCode::tags_small,
        fmt::format("from {} the smallest tag is only {:.0f} pixels wide, and {:.0f} are needed for it to be found",
                    meters(bench.stand_mm), bench.tag_px, needed),
        "stand about " + meters(bench.stand_mm * bench.tag_px / needed) +
            " away (--stand), or photograph with a longer lens or more pixels (--camera)"));
}

// Lays the bench out at one distance with tags of sufficient size; nothing if no groove can glint.
std::optional<LaidOutBench> with_visible_tags(double stand_mm, const BenchWishes& wanted) {
  const TagSizes sizes = tag_sizes(wanted.board_mm);
  const double needed = needed_px(wanted.camera.lens);
  double tag = sizes.usual_mm;
  auto bench = laid_out_at(stand_mm, tag, wanted);
  while (bench && bench->tag_px < needed && tag < sizes.largest_mm) {
    tag = std::min(sizes.largest_mm, std::max(tag + 1, std::ceil(tag * needed / bench->tag_px)));
    auto larger = laid_out_at(stand_mm, tag, wanted);
    if (!larger) break;
    bench = std::move(larger);
  }
  if (bench) find_shortfalls(wanted, *bench);
  return bench;
}

// Chooses a missing viewing distance: four times the diagonal, at which half vectors vary little over the board. It is
// smaller if tags would be too small, or larger if the lens would crop the board.
std::optional<LaidOutBench> at_usual_distance(const BenchWishes& wanted, double& stand_mm) {
  constexpr double kNearest_mm = 400, kUsualFurthest_mm = 2000, kRound_mm = 50;
  const double diagonal = wanted.board_mm.norm();
  const auto rounded = [&](double times) {
    const double mm = std::clamp(times * diagonal, kNearest_mm, std::max(kUsualFurthest_mm, 2 * diagonal));
    return kRound_mm * std::round(mm / kRound_mm);
  };
  std::optional<LaidOutBench> usual;
  for (const double times : {4.0, 3.4, 2.9, 2.4, 2.0, 1.7, 1.4, 1.2, 5.0, 7.0, 10.0, 14.0, 20.0, 28.0, 40.0}) {
    stand_mm = times > 4 ? kRound_mm * std::round(times * diagonal / kRound_mm) : rounded(times);
    if (stand_mm > kFurthest_mm) break;
    auto bench = with_visible_tags(stand_mm, wanted);
    if (bench && bench->findings.empty()) return bench;
    if (!usual) usual = bench;
  }
  return usual;
}

}  // namespace

LaidOutBench lay_out(const BenchWishes& wanted) {
  double stand_mm = wanted.stand_mm;
  const auto bench = stand_mm > 0 ? with_visible_tags(stand_mm, wanted) : at_usual_distance(wanted, stand_mm);
  if (!bench) fail_without_glint(wanted, stand_mm);
  return *bench;
}

}  // namespace burin

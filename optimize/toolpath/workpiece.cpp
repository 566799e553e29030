#include "burin/optimize/toolpath/workpiece.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "burin/scene/keep_out.h"
#include "burin/scene/physical_bounds.h"

namespace burin {
namespace {

double over_mm(const KeepOut& place) {
  return *place.height_mm > 0
             ? *place.height_mm + (place.height_mm <= kOverStanding_mm ? kOverPaper_mm : kOverStanding_mm)
             : 0;
}

// A way in the board's frame.
struct WayOnBoard {
  Eigen::Vector2d a, b;
  double beside_mm;

  WayOnBoard(const Workpiece& workpiece, const Eigen::Vector2d& from_mm, const Eigen::Vector2d& to_mm, double beside)
      : a(workpiece.lands * from_mm.homogeneous()), b(workpiece.lands * to_mm.homogeneous()), beside_mm(beside) {}

  bool runs_into(const Standing& standing) const {
    constexpr double kTouching_mm = 1e-6;
    const double reach_mm = std::max(beside_mm, kTouching_mm);
    if ((a.cwiseMax(b).array() <= standing.box.min().array() - reach_mm).any() ||
        (a.cwiseMin(b).array() >= standing.box.max().array() + reach_mm).any())
      return false;
    const auto free = free_parts(a, b, std::span(&standing.place, 1), reach_mm);
    return free.size() != 1 || free[0] != LinePart{0, 1};
  }
};

Standing standing_at(KeepOut place, double height_mm) {
  place.height_mm = height_mm;
  Standing out{std::move(place), {}};
  for (const Eigen::Vector2d& p : out.place.polygon_mm) out.box.extend(p);
  if (out.place.polygon_mm.empty())
    out.box = {out.place.center_mm.array() - out.place.radius_mm, out.place.center_mm.array() + out.place.radius_mm};
  return out;
}

}  // namespace

Workpiece workpiece_of(const Board& board, const Bench* measured) {
  Workpiece out;
  out.size_mm = board.size_mm;
  for (const KeepOut& place : board.keep_out) {
    if (!place.height_mm && out.unknown.empty()) out.unknown = place.name.empty() ? "a keep-out" : place.name;
    if (place.height_mm) out.standing.push_back(standing_at(place, *place.height_mm));
  }
  for (const Tag& tag : board.tags.list) {  // as the design's limits have them (carving_limits())
    out.standing.push_back(standing_at(tag_paper(tag, board.tags.family), board.tags.z_mm));
    out.paper_mm = board.tags.z_mm;
  }
  out.deepest_mm = 1e-3 * std::min(board.tool_width_um / 4, bound::kDepth_um);
  if (measured != nullptr) {
    out.lands = measured->machine_affine;
    out.lags = !measured->machine_errors.none();
  }
  return out;
}

const KeepOut* standing_under(const Workpiece& workpiece, const Eigen::Vector2d& from_mm, const Eigen::Vector2d& to_mm,
                              double beside_mm) {
  const WayOnBoard way(workpiece, from_mm, to_mm, beside_mm);
  for (const Standing& standing : workpiece.standing)
    if (way.runs_into(standing)) return &standing.place;
  return nullptr;
}

double height_needed_mm(const Workpiece& workpiece, const Eigen::Vector2d& from_mm, const Eigen::Vector2d& to_mm,
                        double beside_mm) {
  const WayOnBoard way(workpiece, from_mm, to_mm, beside_mm);
  double needed_mm = 0;
  for (const Standing& standing : workpiece.standing)
    if (over_mm(standing.place) > needed_mm && way.runs_into(standing)) needed_mm = over_mm(standing.place);
  return needed_mm;
}

double height_over_all_mm(const Workpiece& workpiece) {
  double highest_mm = 0;
  for (const Standing& standing : workpiece.standing) highest_mm = std::max(highest_mm, over_mm(standing.place));
  return highest_mm;
}

double travel_z_mm(const Workpiece& workpiece, const Face& face, const MachineProfile& machine,
                   const Eigen::Vector2d& from_mm, const Eigen::Vector2d& to_mm) {
  const auto at_face = [](const Eigen::Vector2d& p) { return Eigen::Vector3d(p.x(), p.y(), 0); };
  const double face_mm = std::max(0.0, -height_above(face, at_face(from_mm), at_face(to_mm)).least_mm);
  const double paper_mm = workpiece.paper_mm > 0 ? workpiece.paper_mm + kOverPaper_mm : 0;
  return face_mm + std::max({machine.safe_z_mm, paper_mm, height_needed_mm(workpiece, from_mm, to_mm)});
}

double first_z_mm(const Workpiece& workpiece, const Face& face, const MachineProfile& machine) {
  return highest_mm(face) + std::max(machine.safe_z_mm, height_over_all_mm(workpiece) + kFirstWay_mm);
}

double deepest_plunge_mm(const Workpiece& workpiece, const MachineProfile& machine) {
  if (machine.depth_by == DepthBy::servo) return 0;
  if (!by_preload(machine.depth_by)) return workpiece.deepest_mm;
  return machine.depth_table.rows.empty() ? 0 : std::min(machine.depth_table.rows.back().command, bound::kPreload_mm);
}

}  // namespace burin

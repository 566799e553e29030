#include "burin/optimize/toolpath/toolpath_plan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/optimize/toolpath/carving_time.h"
#include "burin/optimize/toolpath/ends.h"
#include "burin/optimize/toolpath/sheet.h"
#include "burin/optimize/toolpath/toolpath_check.h"
#include "burin/scene/parameter_name.h"

namespace burin {
namespace {

constexpr double kEdgeTolerance_mm = 1e-3;  // files are rounded to 1e-5 mm or, by others, to 1e-3

std::string point_text(const Eigen::Vector2d& p) { return "(" + fixed(p.x(), 3) + ", " + fixed(p.y(), 3) + ") mm"; }

/// The commanded scratches on this bench; an unmeasured depth keeps its previous command.
Sent sent_to(const Scratches& scratches, const Board& board, const Bench* measured) {
  if (measured == nullptr) return Sent(scratches);
  Bench bench = *measured;
  if (!depth_is_measured(bench)) bench.material.depth_um = board.material.depth_um;
  return compensated(Designed(scratches), bench, board);
}

// Commanded scratches, and the resulting grooves.
struct Told {
  Scratches sent, carved;
};

Told told_to_machine(const Scratches& scratches, Sent sent_as_wanted, const Affine2& carves, double step_mm,
                     Toolpath& path) {
  const auto lies_mm = [&](Eigen::Vector2d& q, Eigen::Vector2d& p) {
    if (step_mm <= 0) return;
    // The machine rounds commands to its steps, so the command is rounded, and the result is judged.
    const Eigen::Vector2d wanted = p;
    q = (q / step_mm).array().round() * step_mm;
    const Eigen::Vector2d lies = carves.leftCols<2>() * q + carves.col(2);
    if ((lies - wanted).norm() > kOnStep_mm) p = lies;
    path.stepped_mm = std::max(path.stepped_mm, (lies - wanted).norm());
  };
  Told out{std::move(sent_as_wanted.scratches), scratches};
  for (std::size_t i = 0; i < scratches.size(); ++i) {
    if (scratches.is_carved(i)) {
      ++path.already_carved;
      continue;
    }
    Ends sent = ends_of(out.sent, i), carved = ends_of(scratches, i);
    lies_mm(sent.a, carved.a);
    lies_mm(sent.b, carved.b);
    set_ends(out.sent, i, sent);
    set_ends(out.carved, i, carved);
  }
  return out;
}

void check_travel(const Scratches& sent, const MachineProfile& machine, bool compensated) {
  if (!machine.travel) return;
  for (std::size_t i = 0; i < sent.size(); ++i) {
    if (sent.is_carved(i)) continue;
    const Ends e = ends_of(sent, i);
    for (const Eigen::Vector2d& p : {e.a, e.b})
      if ((p.array() < machine.travel->min_mm.array()).any() || (p.array() > machine.travel->max_mm.array()).any())
        fail("scratch in row " + std::to_string(i + 1),
             std::string(compensated ? "compensated for the machine's error it" : "it") + " leaves the travel of " +
                 machine.name + " at " + point_text(p),
             "place the board elsewhere, or correct travel_mm (now " + point_text(machine.travel->min_mm) + " to " +
                 point_text(machine.travel->max_mm) + ")");
  }
}

// Far beyond its points, a map does not determine the face.
void check_within(const HeightMap& map, const PlannedScratch& s) {
  for (const Eigen::Vector2d& p : {s.from_mm, s.to_mm})
    if (beyond_mm(map, p) > map.step_mm.minCoeff())
      fail("scratch in row " + std::to_string(s.scratch + 1),
           "lies " + fixed(beyond_mm(map, p), 1) + " mm beyond the height map, at " + point_text(p),
           "probe the whole carve area (burin probe)");
}

// Appends a scratch to the path: its extent, its ways and its time.
void append(Toolpath& path, const PlannedScratch& s, const MachineProfile& machine) {
  if (path.scratches.empty()) {
    path.min_mm.setConstant(std::numeric_limits<double>::infinity());
    path.max_mm = -path.min_mm;
  }
  const Eigen::Vector2d at = path.scratches.empty() ? Eigen::Vector2d(0, 0) : path.scratches.back().to_mm;
  path.min_mm = path.min_mm.cwiseMin(s.from_mm).cwiseMin(s.to_mm);
  path.max_mm = path.max_mm.cwiseMax(s.from_mm).cwiseMax(s.to_mm);
  path.carve_mm += (s.to_mm - s.from_mm).norm();
  if (path.face.map) check_within(*path.face.map, s);
  path.duration_s += scratch_time(at, s.from_mm, s.to_mm, s.depth_mm, machine).total_s();
  path.scratches.push_back(s);
}

// Travel height between scratches, by the face and the obstacles on each way.
void plan_heights(Toolpath& path, const MachineProfile& machine) {
  path.first_z_mm = first_z_mm(path.workpiece, path.face, machine);
  const Workpiece bare;  // a constant Z depends on the face; obstacles raise Z on a single way
  path.kept_z_mm = machine.safe_z_mm;
  for (std::size_t k = 0; k < path.scratches.size(); ++k) {
    PlannedScratch& s = path.scratches[k];
    const Eigen::Vector2d& before = k == 0 ? s.from_mm : path.scratches[k - 1].to_mm;
    s.travel_z_mm = k == 0 ? path.first_z_mm : travel_z_mm(path.workpiece, path.face, machine, before, s.from_mm);
    path.kept_z_mm = std::max({path.kept_z_mm, travel_z_mm(bare, path.face, machine, before, s.from_mm),
                               travel_z_mm(bare, path.face, machine, s.from_mm, s.to_mm)});
  }
}

// The commanded scratches in the order and directions of carving: a reversed scratch has backlash from the other side.
Sent told_in_order(const Scratches& wanted, const std::vector<CarvingStep>& order, const Board& board,
                   const Bench& measured, double step_mm) {
  Sent sent = sent_to(in_carving_order(wanted, order), board, &measured);
  for (std::size_t i = 0; i < sent.size() && step_mm > 0; ++i) {
    Ends e = ends_of(sent.scratches, i);
    e.a = (e.a / step_mm).array().round() * step_mm;
    e.b = (e.b / step_mm).array().round() * step_mm;
    set_ends(sent.scratches, i, e);
  }
  return sent;
}

}  // namespace

CarvingLimits toolpath_limits(const Board& board, const Bench* measured, const MachineProfile& machine) {
  if (measured == nullptr)
    return carving_limits(board, machine.limits, board.material.depth_um, CarvingLimits().affine);
  return carving_limits(board, machine.limits, measured->material.depth_um, measured->machine_affine);
}

Toolpath plan_toolpath(const Scratches& scratches, const Board& board, const Bench* measured,
                       const MachineProfile& machine, const ToolpathOptions& options, const Progress& progress) {
  if (scratches.size() == 0) fail("tool path", "there is no scratch to carve", "design some first");
  if (!options.feed_mm_min.empty() && options.feed_mm_min.size() != scratches.size())
    fail("tool path",
         "has " + std::to_string(options.feed_mm_min.size()) + " feeds for " + std::to_string(scratches.size()) +
             " scratches",
         "give one each, or none");
  const CarvingLimits limits = toolpath_limits(board, measured, machine);
  Toolpath path;
  path.workpiece = workpiece_of(board, measured);
  path.face = face_to_follow(board, measured != nullptr ? *measured : Bench{}, options.heights, options.follow_bow);
  path.compensated = !limits.affine.isApprox(CarvingLimits().affine, 1e-12) ||
                     (measured != nullptr && !measured->machine_errors.none());
  const auto [sent, carved] =
      told_to_machine(scratches, sent_to(scratches, board, measured), limits.affine, machine.limits.step_mm, path);
  if (path.already_carved == scratches.size())
    fail("tool path", "has nothing to do: of " + counted(scratches.size(), "scratch") + " all is carved already",
         "design some more, or take the column carved away to carve all again");
  fail_if_crowded(carved, limits);
  fail_unless_good(check_limits(carved, limits, kEdgeTolerance_mm), "tool path");
  check_travel(sent, machine, path.compensated);

  std::vector<std::size_t> rows;  // scratches to be carved
  for (std::size_t i = 0; i < sent.size(); ++i)
    if (!sent.is_carved(i)) rows.push_back(i);
  const Scratches to_carve = selected(sent, rows);
  path.kept_order = options.keep_order.value_or(measured != nullptr && order_matters(*measured));
  path.order = path.kept_order ? file_order(to_carve) : carving_order(to_carve, {}, progress);
  const bool lags = measured != nullptr && !measured->machine_errors.none();
  path.sent = lags ? told_in_order(selected(scratches, rows), path.order, board, *measured, machine.limits.step_mm)
                   : Sent(in_carving_order(to_carve, path.order));
  path.travel_mm = travel_mm(to_carve, path.order);
  path.file_order_travel_mm = travel_mm(to_carve, file_order(to_carve));
  for (CarvingStep& step : path.order) step.scratch = static_cast<std::uint32_t>(rows[step.scratch]);
  path.sent.scratches.carved.clear();
  path.scratches.reserve(rows.size());
  for (std::size_t k = 0; k < path.order.size(); ++k) {
    const Scratches& sent_rows = path.sent.scratches;
    const Ends e = ends_of(sent_rows, k);
    const double depth_um = sent_rows.depth_um.empty() ? board.material.depth_um : sent_rows.depth_um[k];
    const double feed_mm_min = options.feed_mm_min.empty() ? 0 : options.feed_mm_min[path.order[k].scratch];
    append(path, {path.order[k].scratch, e.a, e.b, 1e-3 * depth_um, feed_mm_min}, machine);
  }
  plan_heights(path, machine);
  return path;
}

Toolpath left_after(const Toolpath& planned, const MachineProfile& machine, std::string_view text, std::size_t line,
                    const std::string& name) {
  const Replay replay = replay_gcode(text, machine, name, &planned.face);
  fail_unless_ended(replay, machine, name);
  if (line < 1 || line > replay.lines)
    fail(name + ": line " + std::to_string(line), "is not in the file, which has " + std::to_string(replay.lines),
         "give the line at which the machine stopped");
  const double tolerance_mm = 1e-3;  // of coordinates with the fewest sensible decimals
  // A depth is accurate to the last decimal of Z; with a servo's S only roughly.
  const double depth_tolerance_mm = machine.depth_by == DepthBy::servo
                                        ? tolerance_mm
                                        : std::min(tolerance_mm, 0.6 * std::pow(10.0, -machine.decimals));
  const std::vector<std::ptrdiff_t> found =
      find_planned(replay.scratches, planned.scratches, tolerance_mm, depth_share(planned.face), depth_tolerance_mm);
  for (std::size_t k = 0; k < found.size(); ++k)
    if (found[k] < 0)
      fail(name + ":" + std::to_string(replay.scratches[k].line),
           "carves a scratch that is not among those given, " + point_text(replay.scratches[k].from_mm) + " to " +
               point_text(replay.scratches[k].to_mm),
           "give the scratches, board, bench and machine that the file was made with");
  // A scratch is done once the machine has passed its line.
  const auto first = std::find_if(replay.scratches.begin(), replay.scratches.end(),
                                  [&](const ReplayedScratch& s) { return s.line >= line; });
  if (first == replay.scratches.begin())
    fail(name, "has carved nothing before line " + std::to_string(line), "start it again from its beginning");
  if (first == replay.scratches.end())
    fail(name, "has carved all its scratches before line " + std::to_string(line), "go on with the next file");

  Toolpath left;
  left.done_before = static_cast<std::size_t>(first - replay.scratches.begin());
  left.face = planned.face;
  left.workpiece = planned.workpiece;
  left.compensated = planned.compensated;
  left.kept_order = planned.kept_order;
  left.already_carved = planned.already_carved;
  left.stepped_mm = planned.stepped_mm;
  std::vector<CarvingStep> rows;  // of the planned ones
  for (std::size_t k = left.done_before; k < found.size(); ++k) {
    const auto i = static_cast<std::size_t>(found[k]);
    PlannedScratch s = planned.scratches[i];
    CarvingStep step = planned.order[i];
    if ((s.from_mm - replay.scratches[k].from_mm).norm() > tolerance_mm) {
      std::swap(s.from_mm, s.to_mm);
      step.reversed = !step.reversed;
    }
    left.travel_mm +=
        (s.from_mm - (left.scratches.empty() ? Eigen::Vector2d(0, 0) : left.scratches.back().to_mm)).norm();
    left.order.push_back(step);
    rows.push_back({static_cast<std::uint32_t>(i), step.reversed != planned.order[i].reversed});
    append(left, s, machine);
  }
  plan_heights(left, machine);
  left.file_order_travel_mm = left.travel_mm;
  left.sent = Sent(in_carving_order(planned.sent.scratches, rows));
  return left;
}

}  // namespace burin

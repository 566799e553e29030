#include "burin/optimize/toolpath/release_check.h"

#include <algorithm>
#include <cmath>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/scene/physical_bounds.h"

namespace burin {
namespace {

std::string place_of(const Eigen::Vector3d& p) {
  std::string text;
  for (int axis = 0; axis < 3; ++axis)
    if (!std::isnan(p[axis]))
      text += (text.empty() ? "" : " ") + std::string(1, "XYZ"[axis]) + fixed(p[axis], axis == 2 ? 4 : 2);
  return text;
}

constexpr const char* kHeightRemedy =
    "add \"height_mm\" to this keep_out in board.json: how far it rises above the face, 0 if nothing stands "
    "there "
    "(a hole)";

}  // namespace

ReleaseCheck::ReleaseCheck(const Workpiece& workpiece, const MachineProfile& machine, const Face& face)
    : workpiece_(workpiece),
      machine_(machine),
      face_(face),
      first_z_mm_(highest_mm(face) + std::max(kFirstWay_mm, height_over_all_mm(workpiece))),
      rounding_mm_(2 * std::pow(10.0, -machine.decimals)) {
  if (!workpiece.unknown.empty())
    add(kUnknownHeight, 0, "goes over a sheet on which " + workpiece.unknown + " stands, and its height is unknown",
        kHeightRemedy);
}

void ReleaseCheck::add(Kind kind, std::size_t line, const std::string& what, const std::string& remedy) {
  Fault& fault = faults_[kind];
  if (fault.count++ == 0) fault.line = line, fault.what = what, fault.remedy = remedy;
}

// Height of the tip: a servo lifts it by safe_z_mm at constant Z, and so does a head without Z.
double ReleaseCheck::tip_mm(const Eigen::Vector3d& p) const {
  if (machine_.depth_by == DepthBy::servo) return std::fmax(p.z(), machine_.safe_z_mm);
  return presses_by_itself(machine_) && std::isnan(p.z()) ? machine_.safe_z_mm : p.z();
}

void ReleaseCheck::judge_place(const ToolWay& way) {
  for (int axis = 0; axis < 2; ++axis) {
    const double at = way.to_mm[axis], most = workpiece_.size_mm[axis] + kBesideSheet_mm + rounding_mm_;
    if (at < -kBesideSheet_mm - rounding_mm_ || at > most)
      return add(kOffSheet, way.line,
                 "goes to " + place_of(way.to_mm) + ", off the sheet of " + shortest(workpiece_.size_mm.x()) + " x " +
                     shortest(workpiece_.size_mm.y()) + " mm",
                 "look at the bench's machine.affine, at the profile's blocks and where work zero is; park the tool by "
                 "hand");
  }
  if (way.to_mm.z() > bound::kHighest_mm)
    add(kTooHigh, way.line, "lifts to Z" + fixed(way.to_mm.z(), 2) + ", higher than a machine reaches",
        "correct safe_z_mm, or the heights of keep-outs");
}

void ReleaseCheck::judge_depth(const ToolWay& way) {
  const double deepest_mm = deepest_plunge_mm(workpiece_, machine_) + rounding_mm_;
  double least_mm = way.to_mm.z();
  if (way.to_mm.allFinite())
    least_mm = way.from_mm.allFinite() ? height_above(face_, way.from_mm, way.to_mm).least_mm
                                       : way.to_mm.z() - height_mm(face_, way.to_mm.head<2>());
  const double tilt_mm = bound::kTilt * 1.5 * workpiece_.size_mm.norm();
  if (least_mm < -deepest_mm || way.to_mm.z() < -(deepest_mm + tilt_mm))
    add(kDepth, way.line,
        "goes to Z" + fixed(way.to_mm.z(), 4) + ", deeper below the face than the " +
            fixed(deepest_plunge_mm(workpiece_, machine_), 4) + " mm that " +
            (by_preload(machine_.depth_by) ? "the machine's depth_table presses" : "this tip can cut (wt / 4)"),
        "correct the depth, the tool's width_um in board.json, or the profile's blocks; depths in board.json and "
        "scratches.csv are um, Z is mm");
}

// Judges a way with a course unknown to the file: the first one, from the tool's current position, and ways home.
void ReleaseCheck::judge_unknown_course(const ToolWay& way) {
  const auto moves = [&](int axis) {
    const double from = way.from_mm[axis], to = way.to_mm[axis];
    return std::isnan(from) != std::isnan(to) || from < to || from > to;
  };
  const bool home = way.to_mm.array().isNaN().all() && !std::isnan(way.from_mm.z());
  if (!moves(0) && !moves(1) && !home) return;
  const bool by_z = !std::isnan(way.from_mm.z()) || !std::isnan(way.to_mm.z());
  const double needed_mm = by_z ? first_z_mm_ : height_over_all_mm(workpiece_);
  const double tip_mm = std::fmin(this->tip_mm(way.from_mm), this->tip_mm(way.to_mm));
  if (tip_mm < needed_mm - rounding_mm_)
    add(kFirstWay, way.line,
        "goes along the board from or to a place that is not in the file, at Z" + fixed(tip_mm, 2) +
            "; the tool clears the sheet and its clamps from Z" + fixed(needed_mm, 2) + " on",
        "lift to {z_safe} in the profile's start, and write the file again");
}

void ReleaseCheck::judge_course(const ToolWay& way) {
  const Eigen::Vector2d from = way.from_mm.head<2>(), to = way.to_mm.head<2>();
  if (!from.allFinite() || !to.allFinite()) return judge_unknown_course(way);
  if (way.carves) {
    const KeepOut* place = workpiece_.lags ? nullptr : standing_under(workpiece_, from, to, 0);
    if (place != nullptr)
      add(kStanding, way.line, "carves over " + (place->name.empty() ? "a keep-out" : place->name),
          "leave these scratches out (--mend), or correct keep_out and tags in board.json");
    return;
  }
  const bool along = from != to;
  // A vertical move next to tags and clamps begins a scratch; judge_depth() checks it.
  const double needed_mm = height_needed_mm(workpiece_, from, to, along ? kBesideStanding_mm : 0),
               paper_mm = along ? workpiece_.paper_mm : 0;
  if (std::max(needed_mm, paper_mm) == 0) return;
  // From an unknown height the tool descends, or rises, to a known one.
  const double end_mm = tip_mm(way.to_mm), begin_mm = std::isnan(tip_mm(way.from_mm)) ? end_mm : tip_mm(way.from_mm);
  const double least_mm = height_above(face_, {from.x(), from.y(), begin_mm}, {to.x(), to.y(), end_mm}).least_mm;
  if (least_mm < std::max(needed_mm, paper_mm) - rounding_mm_)
    add(kStanding, way.line,
        "travels " + fixed(least_mm, 2) + " mm above the face on its way to " + place_of(way.to_mm) +
            (needed_mm > 0 ? ", over or close to a keep-out or tag that needs " + fixed(needed_mm, 2) + " mm"
                           : ", and the tags' paper is " + fixed(paper_mm, 2) + " mm thick"),
        "raise safe_z_mm, or correct height_mm of keep_out in board.json, and write the file again");
}

void ReleaseCheck::judge(const ToolWay& way) {
  judge_place(way);
  judge_depth(way);
  judge_course(way);
}

void ReleaseCheck::judge_touch(const ToolWay& way) {
  judge_place(way);
  if (const KeepOut* place = standing_under(workpiece_, way.to_mm.head<2>(), way.to_mm.head<2>(), 0))
    add(kStanding, way.line, "probes on " + (place->name.empty() ? "a keep-out" : place->name),
        "write the probing file again (burin probe write)");
}

void ReleaseCheck::judge(const Replay& replay) {
  for (const ReplayedScratch& s : replay.scratches)
    if (s.depth_mm + s.depth_spread_mm > workpiece_.deepest_mm + rounding_mm_)
      add(kDepth, s.line,
          "carves " + fixed(1e3 * s.depth_mm, 1) + " um deep, and this tip cuts " +
              fixed(1e3 * workpiece_.deepest_mm, 1) + " um (wt / 4) at most",
          "correct the depth, or the tool's width_um in board.json");
}

std::vector<Finding> ReleaseCheck::findings(const std::string& name) const {
  std::vector<Finding> out;
  for (const Fault& fault : faults_) {
    if (fault.count == 0) continue;
    const std::string line = fault.line > 0 ? ":" + std::to_string(fault.line) : "";
    const std::string more = fault.count > 1 ? " (" + std::to_string(fault.count) + " such lines)" : "";
    out.push_back({FindingCode::gcode_unsafe, Finding::Severity::error, name + line, fault.what + more, fault.remedy});
  }
  return out;
}

void ReleaseCheck::fail_unless_safe(const std::string& name) const {
  const Fault* first = nullptr;
  for (const Fault& fault : faults_)
    if (fault.count > 0 && (first == nullptr || fault.line < first->line)) first = &fault;
  if (first != nullptr)
    fail(name + (first->line > 0 ? ":" + std::to_string(first->line) : ""), first->what, first->remedy);
}

namespace {

Replay judged(std::string_view gcode, const MachineProfile& machine, const Face& face, const std::string& name,
              ReleaseCheck& check) {
  Replay replay = replay_gcode(gcode, machine, name, &face, [&](const ToolWay& way) { check.judge(way); });
  check.judge(replay);
  return replay;
}

}  // namespace

ReleasedFile check_release(std::string_view gcode, const MachineProfile& machine, const Workpiece& workpiece,
                           const Face& face, const std::string& name) {
  ReleaseCheck check(workpiece, machine, face);
  ReleasedFile out{judged(gcode, machine, face, name, check), {}};
  out.faults = check.findings(name);
  return out;
}

Replay fail_unless_released(std::string_view gcode, const MachineProfile& machine, const Workpiece& workpiece,
                            const Face& face, const std::string& name) {
  ReleaseCheck check(workpiece, machine, face);
  Replay replay = judged(gcode, machine, face, name, check);
  check.fail_unless_safe(name);
  return replay;
}

std::vector<Finding> height_findings(const Board& board, const std::filesystem::path& board_file) {
  const auto low = std::find_if(board.keep_out.begin(), board.keep_out.end(),
                                [](const KeepOut& place) { return !place.height_mm.has_value(); });
  if (low == board.keep_out.end()) return {};
  return {{FindingCode::keep_out_height, Finding::Severity::warning, board_file,
           "the height of the keep-out " + (low->name.empty() ? "" : low->name + " ") +
               "is unknown; the design continues, but no G-code will be written",
           kHeightRemedy, "keep_out"}};
}

std::vector<Finding> reach_findings(const MachineProfile& machine) {
  if (machine.travel || machine.travel_is_unknown) return {};
  return {{FindingCode::machine_travel,
           Finding::Severity::warning,
           {},
           "the travel of " + machine.name + " is unknown: nothing checks that it reaches all of these places",
           "write \"travel_mm\": [[0, 0], [300, 180]] with its own numbers into its burin/machine file (for a built-in "
           "machine into one that is \"based_on\" it), or set it for the project once: burin loop --travel 300x180, or "
           "--travel unknown",
           "travel_mm"}};
}

}  // namespace burin

#include "burin/optimize/machine_profile.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/base/files/json_file.h"
#include "burin/optimize/machine_measured_json.h"
#include "burin/optimize/toolpath/toml_file.h"
#include "burin/scene/physical_bounds.h"

namespace burin {
namespace {

const std::vector<std::string> kScratch{"G0 X{x0} Y{y0}", "G1 Z{z_carve} F{plunge_feed}", "G4 P{dwell_s}",
                                        "G1 X{x1} Y{y1} F{feed}", "G0 Z{z_safe}"};

MachineProfile grbl() {
  MachineProfile machine;
  machine.start = {"G21 G90 G17 G94 G54", "G0 Z{z_safe}"};
  machine.per_scratch = kScratch;
  machine.end = {"G0 Z{z_safe}", "M2"};
  return machine;
}

MachineProfile linuxcnc() {
  MachineProfile machine = grbl();
  machine.name = "linuxcnc";
  machine.dialect = GcodeDialect::linuxcnc;
  machine.start = {"G21 G90 G17 G94 G54", "G40 G49 G80", "G0 Z{z_safe}"};  // resets left-over tool and length offsets
  machine.max_lines = 0;
  return machine;
}

MachineProfile marlin() {
  MachineProfile machine;
  machine.name = "marlin";
  machine.dialect = GcodeDialect::marlin;
  // Marlin moves G0 with the last feed, so every line has its own; M400 waits for the queue to drain.
  machine.start = {"G21", "G90", "G0 Z{z_safe} F{rapid_z}"};
  machine.per_scratch = {"G0 X{x0} Y{y0} F{rapid}", "G1 Z{z_carve} F{plunge_feed}", "G4 P{dwell_ms}",
                         "G1 X{x1} Y{y1} F{feed}", "G0 Z{z_safe} F{rapid_z}"};
  machine.end = {"G0 Z{z_safe} F{rapid_z}", "M400"};
  return machine;
}

// A spring-loaded tool in grbl's machine. Nobody measured its table: it has the order of magnitude of common
// spring-loaded diamond points in aluminum.
MachineProfile grbl_spring() {
  MachineProfile machine = grbl();
  machine.name = "grbl-spring";
  machine.depth_by = DepthBy::spring;
  machine.depth_table = {{{4, 0.2}, {8, 0.4}, {14, 0.8}, {20, 1.3}, {26, 1.9}}, true};
  machine.decimals = 3;
  return machine;
}

// A laser engraver whose Z axis carries a tool instead. The beam stays off, in laser mode ($32=1) and outside of it.
MachineProfile laser_z() {
  MachineProfile machine = grbl();
  machine.name = "laser-z";
  machine.laser = true;
  return machine;
}

using MakeProfile = MachineProfile (*)();
constexpr std::array<std::pair<const char*, MakeProfile>, 5> kBuiltIn{
    {{"grbl", grbl}, {"grbl-spring", grbl_spring}, {"linuxcnc", linuxcnc}, {"marlin", marlin}, {"laser-z", laser_z}}};

std::optional<MachineProfile> built_in(const std::string& name) {
  for (const auto& [known, make] : kBuiltIn)
    if (name == known) return make();
  return std::nullopt;
}

// The blocks of a servo's head: S changes, Z stays.
void press_by_servo(MachineProfile& machine) {
  const bool marlin = machine.dialect == GcodeDialect::marlin;
  const std::string dwell = marlin ? "G4 P{dwell_ms}" : "G4 P{dwell_s}";
  machine.per_scratch = {marlin ? "G0 X{x0} Y{y0} F{rapid}" : "G0 X{x0} Y{y0}",
                         "M3 S{servo}",
                         dwell,
                         "G1 X{x1} Y{y1} F{feed}",
                         "M3 S{servo_up}",
                         dwell};
  // M2 turns S off. If that would press the head, grbl's files omit it.
  if (machine.dialect == GcodeDialect::grbl && !lifts_servo(machine, 0))
    machine.end.erase(std::remove(machine.end.begin(), machine.end.end(), "M2"), machine.end.end());
}

// A negative S is an error on every controller; only an analog output's Q (M67, M68) can be negative.
void check_servo_commands(JsonObject& json, const MachineProfile& machine) {
  const bool by_output =
      std::any_of(machine.per_scratch.begin(), machine.per_scratch.end(),
                  [](const std::string& line) { return line.find("Q{servo}") != std::string::npos; });
  const double least = by_output ? -1e6 : 0, most = 1e6;
  const auto outside = [&](double command) { return !(command >= least && command <= most); };
  const std::string remedy = by_output ? "write -1000000 to 1000000" : "write an S from 0 to 1000000";
  if (outside(machine.servo_up)) json.fail_field("servo_up", "is " + Json(machine.servo_up).dump(), remedy);
  for (const DepthStep& row : machine.depth_table.rows)
    if (outside(row.command)) json.fail_field("depth_table", "has the S " + Json(row.command).dump(), remedy);
}

// On a laser or a servo, every output may switch the beam or move a head.
void check_other_m_codes(JsonObject& json, const MachineProfile& machine) {
  const bool servo = machine.depth_by == DepthBy::servo;
  if (!machine.laser && !servo) return;
  for (const int code : machine.other_m_codes) {
    const bool head = servo && (code == 67 || code == 68 || code == 280);
    if (!head && !switches_nothing_on(10 * code))
      json.fail_field("other_m_codes",
                      "has M" + std::to_string(code) + ", which may switch an output: on a " +
                          (servo ? "servo perhaps its head" : "laser perhaps its beam"),
                      servo ? "take it away; a head may be moved by M3, M67, M68 or M280" : "take it away");
  }
}

}  // namespace

// Machines that home to their far corner count down from there, so the reach is converted to work zero.
void read_travel(JsonObject& json, MachineProfile& machine) {
  constexpr double kFarthest_mm = 1e5;  // as in the replay: no machine reaches 100 m
  Eigen::Vector2d zero_mm(0, 0);
  if (json.has("work_zero_mm")) {
    const std::vector<double> zero = json.numbers("work_zero_mm", 2);
    zero_mm = {zero[0], zero[1]};
    if (!json.has("travel_mm"))
      json.fail_field("work_zero_mm", "is of no use without travel_mm", "write both in the machine's own coordinates");
    if (!(zero_mm.cwiseAbs().maxCoeff() <= kFarthest_mm))
      json.fail_field("work_zero_mm", "is " + to_json(zero_mm).dump(), "write millimeters, at most 100000");
  }
  if (!json.has("travel_mm")) return;
  machine.travel.reset();
  machine.travel_is_unknown = json.raw("travel_mm") == "unknown";
  if (machine.travel_is_unknown) return;
  const Eigen::MatrixXd travel = json.matrix("travel_mm", 2, 2);
  if (!(travel.cwiseAbs().maxCoeff() <= kFarthest_mm))
    json.fail_field("travel_mm", "is " + to_json(travel).dump(), "write millimeters, at most 100000");
  machine.travel = MachineBounds{travel.row(0).transpose() - zero_mm, travel.row(1).transpose() - zero_mm};
  if (!(machine.travel->min_mm.array() < machine.travel->max_mm.array()).all())
    json.fail_field("travel_mm", "is " + to_json(travel).dump(), "write the lower-left, then the upper-right corner");
  // Every board extends to the right of its work zero and above it.
  if ((machine.travel->max_mm.array() <= 0).any())
    json.fail_field("travel_mm", "reaches no farther than work zero, the board's lower left corner",
                    json.has("work_zero_mm")
                        ? "correct work_zero_mm, the machine's own position at work zero"
                        : "count from work zero; or, with travel_mm as the machine counts after homing (grbl: -400 to "
                          "0), add work_zero_mm, its own position (MPos) at work zero, such as [-380, -270]");
}

namespace {

void read_depth_table(JsonObject& json, MachineProfile& machine) {
  machine.depth_table = {};
  const Json& rows = json.raw("depth_table");
  const auto wrong = [&](const std::string& what) {
    json.fail_field("depth_table", what,
                    machine.depth_by == DepthBy::servo
                        ? "write [[depth in um, S], ...], shallowest first"
                        : "write [[depth in um, mm below contact], ...], shallowest first");
  };
  if (!rows.is_array() || rows.size() < 2) wrong("is no list of at least two rows");
  for (const Json& row : rows) {
    const auto finite = [](const Json& v) { return v.is_number() && std::isfinite(v.get<double>()); };
    if (!row.is_array() || (row.size() != 2 && row.size() != 3) || !std::all_of(row.begin(), row.end(), finite))
      wrong("has a row " + row.dump());
    const DepthStep step{row[0].get<double>(), row[1].get<double>(), row.size() == 3 ? row[2].get<double>() : 0};
    if (step.sigma_um < 0) wrong("has a negative sigma in row " + row.dump());
    if (!(step.depth_um > 0 && step.depth_um <= bound::kDepth_um)) wrong("has a depth of " + row[0].dump() + " um");
    if (machine.depth_by != DepthBy::servo && step.command > bound::kPreload_mm)
      wrong("has a preload of " + row[1].dump() + " mm, more than " + shortest(bound::kPreload_mm));
    if (std::abs(step.command) > 1e6) wrong("has a command of " + row[1].dump());
    std::vector<DepthStep>& done = machine.depth_table.rows;
    if (!done.empty() && !(step.depth_um > done.back().depth_um)) wrong("has depths that do not rise at " + row.dump());
    if (machine.depth_by != DepthBy::servo && !(step.command > (done.empty() ? 0 : done.back().command)))
      wrong("has a preload that does not rise at " + row.dump());
    if (!done.empty() && step.command == done.back().command) wrong("has the same command twice, at " + row.dump());
    if (done.size() > 1 && (step.command > done.back().command) != (done[1].command > done[0].command))
      wrong("has commands that turn back at " + row.dump());
    done.push_back(step);
  }
}

void read_depth_by(JsonObject& json, MachineProfile& machine) {
  if (json.has("depth_by")) {
    const std::string name = json.text("depth_by");
    bool known = false;
    for (const DepthBy by : {DepthBy::fixed_z, DepthBy::spring, DepthBy::drag, DepthBy::servo})
      if (name == depth_by_name(by)) machine.depth_by = by, known = true;
    if (!known) json.fail_field("depth_by", "is \"" + name + "\"", "write fixed-z, spring, drag or servo");
    if (machine.depth_by == DepthBy::fixed_z) machine.depth_table = {};
  }
  machine.laser = json.boolean("laser", machine.laser);
  machine.servo_up = json.number("servo_up", machine.servo_up);
  if (machine.depth_by == DepthBy::fixed_z) {
    if (json.has("depth_table"))
      json.fail_field("depth_table", "is for heads that are pressed", "add \"depth_by\": spring, drag or servo");
    return;
  }
  if (json.has("depth_table")) read_depth_table(json, machine);
  const std::string by = depth_by_name(machine.depth_by);
  if (machine.depth_table.rows.empty())
    json.fail_field("depth_table", "is missing, and a depth by " + by + " needs it",
                    machine.depth_by == DepthBy::servo
                        ? "write [[depth in um, S], ...], shallowest first"
                        : "write [[depth in um, mm below contact], ...], shallowest first");
  if (machine.depth_by != DepthBy::servo) return;
  if (machine.depth_table.assumed)
    json.fail_field("depth_table", "is missing: preloads are no S values", "write [[depth in um, S], ...]");
  if (!(machine.dwell_s > 0))
    json.fail_field("dwell_s", "is missing: a servo needs time to go down", "write a time in seconds, such as 0.2");
  const std::vector<DepthStep>& rows = machine.depth_table.rows;
  const double low = std::min(rows.front().command, rows.back().command),
               high = std::max(rows.front().command, rows.back().command);
  if (machine.servo_up >= low && machine.servo_up <= high)
    json.fail_field("servo_up", "is " + Json(machine.servo_up).dump() + ", which depth_table has as a depth",
                    "write the S that lifts the head");
  // A machine whose deepest S is nearer to the lifting S than its shallowest turns the wrong way.
  if (std::abs(rows.front().command - machine.servo_up) > std::abs(rows.back().command - machine.servo_up))
    json.fail_field("servo_up", "is " + Json(machine.servo_up).dump() + ", beyond the deepest row of depth_table",
                    "write the S that lifts the head, which lies on the side of the shallowest row");
  if (machine.laser) json.fail_field("laser", "stays off, and a servo needs S", "take one of them away");
  press_by_servo(machine);
}

void read_block(JsonObject& json, const std::string& key, std::vector<std::string>& block) {
  if (!json.has(key)) return;
  const Json& lines = json.raw(key);
  if (!lines.is_array()) json.fail_field(key, "is no array", "write an array of lines, each in double quotes");
  block.clear();
  for (const Json& line : lines) {
    const auto printable = [](unsigned char c) { return c >= 0x20 && c <= 0x7E; };
    const bool text = line.is_string();
    const std::string words = text ? line.get<std::string>() : "";
    if (!text || !std::all_of(words.begin(), words.end(), printable))
      json.fail_field(key, "has an entry that is not one line of text in plain ASCII",
                      "write each line of G-code in double quotes");
    block.push_back(line.get<std::string>());
  }
}

std::vector<int> read_m_codes(JsonObject& json) {
  std::vector<int> codes;
  const Json& list = json.raw("other_m_codes");
  const auto wrong = [&](const std::string& what) {
    json.fail_field("other_m_codes", what, "write a list of numbers, such as [42, 106]");
  };
  if (!list.is_array()) wrong("is no list");
  for (const Json& code : list) {
    if (!code.is_number_integer() || code.get<double>() < 0 || code.get<double>() > 999) wrong("has " + code.dump());
    codes.push_back(code.get<int>());
    // Codes with effects of their own: ends, calls, and offsets.
    for (const int never : {2, 6, 30, 98, 99, 206, 428})
      if (codes.back() == never) wrong("has M" + std::to_string(never) + ", which does more than it tells");
  }
  return codes;
}

MachineLimits read_limits(JsonObject json) {
  MachineLimits limits;
  const auto length = [&](const char* key, double smallest) {
    const double v = json.number(key, 0);
    if (v != 0 && v < smallest)
      json.fail_field(key, "is " + Json(v).dump(),
                      "write a length in mm of at least " + Json(smallest).dump() + ", or 0 for no limit");
    return v;
  };
  limits.step_mm = length("step_mm", 1e-4);
  limits.shortest_mm = length("shortest_mm", 1e-3);
  limits.longest_mm = length("longest_mm", 1e-3);
  limits.distance_mm = length("min_distance_mm", 1e-4);
  limits.max_overlap = json.number("max_overlap", 0);
  if (limits.max_overlap < 0 || limits.max_overlap > 1)
    json.fail_field("max_overlap", "is no share of a groove",
                    "write a number above 0 and up to 1, or 0 for no limit (no crossings at all: \"max_grooves\": 1)");
  limits.max_grooves = json.integer("max_grooves", 0);
  if (limits.max_grooves < 0)
    json.fail_field("max_grooves", "is negative", "write how many may lie over one place, or 0 for no limit");
  // Both ends move to a step, so a length is reachable only if some steps are between shortest and longest.
  if (limits.longest_mm > 0 && limits.longest_mm < limits.shortest_mm + 2 * limits.step_mm)
    json.fail_field("longest_mm", "leaves no length above shortest_mm",
                    "make it longer than shortest_mm by at least two steps");
  json.finish();
  return limits;
}

MachineProfile read_profile(const Json& content, const std::filesystem::path& file) {
  JsonObject json(content, file.string());
  const std::string base = json.text("based_on", "grbl");
  const std::optional<MachineProfile> known = built_in(base);
  if (!known) json.fail_field("based_on", "is \"" + base + "\"", "write " + built_in_machines());
  MachineProfile machine = *known;
  machine.name = json.text("name", file.stem().string());
  const auto within = [&](const char* key, double& value, double least, double most, const char* unit) {
    value = least > 0 ? json.positive(key, value) : json.number(key, value);
    if (!(value >= least && value <= most))
      json.fail_field(key, "is " + Json(value).dump(),
                      "write " + shortest(least) + " to " + shortest(most) + " " + unit);
  };
  constexpr double kSlowest = 1, kFastest = 1e6;  // as in the replay (toolpath/toolpath_check.h)
  within("carve_feed_mm_min", machine.carve_feed_mm_min, kSlowest, kFastest, "mm/min");
  within("plunge_feed_mm_min", machine.plunge_feed_mm_min, kSlowest, kFastest, "mm/min");
  within("rapid_mm_min", machine.rapid_mm_min, kSlowest, kFastest, "mm/min");
  within("rapid_z_mm_min", machine.rapid_z_mm_min, kSlowest, kFastest, "mm/min");
  within("acceleration_mm_s2", machine.acceleration_mm_s2, 0.1, 1e6, "mm/s^2");
  within("acceleration_z_mm_s2", machine.acceleration_z_mm_s2, 0.1, 1e6, "mm/s^2");
  within("safe_z_mm", machine.safe_z_mm, 0.01, bound::kSafeZ_mm, "mm, clear of the face and of what lies on it");
  machine.dwell_s = json.number("dwell_s", machine.dwell_s);
  if (machine.dwell_s < 0) json.fail_field("dwell_s", "is negative", "write 0 or a time in seconds");
  within("dwell_s", machine.dwell_s, 0, 600, "s");
  machine.decimals = json.integer("decimals", machine.decimals);
  if (machine.decimals < 2 || machine.decimals > 6)
    json.fail_field("decimals", "is " + std::to_string(machine.decimals), "write 2 to 6");
  machine.max_lines = json.integer("max_lines", machine.max_lines);
  if (machine.max_lines != 0 && machine.max_lines < kLeastLines)
    json.fail_field("max_lines", "is " + std::to_string(machine.max_lines), "write 0 for no limit, or at least 100");
  machine.max_line_characters = json.integer("max_line_characters", machine.max_line_characters);
  if (machine.max_line_characters != 0 && (machine.max_line_characters < 40 || machine.max_line_characters > 1000))
    json.fail_field("max_line_characters", "is " + std::to_string(machine.max_line_characters),
                    "write 40 to 1000, or 0 for what its dialect reads");
  if (json.has("other_m_codes")) machine.other_m_codes = read_m_codes(json);
  within("force", machine.force, -1e6, 1e6, "in the unit that {force} has in the blocks");
  if (json.has("measured")) machine.measured = read_measured(json.object("measured"));
  if (json.has("limits")) machine.limits = read_limits(json.object("limits"));
  read_travel(json, machine);
  read_depth_by(json, machine);
  read_block(json, "head", machine.head);
  read_block(json, "start", machine.start);
  read_block(json, "per_scratch", machine.per_scratch);
  read_block(json, "end", machine.end);
  if (machine.depth_by == DepthBy::servo) check_servo_commands(json, machine);
  check_other_m_codes(json, machine);
  json.finish();
  return machine;
}

}  // namespace

const char* depth_by_name(DepthBy depth_by) {
  switch (depth_by) {
    case DepthBy::fixed_z:
      return "fixed-z";
    case DepthBy::spring:
      return "spring";
    case DepthBy::drag:
      return "drag";
    case DepthBy::servo:
      return "servo";
  }
  return "";
}

std::string built_in_machines() {
  std::string names;
  for (std::size_t i = 0; i < kBuiltIn.size(); ++i)
    names += (i == 0 ? "" : i + 1 < kBuiltIn.size() ? ", " : " or ") + std::string(kBuiltIn[i].first);
  return names;
}

double plunge_mm(const MachineProfile& machine, double depth_mm) {
  if (machine.depth_by == DepthBy::servo) return 0;
  if (!by_preload(machine.depth_by)) return depth_mm;
  return command_for_depth(machine.depth_table, 1e3 * depth_mm, "machine profile \"" + machine.name + "\"");
}

namespace {
bool any_holds(const std::vector<std::string>& block, const char* word) {
  return std::any_of(block.begin(), block.end(),
                     [&](const std::string& line) { return line.find(word) != std::string::npos; });
}
}  // namespace

bool presses_by_itself(const MachineProfile& machine) {
  return machine.depth_by == DepthBy::fixed_z && !any_holds(machine.per_scratch, "{z_carve}") &&
         !any_holds(machine.per_scratch, "{z1}");
}

bool keeps_z(const MachineProfile& machine) { return !any_holds(machine.per_scratch, "{z_safe}"); }

bool switches_nothing_on(int m_tenths) {
  // Ends, pauses, overrides, motors, reports and settings. Of outputs, only the codes that turn them off (M5, M9,
  // M107).
  constexpr std::array kCodes{0,   10,  20,  50,  90,   170,  180,  300,  480,  490,  500,  510,  520,  530,  730,
                              750, 760, 770, 840, 1050, 1070, 1140, 1170, 1180, 2010, 2030, 2040, 2050, 2110, 4000};
  return std::find(kCodes.begin(), kCodes.end(), m_tenths) != kCodes.end();
}

bool lifts_servo(const MachineProfile& machine, double command) {
  constexpr double kSame = 1e-4;  // rounding of S by a file's decimals and a controller's digits
  const bool up_is_more = machine.servo_up > machine.depth_table.rows.front().command;
  return up_is_more ? command >= machine.servo_up - kSame : command <= machine.servo_up + kSame;
}

double depth_of_plunge_mm(const MachineProfile& machine, double below_mm) {
  if (!by_preload(machine.depth_by)) return below_mm;
  return 1e-3 * depth_for_command(machine.depth_table, below_mm, true);
}

MachineProfile read_machine_profile(const std::filesystem::path& file) {
  if (file.extension() != ".toml") return read_profile(read_json(file, "burin/machine", 1), file);
  const TomlFile toml = read_toml(file, "burin/machine", 1);
  MachineProfile machine;
  with_line(file, toml, [&] { machine = read_profile(toml.content, file); });
  return machine;
}

MachineProfile machine_profile(const std::string& name_or_file) {
  if (const std::optional<MachineProfile> known = built_in(name_or_file)) return *known;
  if (!std::filesystem::exists(name_or_file))
    fail("machine \"" + name_or_file + "\"", "is neither a built-in profile nor a file",
         "choose " + built_in_machines() + ", or name a burin/machine file");
  return read_machine_profile(name_or_file);
}

double move_time_s(double length_mm, double feed_mm_min, double acceleration_mm_s2) {
  const double speed_mm_s = feed_mm_min / 60;
  const double ramps_mm = speed_mm_s * speed_mm_s / acceleration_mm_s2;  // acceleration and deceleration together
  if (length_mm >= ramps_mm) return length_mm / speed_mm_s + speed_mm_s / acceleration_mm_s2;
  return 2 * std::sqrt(length_mm / acceleration_mm_s2);
}

}  // namespace burin

#include "tests/reliability/gcode_fuzz.h"

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <numbers>
#include <optional>
#include <random>
#include <utility>

#include "burin/base/error.h"
#include "burin/optimize/toolpath/gcode.h"
#include "burin/optimize/toolpath/gcode_line.h"
#include "burin/optimize/toolpath/probe.h"
#include "burin/optimize/toolpath/probe_check.h"
#include "burin/optimize/toolpath/release_check.h"
#include "burin/optimize/toolpath/toolpath_check.h"
#include "burin/optimize/toolpath/toolpath_plan.h"
#include "burin/scene/bench_of_board.h"
#include "tests/reliability/strict_gcode.h"

namespace burin {
namespace {

using Random = std::mt19937_64;

std::size_t below(Random& random, std::size_t n) { return n == 0 ? 0 : random() % n; }

// A sheet with a clamp and a hole among six scratches.
Board sheet_with_clamp() {
  Board board;
  board.size_mm = {60, 50};
  board.carve_min_mm = {5, 5};
  board.carve_max_mm = {55, 45};
  board.material.depth_um = 10;
  board.keep_out = {{"clamp", {{30.2, 2}, {31.2, 2}, {31.2, 12}, {30.2, 12}}, {0, 0}, 0, 7.5},
                    {"hole", {}, {14, 25}, 2.5, 0}};
  return board;
}

Scratches six_scratches() {
  Scratches s;
  for (int i = 0; i < 6; ++i) {
    s.x0_mm.push_back(10 + 5.1234 * i), s.y0_mm.push_back(10 + 3.3 * (i % 3));
    s.x1_mm.push_back(12.5 + 4.75 * i), s.y1_mm.push_back(20.015 - 1.5 * i);
    s.depth_um.push_back(8 + 2 * (i % 3));
  }
  return s;
}

Toolpath planned(const MachineProfile& machine) {
  ToolpathOptions options;
  options.keep_order = true;
  return plan_toolpath(six_scratches(), sheet_with_clamp(), nullptr, machine, options);
}

// What the strict reader knows of a board: from its numbers alone.
strict::Sheet sheet_of(const Board& board, const MachineProfile& m, const Bench* bench = nullptr) {
  strict::Sheet sheet;
  sheet.width = board.size_mm.x();
  sheet.height = board.size_mm.y();
  sheet.deepest = 1e-3 * board.tool_width_um / 4;
  if (m.depth_by == DepthBy::servo) sheet.deepest = 0;
  if (by_preload(m.depth_by)) sheet.deepest = m.depth_table.rows.back().command;
  for (const KeepOut& place : board.keep_out) {
    strict::Standing standing{{}, place.center_mm.x(), place.center_mm.y(), place.radius_mm, *place.height_mm};
    for (const Eigen::Vector2d& p : place.polygon_mm) standing.corners.push_back({p.x(), p.y()});
    sheet.standing.push_back(standing);
  }
  for (const Tag& tag : board.tags.list) {
    // Nine fifths of its size, for the family that the files here have: to the paper's edge.
    const double half = 0.9 * tag.size_mm, a = tag.rotation_deg * std::numbers::pi / 180;
    strict::Standing paper{{}, 0, 0, 0, board.tags.z_mm};
    for (const auto& [u, v] : {std::pair(-1, -1), std::pair(1, -1), std::pair(1, 1), std::pair(-1, 1)})
      paper.corners.push_back({tag.center_mm.x() + half * (u * std::cos(a) - v * std::sin(a)),
                               tag.center_mm.y() + half * (u * std::sin(a) + v * std::cos(a))});
    sheet.standing.push_back(paper);
  }
  if (bench != nullptr)
    for (int k = 0; k < 6; ++k) sheet.map[static_cast<std::size_t>(k)] = bench->machine_affine(k / 3, k % 3);
  return sheet;
}

// Heights between the points of a grid, straight along x, then along y.
double height_between(const HeightMap& map, double x, double y) {
  const double gx = (x - map.first_mm.x()) / map.step_mm.x(), gy = (y - map.first_mm.y()) / map.step_mm.y();
  const int c = std::clamp(static_cast<int>(std::floor(gx)), 0, map.columns - 2),
            r = std::clamp(static_cast<int>(std::floor(gy)), 0, map.rows - 2);
  const auto z = [&](int row, int column) { return map.z_mm[static_cast<std::size_t>(row * map.columns + column)]; };
  const double low = z(r, c) + (gx - c) * (z(r, c + 1) - z(r, c)),
               high = z(r + 1, c) + (gx - c) * (z(r + 1, c + 1) - z(r + 1, c));
  return low + (gy - r) * (high - low);
}

struct Machine {
  MachineProfile profile;
  std::string file;  // whole G-code of six scratches
};

strict::Controller controller_of(const MachineProfile& m) {
  strict::Controller c;
  c.kind = m.dialect == GcodeDialect::grbl       ? strict::Controller::Kind::grbl
           : m.dialect == GcodeDialect::linuxcnc ? strict::Controller::Kind::linuxcnc
                                                 : strict::Controller::Kind::marlin;
  c.line_bytes = static_cast<std::size_t>(longest_line(m));
  c.by_s = m.depth_by == DepthBy::servo;
  c.lifted_s = std::llround(1e3 * m.servo_up);
  c.low_s_presses = c.by_s && m.servo_up > m.depth_table.rows.front().command;
  c.laser = m.laser;
  if (m.travel) {
    c.bounded = true;
    for (int axis = 0; axis < 2; ++axis) {
      c.low[axis] = std::llround(1e6 * m.travel->min_mm[axis]);
      c.high[axis] = std::llround(1e6 * m.travel->max_mm[axis]);
    }
  }
  return c;
}

std::vector<Machine> machines() {
  std::vector<Machine> all;
  for (const char* name : {"grbl", "grbl-spring", "linuxcnc", "marlin", "laser-z"})
    all.push_back({machine_profile(name), {}});
  Machine own{machine_profile("grbl"), {}};
  own.profile.name = "a person's";
  own.profile.travel = MachineBounds{{0, 0}, {60, 60}};
  own.profile.max_line_characters = 60;
  own.profile.start.insert(own.profile.start.begin(), "M3 S350");
  own.profile.end.insert(own.profile.end.begin(), "M5");
  all.push_back(own);
  Machine servo{machine_profile("grbl"), {}};
  servo.profile.depth_by = DepthBy::servo;
  servo.profile.depth_table.rows = {{5, 300}, {20, 900}};
  servo.profile.servo_up = 100;
  servo.profile.safe_z_mm = 9;  // over the clamp
  servo.profile.dwell_s = 0.2;
  servo.profile.per_scratch = {"G0 X{x0} Y{y0}",         "M3 S{servo}",    "G4 P{dwell_s}",
                               "G1 X{x1} Y{y1} F{feed}", "M3 S{servo_up}", "G4 P{dwell_s}"};
  all.push_back(servo);
  Machine turned = servo;  // whose head goes up by a higher S
  turned.profile.depth_table.rows = {{5, 900}, {20, 300}};
  turned.profile.servo_up = 1000;
  turned.profile.end = {"G0 Z{z_safe}"};
  all.push_back(turned);
  Machine fan_laser{machine_profile("marlin"), {}};
  fan_laser.profile.laser = true;
  all.push_back(fan_laser);
  for (Machine& m : all) m.file = gcode_parts(planned(m.profile), m.profile).front().text;
  return all;
}

// What makes readers stumble.
const std::vector<std::string> kWords{
    "G0 ",
    "G1 ",
    "G2 X1 Y1 I1\n",
    "G20 ",
    "G21 ",
    "G28\n",
    "G28 Z0\n",
    "G30\n",
    "G53 G0 Z0\n",
    "G53 ",
    "G90 ",
    "G91 ",
    "G92 X0\n",
    "G91.1 ",
    "G90.1 ",
    "G10 L2 P1 X5\n",
    "G18 ",
    "G43 H1\n",
    "G43.1 Z1\n",
    "G54 ",
    "G55\n",
    "G4 P1\n",
    "G4 X1\n",
    "G4 ",
    "G80\n",
    "G61.1 ",
    "G64 P0.01\n",
    "G64 P0.001\n",
    "M62 P0\n",
    "M64 P0\n",
    "M42 P4 S255\n",
    "M211 S0\n",
    "M211 S1\n",
    "G38.2 Z-5\n",
    "G0.5 ",
    "G01 ",
    "G1.0 ",
    "G001",
    "M2\n",
    "M30\n",
    "M0\n",
    "M3 S100\n",
    "M3 ",
    "M4 ",
    "M5\n",
    "M5 ",
    "M6 T1\n",
    "M98 P1\n",
    "M67 E0 Q5\n",
    "M68 E0 Q0\n",
    "M280 P0 S30\n",
    "M117 hello (x\n",
    "M106 S255\n",
    "M400\n",
    "M204 T500 X5\n",
    "X5 ",
    "Y5 ",
    "Z1 ",
    "Z0 ",
    "Z-0.01 ",
    "Z-5\n",
    "Z5\n",
    "X-1 ",
    "X61 ",
    "X5e1 ",
    "X1e-3 ",
    "Xnan ",
    "Xinf ",
    "X.5 ",
    "X5. ",
    "X. ",
    "X+5 ",
    "X-+5 ",
    "X--5 ",
    "X1 2 ",
    "X12345678 ",
    "X0.123456789 ",
    "X000000000000000000001 ",
    "X99999.9 ",
    "F0 ",
    "F-1 ",
    "F0.5 ",
    "F1e-300 ",
    "F1 ",
    "F1000001 ",
    "F300 ",
    "S100 ",
    "S0 ",
    "S900 ",
    "S-5 ",
    "P1 ",
    "A5 ",
    "B1 ",
    "C1 ",
    "E1 ",
    "I1 ",
    "K1 ",
    "R5 ",
    "L2 ",
    "T1 ",
    "T-1 ",
    "N5 ",
    "N-5 ",
    "N1.5 ",
    "H1 ",
    "(",
    ")",
    "(a)",
    "(a (b))",
    "(LOGOPEN,x)",
    "(py,x)",
    ";",
    ";py,x",
    "%",
    "%\n",
    "/",
    "$H\n",
    "$X\n",
    "$32=1\n",
    "#1=5\n",
    "*57",
    "!",
    "?",
    "~",
    "o100 call\n",
    "[1+1]",
    "\n",
    "\r\n",
    "\r",
    "\t",
    " ",
    std::string(1, '\0'),
    "\x80",
    "\xc3\xa9",
    "\x18",
    "300.00001 ",
    "1.00000000000000000001 ",
    "G1 Z-0.01 F100\n",
    "G0 Z1\n",
    "G1 X20 Y20 F500\n",
    "G0 X20 Y20\n",
    "g1x20\n",
    "(0123456789012345678901234567890123456789012345678901234567890123456789012345678901234567890)\n"};

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    lines.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return lines;
}

std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + '\n';
  return text;
}

void change_line(std::string& text, Random& random) {
  std::vector<std::string> lines = lines_of(text);
  if (lines.empty()) return;
  const std::size_t i = below(random, lines.size()), j = below(random, lines.size());
  switch (below(random, 5)) {
    case 0:
      lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(i), lines[j]);
      break;
    case 1:
      std::swap(lines[i], lines[j]);
      break;
    case 2:
      lines.erase(lines.begin() + static_cast<std::ptrdiff_t>(i));
      break;
    case 3:
      lines[i] += " " + lines[j];
      break;
    default:
      lines.resize(i);
  }
  text = joined(lines);
}

void change(std::string& text, Random& random) {
  const std::size_t at = below(random, text.size() + 1);
  switch (below(random, 8)) {
    case 0:
      if (at < text.size()) text[at] = static_cast<char>(random());
      break;
    case 1:
      text.erase(std::min(at, text.size()), 1 + below(random, 6));
      break;
    case 2:
    case 3:
      text.insert(at, kWords[below(random, kWords.size())]);
      break;
    case 4: {  // at the beginning of a line, where words mean most
      const std::size_t line = text.rfind('\n', at);
      text.insert(line == std::string::npos ? 0 : line + 1, kWords[below(random, kWords.size())]);
      break;
    }
    case 5: {  // another digit
      const std::size_t digit = text.find_first_of("0123456789", at);
      if (digit != std::string::npos) text[digit] = static_cast<char>('0' + below(random, 10));
      break;
    }
    case 6: {
      const std::size_t letter = text.find_first_of("GMXYZFSP", at);
      if (letter != std::string::npos) text[letter] = "GMXYZFSPN"[below(random, 9)];
      break;
    }
    default:
      change_line(text, random);
  }
}

// What is wrong with what the replay accepted; empty if nothing.
std::string compare(const Replay& replay, const std::string& text, const MachineProfile& machine) {
  const strict::Executed done = strict::execute(text, controller_of(machine));
  if (!done.alarm.empty()) return "the strict reader stops in line " + std::to_string(done.line) + ": " + done.alarm;
  if (done.strokes.size() != replay.scratches.size())
    return std::to_string(replay.scratches.size()) + " strokes, strictly " + std::to_string(done.strokes.size());
  for (std::size_t k = 0; k < done.strokes.size(); ++k) {
    const strict::Stroke& s = done.strokes[k];
    const ReplayedScratch& r = replay.scratches[k];
    const double off = std::max({std::abs(1e-6 * static_cast<double>(s.x0) - r.from_mm.x()),
                                 std::abs(1e-6 * static_cast<double>(s.y0) - r.from_mm.y()),
                                 std::abs(1e-6 * static_cast<double>(s.x1) - r.to_mm.x()),
                                 std::abs(1e-6 * static_cast<double>(s.y1) - r.to_mm.y())});
    const double depth =
        machine.depth_by == DepthBy::servo ? r.depth_mm : depth_of_plunge_mm(machine, 1e-6 * static_cast<double>(s.z));
    if (!(off <= 1e-3) || !(std::abs(depth - r.depth_mm) <= 1e-3))
      return "stroke " + std::to_string(k + 1) + " lies elsewhere";
  }
  return "";
}

// What is wrong with a file that is given out, by the strict reader's own idea of a sheet.
std::string against_sheet(const std::string& text, const MachineProfile& machine, const strict::Sheet& sheet) {
  if (const std::string word = strict::words_off_sheet(text, sheet); !word.empty()) return "sends the tool to " + word;
  strict::Controller controller = controller_of(machine);
  controller.sheet = &sheet;
  controller.servo_lift = machine.safe_z_mm;
  const strict::Executed done = strict::execute(text, controller);
  return done.alarm.empty() ? "" : "on the sheet, in line " + std::to_string(done.line) + ": " + done.alarm;
}

void keep(GcodeFuzz& fuzz, const std::string& what, const std::string& machine, const std::string& text) {
  constexpr std::size_t kMost = 10;
  if (fuzz.findings.size() < kMost) fuzz.findings.push_back(machine + ": " + what + "\n----\n" + text + "----");
}

bool goes_on(const GcodeFuzz& fuzz, std::uint64_t runs, double seconds, std::chrono::steady_clock::time_point begun) {
  if (fuzz.runs >= runs) return false;
  return fuzz.runs % 256 != 0 ||
         std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count() < seconds;
}

// A profile as a person writes it, changed.
std::string random_profile(Random& random) {
  const auto one_of = [&](const std::vector<std::string>& words) { return words[below(random, words.size())]; };
  const std::vector<std::string> numbers{"0",    "1",    "-1",   "0.5",  "1e-300", "1e308", "3",      "4",     "6",
                                         "79",   "1e-9", "1200", "0.01", "1e6",    "-0.0",  "1e10",   "12.3",  "0.004",
                                         "2000", "60",   "100",  "40",   "0.001",  "5e-5",  "999999", "250000"};
  std::string text = "{\"format\":\"burin/machine\",\"version\":1,\"based_on\":\"" +
                     one_of({"grbl", "grbl-spring", "linuxcnc", "marlin", "laser-z"}) + "\"";
  const std::vector<std::string> names{
      "mine", "my router (left)",    "a\\nG1 Z-5 F300", ");G1 Z-9",    "\\u00e9\\u4e2d", "!~?",
      "%",    std::string(300, 'x'), "\\u0000",         "(LOGOPEN,x)", "\\r\\nM3 S1000"};
  if (below(random, 2) == 0) text += ",\"name\":\"" + one_of(names) + "\"";
  for (const char* key : {"carve_feed_mm_min", "plunge_feed_mm_min", "rapid_mm_min", "rapid_z_mm_min",
                          "acceleration_mm_s2", "acceleration_z_mm_s2", "safe_z_mm", "dwell_s", "decimals", "max_lines",
                          "max_line_characters", "force", "servo_up"})
    if (below(random, 12) == 0) text += ",\"" + std::string(key) + "\":" + one_of(numbers);
  if (below(random, 8) == 0)
    text += ",\"travel_mm\":[[" + one_of(numbers) + "," + one_of(numbers) + "],[" + one_of(numbers) + "," +
            one_of(numbers) + "]]";
  if (below(random, 8) == 0) text += ",\"laser\":true";
  if (below(random, 6) == 0)
    text += ",\"depth_by\":\"" + one_of({"spring", "drag", "servo", "fixed-z"}) + "\",\"depth_table\":[[5," +
            one_of(numbers) + "],[20," + one_of(numbers) + "]]";
  const std::vector<std::string> lines{"G21 G90",
                                       "G21",
                                       "G90",
                                       "G0 Z{z_safe}",
                                       "G0 X{x0} Y{y0}",
                                       "G1 Z{z_carve} F{plunge_feed}",
                                       "G1 X{x1} Y{y1} F{feed}",
                                       "G4 P{dwell_s}",
                                       "M3 S{force}",
                                       "M5",
                                       "M2",
                                       "G91",
                                       "G20",
                                       "M3 S{servo}",
                                       "M3 S{servo_up}",
                                       "({depth_um})",
                                       "G1 Z-{depth_um}",
                                       "G28",
                                       "; {number}",
                                       "G1 X{x1} Y{y1} Z{z1} F{feed}",
                                       "M30",
                                       "G53 G0 Z0",
                                       "%",
                                       "G0 Z0",
                                       "F{rapid}",
                                       "N{number} G0 X{y0}",
                                       "G0 X{x0} Y{y0} F{rapid}",
                                       "G0 Z-20",
                                       "G1 Z-{depth_um} F{plunge_feed}",
                                       "G0 X-200 Y-200",
                                       "G0 X0 Y0",
                                       "G53 G0 Z-80",
                                       "G0 Z1",
                                       "G0 Z40",
                                       "G1 Z-5 F100",
                                       "G1 X{x1} Y200 F{feed}",
                                       "G1 Z-0.01 F100"};
  for (const char* block : {"start", "per_scratch", "end"})
    if (below(random, 6) == 0) {
      text += ",\"" + std::string(block) + "\":[";
      const std::size_t count = below(random, 7);
      for (std::size_t k = 0; k < count; ++k) text += (k == 0 ? "\"" : ",\"") + one_of(lines) + "\"";
      text += "]";
    }
  text += "}";
  if (below(random, 10) == 0 && !text.empty()) text[below(random, text.size())] = static_cast<char>(random());
  return text;
}

}  // namespace

GcodeFuzz fuzz_gcode(std::uint64_t seed, std::uint64_t runs, double seconds) {
  const auto begun = std::chrono::steady_clock::now();
  const std::vector<Machine> all = machines();
  const Board board = sheet_with_clamp();
  const Workpiece workpiece = workpiece_of(board, nullptr);
  Random random(seed);
  GcodeFuzz fuzz;
  for (; goes_on(fuzz, runs, seconds, begun); ++fuzz.runs) {
    const Machine& machine = all[below(random, all.size())];
    // Files of another machine too: what one controller reads, another one need not.
    std::string text = below(random, 8) == 0 ? all[below(random, all.size())].file : machine.file;
    for (std::size_t changes = below(random, 6); changes > 0; --changes) change(text, random);
    try {
      const Replay replay = replay_gcode(text, machine.profile, "fuzz");
      ++fuzz.accepted;
      std::string wrong = compare(replay, text, machine.profile);
      if (wrong.empty() && check_release(text, machine.profile, workpiece, Face{}, "fuzz").faults.empty()) {
        ++fuzz.released;
        wrong = against_sheet(text, machine.profile, sheet_of(board, machine.profile));
      }
      if (!wrong.empty()) keep(fuzz, wrong, machine.profile.name, text);
    } catch (const Error&) {
    } catch (const std::exception& error) {
      keep(fuzz, error.what(), machine.profile.name, text);
    }
  }
  return fuzz;
}

GcodeFuzz fuzz_profiles(std::uint64_t seed, std::uint64_t runs, double seconds, const std::filesystem::path& folder) {
  const auto begun = std::chrono::steady_clock::now();
  const std::filesystem::path file = folder / "profile.json";
  const Board board = sheet_with_clamp();
  Random random(seed);
  GcodeFuzz fuzz;
  for (; goes_on(fuzz, runs, seconds, begun); ++fuzz.runs) {
    const std::string json = random_profile(random);
    std::ofstream(file, std::ios::binary) << json;
    try {
      const MachineProfile machine = read_machine_profile(file);
      const Toolpath path = planned(machine);
      const std::vector<GcodePart> parts = gcode_parts(path, machine);
      const strict::Sheet sheet = sheet_of(board, machine);
      std::size_t carved = 0;
      for (const GcodePart& part : parts) {
        const Replay replay = replay_gcode(part.text, machine, "fuzz");  // what is written is what was replayed
        carved += replay.scratches.size();
        std::string wrong = strict::words_off_sheet(part.text, sheet);
        if (!wrong.empty()) wrong = "sends the tool to " + wrong;
        // A head that presses by itself carves with every G1: the strict reader knows no such head.
        if (wrong.empty() && !presses_by_itself(machine)) wrong = compare(replay, part.text, machine);
        if (wrong.empty() && !presses_by_itself(machine)) wrong = against_sheet(part.text, machine, sheet);
        if (!wrong.empty()) keep(fuzz, wrong, json, part.text);
      }
      ++fuzz.accepted, ++fuzz.released;
      if (carved != path.scratches.size()) keep(fuzz, "carves " + std::to_string(carved), json, parts.front().text);
    } catch (const Error&) {
    } catch (const std::exception& error) {
      keep(fuzz, error.what(), "a profile", json);
    }
  }
  return fuzz;
}

namespace {

// What a tool path is made of, as texts.
struct Inputs {
  std::string board, bench, heights, scratches, profile;
  bool with_bench = false, with_heights = false;
};

std::vector<Inputs> good_inputs() {
  Inputs plain;
  plain.board = R"({"format": "burin/board", "version": 1, "size_mm": [80, 70], "carve_mm": [[15, 15], [65, 55]],
 "keep_out": [{"name": "hole", "center_mm": [40, 35], "radius_mm": 4, "height_mm": 0},
  {"name": "clamp", "rect_mm": [[15, 15], [22, 21]], "height_mm": 12.5}],
 "tool": {"width_um": 400}, "material": {"alpha": 0.06, "depth_um": 11, "base_alpha": 0.15, "f0": [0.9, 0.9, 0.9]},
 "tags": {"family": "tagStandard41h12", "z_mm": 0.1, "sigma_mm": 0.1, "list": [
  {"id": 0, "center_mm": [7, 7], "size_mm": 6}, {"id": 1, "center_mm": [73, 7], "size_mm": 6, "rotation_deg": 90},
  {"id": 2, "center_mm": [40, 63], "size_mm": 6}]}})";
  plain.bench = R"({"format": "burin/bench", "version": 2,
 "camera": {"focal_35mm": 50, "pixels": [900, 700]}, "views": [], "lights": [],
 "material": {"alpha": 0.06, "depth_um": 11, "base_alpha": 0.15, "f0": [0.9, 0.9, 0.9]},
 "board": {"bow_mm": [0.02, 0.01, -0.015]},
 "machine": {"affine": [[1.0012, -0.0002, 0.09], [0.0006, 0.9988, -0.12]], "backlash_mm": [0.03, 0.02],
  "screw_mm": [0.01, 0.02], "screw_period_mm": [5, 5], "screw_phase_deg": [30, 60]}})";
  plain.heights = R"({"format": "burin/heights", "version": 1, "zero_mm": [15, 15], "first_mm": [15, 15],
 "step_mm": [12.5, 10], "z_mm": [[0, 0.012, 0.031, 0.03, 0.02], [0.004, null, 0.036, 0.03, 0.02],
 [0.011, 0.022, 0.043, 0.04, 0.03], [0.01, 0.02, 0.04, 0.03, 0.02], [0, 0.01, 0.02, 0.02, 0.01]], "drift_um": 0.5})";
  plain.scratches =
      "x0_mm,y0_mm,x1_mm,y1_mm,depth_um\n25,18,29,20,11\n17,40,19,44,12\n60,50,57,47,8\n45,30,48,33,10.5\n"
      "30,48,33,51,11\n";
  const std::vector<std::string> profiles{
      R"({"format": "burin/machine", "version": 1, "based_on": "grbl", "safe_z_mm": 1, "decimals": 3,
 "carve_feed_mm_min": 900, "plunge_feed_mm_min": 200, "travel_mm": [[-10, -10], [300, 180]]})",
      R"({"format": "burin/machine", "version": 1, "based_on": "marlin", "safe_z_mm": 2, "dwell_s": 0.1})",
      R"({"format": "burin/machine", "version": 1, "based_on": "linuxcnc", "depth_by": "spring",
 "depth_table": [[5, 0.25], [12, 0.6], [20, 1.2]], "safe_z_mm": 1.5})",
      R"({"format": "burin/machine", "version": 1, "based_on": "grbl", "start": ["G21 G90", "G0 Z20", "M3 S0"],
 "per_scratch": ["G0 Z19", "G0 X{x0} Y{y0}", "G1 Z{z_carve} F200", "G1 X{x1} Y{y1} F600", "G0 Z19"],
 "end": ["G0 Z20", "M5", "G0 X0 Y0", "M2"]})"};
  std::vector<Inputs> all;
  for (std::size_t k = 0; k < 4 * profiles.size(); ++k) {
    all.push_back(plain);
    all.back().profile = profiles[k / 4];
    all.back().with_bench = (k & 1) != 0;
    all.back().with_heights = (k & 2) != 0;
  }
  return all;
}

// One number of a text becomes another one.
std::string with_one_number_changed(const std::string& text, Random& random) {
  std::vector<std::pair<std::size_t, std::size_t>> numbers;  // where, how long
  for (std::size_t i = 0; i < text.size();) {
    const bool in_word = i > 0 && (std::isalnum(static_cast<unsigned char>(text[i - 1])) || text[i - 1] == '_');
    const bool begins = std::isdigit(static_cast<unsigned char>(text[i])) != 0 || text[i] == '-';
    const std::size_t end = std::min(text.find_first_not_of("+-.0123456789eE", i), text.size());
    if (begins && !in_word) numbers.emplace_back(i, end - i);
    i = begins && !in_word ? end : i + 1;
  }
  const auto [at, length] = numbers[below(random, numbers.size())];
  const double was = std::atof(text.substr(at, length).c_str());
  const std::vector<double> others{was * 10,    was * 1000, was / 1000, -was,     was + 1,     was - 1,   0,
                                   was * 1.001, 1e300,      -1e300,     1e-9,     was * 2,     was * 1e6, was + 0.1,
                                   -1,          was * 1.05, 1e5,        -1e5,     2 * was + 5, was * 100, was / 10,
                                   12.7,        was + 20,   -12.7,      was - 20, 100,         0.5 * was, 3};
  char word[64];
  std::snprintf(word, sizeof word, "%.12g", others[below(random, others.size())]);
  return text.substr(0, at) + word + text.substr(at + length);
}

// Writes the inputs, reads them as commands do, and makes G-code of them. Returns what is wrong with it.
std::string wrong_with(const Inputs& inputs, const std::filesystem::path& folder) {
  const auto written = [&](const char* name, const std::string& text) {
    std::ofstream(folder / name, std::ios::binary) << text;
    return folder / name;
  };
  const MachineProfile machine = read_machine_profile(written("m.json", inputs.profile));
  const Board board = read_board(written("board.json", inputs.board));
  std::optional<Bench> bench;
  if (inputs.with_bench) bench = read_bench_of(board, folder / "board.json", written("bench.json", inputs.bench));
  ToolpathOptions options;
  options.keep_order = true;
  if (inputs.with_heights) options.heights = read_heights(written("heights.json", inputs.heights));
  const Scratches scratches = read_scratches(written("s.csv", inputs.scratches));
  const Toolpath path = plan_toolpath(scratches, board, bench ? &*bench : nullptr, machine, options);
  std::vector<std::string> files;
  for (const GcodePart& part : gcode_parts(path, machine)) files.push_back(part.text);
  files.push_back(frame_gcode(path, machine));
  fail_unless_released(files.back(), machine, path.workpiece, path.face, "frame");
  strict::Sheet sheet = sheet_of(board, machine, bench ? &*bench : nullptr);
  if (options.heights) {
    const HeightMap& map = *options.heights;
    sheet.face = [&map](double x, double y) { return height_between(map, x, y); };
    for (const double z : map.z_mm) sheet.face_top = std::max(sheet.face_top, z);
  }
  constexpr double kNoTool_mm = 10;  // goes deeper, whatever its inputs hold
  sheet.deepest = std::min(sheet.deepest, kNoTool_mm);
  for (const std::string& file : files)
    if (const std::string wrong = against_sheet(file, machine, sheet); !wrong.empty()) return wrong + "\n" + file;
  if (machine.dialect == GcodeDialect::marlin) return "";
  try {
    const ProbePlan plan = probe_plan(board, 20);
    const std::string probing = probe_gcode(plan, machine);
    fail_unless_probes(probing, plan, machine, "probe");
    strict::Sheet touched = sheet_of(board, machine);
    touched.deepest = 2;  // how far below zero the face is looked for
    if (const std::string word = strict::words_off_sheet(probing, touched); !word.empty()) return word + "\n" + probing;
  } catch (const Error&) {
  }
  return "";
}

}  // namespace

GcodeFuzz fuzz_inputs(std::uint64_t seed, std::uint64_t runs, double seconds, const std::filesystem::path& folder) {
  const auto begun = std::chrono::steady_clock::now();
  const std::vector<Inputs> all = good_inputs();
  Random random(seed);
  GcodeFuzz fuzz;
  for (; goes_on(fuzz, runs, seconds, begun); ++fuzz.runs) {
    const bool as_it_is = fuzz.runs < all.size();  // first each good one, which must be given out
    Inputs inputs = all[as_it_is ? fuzz.runs : below(random, all.size())];
    std::vector<std::string*> texts{&inputs.board, &inputs.scratches, &inputs.profile};
    if (inputs.with_bench) texts.push_back(&inputs.bench);
    if (inputs.with_heights) texts.push_back(&inputs.heights);
    std::string& changed = *texts[below(random, texts.size())];
    if (!as_it_is) changed = with_one_number_changed(changed, random);
    try {
      const std::string wrong = wrong_with(inputs, folder);
      ++fuzz.accepted, ++fuzz.released;
      if (!wrong.empty()) keep(fuzz, wrong, changed, "");
    } catch (const Error& error) {
      if (as_it_is) keep(fuzz, std::string("good ones are refused: ") + error.what(), inputs.profile, "");
    } catch (const std::exception& error) {
      keep(fuzz, error.what(), "changed inputs", changed);
    }
  }
  return fuzz;
}

}  // namespace burin

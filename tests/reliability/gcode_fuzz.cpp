#include "tests/reliability/gcode_fuzz.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <random>

#include "burin/optimize/carving/gcode.h"
#include "burin/optimize/carving/gcode_line.h"
#include "burin/optimize/carving/toolpath_check.h"
#include "burin/render/error.h"
#include "tests/reliability/strict_gcode.h"

namespace burin {
namespace {

using Random = std::mt19937_64;

std::size_t below(Random& random, std::size_t n) { return n == 0 ? 0 : random() % n; }

Toolpath six_scratches() {
  Toolpath path;
  path.min_mm = {10, 10};
  path.max_mm = {40, 30};
  for (int i = 0; i < 6; ++i)
    path.scratches.push_back({static_cast<std::uint32_t>(i),
                              {10 + 5.1234 * i, 10 + 3.3 * (i % 3)},
                              {12.5 + 4.75 * i, 20.015 - 1.5 * i},
                              0.008 + 0.002 * (i % 3)});
  return path;
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
  const Toolpath path = six_scratches();
  for (Machine& m : all) m.file = gcode_parts(path, m.profile).front().text;
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
                                       "G0 X{x0} Y{y0} F{rapid}"};
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
      const std::string wrong = compare(replay, text, machine.profile);
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
  const Toolpath path = six_scratches();
  const std::filesystem::path file = folder / "profile.json";
  Random random(seed);
  GcodeFuzz fuzz;
  for (; goes_on(fuzz, runs, seconds, begun); ++fuzz.runs) {
    const std::string json = random_profile(random);
    std::ofstream(file, std::ios::binary) << json;
    try {
      const MachineProfile machine = read_machine_profile(file);
      const std::vector<GcodePart> parts = gcode_parts(path, machine);
      std::size_t carved = 0;
      for (const GcodePart& part : parts) {
        const Replay replay = replay_gcode(part.text, machine, "fuzz");  // what is written is what was replayed
        carved += replay.scratches.size();
        // A head that presses by itself carves with every G1: the strict reader knows no such head.
        const bool by_z =
            std::any_of(machine.per_scratch.begin(), machine.per_scratch.end(),
                        [](const std::string& line) { return line.find("{z_carve}") != std::string::npos; });
        if (!by_z && machine.depth_by != DepthBy::servo) continue;
        const std::string wrong = compare(replay, part.text, machine);
        if (!wrong.empty()) keep(fuzz, wrong, json, part.text);
      }
      ++fuzz.accepted;
      if (carved != path.scratches.size()) keep(fuzz, "carves " + std::to_string(carved), json, parts.front().text);
    } catch (const Error&) {
    } catch (const std::exception& error) {
      keep(fuzz, error.what(), "a profile", json);
    }
  }
  return fuzz;
}

}  // namespace burin

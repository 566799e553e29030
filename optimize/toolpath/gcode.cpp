#include "burin/optimize/toolpath/gcode.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/base/files/json_file.h"
#include "burin/optimize/duration.h"
#include "burin/optimize/toolpath/carving_time.h"
#include "burin/optimize/toolpath/gcode_line.h"
#include "burin/optimize/toolpath/release_check.h"

namespace burin {
namespace {

/// Data of a whole file for its head.
struct WholeFile {
  const Replay& replay;   ///< of its commands
  std::size_t lines = 0;  ///< all of them
  GcodeHead head;
};

/// Values of a block's placeholders. Those of one scratch are null outside of `per_scratch`, those of the whole file
/// outside of `head`.
struct BlockValues {
  const MachineProfile& machine;
  const PlannedScratch* scratch = nullptr;
  const WholeFile* file = nullptr;
  std::size_t number = 0;
  const Face* face = nullptr;  ///< reference of depths
  double z_safe_mm = 0;        ///< Z of travel before and after these lines
  double until = 1;            ///< end of this line, as a share of the scratch

  BlockValues(const MachineProfile& profile, const Toolpath& path)
      : machine(profile), face(&path.face), z_safe_mm(path.first_z_mm) {}
};

/// A feed, a force or a servo's position, with at most a controller's decimals.
std::string plain(double value) {
  std::string text = fixed(value, 6);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.ends_with('.')) text.pop_back();
  return text;
}

Eigen::Vector2d along(const PlannedScratch& s, double t) { return s.from_mm + t * (s.to_mm - s.from_mm); }

/// Z of the tool in the metal of a scratch, at a part of its length.
double carving_z(const BlockValues& values, double t) {
  const PlannedScratch& s = *values.scratch;
  return height_mm(*values.face, along(s, t)) - plunge_mm(values.machine, s.depth_mm);
}

/// Bends of a scratch that follows the face; its depth then is well within the replay's tolerance.
std::vector<double> bends(const Face& face, const PlannedScratch& s) {
  return bends(face, s.from_mm, s.to_mm, kFollowShare / 4 * s.depth_mm);
}

/// A placeholder that only a file's head knows; empty for other names.
std::string of_whole_file(const std::string& name, const WholeFile& file, int decimals) {
  const Replay& r = file.replay;
  if (name == "lines") return std::to_string(file.lines);
  if (name == "time_s") return fixed(std::ceil(r.duration_s), 0);
  if (name == "part") return std::to_string(file.head.part);
  if (name == "parts") return std::to_string(file.head.parts);
  if (name == "scratches") return std::to_string(r.scratches.size());
  for (int axis = 0; axis < 3; ++axis) {
    const std::string letter(1, "xyz"[axis]);
    if (name == "min_" + letter) return fixed(r.min_mm[axis], decimals);
    if (name == "max_" + letter) return fixed(r.max_mm[axis], decimals);
  }
  return "";
}

/// The text of one placeholder; nothing for the dwell of a machine without one (its line is then left out).
std::optional<std::string> placeholder(const std::string& name, const BlockValues& values) {
  const MachineProfile& m = values.machine;
  const PlannedScratch* s = values.scratch;
  if (name == "z_safe") return fixed(values.z_safe_mm, m.decimals);
  if (name == "feed") return plain(s != nullptr && s->feed_mm_min > 0 ? s->feed_mm_min : m.carve_feed_mm_min);
  if (name == "plunge_feed") return plain(m.plunge_feed_mm_min);
  if (name == "rapid") return plain(m.rapid_mm_min);
  if (name == "force" && m.force != 0) return plain(m.force);
  if (name == "rapid_z") return plain(m.rapid_z_mm_min);
  if (name == "servo_up") return plain(m.servo_up);
  if (name == "dwell_s") return m.dwell_s > 0 ? std::optional(fixed(m.dwell_s, 3)) : std::nullopt;
  if (name == "dwell_ms") return m.dwell_s > 0 ? std::optional(fixed(m.dwell_s * 1e3, 0)) : std::nullopt;
  if (values.file != nullptr)
    if (std::string text = of_whole_file(name, *values.file, m.decimals); !text.empty()) return text;
  if (s != nullptr) {
    if (name == "x0") return fixed(s->from_mm.x(), m.decimals);
    if (name == "y0") return fixed(s->from_mm.y(), m.decimals);
    if (name == "x1") return fixed(along(*s, values.until).x(), m.decimals);
    if (name == "y1") return fixed(along(*s, values.until).y(), m.decimals);
    if (name == "z_carve") return fixed(carving_z(values, 0), m.decimals);
    if (name == "z1") return fixed(carving_z(values, values.until), m.decimals);
    if (name == "servo" && m.depth_by == DepthBy::servo)
      return fixed(command_for_depth(m.depth_table, 1e3 * s->depth_mm, "machine profile \"" + m.name + "\""), 2);
    if (name == "depth_um") return fixed(s->depth_mm * 1e3, 2);
    if (name == "number") return std::to_string(values.number);
  }
  if (name == "servo")
    fail("machine profile \"" + m.name + "\"", "its blocks use {servo}, but it is none",
         "add \"depth_by\": \"servo\" and a depth_table");
  if (name == "force")
    fail("machine profile \"" + m.name + "\"", "its blocks use {force}, but it has none", "add \"force\": 350");
  fail("machine profile \"" + m.name + "\"", "its blocks use {" + name + "}, which is not known there",
       "use z_safe, feed, plunge_feed, rapid, rapid_z, force, servo_up, dwell_s, dwell_ms and, in per_scratch, x0, y0, "
       "x1, y1, z_carve, z1, servo, depth_um, number; in head, lines, time_s, part, parts, scratches, min_x, max_x, "
       "min_y, max_y, min_z, max_z");
}

/// Appends a line, unless it needs a dwell and the machine has none.
void append_line(std::string& text, const std::string& line, const BlockValues& values) {
  const std::size_t line_start = text.size();
  for (std::size_t i = 0; i < line.size();) {
    const std::size_t open = line.find('{', i), close = open == std::string::npos ? open : line.find('}', open);
    if (close == std::string::npos) {
      text.append(line, i);
      break;
    }
    text.append(line, i, open - i);
    const std::optional<std::string> value = placeholder(line.substr(open + 1, close - open - 1), values);
    if (!value) {
      text.resize(line_start);
      return;
    }
    text += *value;
    i = close + 1;
  }
  text += '\n';
}

void append_block(std::string& text, const std::vector<std::string>& block, const BlockValues& values) {
  for (const std::string& line : block) append_line(text, line, values);
}

/// True if a line of the block moves the tool along the scratch.
bool goes_along(const std::string& line) {
  return line.find("{x1}") != std::string::npos || line.find("{y1}") != std::string::npos;
}

/// Z of travel before and after a scratch, the same for both, since blocks lift first or last. A part begins and ends
/// above all obstacles.
double travel_z(const Toolpath& path, const GcodePart& part, std::size_t i) {
  if (i == part.first || i + 1 == part.first + part.count) return path.first_z_mm;
  return std::max(path.scratches[i].travel_z_mm, path.scratches[i + 1].travel_z_mm);
}

/// Appends a scratch. On a followed face, the line along it also has Z, and is repeated for each bend.
void append_scratch(std::string& text, const MachineProfile& machine, const Toolpath& path, const GcodePart& part,
                    std::size_t i) {
  BlockValues values(machine, path);
  values.z_safe_mm = travel_z(path, part, i);
  values.scratch = &path.scratches[i];
  values.number = i + 1;
  const bool follows = path.face.followed() && machine.depth_by != DepthBy::servo;
  for (std::string line : machine.per_scratch) {
    if (!follows || !goes_along(line)) {
      append_line(text, line, values);
      continue;
    }
    if (line.find("{z1}") == std::string::npos) {
      const std::size_t x = line.find("{x1}"), y = line.find("{y1}");
      const std::size_t last = y == std::string::npos || (x != std::string::npos && x > y) ? x : y;
      line.insert(last + 4, " Z{z1}");
    }
    for (const double t : bends(path.face, path.scratches[i])) {
      values.until = t;
      append_line(text, line, values);
    }
    values.until = 1;
  }
}

/// True if the profile's start lifts to {z_safe}: its files then contain the height of their first way.
bool starts_lifted(const MachineProfile& machine) {
  return std::any_of(machine.start.begin(), machine.start.end(),
                     [](const std::string& line) { return line.find("{z_safe}") != std::string::npos; });
}

/// Appends a way in the air outside of the profile's blocks. Marlin uses the last feed unless the line sets one.
void append_way(std::string& text, const MachineProfile& machine, const Eigen::Vector2d& to) {
  text += "G0 X" + fixed(to.x(), machine.decimals) + " Y" + fixed(to.y(), machine.decimals) +
          (machine.dialect == GcodeDialect::marlin ? " F" + plain(machine.rapid_mm_min) : "") + "\n";
}
void append_z(std::string& text, const MachineProfile& machine, double z_mm) {
  text += "G0 Z" + fixed(z_mm, machine.decimals) +
          (machine.dialect == GcodeDialect::marlin ? " F" + plain(machine.rapid_z_mm_min) : "") + "\n";
}

/// True if Z is constant while scratches are carved, and descends from higher travel over the next scratch.
bool is_approached(const MachineProfile& machine) { return keeps_z(machine) && starts_lifted(machine); }

constexpr std::size_t kApproachLines = 2, kLiftedLines = 1 + kApproachLines;

void append_approach(std::string& text, const MachineProfile& machine, const Toolpath& path,
                     const Eigen::Vector2d& to) {
  append_way(text, machine, to);
  append_z(text, machine, path.kept_z_mm);
}

/// True if Z must leave its height on the way to a scratch, over a clamp.
bool is_lifted(const MachineProfile& machine, const Toolpath& path, std::size_t i) {
  return is_approached(machine) && path.scratches[i].travel_z_mm > path.kept_z_mm;
}

/// A comment of Burin's, in lines for the machine. External words enter it by comment_word() alone.
void append_comment(std::string& text, const MachineProfile& machine, const std::string& comment) {
  text += comment_lines(machine, comment);
}

/// Notes about depths for the machine's operator.
void append_notes(std::string& text, const MachineProfile& machine, const Toolpath& path) {
  if (starts_lifted(machine))
    append_comment(text, machine,
                   "first way along X and Y: " + fixed(path.first_z_mm, 1) + " mm above zero, over sheet and clamps");
  if (path.face.followed())
    append_comment(text, machine,
                   "Z zero: the face at X" + fixed(path.face.zero_mm.x(), 3) + " Y" + fixed(path.face.zero_mm.y(), 3) +
                       ", Z follows the face");
  if (by_preload(machine.depth_by)) append_comment(text, machine, "Z zero: where the tool touches, not yet pressed");
  if (machine.laser) append_comment(text, machine, "the beam is turned off and stays off");
}

/// The line that lifts a servo's head: the one that presses it, with another S.
std::string lifting_line(const MachineProfile& machine) {
  constexpr std::string_view kPressed = "{servo}";
  for (std::string line : machine.per_scratch) {
    const std::size_t at = line.find(kPressed);
    if (at == std::string::npos || line.find_first_of("XYZ") != std::string::npos) continue;
    return line.replace(at, kPressed.size(), "{servo_up}");
  }
  return "M3 S{servo_up}";
}

/// Commands before any motion that no profile's blocks can omit, for any state of the machine.
std::vector<std::string> own_start(const MachineProfile& machine) {
  const bool marlin = machine.dialect == GcodeDialect::marlin;
  std::vector<std::string> lines;
  if (machine.laser) lines = marlin ? std::vector<std::string>{"M5", "M107"} : std::vector<std::string>{"M5 S0"};
  if (machine.depth_by == DepthBy::servo)
    lines = {lifting_line(machine), marlin ? "G4 P{dwell_ms}" : "G4 P{dwell_s}"};
  else if (marlin)
    lines.emplace_back("M211 S0");  // else its software endstops stop Z at zero without a message
  if (machine.dialect == GcodeDialect::linuxcnc) lines.emplace_back("G61");  // exact path, no rounded corners
  return lines;
}

/// Commands after all carving, before the profile's own end.
std::vector<std::string> own_end(const MachineProfile& machine) {
  const bool marlin = machine.dialect == GcodeDialect::marlin;
  std::vector<std::string> lines;
  if (machine.laser) lines = marlin ? std::vector<std::string>{"M5", "M107"} : std::vector<std::string>{"M5 S0"};
  if (machine.depth_by == DepthBy::servo)
    lines.push_back(lifting_line(machine));
  else if (marlin)
    lines.emplace_back("M211 S1");
  return lines;
}

void append_start(std::string& text, const MachineProfile& machine, const Toolpath& path) {
  // LinuxCNC's % is the first of all.
  const std::size_t before = !machine.start.empty() && machine.start.front() == "%" ? 1 : 0;
  const auto own = machine.start.begin() + static_cast<std::ptrdiff_t>(before);
  append_block(text, {machine.start.begin(), own}, {machine, path});
  append_block(text, own_start(machine), {machine, path});
  append_block(text, {own, machine.start.end()}, {machine, path});
}

void append_end(std::string& text, const MachineProfile& machine, const Toolpath& path) {
  append_block(text, own_end(machine), {machine, path});
  append_block(text, machine.end, {machine, path});
}

std::size_t count_lines(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

/// The whole file: the profile's head, then `rest`.
std::string with_head(const std::string& rest, const Replay& replay, const GcodeHead& head,
                      const MachineProfile& machine, const Toolpath& path) {
  const WholeFile file{replay, count_lines(rest) + machine.head.size(), head};
  BlockValues values(machine, path);
  values.file = &file;
  std::string text;
  append_block(text, machine.head, values);
  return text + rest;
}

/// A file's comments, then its commands. LinuxCNC's % must be on the first line.
std::string after_comments(const std::string& comments, const std::string& commands) {
  const std::size_t begin = commands.starts_with("%\n") ? 2 : 0;
  return commands.substr(0, begin) + comments + commands.substr(begin);
}

/// The comments of a part, before its commands.
std::string comments(const Toolpath& path, const MachineProfile& machine, const GcodeHead& head, double duration_s) {
  std::string text;
  append_comment(text, machine, "Burin tool path for " + comment_word(machine.name) + ", mm");
  append_comment(text, machine, head_text(head));
  append_comment(text, machine,
                 "X " + fixed(path.min_mm.x(), 3) + " to " + fixed(path.max_mm.x(), 3) + ", Y " +
                     fixed(path.min_mm.y(), 3) + " to " + fixed(path.max_mm.y(), 3));
  append_comment(text, machine, "zero: lower left corner of the board, its face");
  append_notes(text, machine, path);
  append_comment(text, machine, "about " + duration_text(duration_s));
  return text;
}

/// Scratches [first, first + count) of the path for each file: as many as its time and lines allow.
std::vector<std::pair<std::size_t, std::size_t>> split(const Toolpath& path, const MachineProfile& machine,
                                                       double part_s) {
  constexpr std::size_t kMostParts = 999;
  // Comments at their longest: every number has its most digits.
  const std::size_t all = path.scratches.size();
  constexpr double kLongest_s = 3599999;
  const std::size_t fixed_lines = machine.head.size() + own_start(machine).size() + machine.start.size() +
                                  (is_approached(machine) ? kApproachLines : 0) + own_end(machine).size() +
                                  machine.end.size() +
                                  count_lines(comments(path, machine, {all, all, all, all, all}, kLongest_s));
  const std::size_t room = machine.max_lines == 0 ? std::numeric_limits<std::size_t>::max()
                           : static_cast<std::size_t>(machine.max_lines) > fixed_lines
                               ? static_cast<std::size_t>(machine.max_lines) - fixed_lines
                               : 0;
  const std::size_t lines_each = std::max<std::size_t>(1, machine.per_scratch.size());
  std::vector<std::pair<std::size_t, std::size_t>> parts;
  Eigen::Vector2d at(0, 0);
  double elapsed_s = 0;
  std::size_t lines = 0;
  for (std::size_t i = 0; i < path.scratches.size(); ++i) {
    const PlannedScratch& scratch = path.scratches[i];
    const double s = scratch_time(at, scratch.from_mm, scratch.to_mm, scratch.depth_mm, machine).total_s();
    at = scratch.to_mm;
    const std::size_t more = lines_each * (path.face.followed() ? bends(path.face, scratch).size() : 1) +
                             (is_lifted(machine, path, i) ? kLiftedLines : 0);
    if (more > room)
      fail("tool path",
           "files of at most " + std::to_string(machine.max_lines) + " lines leave no room for the scratch in row " +
               std::to_string(scratch.scratch + 1) + ": beside it a file has " + std::to_string(fixed_lines) + " lines",
           "allow at least " + std::to_string(fixed_lines + more) + " (--max-lines, or max_lines of the profile)");
    const bool full = !parts.empty() && (more > room - std::min(room, lines) || (part_s > 0 && elapsed_s + s > part_s));
    if (parts.empty() || full) {
      if (parts.size() == kMostParts)
        fail("tool path", "would be more than " + std::to_string(kMostParts) + " files",
             "allow longer ones (--chunks, --max-lines, or max_lines of the machine profile)");
      parts.emplace_back(i, 0);
      elapsed_s = 0;
      lines = 0;
    }
    ++parts.back().second;
    elapsed_s += s;
    lines += more;
  }
  return parts;
}

}  // namespace

std::vector<GcodePart> gcode_parts(const Toolpath& path, const MachineProfile& machine, double part_s) {
  const auto parts = split(path, machine, part_s);
  std::vector<GcodePart> list;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    GcodePart part{{}, parts[k].first, parts[k].second, 0};
    std::string body;
    append_start(body, machine, path);
    for (std::size_t i = part.first; i < part.first + part.count; ++i) {
      const bool lifted = i > part.first && is_lifted(machine, path, i);
      if (lifted) append_z(body, machine, path.scratches[i].travel_z_mm);
      if (lifted || (i == part.first && is_approached(machine)))
        append_approach(body, machine, path, path.scratches[i].from_mm);
      append_scratch(body, machine, path, part, i);
    }
    append_end(body, machine, path);
    const std::string name = "tool path, part " + std::to_string(k + 1);
    const Replay replay = fail_unless_released(body, machine, path.workpiece, path.face, name);
    part.duration_s = replay.duration_s;
    fail_unless_carves(replay, path, part, machine, name);

    // The written file is read back and replayed whole (replay_written).
    const GcodeHead head{k + 1, parts.size(), part.first + 1, part.first + part.count, path.scratches.size()};
    part.text =
        with_head(after_comments(comments(path, machine, head, part.duration_s), body), replay, head, machine, path);
    list.push_back(std::move(part));
  }
  return list;
}

std::string read_back(const std::filesystem::path& written, std::string_view text, const std::string& name) {
  std::string bytes = read_text(written);
  if (bytes != text)
    fail(name,
         "is not on the disk as it was written (" + std::to_string(bytes.size()) + " bytes of " +
             std::to_string(text.size()) + " came back, or others)",
         "check the disk, and write it again");
  return bytes;
}

Replay replay_written(const std::filesystem::path& written, std::string_view text, const Toolpath& path,
                      const MachineProfile& machine, const std::string& name) {
  Replay replay = fail_unless_released(read_back(written, text, name), machine, path.workpiece, path.face, name);
  fail_unless_ended(replay, machine, name);
  return replay;
}

void fail_unless_carves(const Replay& replay, const Toolpath& path, const GcodePart& part,
                        const MachineProfile& machine, const std::string& name) {
  fail_unless_good(check_toolpath(replay.scratches, std::span(path.scratches).subspan(part.first, part.count),
                                  2 * std::pow(10.0, -machine.decimals), depth_share(path.face)),
                   name);
}

std::string frame_gcode(const Toolpath& path, const MachineProfile& machine) {
  std::string notes, text;
  append_comment(notes, machine, "Burin frame for " + comment_word(machine.name) + ", mm, in the air");
  append_notes(notes, machine, path);
  append_start(text, machine, path);
  const Eigen::Vector2d &low = path.min_mm, &high = path.max_mm;
  const std::array<Eigen::Vector2d, 5> corners{low, {high.x(), low.y()}, high, {low.x(), high.y()}, low};
  double z_mm = path.kept_z_mm;
  for (std::size_t k = 0; k + 1 < corners.size(); ++k)
    z_mm = std::max(z_mm, travel_z_mm(path.workpiece, path.face, machine, corners[k], corners[k + 1]));
  append_way(text, machine, low);
  if (starts_lifted(machine)) append_z(text, machine, z_mm);
  for (std::size_t k = 1; k < corners.size(); ++k)
    text += "G1 X" + fixed(corners[k].x(), machine.decimals) + " Y" + fixed(corners[k].y(), machine.decimals) + " F" +
            plain(machine.carve_feed_mm_min) + "\n";
  append_end(text, machine, path);
  text = after_comments(notes, text);
  return with_head(text, replay_gcode(text, machine, "frame", &path.face), {1, 1, 0, 0, 0}, machine, path);
}

}  // namespace burin

#include "burin/optimize/carving/gcode.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "burin/optimize/carving/carving_time.h"
#include "burin/optimize/carving/number_text.h"
#include "burin/optimize/carving/toolpath_check.h"
#include "burin/optimize/duration.h"
#include "burin/render/error.h"

namespace burin {
namespace {

/// What a block's placeholders stand for. Those of one scratch are null outside of `per_scratch`.
struct BlockValues {
  const MachineProfile& machine;
  const PlannedScratch* scratch = nullptr;
  std::size_t number = 0;
};

/// The text of one placeholder; nothing for the dwell of a machine that needs none (its line is then left out).
std::optional<std::string> placeholder(const std::string& name, const BlockValues& values) {
  const MachineProfile& m = values.machine;
  const PlannedScratch* s = values.scratch;
  if (name == "z_safe") return fixed(m.safe_z_mm, m.decimals);
  if (name == "feed") return shortest(m.carve_feed_mm_min);
  if (name == "plunge_feed") return shortest(m.plunge_feed_mm_min);
  if (name == "rapid") return shortest(m.rapid_mm_min);
  if (name == "force" && m.force != 0) return shortest(m.force);
  if (name == "rapid_z") return shortest(m.rapid_z_mm_min);
  if (name == "dwell_s") return m.dwell_s > 0 ? std::optional(fixed(m.dwell_s, 3)) : std::nullopt;
  if (name == "dwell_ms") return m.dwell_s > 0 ? std::optional(fixed(m.dwell_s * 1e3, 0)) : std::nullopt;
  if (s != nullptr) {
    if (name == "x0") return fixed(s->from_mm.x(), m.decimals);
    if (name == "y0") return fixed(s->from_mm.y(), m.decimals);
    if (name == "x1") return fixed(s->to_mm.x(), m.decimals);
    if (name == "y1") return fixed(s->to_mm.y(), m.decimals);
    if (name == "z_carve") return fixed(-s->depth_mm, m.decimals);
    if (name == "depth_um") return fixed(s->depth_mm * 1e3, 2);
    if (name == "number") return std::to_string(values.number);
  }
  if (name == "force")
    fail("machine profile \"" + m.name + "\"", "its blocks ask for {force}, but it says none", "add \"force\": 350");
  fail("machine profile \"" + m.name + "\"", "its blocks ask for {" + name + "}, which is not known there",
       "use z_safe, feed, plunge_feed, rapid, rapid_z, force, dwell_s, dwell_ms and, in per_scratch, x0, y0, x1, y1, "
       "z_carve, "
       "depth_um, number");
}

/// Appends a block's lines; returns how many.
std::size_t append_block(std::string& text, const std::vector<std::string>& block, const BlockValues& values) {
  std::size_t lines = 0;
  for (const std::string& line : block) {
    const std::size_t line_start = text.size();
    bool wanted = true;
    for (std::size_t i = 0; i < line.size() && wanted;) {
      const std::size_t open = line.find('{', i), close = open == std::string::npos ? open : line.find('}', open);
      if (close == std::string::npos) {
        text.append(line, i);
        break;
      }
      text.append(line, i, open - i);
      const std::optional<std::string> value = placeholder(line.substr(open + 1, close - open - 1), values);
      wanted = value.has_value();
      if (wanted) text += *value;
      i = close + 1;
    }
    if (wanted) {
      text += '\n';
      ++lines;
    } else {
      text.resize(line_start);
    }
  }
  return lines;
}

void append_comment(std::string& text, const MachineProfile& machine, const std::string& comment) {
  text += machine.dialect == GcodeDialect::marlin ? "; " + comment + "\n" : "(" + comment + ")\n";
}

/// Scratches [first, first + count) of the path for each file: as many as its time and lines allow.
std::vector<std::pair<std::size_t, std::size_t>> split(const Toolpath& path, const MachineProfile& machine,
                                                       double part_s) {
  constexpr std::size_t kCommentLines = 8;
  const std::size_t fixed_lines = machine.start.size() + machine.end.size() + kCommentLines;
  const std::size_t room = machine.max_lines == 0 ? std::numeric_limits<std::size_t>::max()
                           : static_cast<std::size_t>(machine.max_lines) > fixed_lines
                               ? static_cast<std::size_t>(machine.max_lines) - fixed_lines
                               : 0;
  const std::size_t lines_each = std::max<std::size_t>(1, machine.per_scratch.size());
  const std::size_t most = std::max<std::size_t>(1, room / lines_each);
  std::vector<std::pair<std::size_t, std::size_t>> parts;
  Eigen::Vector2d at(0, 0);
  double elapsed_s = 0;
  for (std::size_t i = 0; i < path.scratches.size(); ++i) {
    const PlannedScratch& scratch = path.scratches[i];
    const double s = scratch_time(at, scratch.from_mm, scratch.to_mm, scratch.depth_mm, machine).total_s();
    at = scratch.to_mm;
    const bool full = !parts.empty() && (parts.back().second >= most || (part_s > 0 && elapsed_s + s > part_s));
    if (parts.empty() || full) {
      parts.emplace_back(i, 0);
      elapsed_s = 0;
    }
    ++parts.back().second;
    elapsed_s += s;
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
    append_block(body, machine.start, {machine});
    for (std::size_t i = part.first; i < part.first + part.count; ++i)
      append_block(body, machine.per_scratch, {machine, &path.scratches[i], i + 1});
    append_block(body, machine.end, {machine});
    const Replay replay = replay_gcode(body, machine, "tool path, part " + std::to_string(k + 1));
    part.duration_s = replay.duration_s;
    fail_unless_good(check_toolpath(replay.scratches, std::span(path.scratches).subspan(part.first, part.count),
                                    2 * std::pow(10.0, -machine.decimals)),
                     "tool path, part " + std::to_string(k + 1));

    // Short lines: grbl reads at most 80 characters.
    append_comment(part.text, machine, "Burin tool path for " + machine.name + ", mm");
    append_comment(part.text, machine,
                   "part " + std::to_string(k + 1) + " of " + std::to_string(parts.size()) + ", scratches " +
                       std::to_string(part.first + 1) + " to " + std::to_string(part.first + part.count) + " of " +
                       std::to_string(path.scratches.size()));
    append_comment(part.text, machine,
                   "X " + fixed(path.min_mm.x(), 3) + " to " + fixed(path.max_mm.x(), 3) + ", Y " +
                       fixed(path.min_mm.y(), 3) + " to " + fixed(path.max_mm.y(), 3));
    append_comment(part.text, machine, "zero: lower left corner of the board, its face");
    append_comment(part.text, machine, "about " + duration_text(part.duration_s));
    part.text += body;
    list.push_back(std::move(part));
  }
  return list;
}

std::string frame_gcode(const Toolpath& path, const MachineProfile& machine) {
  std::string text;
  append_comment(text, machine, "Burin frame for " + machine.name + ", mm: round the scratches, in the air");
  append_block(text, machine.start, {machine});
  const auto go = [&](const std::string& how, double x, double y) {
    text += how + " X" + fixed(x, machine.decimals) + " Y" + fixed(y, machine.decimals) + " F" +
            shortest(machine.carve_feed_mm_min) + "\n";
  };
  go("G0", path.min_mm.x(), path.min_mm.y());
  go("G1", path.max_mm.x(), path.min_mm.y());
  go("G1", path.max_mm.x(), path.max_mm.y());
  go("G1", path.min_mm.x(), path.max_mm.y());
  go("G1", path.min_mm.x(), path.min_mm.y());
  append_block(text, machine.end, {machine});
  return text;
}

}  // namespace burin

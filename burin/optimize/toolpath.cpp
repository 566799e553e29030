#include "burin/optimize/toolpath.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>
#include <system_error>

#include "burin/optimize/carving/carving_limits.h"
#include "burin/optimize/carving/carving_time.h"
#include "burin/optimize/carving/toolpath_check.h"
#include "burin/render/error.h"
#include "burin/render/files/json_file.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

constexpr double kEdgeTolerance_mm = 1e-3;  // files are rounded to 1e-5 mm or, by others, to 1e-3

std::string fixed(double value, int decimals) {
  std::array<char, 64> buffer;
  std::string text(buffer.data(),
                   std::to_chars(buffer.begin(), buffer.end(), value, std::chars_format::fixed, decimals).ptr);
  // "-0.0000" is no place of its own.
  if (text[0] == '-' && text.find_first_not_of("-0.") == std::string::npos) text.erase(0, 1);
  return text;
}

std::string shortest(double value) {
  std::array<char, 64> buffer;
  return {buffer.data(), std::to_chars(buffer.begin(), buffer.end(), value).ptr};
}

std::string point_text(const Eigen::Vector2d& p) { return "(" + fixed(p.x(), 3) + ", " + fixed(p.y(), 3) + ") mm"; }

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

/// board.gcode, or board-03.gcode for the third of several.
fs::path part_file(const fs::path& out, std::size_t part, std::size_t parts) {
  if (parts == 1) return out;
  const std::size_t digits = std::max<std::size_t>(2, std::to_string(parts).size());
  std::string number = std::to_string(part + 1);
  number.insert(0, digits - std::min(digits, number.size()), '0');
  return out.parent_path() / (out.stem().string() + "-" + number + out.extension().string());
}

bool written_by_us(const fs::path& file) {
  std::ifstream stream(file);
  std::string first_line;
  std::getline(stream, first_line);
  return first_line.find("Burin") != std::string::npos;
}

/// A shorter job leaves no part of a longer one behind: someone would carve it.
void remove_stale_parts(const fs::path& out, const std::vector<fs::path>& written) {
  const fs::path folder = out.has_parent_path() ? out.parent_path() : fs::path(".");
  const std::string prefix = out.stem().string() + "-";
  std::error_code error;
  std::vector<fs::path> stale;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const fs::path& file = entry.path();
    const std::string stem = file.stem().string();
    const bool ours =
        file.extension() == out.extension() &&
        (stem == out.stem().string() || (stem.starts_with(prefix) && stem.size() > prefix.size() &&
                                         stem.find_first_not_of("0123456789", prefix.size()) == std::string::npos));
    const auto same_name = [&](const fs::path& w) { return w.filename() == file.filename(); };
    if (ours && std::none_of(written.begin(), written.end(), same_name) && written_by_us(file)) stale.push_back(file);
  }
  for (const fs::path& file : stale) fs::remove(file, error);
}

std::string extension_of(const fs::path& out) {
  std::string extension = out.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

/// believed / measured depth: what a depth to be carved must be multiplied with to become the machine's command.
double depth_command_factor(const Board& board, const Bench* measured) {
  if (measured == nullptr || !measured->material_sigma.depth_um) return 1;
  const auto verdict = measured->verdict.find("depth_um");
  if (verdict != measured->verdict.end() && !verdict->second.determined) return 1;
  return board.material.depth_um / measured->material.depth_um;
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
  const CarvingLimits limits = toolpath_limits(board, measured, machine);
  const Affine2 carves = limits.affine;

  Toolpath path;
  path.compensated = !carves.isApprox(CarvingLimits().affine, 1e-12);
  const Eigen::Matrix2d A_inverse = carves.leftCols<2>().inverse();
  const auto told = [&](const Eigen::Vector2d& p) -> Eigen::Vector2d {
    return path.compensated ? Eigen::Vector2d(A_inverse * (p - carves.col(2))) : p;
  };
  Scratches sent = scratches, carved = scratches;
  const auto put = [](std::vector<double>& x, std::vector<double>& y, std::size_t i, const Eigen::Vector2d& p) {
    x[i] = p.x();
    y[i] = p.y();
  };
  for (std::size_t i = 0; i < scratches.size(); ++i) {
    if (scratches.is_carved(i)) {
      ++path.already_carved;
      continue;
    }
    for (const auto& [x, y] :
         {std::pair(&Scratches::x0_mm, &Scratches::y0_mm), {&Scratches::x1_mm, &Scratches::y1_mm}}) {
      const Eigen::Vector2d p((scratches.*x)[i], (scratches.*y)[i]);
      Eigen::Vector2d q = told(p);
      if (const double step = machine.limits.step_mm; step > 0) {
        // The machine goes to its steps whatever it is told: tell it so, and judge what it will carve.
        const Eigen::Vector2d on_step = (q / step).array().round() * step;
        const Eigen::Vector2d lies = carves.leftCols<2>() * on_step + carves.col(2);
        if ((lies - p).norm() > kOnStep_mm) put(carved.*x, carved.*y, i, lies);
        path.stepped_mm = std::max(path.stepped_mm, (lies - p).norm());
        q = on_step;
      }
      put(sent.*x, sent.*y, i, q);
    }
  }
  if (path.already_carved == scratches.size())
    fail("tool path", "all " + std::to_string(scratches.size()) + " scratches are carved already",
         "design some more, or take the column carved away to carve all again");
  fail_unless_good(check_limits(carved, limits, kEdgeTolerance_mm), "tool path");
  if (machine.travel)
    for (std::size_t i = 0; i < sent.size(); ++i) {
      if (sent.is_carved(i)) continue;
      for (const Eigen::Vector2d& p :
           {Eigen::Vector2d(sent.x0_mm[i], sent.y0_mm[i]), Eigen::Vector2d(sent.x1_mm[i], sent.y1_mm[i])})
        if ((p.array() < machine.travel->min_mm.array()).any() || (p.array() > machine.travel->max_mm.array()).any())
          fail("scratch in row " + std::to_string(i + 1),
               std::string(path.compensated ? "compensated for the machine's error it" : "it") +
                   " leaves the travel of " + machine.name + " at " + point_text(p),
               "place the board elsewhere, or correct travel_mm (now " + point_text(machine.travel->min_mm) + " to " +
                   point_text(machine.travel->max_mm) + ")");
    }

  std::vector<std::size_t> rows;  // what is to be carved
  for (std::size_t i = 0; i < sent.size(); ++i)
    if (!sent.is_carved(i)) rows.push_back(i);
  const Scratches to_carve = selected(sent, rows);
  path.order = options.keep_order ? file_order(to_carve) : carving_order(to_carve, {}, progress);
  path.travel_mm = travel_mm(to_carve, path.order);
  path.file_order_travel_mm = travel_mm(to_carve, file_order(to_carve));
  for (CarvingStep& step : path.order) step.scratch = static_cast<std::uint32_t>(rows[step.scratch]);
  const double factor = depth_command_factor(board, measured);
  path.min_mm.setConstant(std::numeric_limits<double>::infinity());
  path.max_mm = -path.min_mm;
  path.scratches.reserve(rows.size());
  Eigen::Vector2d at(0, 0);
  for (const CarvingStep& step : path.order) {
    const std::size_t i = step.scratch;
    PlannedScratch planned;
    planned.scratch = step.scratch;
    planned.from_mm = {sent.x0_mm[i], sent.y0_mm[i]};
    planned.to_mm = {sent.x1_mm[i], sent.y1_mm[i]};
    if (step.reversed) std::swap(planned.from_mm, planned.to_mm);
    planned.depth_mm = 1e-3 * (sent.depth_um.empty() ? board.material.depth_um : sent.depth_um[i] * factor);
    path.min_mm = path.min_mm.cwiseMin(planned.from_mm).cwiseMin(planned.to_mm);
    path.max_mm = path.max_mm.cwiseMax(planned.from_mm).cwiseMax(planned.to_mm);
    path.carve_mm += (planned.to_mm - planned.from_mm).norm();
    path.duration_s += scratch_time(at, planned.from_mm, planned.to_mm, planned.depth_mm, machine).total_s();
    at = planned.to_mm;
    path.scratches.push_back(planned);
  }
  return path;
}

Toolpath left_after(const Toolpath& planned, const MachineProfile& machine, std::string_view text, std::size_t line,
                    const std::string& name) {
  const Replay replay = replay_gcode(text, machine, name);
  if (line < 1 || line > replay.lines)
    fail(name + ": line " + std::to_string(line), "is not in the file, which has " + std::to_string(replay.lines),
         "give the line at which the machine stopped");
  const double tolerance_mm = 1e-3;  // of coordinates with the fewest decimals that make sense
  const std::vector<std::ptrdiff_t> found = find_planned(replay.scratches, planned.scratches, tolerance_mm);
  for (std::size_t k = 0; k < found.size(); ++k)
    if (found[k] < 0)
      fail(name + ":" + std::to_string(replay.scratches[k].line),
           "carves a scratch that is not among those given, " + point_text(replay.scratches[k].from_mm) + " to " +
               point_text(replay.scratches[k].to_mm),
           "give the scratches, board, bench and machine that the file was made with");
  // A scratch is done once the line that carves it lies behind the machine.
  const auto first = std::find_if(replay.scratches.begin(), replay.scratches.end(),
                                  [&](const ReplayedScratch& s) { return s.line >= line; });
  if (first == replay.scratches.begin())
    fail(name, "has carved nothing before line " + std::to_string(line), "start it again from its beginning");
  if (first == replay.scratches.end())
    fail(name, "has carved all its scratches before line " + std::to_string(line), "go on with the next file");

  Toolpath left;
  left.done_before = static_cast<std::size_t>(first - replay.scratches.begin());
  left.compensated = planned.compensated;
  left.already_carved = planned.already_carved;
  left.stepped_mm = planned.stepped_mm;
  left.min_mm.setConstant(std::numeric_limits<double>::infinity());
  left.max_mm = -left.min_mm;
  Eigen::Vector2d at(0, 0);
  for (std::size_t k = left.done_before; k < found.size(); ++k) {
    const auto i = static_cast<std::size_t>(found[k]);
    PlannedScratch s = planned.scratches[i];
    CarvingStep step = planned.order[i];
    if ((s.from_mm - replay.scratches[k].from_mm).norm() > tolerance_mm) {
      std::swap(s.from_mm, s.to_mm);
      step.reversed = !step.reversed;
    }
    left.min_mm = left.min_mm.cwiseMin(s.from_mm).cwiseMin(s.to_mm);
    left.max_mm = left.max_mm.cwiseMax(s.from_mm).cwiseMax(s.to_mm);
    left.carve_mm += (s.to_mm - s.from_mm).norm();
    left.travel_mm += (s.from_mm - at).norm();
    left.duration_s += scratch_time(at, s.from_mm, s.to_mm, s.depth_mm, machine).total_s();
    at = s.to_mm;
    left.order.push_back(step);
    left.scratches.push_back(s);
  }
  left.file_order_travel_mm = left.travel_mm;
  return left;
}

std::vector<GcodePart> gcode_parts(const Toolpath& path, const MachineProfile& machine,
                                   const ToolpathOptions& options) {
  const auto parts = split(path, machine, options.part_s);
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

std::string svg(const Toolpath& path, const Eigen::Vector2d& board_size_mm, int decimals) {
  const std::string width = shortest(board_size_mm.x()), height = shortest(board_size_mm.y());
  std::string text =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" version=\"1.1\" width=\"" +
      width + "mm\" height=\"" + height + "mm\" viewBox=\"0 0 " + width + " " + height + "\">\n";
  text += "<g id=\"scratches\" fill=\"none\" stroke=\"black\" stroke-width=\"0.05\">\n";
  const double h = board_size_mm.y();  // SVG's y runs down
  for (const PlannedScratch& s : path.scratches)
    text += "<line x1=\"" + fixed(s.from_mm.x(), decimals) + "\" y1=\"" + fixed(h - s.from_mm.y(), decimals) +
            "\" x2=\"" + fixed(s.to_mm.x(), decimals) + "\" y2=\"" + fixed(h - s.to_mm.y(), decimals) + "\"/>\n";
  return text + "</g>\n</svg>\n";
}

std::string dxf(const Toolpath& path, int decimals) {
  std::string text;
  const auto group = [&text](int code, const std::string& value) {
    text += std::to_string(code) + "\n" + value + "\n";
  };
  const auto point = [&](int code, const Eigen::Vector2d& p) {
    group(code, fixed(p.x(), decimals));
    group(code + 10, fixed(p.y(), decimals));
    group(code + 20, "0");
  };
  group(0, "SECTION"), group(2, "HEADER");
  group(9, "$ACADVER"), group(1, "AC1009");
  group(9, "$INSUNITS"), group(70, "4");     // millimetres
  group(9, "$MEASUREMENT"), group(70, "1");  // metric
  group(9, "$EXTMIN"), point(10, path.min_mm);
  group(9, "$EXTMAX"), point(10, path.max_mm);
  group(0, "ENDSEC");
  group(0, "SECTION"), group(2, "TABLES");
  group(0, "TABLE"), group(2, "LAYER"), group(70, "1");
  group(0, "LAYER"), group(2, "SCRATCHES"), group(70, "0"), group(62, "7"), group(6, "CONTINUOUS");
  group(0, "ENDTAB"), group(0, "ENDSEC");
  group(0, "SECTION"), group(2, "ENTITIES");
  for (const PlannedScratch& s : path.scratches) {
    group(0, "LINE"), group(8, "SCRATCHES");
    point(10, s.from_mm);
    point(11, s.to_mm);
  }
  group(0, "ENDSEC"), group(0, "EOF");
  return text;
}

ToolpathReport write_toolpath(const Scratches& scratches, const Board& board, const Bench* measured,
                              const MachineProfile& machine, const ToolpathOptions& options,
                              const std::filesystem::path& out, const Progress& progress) {
  const std::string extension = extension_of(out);
  const bool is_gcode = extension == ".gcode" || extension == ".nc" || extension == ".ngc";
  if (!is_gcode && extension != ".svg" && extension != ".dxf")
    fail(out.string(), "unknown kind of tool path \"" + extension + "\"", "use .gcode, .nc, .ngc, .svg or .dxf");
  ToolpathReport report;
  ToolpathOptions settings = options;
  if (options.after) {
    std::error_code unknown;
    if (fs::equivalent(options.after->file, out, unknown))
      fail(out.string(), "is the file that was interrupted", "name another one for what is left");
    settings.keep_order = true;  // the interrupted file has the order
  }
  Toolpath path = plan_toolpath(scratches, board, measured, machine, settings, progress);
  if (options.after)
    path = left_after(path, machine, read_text(options.after->file), options.after->line, options.after->file.string());
  report.done_before = path.done_before;
  report.scratch_count = path.scratches.size();
  report.duration_s = path.duration_s;
  report.carve_mm = path.carve_mm;
  report.travel_mm = path.travel_mm;
  report.file_order_travel_mm = path.file_order_travel_mm;
  report.min_mm = path.min_mm, report.max_mm = path.max_mm;
  report.order = path.order;
  report.compensated = path.compensated;
  report.already_carved = path.already_carved;
  report.stepped_mm = path.stepped_mm;
  if (!is_gcode) {
    write_text(extension == ".svg" ? svg(path, board.size_mm, machine.decimals) : dxf(path, machine.decimals), out);
    report.files = {out};
    report.file_duration_s = {path.duration_s};
    return report;
  }
  const std::vector<GcodePart> parts = gcode_parts(path, machine, options);
  report.duration_s = 0;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const fs::path file = part_file(out, k, parts.size());
    write_text(parts[k].text, file);
    report.files.push_back(file);
    report.file_duration_s.push_back(parts[k].duration_s);
    report.duration_s += parts[k].duration_s;
  }
  if (options.frame) {
    const std::string frame = frame_gcode(path, machine);
    report.files.push_back(out.parent_path() / (out.stem().string() + "-frame" + out.extension().string()));
    write_text(frame, report.files.back());
    report.file_duration_s.push_back(replay_gcode(frame, machine, report.files.back().string()).duration_s);
  }
  if (!options.after) remove_stale_parts(out, report.files);
  return report;
}

double duration_from_text(const std::string& text) {
  const auto wrong = [&] {
    fail("duration \"" + text + "\"", "is not understood", "write it like 30min, 45s, 2h or 1h30min");
  };
  double total_s = 0;
  const char* at = text.data();
  const char* const end = at + text.size();
  if (at == end) wrong();
  while (at != end) {
    double value = 0;
    const auto number = std::from_chars(at, end, value, std::chars_format::fixed);
    if (number.ec != std::errc{} || !(value >= 0) || !std::isfinite(value)) wrong();
    at = number.ptr;
    const char* unit_end = at;
    while (unit_end != end && std::isalpha(static_cast<unsigned char>(*unit_end))) ++unit_end;
    const std::string_view unit(at, static_cast<std::size_t>(unit_end - at));
    if (unit == "s")
      total_s += value;
    else if (unit == "min" || unit == "m")
      total_s += 60 * value;
    else if (unit == "h")
      total_s += 3600 * value;
    else
      wrong();
    at = unit_end;
  }
  if (!(total_s > 0)) wrong();
  return total_s;
}

std::string duration_text(double seconds) {
  const long long s = std::llround(seconds);
  if (s < 60) return std::to_string(s) + " s";
  const long long minutes = (s + 30) / 60;
  if (minutes < 60) return std::to_string(minutes) + " min";
  return std::to_string(minutes / 60) + " h " + std::to_string(minutes % 60) + " min";
}

}  // namespace burin

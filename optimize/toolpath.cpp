#include "burin/optimize/toolpath.h"

#include <algorithm>
#include <array>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

#include "burin/base/error.h"
#include "burin/base/files/file_names.h"
#include "burin/base/files/files_together.h"
#include "burin/base/files/input_file.h"
#include "burin/base/files/json_file.h"
#include "burin/optimize/toolpath/gcode_line.h"
#include "burin/optimize/toolpath/release_check.h"
#include "burin/optimize/toolpath/sheet.h"
#include "burin/optimize/toolpath/toolpath_check.h"
#include "burin/scene/parameter_name.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

/// board.gcode, or board-03.gcode for the third of several.
fs::path part_file(const fs::path& out, std::size_t part, std::size_t parts) {
  if (parts == 1) return out;
  const std::size_t digits = std::max<std::size_t>(2, std::to_string(parts).size());
  std::string number = std::to_string(part + 1);
  number.insert(0, digits - std::min(digits, number.size()), '0');
  return out.parent_path() / (out.stem().string() + "-" + number + out.extension().string());
}

/// Leftover files of an earlier run for `out`: a person could carve them. A file with such a name may belong to another
/// job, so its head has to name it as exactly this part of several.
std::vector<fs::path> stale_files(const fs::path& out, const std::vector<fs::path>& written) {
  constexpr std::uintmax_t kHead = 1 << 14;
  const fs::path folder = out.has_parent_path() ? out.parent_path() : fs::path(".");
  std::error_code error;
  std::vector<fs::path> stale;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const fs::path& file = entry.path();
    const auto same_name = [&](const fs::path& other) { return other.filename() == file.filename(); };
    if (!file.filename().native().starts_with(out.stem().native()) || file.extension() != out.extension() ||
        !fs::is_regular_file(file, error) || std::any_of(written.begin(), written.end(), same_name))
      continue;
    const std::optional<GcodeHead> head = read_gcode_head(read_head(file, kHead));
    if (head && same_name(head->parts > 1 ? part_file(out, head->part - 1, head->parts) : out))
      stale.push_back(out.parent_path() / file.filename());
  }
  std::sort(stale.begin(), stale.end());
  return stale;
}

/// Throws Error if a part or a frame, whose name nobody gave, would replace a file of no earlier run.
void fail_unless_ours(const fs::path& file, const fs::path& out) {
  constexpr std::uintmax_t kHead = 1 << 14;
  std::error_code error;
  if (file == out || !fs::exists(file, error)) return;
  const std::string text = read_head(file, kHead);
  const std::optional<GcodeHead> head = read_gcode_head(text);
  const bool part =
      head && head->parts > 1 && part_file(out, head->part - 1, head->parts).filename() == file.filename();
  if (!part && text.find("Burin frame for ") == std::string::npos)
    fail(file.string(), "is there already, and is no part of an earlier " + out.filename().string(),
         "name another --out, or move that file away");
}

/// Throws Error for options that a drawing or a table cannot express.
void fail_unless_drawn(const ToolpathOptions& options, const std::string& extension, const fs::path& out) {
  const auto unable = [&](bool asked, const std::string& what) {
    if (asked)
      fail(out.string(), "holds no " + what + ": " + extension + " has lines only",
           "write G-code (.gcode, .nc, .ngc), or leave that option away");
  };
  unable(options.heights.has_value(), "heights (--heights)");
  unable(options.follow_bow, "heights (--follow-bow)");
  unable(options.frame, "frame (--frame)");
  unable(options.part_s > 0, "parts (--chunks)");
}

/// Reports the layers of a drawing with different depths.
void add_drawing_findings(const DrawingLayers& layers, const fs::path& out, std::vector<Finding>& findings) {
  if (layers.names.size() < 2) return;
  findings.push_back({FindingCode::layers, Finding::Severity::warning, out.string(),
                      "depths differ, and a drawing has none: its scratches lie on " +
                          std::to_string(layers.names.size()) + " layers named by depth, " + layers.names.front() +
                          " to " + layers.names.back(),
                      "give each layer its own depth in the program that reads it"});
}

// G-code gets its name only after it was read back from the disk and replayed.
void write_gcode(const std::string& text, const fs::path& file, const Toolpath& path, const MachineProfile& machine,
                 const std::function<void(Replay&)>& check) {
  write_file(text, file, Durability::on_disk, [&](const fs::path& part) {
    Replay replay = replay_written(part, text, path, machine, file.string());
    check(replay);
  });
}

}  // namespace

bool has_gcode_name(const std::filesystem::path& file) {
  constexpr std::array kNames{".gcode", ".nc", ".ngc", ".cnc", ".tap"};
  return std::find(kNames.begin(), kNames.end(), lower_extension(file)) != kNames.end();
}

ToolpathReport write_toolpath(const Scratches& scratches, const Board& board, const Bench* measured,
                              const MachineProfile& machine, const ToolpathOptions& options,
                              const std::filesystem::path& out, const Progress& progress) {
  const std::string extension = lower_extension(out);
  const bool is_gcode = has_gcode_name(out);
  if (!is_gcode && extension != ".svg" && extension != ".dxf" && extension != ".csv")
    fail(out.string(), "unknown kind of tool path \"" + extension + "\"",
         "use .gcode, .nc, .ngc, .cnc, .tap, .svg, .dxf or .csv");
  if (!is_gcode) fail_unless_drawn(options, extension, out);
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
  report.sent = path.sent;
  report.kept_order = path.kept_order;
  report.compensated = path.compensated;
  report.already_carved = path.already_carved;
  report.stepped_mm = path.stepped_mm;
  report.face = path.face;
  const auto tell = [&](std::string_view stage, std::size_t done, std::size_t of) {
    if (progress) progress(stage, static_cast<double>(done) / static_cast<double>(of));
  };
  if (!is_gcode) {
    tell("writing", 0, 1);
    if (extension == ".csv")
      write_scratches(path.sent.scratches, out);
    else
      write_text(extension == ".svg" ? svg(path, board.size_mm, machine.decimals) : dxf(path, machine.decimals), out);
    if (extension != ".csv") add_drawing_findings(drawing_layers(path), out, report.findings);
    report.files = {out};
    report.file_duration_s = {path.duration_s};
    return report;
  }
  report.findings = sheet_findings(path, board, measured, machine);
  append(report.findings, reach_findings(machine));
  for (const Finding& finding : report.findings)
    if (finding.severity == Finding::Severity::error) fail("tool path", finding.what, finding.remedy);
  tell("making G-code", 0, 1);
  const std::vector<GcodePart> parts = gcode_parts(path, machine, options.part_s);
  report.duration_s = 0;
  FilesTogether all;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const fs::path file = part_file(out, k, parts.size());
    tell("writing and replaying", k, parts.size());
    fail_unless_ours(file, out);
    write_gcode(parts[k].text, file, path, machine, [&](Replay& replay) {
      fail_unless_carves(replay, path, parts[k], machine, file.string());
      report.replayed.insert(report.replayed.end(), replay.scratches.begin(), replay.scratches.end());
    });
    report.files.push_back(file);
    report.file_duration_s.push_back(parts[k].duration_s);
    report.duration_s += parts[k].duration_s;
  }
  if (options.frame) {
    const std::string frame = frame_gcode(path, machine);
    report.files.push_back(out.parent_path() / (out.stem().string() + "-frame" + out.extension().string()));
    fail_unless_ours(report.files.back(), out);
    write_gcode(frame, report.files.back(), path, machine,
                [&](Replay& replay) { report.file_duration_s.push_back(replay.duration_s); });
  }
  if (!options.after) report.removed = stale_files(out, report.files);
  for (const fs::path& file : report.removed) remove_file(file);
  all.put();
  return report;
}

}  // namespace burin

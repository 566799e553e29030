// burin toolpath - writes files for a carving machine from scratches. The work is in burin/optimize/toolpath.h.
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/base/files/file_names.h"
#include "burin/base/files/files_together.h"
#include "burin/base/files/json_file.h"
#include "burin/optimize/duration.h"
#include "burin/optimize/toolpath.h"
#include "burin/optimize/toolpath/carving_limits.h"
#include "burin/optimize/toolpath/height_map.h"
#include "burin/optimize/toolpath/release_check.h"
#include "burin/optimize/toolpath/toolpath_check.h"
#include "burin/scene/bench.h"
#include "burin/scene/bench_of_board.h"
#include "burin/scene/board.h"
#include "burin/scene/scratches.h"
#include "tools/commands.h"
#include "tools/progress_bar.h"
#include "tools/project_settings.h"
#include "tools/steps.h"
#include "tools/work_lock.h"

namespace burin {
namespace {

MachineProfile machine_of(const ToolpathArguments& options) {
  MachineProfile machine = machine_in_project(options.machine, options.scratches);
  if (options.decimals > 0) machine.decimals = options.decimals;
  if (options.max_lines >= 0) machine.max_lines = options.max_lines;
  if (machine.max_lines != 0 && machine.max_lines < kLeastLines)
    fail("--max-lines", fmt::format("is {}", machine.max_lines),
         fmt::format("allow at least {} lines a file, or 0: no limit", kLeastLines));
  return machine;
}

// Returns the scratches to carve: unchanged or, on request, adapted to the machine's limits.
Scratches scratches_of(const ToolpathArguments& options, const Board& board, const Bench* bench,
                       const MachineProfile& machine, ProgressBar& bar) {
  bar.progress()("reading scratches", 0);
  Scratches scratches = read_scratches(options.scratches);
  if (!options.mend) return scratches;
  const CarvingLimits limits = toolpath_limits(board, bench, machine);
  fail_if_crowded(scratches, limits);
  Mended mended = mend(scratches, limits);
  bar.clear();
  if (mended.rows.size() < scratches.size())
    tell(make_warning(FindingCode::scratches_changed,
                      fmt::format("mended: {} of {} scratches are left out, {}", scratches.size() - mended.rows.size(),
                                  scratches.size(), dropped_text(mended.dropped))));
  return std::move(mended.scratches);
}

// Sets the face for the depths, from the options.
void set_face(const ToolpathArguments& options, ToolpathOptions& settings) {
  if (options.follow_bow && options.bench.empty()) throw CLI::RequiresError("--follow-bow", "--bench");
  if (options.follow_bow && !options.heights.empty()) throw CLI::ExcludesError("--follow-bow", "--heights");
  if (!options.heights.empty()) settings.heights = read_heights(options.heights);
  settings.follow_bow = options.follow_bow;
}

// Describes the work zero before carving, and the reference of the depths.
std::string zero_text(const MachineProfile& machine, const ToolpathReport& report) {
  if (machine.depth_by == DepthBy::servo) return "set work zero at the board's lower left corner";
  const std::string where = report.face.followed() ? fmt::format("where the tool touches the face at X{:.2f} Y{:.2f}",
                                                                 report.face.zero_mm.x(), report.face.zero_mm.y())
                                                   : "on its face";
  return fmt::format(
      "set work zero at the board's lower left corner, Z {}",
      by_preload(machine.depth_by) && !report.face.followed() ? "where the tool first touches the face" : where);
}

bool is_drawing(const std::filesystem::path& out) {
  const std::string extension = lower_extension(out);
  return extension == ".svg" || extension == ".dxf" || extension == ".csv";
}

// Returns the command that checks the files before carving; a loop does this itself.
std::vector<std::string> check_command(const ToolpathArguments& options, const ToolpathReport& report) {
  std::vector<std::string> words{
      "burin", "check", "carve", options.scratches.string(), "--board", options.board.string()};
  const auto add = [&](const char* option, const std::string& value) {
    if (!value.empty()) words.insert(words.end(), {option, value});
  };
  add("--bench", options.bench.string());
  add("--machine", options.machine);
  add("--heights", options.heights.string());
  if (options.follow_bow) words.emplace_back("--follow-bow");
  words.emplace_back("--gcode");
  for (const std::filesystem::path& file : report.files) words.push_back(file.string());
  return words;
}

// Returns the commanded scratches with the G-code's decimals. They are read back from the files, which the machine
// carves.
Scratches told_by(const ToolpathReport& report) {
  Scratches told = report.sent.scratches;
  if (report.replayed.size() != told.size())
    fail(report.files.front().string(),
         fmt::format("carves {} of {}", counted(report.replayed.size(), "scratch"), told.size()),
         "this is a fault in Burin");
  for (std::size_t row = 0; row < told.size(); ++row) {
    const ReplayedScratch& s = report.replayed[row];
    told.x0_mm[row] = s.from_mm.x(), told.y0_mm[row] = s.from_mm.y();
    told.x1_mm[row] = s.to_mm.x(), told.y1_mm[row] = s.to_mm.y();
    // A pressing head gets a force instead of a depth.
    if (!told.depth_um.empty() && std::isfinite(s.depth_mm)) told.depth_um[row] = 1e3 * s.depth_mm;
  }
  return told;
}

// The files, in carving order, and the path over all of them.
void report_files(const ToolpathReport& path, const MachineProfile& machine, Report& report) {
  for (std::size_t i = 0; i < path.files.size(); ++i) {
    Facts file = report.add("gcode");
    file.set("time", path.file_duration_s[i], "s");
    file.line("{}  {}\n", fact("file", path.files[i].string()), duration_text(path.file_duration_s[i]));
  }
  for (const std::filesystem::path& file : path.removed)
    report.add("removed").line("{}  removed: it was part of an earlier tool path of this name\n",
                               fact("file", file.string()));
  Facts all = report.all();
  all.set("compensated", path.compensated);
  all.set("extent", {{path.min_mm.x(), path.min_mm.y()}, {path.max_mm.x(), path.max_mm.y()}}, "mm");
  all.line("covers X {:.2f} to {:.2f}, Y {:.2f} to {:.2f} mm; {}\n", path.min_mm.x(), path.max_mm.x(), path.min_mm.y(),
           path.max_mm.y(), path.compensated ? "compensated by the measured machine.affine" : "not compensated");
  if (path.already_carved > 0) {
    all.set("already_carved", path.already_carved);
    all.line("{} carved already and left out\n", counted(path.already_carved, "scratch"));
  }
  if (path.stepped_mm > kOnStep_mm)
    all.line("the machine's steps of {:g} mm move ends by up to {:.4f} mm\n", machine.limits.step_mm,
             fact("largest_rounding", path.stepped_mm, "mm"));
  all.line("carves {:.1f} m, travels {:.1f} m in the air ({:.1f} m in the file's own order)\n",
           fact("carved_length", path.carve_mm / 1000, "m"), fact("travel", path.travel_mm / 1000, "m"),
           fact("travel_in_file_order", path.file_order_travel_mm / 1000, "m"));
  all.set("kept_order", path.kept_order);
  all.set("scratches", path.scratch_count);
  all.set("machine", machine.name);
  all.set("time", path.duration_s, "s");
}

Report write(const ToolpathArguments& options) {
  if (is_drawing(options.out) && options.max_lines >= 0)
    fail(options.out.string(), "is no G-code, and --max-lines splits G-code", "leave it away");
  const WorkLock lock(options.out.parent_path(), "burin toolpath", WorkLock::Where::projects);
  const MachineProfile machine = machine_of(options);
  const Board board = read_board(options.board);
  std::optional<Bench> bench;
  if (!options.bench.empty()) bench = read_bench_of(board, options.board, options.bench);
  if (bench)
    for (const Finding& finding : bench->findings) tell(finding);
  ProgressBar bar;
  const Scratches scratches = scratches_of(options, board, bench ? &*bench : nullptr, machine, bar);
  ToolpathOptions settings;
  set_face(options, settings);
  if (options.order == "keep") settings.keep_order = true;
  if (options.order == "short") settings.keep_order = false;
  settings.frame = options.frame;
  if (!options.part.empty()) settings.part_s = duration_from_text(options.part);
  if (!options.resume.empty()) settings.after = Interruption{options.resume, options.at_line};

  FilesTogether all;
  const ToolpathReport report =
      write_toolpath(scratches, board, bench ? &*bench : nullptr, machine, settings, options.out, bar.progress());
  if (!options.drawing.empty()) {
    ToolpathOptions whole = settings;  // without features that a drawing cannot have
    whole.frame = whole.follow_bow = false;
    whole.part_s = 0;
    whole.heights.reset();
    write_toolpath(scratches, board, bench ? &*bench : nullptr, machine, whole, options.drawing, bar.progress());
  }
  bar.progress()("writing", 0);
  if (!options.sent.empty()) {
    write_scratches(is_drawing(options.out) ? report.sent.scratches : told_by(report), options.sent);
  }
  all.put();
  bar.clear();
  for (const Finding& finding : report.findings) tell(finding);

  Report out;
  report_files(report, machine, out);
  if (report.kept_order && settings.after == std::nullopt)
    out.line("in the file's order{}\n", settings.keep_order.has_value()
                                            ? ""
                                            : ", which the board is designed for: on this bench it shows (wear, or the "
                                              "groove carved last rules at crossings)");
  if (!options.resume.empty()) {
    const CarvingStep& next = report.order.front();
    out.all().set("done_before", report.done_before);
    out.line(
        "{}: {} done before line {}; the first that is left is row {} of {}. Controllers are told lines "
        "ahead of what they carve: look whether the last ones are there, and name an earlier line if not.\n",
        options.resume.string(), counted(report.done_before, "scratch"), options.at_line,
        fact("first_row", next.scratch + 1), options.scratches.string());
    out.line(
        "Wrote the {} left, about {}: home the machine, set work zero where it was, and carve{}; then go on "
        "with the next file.\n",
        counted(report.scratch_count, "scratch"), duration_text(report.duration_s),
        options.frame ? " (the frame first: it goes round them in the air)" : "");
    return out;
  }
  if (!is_drawing(options.out) && !is_in_round(options.out)) out.next.push_back(check_command(options, report));
  out.line("Wrote {} for {}, about {}: {}{}\n", counted(report.scratch_count, "scratch"), machine.name,
           duration_text(report.duration_s), zero_text(machine, report),
           out.next.empty() ? "." : "; next: " + command_text(out.next.front()));
  return out;
}

Report replay(const ToolpathArguments& options) {
  const MachineProfile machine = machine_of(options);
  const Board board = read_board(options.board);
  std::optional<Bench> bench;
  if (!options.bench.empty()) bench = read_bench_of(board, options.board, options.bench);
  ToolpathOptions settings;
  settings.keep_order = true;
  set_face(options, settings);
  const Bench* const measured = bench ? &*bench : nullptr;
  ProgressBar bar;
  const Toolpath planned = plan_toolpath(scratches_of(options, board, measured, machine, bar), board, measured, machine,
                                         settings, bar.progress());
  std::vector<ReplayedScratch> carved;
  double duration_s = 0;
  Report report;
  for (const std::filesystem::path& file : options.replay) {
    bar.progress()("replaying", 0);
    const Replay done = fail_unless_released(read_text(file), machine, planned.workpiece, planned.face, file.string());
    fail_unless_ended(done, machine, file.string());
    bar.clear();
    carved.insert(carved.end(), done.scratches.begin(), done.scratches.end());
    duration_s += done.duration_s;
    Facts of = report.add("gcode");
    of.set("lines", done.lines);
    of.set("scratches", done.scratches.size());
    of.set("time", done.duration_s, "s");
    of.set("extent",
           {{done.min_mm.x(), done.min_mm.y(), done.min_mm.z()}, {done.max_mm.x(), done.max_mm.y(), done.max_mm.z()}},
           "mm");
    of.line("{}: {}, {}, {:.1f} m in the metal, {:.1f} m in the air, {}\n", fact("file", file.string()),
            counted(done.lines, "line"), counted(done.scratches.size(), "scratch"),
            fact("carved_length", done.carve_mm / 1000, "m"), fact("travel", done.travel_mm / 1000, "m"),
            duration_text(done.duration_s));
    of.line("  X {:.3f} to {:.3f}, Y {:.3f} to {:.3f}, Z {:.3f} to {:.3f} mm\n", done.min_mm.x(), done.max_mm.x(),
            done.min_mm.y(), done.max_mm.y(), done.min_mm.z(), done.max_mm.z());
  }
  bar.progress()("comparing with what was planned", 0);
  fail_unless_good(check_toolpath(carved, planned.scratches, 1e-3, depth_share(planned.face)),
                   options.replay.front().string());
  bar.clear();
  report.all().set("scratches", carved.size());
  report.all().set("time", duration_s, "s");
  report.line("Replayed: {}, each carved once and as planned, in about {} on {}.\n", counted(carved.size(), "scratch"),
              duration_text(duration_s), fact("machine", machine.name));
  return report;
}

}  // namespace

Report run_toolpath(const ToolpathArguments& arguments) {
  return arguments.replay.empty() ? write(arguments) : replay(arguments);
}

void add_toolpath_options(CLI::App& command, ToolpathArguments& options) {
  command
      .add_option("--chunks", options.part,
                  "Split G-code into files of about this carving time: 30min, or a number of seconds")
      ->check(wrong_duration);
  command
      .add_option("--decimals", options.decimals,
                  "Write coordinates with this number of decimals [default: the machine's]")
      ->check(CLI::Range(2, 6));
  command
      .add_option("--max-lines", options.max_lines,
                  "Split G-code into files of at most this number of lines; 0: one file [default: the machine's]")
      ->check(CLI::Range(0, 100000000));
  command.add_flag("--mend", options.mend,
                   "Repair scratches that break the machine's limits by moving or dropping them");
  command
      .add_option("--order", options.order,
                  "Keep the file's order or minimize travel (short) [default: keep if the order shows, else short]")
      ->check(CLI::IsMember({"keep", "short"}));
  command.add_flag("--frame", options.frame, "Also write a file that moves around the scratches in the air");
  command.add_flag("--follow-bow", options.follow_bow,
                   "Follow the measured warp in Z; the sheet must lie as it did in the photos");
}

void add_toolpath_command(CLI::App& burin) {
  auto options = std::make_shared<ToolpathArguments>();
  CLI::App* command = burin.add_subcommand("toolpath", "Write verified machine files for carving scratches");
  command->add_option("SCRATCHES.csv", options->scratches, "Carve these scratches")->required();
  command->add_option("--board", options->board,
                      "Use size, carve area and depth of this board (board.json) [default: the project's]");
  command->add_option("--bench", options->bench,
                      "Compensate the machine.affine of this measured bench.json [default: the project's]");
  command
      ->add_option("--machine", options->machine,
                   "Use this machine instead of the project's: " + built_in_machines() +
                       ", or a burin/machine file (JSON or TOML)")
      ->capture_default_str();
  command->add_option("--heights", options->heights,
                      "Follow this height map from burin probe in Z (heights.json) [default: the round's]");
  CLI::Option* out = command->add_option(
      "--out", options->out,
      "Write this file: .gcode, .nc, .ngc, .cnc, .tap, .csv, or .svg or .dxf with a layer per depth");
  add_toolpath_options(*command, *options);
  command->add_option("--sent", options->sent,
                      "Also write the commanded positions in carving order, as the board's sent.csv");
  command->add_option("--draw", options->drawing, "Also write a drawing of the carved scratches: .svg or .dxf");
  CLI::Option* resume = command->add_option("--resume", options->resume,
                                            "Write the uncarved rest of this interrupted G-code file, in its order");
  resume->needs(command
                    ->add_option("--at-line", options->at_line,
                                 "Resume --resume's file at this line, at which the machine stopped")
                    ->check(CLI::PositiveNumber)
                    ->needs(resume));
  CLI::Option* check = command->add_option(
      "--replay", options->replay, "Verify this G-code (all its parts) against SCRATCHES.csv without writing anything");
  out->excludes(check);
  resume->excludes(check);
  command->footer(example(
      "burin toolpath scratches.csv --board board.json --bench bench.json --machine grbl --out board.gcode\n"
      "  burin toolpath scratches.csv --board board.json --heights heights.json --machine grbl --out board.gcode\n"
      "  burin toolpath scratches.csv --board board.json --bench bench.json --replay board.gcode\n"
      "  burin toolpath scratches.csv --board board.json --bench bench.json --resume board-03.gcode --at-line 812 "
      "--out rest.gcode"));
  command->callback([options, command] {
    if (options->out.empty() && options->replay.empty()) throw CLI::RequiredError("--out FILE (or --replay FILE)");
    if (const std::optional<ProjectSettings> project = settings_around(options->scratches))
      take_from_project(*command, *project,
                        {.machine = &options->machine,
                         .board = &options->board,
                         .bench = &options->bench,
                         .heights = &options->heights,
                         .follow_bow = &options->follow_bow});
    if (options->board.empty()) throw CLI::RequiredError("--board");
    print(run_toolpath(*options));
  });
}

}  // namespace burin

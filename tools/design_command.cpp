#include <CLI/App.hpp>
#include <CLI/Error.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/base/files/named_paths.h"
#include "burin/base/files/write_file.h"
#include "burin/optimize/design.h"
#include "burin/optimize/design/design_output.h"
#include "burin/optimize/duration.h"
#include "burin/optimize/machine_profile.h"
#include "burin/optimize/toolpath/release_check.h"
#include "burin/pictures/picture.h"
#include "burin/scene/bench_of_board.h"
#include "burin/scene/carve.h"
#include "burin/scene/scratches.h"
#include "tools/commands.h"
#include "tools/kept_memory.h"
#include "tools/picture_quality.h"
#include "tools/progress_bar.h"
#include "tools/project.h"
#include "tools/steps.h"
#include "tools/stop_signal.h"
#include "tools/work_lock.h"

namespace burin {
namespace {

// All views side by side above their targets, as one picture with updates during the work.
class LivePreview {
 public:
  LivePreview(std::filesystem::path file, double every_s) : file_(std::move(file)), every_s_(every_s) {}

  void show(const DesignFrame& frame) {
    const auto now = std::chrono::steady_clock::now();
    if (shown_ && std::chrono::duration<double>(now - last_).count() < every_s_) return;
    std::vector<Image> row;
    for (const Image* picture : frame.pictures) row.push_back(*picture);
    write_picture(tiled({row}, 4), file_);
    last_ = std::chrono::steady_clock::now();
    shown_ = true;
  }

 private:
  std::filesystem::path file_;
  double every_s_;
  std::chrono::steady_clock::time_point last_;
  bool shown_ = false;
};

// Times at which the views' mean first reached each whole number of dB, and time of the first evaluation. Evaluates
// grooves as they will be carved, like the table.
class QualityOverTime {
 public:
  void add(const DesignFrame& frame) {
    if (!frame.psnr_db) return;
    if (reached_.empty()) reached_.push_back({std::floor(10 * *frame.psnr_db) / 10, frame.seconds});
    for (double next = std::floor(reached_.back().db) + 1; next <= *frame.psnr_db; ++next)
      reached_.push_back({next, frame.seconds});
    last_db_ = *frame.psnr_db;
  }
  /// "23.1 dB after 1.4 s, 24 after 2.0, ..."; empty without evaluations. Omits levels above the finished design's and
  /// far below it. With ambient light, exposures during the work differ from the best ones. If the end exceeds the last
  /// evaluation by more than half a dB, the line adds this.
  std::string line(double end_db) const {
    constexpr double kAlike = 0.5, kLast = 10;  // dB
    std::string line;
    for (const Reached& r : reached_)
      if (line.empty())
        line = fmt::format("{:.1f} dB after {:.1f} s", r.db, r.seconds);
      else if (r.db <= end_db && r.db > end_db - kLast)
        line += fmt::format(", {:.0f} after {:.1f}", r.db, r.seconds);
    if (line.empty() || end_db < last_db_ + kAlike) return line;
    return line + fmt::format("; {:.1f} at the exposures that show them best", end_db);
  }

 private:
  struct Reached {
    double db = 0, seconds = 0;
  };
  std::vector<Reached> reached_;
  double last_db_ = 0;
};

// The command that continues a design from its scratches.
std::vector<std::string> continued(const DesignArguments& o, const std::filesystem::path& from,
                                   const std::vector<std::string>& more = {}) {
  std::vector<std::string> words{"burin", "design", o.spec.string(), "--out", o.out.string(), "--from", from.string()};
  words.insert(words.end(), more.begin(), more.end());
  const auto add = [&](const char* option, const std::string& value) {
    if (!value.empty()) words.insert(words.end(), {option, value});
  };
  add("--bench", o.bench.string());
  add("--board", o.board.string());
  for (const std::filesystem::path& file : o.carved) add("--carved", file.string());
  add("--machine", o.machine);
  if (o.depth_um > 0) add("--depth", shortest(o.depth_um));
  return words;
}

// A full disk at the end must not lose hours of work. If the whole result cannot be written, the scratches alone may
// still fit, under a name of its own.
void write_or_keep(const DesignResult& result, const DesignSpec& spec, const Board& board, const Bench& bench,
                   const DesignArguments& o) {
  const std::filesystem::path kept = o.out / "scratches-kept.csv";
  try {
    write_design_result(result, spec, board, bench, o.out);
    remove_file(kept);
  } catch (const Error& error) {
    try {
      write_scratches(result.scratches, kept);
    } catch (const Error&) {
      throw error;
    }
    throw Error(fmt::format("{}. The scratches alone found room. Make some for the rest, and write it with: {}",
                            error.what(),
                            command_text(continued(o, kept, {"--iterations", "0", "--drop-error", "0"}))));
  }
}

// Rows without a depth get the bench's, so that they carry it themselves.
void give_depth(double depth_um, Scratches& rows) {
  if (rows.depth_um.empty()) rows.depth_um.assign(rows.size(), depth_um);
}

int longer_side(const Image& image) { return std::max(image.width, image.height); }

// Prints each view's PSNR at the eye's resolution, and in the pixels to which the design fitted it.
void report_views(const DesignResult& result, Report& report) {
  const int eye_px = result.eye_px, own_px = longer_side(result.views.front().shown);
  const auto of = [](int px) { return fmt::format("({} px)", px); };
  report.line("view        PSNR dB     fitted   SSIM   plain face   own / highest other target's correlation\n");
  report.line("            {:<8}  {:>8}          {}\n", of(eye_px), of(own_px), of(own_px));
  for (std::size_t k = 0; k < result.views.size(); ++k) {
    const DesignedView& v = result.views[k];
    Facts view = report.add("views");
    view.line("{:<10}  {:7.2f}   {:8.2f}  {:5.3f}   {:7.2f} dB   {:5.2f} / {:5.2f}\n", fact("view", v.view),
              fact("eye_psnr", v.eye_psnr_db, "dB"), fact("psnr", v.psnr_db, "dB"), fact("ssim", v.ssim),
              fact("plain_face_psnr", v.achievable_psnr_db, "dB"), fact("own_correlation", v.ghost[k]),
              fact("highest_other_correlation", highest_other(v.ghost, k)));
    if (v.color)
      view.line("            in color: red {:.2f}, green {:.2f}, blue {:.2f} dB, luminance {:.2f} dB {}\n",
                fact("red_psnr", v.color->quality.channel_psnr_db[0], "dB"),
                fact("green_psnr", v.color->quality.channel_psnr_db[1], "dB"),
                fact("blue_psnr", v.color->quality.channel_psnr_db[2], "dB"),
                fact("luminance_psnr", v.color->quality.luminance_psnr_db, "dB"), of(own_px));
  }
  report.all().set("pixels", own_px);
  report.line(
      "{} px along the longer side are what eyes {:.2g} m away tell apart: compare designs by them. Fitted: the "
      "design's own pixels, which flatter it. Plain face: the target, if nothing but the plain face's own light were "
      "wrong; grooves that cover the face may come nearer.\n",
      fact("eye_pixels", eye_px), fact("eye_distance", result.eye_from_m, "m"));
}

Report report_of(const DesignResult& result, const DesignSpec& spec, const DesignOptions& options,
                 const QualityOverTime& quality, const DesignArguments& o) {
  Report report;
  report_views(result, report);
  for (std::size_t k = 0; k < result.tolerance.size(); ++k)
    report.line("{}\n", tolerance_text(result.views[k].view, result.tolerance[k]));
  const std::size_t kept = result.scratches.size() - result.carved;
  Facts all = report.all();
  all.set("iterations", result.history.size() - 1);
  all.set("started_with", result.started_with);
  all.line("loss {:.0f} -> {:.0f} in {}; {:.1f} s in all; {} of {} kept\n",
           fact("first_loss", result.history.front().loss), fact("final_loss", result.final_loss),
           counted(result.history.size() - 1, "iteration"), fact("time", result.total_seconds, "s"),
           fact("scratches", kept), counted(result.started_with, "scratch"));
  double mean_db = 0;
  for (const DesignedView& v : result.views) mean_db += v.psnr_db / static_cast<double>(result.views.size());
  all.set("mean_psnr", mean_db, "dB");
  if (const std::string line = quality.line(mean_db); !line.empty())
    all.line("mean of the views, of {} px: {}\n", longer_side(result.views.front().shown), line);
  if (const std::string dropped = dropped_text(result.dropped_by_rule); !dropped.empty())
    all.line("left out because they could not obey the machine's and the board's limits: {}\n",
             fact("dropped_by_rule", dropped));
  if (result.carved > 0)
    all.line("{} new; {} carved already, which stay as they are (column \"carved\")\n", counted(kept, "scratch"),
             fact("carved_already", result.carved));
  if (!result.curve.empty())
    all.line("{:.2f} hours to carve on {}; what fewer would show: carving-curve.svg\n",
             fact("carving_time", result.curve.front().hours, "h"), fact("machine", options.carve_machine.name));
  if (result.width_um) all.line("width_um {:.1f}\n", fact("width", *result.width_um, "um"));
  if (result.depth_um) all.line("depth_um {:.2f}\n", fact("depth", *result.depth_um, "um"));
  if (result.alpha) all.line("alpha {:.4f}\n", fact("alpha", *result.alpha));
  all.set("stopped_early", result.stopped_early);
  if (result.stopped_early) {
    report.next.push_back(continued(o, o.out / "scratches.csv"));
    all.line("Stopped early. Go on with: {}\n", command_text(report.next.back()));
  }
  if (is_in_round(o.out)) {
    all.line("Wrote {}: look at preview-*.png.\n", o.out.string());
    return report;
  }
  std::vector<std::string> words{"burin",
                                 "toolpath",
                                 (o.out / "scratches.csv").string(),
                                 "--board",
                                 spec.board.lexically_normal().string(),
                                 "--bench",
                                 spec.bench.lexically_normal().string()};
  if (!o.machine.empty()) words.insert(words.end(), {"--machine", o.machine});
  words.insert(words.end(), {"--out", (o.out / "board.gcode").string()});
  report.next.push_back(words);
  all.line("Wrote {}: look at preview-*.png; next: {}\n", o.out.string(), command_text(words));
  return report;
}

}  // namespace

DesignDone run_design(const DesignArguments& o) {
  DesignSpec spec = read_design(o.spec);
  if (!o.bench.empty()) spec.bench = o.bench;
  if (!o.board.empty()) spec.board = o.board;
  if (o.scratches > 0) spec.scratches = o.scratches;
  const Board board = read_board(spec.board);
  const Bench as_known = read_bench_of(board, spec.board, spec.bench);
  Bench bench = as_known;
  if (o.depth_um > 0) bench.material.depth_um = o.depth_um;
  for (const Finding& finding : bench.findings) tell(finding);
  for (const Finding& finding : height_findings(board, spec.board)) tell(finding);
  DesignOptions options = o.design;
  options.start = o.start == "guided" ? Start::guided : Start::random;
  for (const std::string& name : o.free) {
    options.optimize_width = options.optimize_width || name == "width";
    options.optimize_depth = options.optimize_depth || name == "depth";
    options.optimize_alpha = options.optimize_alpha || name == "alpha";
  }
  options.exposure_of = o.exposure == "view" ? ExposureOf::view : ExposureOf::light;
  if (!o.time.empty()) options.time_limit_s = duration_from_text(o.time, 1);
  if (!o.carve_time.empty()) options.carve_hours = duration_from_text(o.carve_time) / 3600;
  if (!o.from.empty()) options.from = read_scratches(o.from);
  if (!o.machine.empty()) {
    options.carve_machine = machine_profile(o.machine);
    options.machine = options.carve_machine.limits;
  }
  Bench whole = as_known;  // crossings are known only when all rows are together
  whole.crossings = Crossings::add;
  for (const std::filesystem::path& file : o.carved) {
    Scratches carved = carve(Sent(read_scratches(file)), whole, board).scratches;
    if (o.depth_um > 0) give_depth(as_known.material.depth_um, carved);
    options.carved = joined(options.carved, carved, board.tool_width_um, bench.material.depth_um, bench.material.alpha);
  }
  if (!o.from.empty()) allow_change_of(o.from);                     // the output folder may be the continued design
  fail_if_input(o.out / "scratches.csv", o.out / "scratches.csv");  // before the work
  const WorkLock lock(o.out, "burin design", WorkLock::Where::new_folders);

  ProgressBar bar;
  std::optional<StopOnSignal> keeps;  // starts with the first result
  options.stop = &StopOnSignal::asked;
  LivePreview live(o.out / "live.png", 2);
  std::string reached;
  QualityOverTime quality;
  options.watch = [&](const DesignFrame& frame) {
    if (!keeps) keeps.emplace();
    if (o.live) live.show(frame);
    quality.add(frame);
    if (frame.psnr_db) reached = fmt::format(": {:.1f} dB", *frame.psnr_db);
  };
  const Progress on_terminal = bar.progress();
  const Progress with_quality = [&](std::string_view stage, double fraction) {
    on_terminal(std::string(stage) + (stage == "designing" ? reached : ""), fraction);
  };
  std::size_t told = 0;  // number of findings before the work began
  options.found = [&](const std::vector<Finding>& findings) {
    bar.clear();
    for (const Finding& finding : findings) tell(finding);
    told = findings.size();
  };
  const KeptMemory kept;
  DesignResult result = design(spec, board, bench, options, with_quality);
  if (o.depth_um > 0) give_depth(o.depth_um, result.scratches);
  result.stopped_early = result.stopped_early || StopOnSignal::asked();  // at any point of the request
  write_or_keep(result, spec, board, bench, o);
  bar.clear();

  for (std::size_t i = told; i < result.findings.size(); ++i) tell(result.findings[i]);
  return {report_of(result, spec, options, quality, o), result.stopped_early};
}

namespace {

// Lists the rarely used options from index `first` on below the others in the help.
void set_seldom_ones_apart(CLI::App& command, std::size_t first) {
  const std::set<std::string> often{"--count", "--time", "--pixels", "--carve-time", "--from"};
  const std::vector<CLI::Option*> all = command.get_options();
  for (std::size_t i = first; i < all.size(); ++i)
    if (!often.contains(all[i]->get_name())) all[i]->group(kSeldom);
}

void add_search_options(CLI::App& command, DesignArguments& o) {
  command.add_option("--count", o.scratches, "Start with this number of scratches [default: DESIGN.json's]")
      ->check(CLI::Range(1, 2000000));
  command.add_option("--iterations", o.design.iterations,
                     "Run 0 to 1000000 optimizer iterations [default: 160; 70 if grooves cut]");
  command
      .add_option("--time", o.time,
                  "Limit the whole design to about this time: 30s, 5min, 1h30min, or a number of seconds")
      ->check(wrong_duration);
  command
      .add_option("--pixels", o.design.pixels,
                  "Set the pixels along the carve area's longer side, 16 to 8192; 0: automatic, at most 512")
      ->capture_default_str();
  command.add_option("--seed", o.design.seed, "Set the random seed of the start and of the re-insertion searches")
      ->capture_default_str();
  command
      .add_option("--start", o.start,
                  "Start from a greedy search for the targets (guided) or at random places (random)")
      ->check(CLI::IsMember({"guided", "random"}))
      ->capture_default_str();
  command.add_option("--from", o.from, "Continue from these scratches (CSV) instead of a new start")->type_name(kFile);
  command.add_option("--carved", o.carved, "Design around existing grooves, given by their commanded positions (CSV)")
      ->type_name(kFile);
  add_length_option(command, "--start-length", o.design.start_length_mm,
                    "Set the scratches' mean initial length; searches allow a tenth to ten times it [default: auto]");
  command
      .add_option("--start-light", o.design.start_light,
                  "Set the light that a scratch adds to a crossed pixel in a guided start, fraction of white")
      ->capture_default_str();
  command
      .add_option("--lift-blacks", o.design.lift_blacks,
                  "Lift black to a reachable gray under light from all sides, strength 0 (off) to 1")
      ->capture_default_str();
  command
      .add_option("--start-sweeps", o.design.start_sweeps,
                  "Improve each scratch's place this number of times in a guided start")
      ->capture_default_str();
  command
      .add_option("--relocate-every", o.design.relocate_every,
                  "Set the number of iterations between re-insertion searches; 0: none")
      ->capture_default_str();
  command
      .add_option("--candidates", o.design.candidates,
                  "Try this number of places per scratch in each re-insertion search, 1 to 10000")
      ->capture_default_str();
  command
      .add_option("--relocate-share", o.design.relocate_share,
                  "Let each re-insertion search move this share of the scratches to another view")
      ->capture_default_str();
  command
      .add_option("--balance", o.design.balance,
                  "Set the strength of view reweighting toward poor views, 0 (off) to 10")
      ->capture_default_str();
  command
      .add_option("--relocate-until", o.design.relocate_until,
                  "End re-insertion searches after this share of the run; less if grooves cut each other")
      ->capture_default_str();
  command
      .add_option("--start-exposure", o.design.start_exposure,
                  "Scale the initial exposure of a random start, as a factor of the one that matches means")
      ->capture_default_str();
  command.add_option("--rate", o.design.rate,
                     "Set Adam's initial learning rate, fraction of the board's edges [default: auto]");
  command.add_option("--final-rate", o.design.final_rate,
                     "Set Adam's final learning rate, fraction of the board's edges [default: auto]");
}

void add_outcome_options(CLI::App& command, DesignArguments& o) {
  command.add_option("--perceptual", o.design.loss.perceptual, "Set the weight of the perceptual loss")
      ->capture_default_str();
  command.add_option("--l2", o.design.loss.l2, "Set the weight of the squared-error loss")->capture_default_str();
  command.add_option("--gram", o.design.loss.gram, "Set the weight of the Gram loss (local contrast)")
      ->capture_default_str();
  command.add_option("--exposure-of", o.exposure, "Give each view (eyes adapt) or each light an exposure of its own")
      ->check(CLI::IsMember({"light", "view"}))
      ->capture_default_str();
  add_length_option(command, "--tolerance", o.design.tolerance_mm,
                    "Design for viewpoints and lamps off by up to this length, and report the viewing zone");
  command
      .add_option("--carve-time", o.carve_time,
                  "Prune scratches until carving takes at most this time: 6h30min, or a number of seconds")
      ->check(wrong_duration);
  command.add_flag("--carve-curve", o.design.carve_curve,
                   "Report quality over carving time; always on with --carve-time");
  command.add_flag("--report-tolerance", o.design.report_tolerance,
                   "Report the viewing zone of eye and lamp without designing for it");
  add_length_option(command, "--depth", o.depth_um,
                    "Set the depth of the new grooves, um or with a unit, for the tool path too [default: the bench's]",
                    "um");
  command
      .add_option("--free", o.free,
                  "Optimize the cutter's width, the depth or the roughness alpha, one value for all scratches; repeat")
      ->take_all()
      ->expected(1)
      ->check(CLI::IsMember({"width", "depth", "alpha"}));
  command
      .add_option("--min-length", o.design.min_length,
                  "Set the shortest scratch, fraction of the board's longer edge, below 0.5")
      ->capture_default_str();
  add_length_option(command, "--max-length", o.design.max_length_mm, "Set the longest scratch; 0: no limit");
  command
      .add_option("--drop-error", o.design.drop_error,
                  "Prune the weakest scratches while the squared error rises by at most this share")
      ->capture_default_str();
  command.add_option("--drop-light", o.design.drop_light,
                     "Prune the weakest scratches that carry this share of the light, instead of --drop-error");
  command.add_option("--drop-share", o.design.drop_share,
                     "Prune this share of the scratches, 0 to 1, instead of --drop-error");
}

}  // namespace

void add_design_options(CLI::App& command, DesignArguments& o) {
  const std::size_t first = command.get_options().size();
  add_search_options(command, o);
  add_outcome_options(command, o);
  set_seldom_ones_apart(command, first);
}

void add_design_command(CLI::App& burin) {
  auto o = std::make_shared<DesignArguments>();
  CLI::App* c =
      burin.add_subcommand("design", "Optimize the scratches that show target pictures in a nominal or measured setup");
  c->add_option("DESIGN.json", o->spec, "Read the targets, views and files of the design from this file")->required();
  c->add_option("--out", o->out, "Write scratches.csv, previews and the report to this folder")->required();
  c->add_option("--bench", o->bench, "Design for this setup (bench.json) [default: DESIGN.json's]");
  c->add_option("--board", o->board, "Design for this board (board.json) [default: DESIGN.json's]");
  c->add_option("--machine", o->machine,
                "Obey limits and time of this machine: " + built_in_machines() +
                    ", or a burin/machine file (JSON or TOML) [default: grbl's time, no limits]");
  add_design_options(*c, *o);
  c->add_flag("--live", o->live, "Refresh the preview OUT/live.png during the run");
  c->footer(example("burin design design.json --out round-01"));
  c->callback([o] { print(run_design(*o).report); });
}

}  // namespace burin

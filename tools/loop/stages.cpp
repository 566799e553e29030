#include "tools/loop/stages.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/base/files/files_together.h"
#include "burin/base/files/input_file.h"
#include "burin/base/files/json_file.h"
#include "burin/base/files/named_paths.h"
#include "burin/base/files/unfinished.h"
#include "burin/base/limits.h"
#include "burin/optimize/design_file.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"
#include "tools/commands.h"
#include "tools/loop/round_depth.h"
#include "tools/loop/round_design.h"
#include "tools/loop/round_lamps.h"
#include "tools/steps.h"
#include "tools/stop_signal.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

// A step of the loop: the arguments of a command's function, and the command line that a person would give for the
// same. Each is set together with the other.
template <typename Arguments>
class Step {
 public:
  explicit Step(std::vector<std::string> command) : words_(std::move(command)) {}

  /// An option, or an argument without a name.
  Step& set(const std::string& option, fs::path& field, const fs::path& value) {
    field = value;
    return say(option, value.string());
  }
  Step& set(const std::string& option, std::string& field, const std::string& value) {
    field = value;
    return say(option, value);
  }
  Step& set(const std::string& option, bool& field) {
    field = true;
    words_.push_back(option);
    return *this;
  }
  Step& say(const std::string& option, const std::string& value) {
    if (!option.empty()) words_.push_back(option);
    words_.push_back(value);
    return *this;
  }
  /// The project's own options of this command.
  Step& give(const LoopProject& loop, const std::vector<std::string>& words) {
    give_options(loop.options, loop.project.folder, arguments);
    words_.insert(words_.end(), words.begin(), words.end());
    return *this;
  }

  /// Prints the command line, does the work and prints its result.
  template <typename Work>
  void run(const Work& work) const {
    stop_if_asked();
    std::vector<std::string> line{"burin"};
    line.insert(line.end(), words_.begin(), words_.end());
    print_event("step", {{"command", line}}, fmt::format("> {}\n", command_text(line)));
    const Report report = work(arguments);
    print_event("step done", {{"command", line}, {"data", report.data}}, report.text);
    if (report.failure) throw InputError(*report.failure);
  }

  Arguments arguments;

 private:
  std::vector<std::string> words_;
};

// Returns all regular files below a folder except hidden ones; none for a missing folder.
std::vector<fs::path> files_below(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::recursive_directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    if (entry->is_regular_file() && entry->path().filename().string().front() != '.') files.push_back(entry->path());
  std::sort(files.begin(), files.end());
  return files;
}

// Parses a possibly edited file; no object if it is invalid.
Json json_or_broken(const fs::path& file) {
  return Json::parse(read_bytes(file, limit::kJsonBytes, "a JSON file"), nullptr, false);
}

// Adds a bench and its lens. An unreadable bench adds no lens: its user reports the error.
void add_bench(const fs::path& bench, std::set<fs::path>& files) {
  files.insert(bench);
  if (!fs::exists(bench)) return;
  const Json json = json_or_broken(bench);
  if (json.is_object() && json.contains("camera") && json["camera"].is_string())
    files.insert(resolve_path(bench, json["camera"].get<std::string>()));
}

void add_pictures(const DesignSpec& spec, std::set<fs::path>& files) {
  for (const DesignView& view : spec.views) {
    files.insert(view.target.picture);
    if (!view.target.mask.empty()) files.insert(view.target.mask);
  }
}

std::set<fs::path> design_basis(const LoopProject& loop, int round) {
  const Project& project = loop.project;
  const DesignSpec spec = read_design(project.folder / "design.json");
  std::set<fs::path> files{project.folder / "design.json", spec.board};
  add_bench(spec.bench, files);
  if (round > 1) {
    add_bench(project.bench_before(round), files);
    for (const char* file : {"names.json", "design/design-report.json"})  // matches of measured and designed views
      if (fs::exists(project.round(round - 1) / file)) files.insert(project.round(round - 1) / file);
  }
  add_pictures(spec, files);
  for (const fs::path& file : design_option_files(loop.options, project.folder)) files.insert(file);
  return files;
}

std::set<fs::path> toolpath_basis(const LoopProject& loop, int round) {
  const Project& project = loop.project;
  std::set<fs::path> files{project.round(round) / "scratches.csv", project.folder / "board.json"};
  add_bench(project.bench_before(round), files);
  if (const fs::path heights = project.heights(round); !heights.empty()) files.insert(heights);
  for (const fs::path& file : toolpath_option_files(loop.options, project.folder)) files.insert(file);
  return files;
}

std::set<fs::path> check_basis(const LoopProject& loop, int round) {
  const fs::path folder = loop.project.round(round);
  std::set<fs::path> files = toolpath_basis(loop, round);
  for (const StageKind stage : {StageKind::design, StageKind::toolpath})
    for (const fs::path& file : outputs_of(loop, {round, stage})) files.insert(file);
  return files;
}

// Returns the round's measured files, for its page.
std::set<fs::path> report_basis(const LoopProject& loop, int round) {
  const Project& project = loop.project;
  const fs::path folder = project.round(round);
  std::set<fs::path> files{folder / "session.json", folder / "board.json", folder / "sent.csv"};
  for (const fs::path& file : photos_of(project, round)) files.insert(file);
  for (const fs::path& file : outputs_of(loop, {round, StageKind::refine}))
    if (file.parent_path() == folder) files.insert(file);
  return files;
}

std::set<fs::path> whole_report_basis(const LoopProject& loop) {
  const Project& project = loop.project;
  const DesignSpec spec = read_design(project.folder / "design.json");
  std::set<fs::path> files{project.folder / "design.json", project.folder / "board.json", spec.board};
  add_bench(spec.bench, files);
  add_bench(project.folder / "bench.json", files);
  add_pictures(spec, files);
  for (int round = 1; round <= project.rounds(); ++round) {
    files.insert(project.round(round) / "scratches.csv");
    if (has_result(loop, {round, StageKind::refine}))
      for (const fs::path& file : report_basis(loop, round)) files.insert(file);
  }
  return files;
}

// Returns the resolution of the first board, for a comparison with the second one. A board with another model of
// crossings holds another number of grooves, and needs another resolution.
std::optional<int> pixels_of_the_board_before(const Project& project, int number) {
  if (number == 1 ||
      read_bench(project.bench_before(number)).crossings != read_bench(project.bench_before(number - 1)).crossings)
    return std::nullopt;
  return project.pixels(number - 1);
}

bool frees_depth(const LoopOptions& options) {
  const auto free = options.design.find("free");
  return free != options.design.end() && std::count(free->second.begin(), free->second.end(), "depth") > 0;
}

bool make_design(const LoopProject& loop, int number) {
  const Project& project = loop.project;
  const fs::path round = project.round(number);
  write_round_design(project, number, round / "design.json");
  Step<DesignArguments> step({"design"});
  DesignArguments& o = step.arguments;
  step.set("", o.spec, round / "design.json").set("--out", o.out, round / "design");
  step.set("--machine", o.machine, machine_argument(loop.options, project.folder));
  step.give(loop, design_arguments(loop.options, project.folder));
  o.live = true;  // while it works; the page of `burin studio` shows it
  // Tolerances of eye and lamp: for the page before carving, and to identify photos of designed viewpoints.
  if (!loop.options.design.contains("tolerance") && !loop.options.design.contains("report-tolerance"))
    step.set("--report-tolerance", o.design.report_tolerance);
  if (const auto pixels = pixels_of_the_board_before(project, number);
      pixels && !loop.options.design.contains("pixels")) {
    o.design.pixels = *pixels;
    step.say("--pixels", std::to_string(*pixels));
  }
  if (const auto depth = depth_of_round(loop.project, loop.options, number);
      depth && !loop.options.design.contains("depth") && !frees_depth(loop.options)) {
    tell(Finding{FindingCode::depth_chosen,
                 depth->as_wanted() ? Finding::Severity::note : Finding::Severity::warning,
                 {},
                 in_words(*depth),
                 ""});
    o.depth_um = depth->depth_um;
    step.say("--depth", shortest(depth->depth_um));
  }
  bool stopped_early = false;
  step.run([&](const DesignArguments& arguments) {
    DesignDone done = run_design(arguments);
    stopped_early = done.stopped_early;
    std::error_code ignored;
    fs::remove(round / "design" / "live.png", ignored);
    return std::move(done.report);
  });
  if (stopped_early) return false;
  finish_design(loop, number);
  return true;
}

void make_toolpath(const LoopProject& loop, int number) {
  const Project& project = loop.project;
  const fs::path round = project.round(number);
  Step<ToolpathArguments> step({"toolpath"});
  ToolpathArguments& o = step.arguments;
  step.set("", o.scratches, round / "scratches.csv").set("--board", o.board, project.folder / "board.json");
  step.set("--bench", o.bench, project.bench_before(number));
  step.set("--machine", o.machine, machine_argument(loop.options, project.folder));
  step.set("--out", o.out, round / "board.gcode").set("--sent", o.sent, round / "sent.csv");
  step.set("--draw", o.drawing, round / "board.svg");
  if (const fs::path heights = project.heights(number); !heights.empty()) step.set("--heights", o.heights, heights);
  step.give(loop, toolpath_arguments(loop.options, project.folder));
  if (!loop.options.toolpath.contains("frame")) step.set("--frame", o.frame);  // for a test run in the air
  step.run(run_toolpath);
}

// Throws Error if the page has an error, which stops the loop.
void make_check(const LoopProject& loop, int number) {
  Step<CarveCheckArguments> step({"check", "carve"});
  CarveCheckArguments& o = step.arguments;
  step.set("", o.what, loop.project.round(number));
  step.set("--machine", o.files.machine, machine_argument(loop.options, loop.project.folder));
  if (loop.options.toolpath.contains("follow-bow")) step.set("--follow-bow", o.files.follow_bow);
  step.run([](const CarveCheckArguments& arguments) { return run_carve_check(arguments); });
}

void make_board(const Project& project, int number) {
  const fs::path round = project.round(number);
  Board board = read_board(project.folder / "board.json");
  board.scratches = round / "sent.csv";
  write_board(board, round / "board.json");
}

// Simulates the workshop: carves the commanded scratches and photographs them.
void make_photos(const Project& project, int number) {
  const fs::path round = project.round(number), photos = round / "photos", part = round / "workshop.part";
  fs::remove_all(part);
  const Unfinished unfinished(part);
  Step<SimulateArguments> step({"simulate"});
  SimulateArguments& o = step.arguments;
  step.set("", o.truth, project.folder / "truth.json");
  step.set("--scratches", o.simulate.scratches, round / "sent.csv").set("--out", o.out, part);
  step.run(run_simulate);
  const auto whole = finishing();
  sort_by_lamp(part);
  remove_empty_lamp_folders(project, number);
  fs::remove(photos);  // always an empty folder
  fs::rename(part / "photos", photos);
  note_moved(part / "photos", photos);
  fs::remove_all(part);
}

void make_capture(const LoopProject& loop, int number) {
  const Project& project = loop.project;
  const fs::path round = project.round(number);
  Step<CaptureArguments> step({"capture"});
  CaptureArguments& o = step.arguments;
  step.set("", o.photos, round / "photos").set("--board", o.board, round / "board.json");
  step.set("--bench", o.bench, bench_of_photos(project, number)).set("--out", o.out, round);
  if (const std::vector<std::string> lamp = lamp_arguments(project, number); !lamp.empty())
    step.set(lamp.front(), o.light, lamp.back());
  step.give(loop, capture_arguments(loop.options, project.folder));
  step.run(run_capture);
}

void make_refinement(const Project& project, int number) {
  const fs::path round = project.round(number), refinement = round / "refinement";
  fs::remove_all(refinement);
  make_output_folder(refinement);
  for (const fs::path& file : files_below(round / "calibration")) copy_whole(file, refinement / file.filename());
  Step<RefineArguments> step({"refine"});
  step.set("", step.arguments.session, round / "session.json");
  step.set("--bench", step.arguments.bench, refinement / "bench.json");
  step.run(run_refine);
  FilesTogether all;
  for (const fs::path& file : files_below(refinement)) copy_whole(file, round / file.filename());
  all.put();
}

void make_calibration(const Project& project, int number) {
  const fs::path round = project.round(number);
  Step<CalibrateArguments> step({"calibrate"});
  step.set("", step.arguments.session, round / "session.json");
  step.set("--out", step.arguments.out, round / "calibration");
  step.run(run_calibrate);
}

void make_report(const fs::path& folder) {
  Step<ReportArguments> step({"report"});
  step.set("", step.arguments.folder, folder);
  step.run(run_report);
}

}  // namespace

const char* name_of(StageKind stage) {
  switch (stage) {
    case StageKind::design:
      return "design";
    case StageKind::toolpath:
      return "toolpath";
    case StageKind::board:
      return "board";
    case StageKind::check:
      return "check";
    case StageKind::photos:
      return "photos";
    case StageKind::capture:
      return "capture";
    case StageKind::calibrate:
      return "calibrate";
    case StageKind::refine:
      return "refine";
    case StageKind::report:
      return "report";
  }
  return "";
}

std::string name_of(const Project& project, const StageOfRound& at) {
  if (at.round == 0) return name_of(at.stage);
  return project.round(at.round).filename().string() + "/" + name_of(at.stage);
}

fs::path folder_of(const Project& project, const StageOfRound& at) {
  return at.round == 0 ? project.folder : project.round(at.round);
}

fs::path record_file(const Project& project, const StageOfRound& at) {
  return folder_of(project, at) / "made" / (std::string(name_of(at.stage)) + ".json");
}

StageBasis basis_of(const LoopProject& loop, const StageOfRound& at) {
  const Project& project = loop.project;
  if (at.round == 0) return {whole_report_basis(loop), {}};
  const fs::path round = project.round(at.round);
  StageBasis basis;
  switch (at.stage) {
    case StageKind::design:
      return {design_basis(loop, at.round), option_texts(loop.options, loop.options.design)};
    case StageKind::toolpath:
      return {toolpath_basis(loop, at.round), option_texts(loop.options, loop.options.toolpath)};
    case StageKind::board:
      return {{project.folder / "board.json", round / "sent.csv"}, {}};
    case StageKind::check:
      basis = {check_basis(loop, at.round), option_texts(loop.options, loop.options.toolpath)};
      // A reach that is named after the tool path was written is held against it.
      if (const auto& reach = loop.options.travel)
        basis.options["travel"] = fmt::format("{:g} {:g} {:g} {:g}", reach->min_mm.x(), reach->min_mm.y(),
                                              reach->max_mm.x(), reach->max_mm.y());
      return basis;
    case StageKind::photos:
      return {{project.folder / "truth.json", round / "sent.csv"}, {}};
    case StageKind::refine:
      basis.files = {round / "sent.csv", round / "calibration" / "bench.json"};
      add_bench(round / "calibration" / "bench.json", basis.files);
      [[fallthrough]];
    case StageKind::calibrate:
      basis.files.insert(round / "session.json");
      [[fallthrough]];
    case StageKind::capture:
      basis.options = texts_of(loop.options.capture);
      add_bench(project.bench_before(at.round), basis.files);
      add_bench(bench_of_photos(project, at.round), basis.files);  // for its lamps' names
      basis.files.insert(round / "board.json");
      for (const fs::path& photo : photos_of(project, at.round)) basis.files.insert(photo);
      return basis;
    case StageKind::report:
      return {report_basis(loop, at.round), {}};
  }
  return basis;
}

std::vector<fs::path> outputs_of(const LoopProject& loop, const StageOfRound& at) {
  const fs::path folder = folder_of(loop.project, at);
  std::vector<fs::path> files;
  const auto take = [&](const fs::path& file) {
    if (fs::is_regular_file(file)) files.push_back(file);
  };
  switch (at.stage) {
    case StageKind::design:
      files = files_below(folder / "design");
      take(folder / "design.json");
      take(folder / "bench-before.json");
      take(folder / "scratches.csv");
      break;
    case StageKind::toolpath:
      if (fs::is_directory(folder))
        for (const auto& entry : fs::directory_iterator(folder)) {
          const std::string name = entry.path().filename().string();
          if (name.starts_with("board") && entry.path().extension() == ".gcode") take(entry.path());
        }
      take(folder / "board.svg");
      take(folder / "sent.csv");
      break;
    case StageKind::board:
      take(folder / "board.json");
      break;
    case StageKind::check:
      take(folder / "carve-check.html");
      break;
    case StageKind::photos:
      files = photos_of(loop.project, at.round);
      break;
    case StageKind::capture:
      take(folder / "session.json");
      break;
    case StageKind::calibrate:
      files = files_below(folder / "calibration");
      break;
    case StageKind::refine:
      files = files_below(folder / "refinement");
      for (const char* name : {"bench.json", "camera.cameramodel", "residuals.vnl", "hold-out.json"})
        take(folder / name);
      break;
    case StageKind::report:
      take(folder / "report.html");
      take(folder / "rounds.json");  // of the whole loop
      break;
  }
  std::sort(files.begin(), files.end());
  return files;
}

bool has_result(const LoopProject& loop, const StageOfRound& at) {
  const fs::path folder = folder_of(loop.project, at);
  const std::vector<fs::path> files = outputs_of(loop, at);
  const auto there = [&](const char* name) { return fs::is_regular_file(folder / name); };
  switch (at.stage) {
    case StageKind::design:
      return there("scratches.csv");
    case StageKind::toolpath:
      return there("sent.csv") &&
             std::any_of(files.begin(), files.end(), [](const fs::path& file) { return file.extension() == ".gcode"; });
    case StageKind::calibrate:
      return there("calibration/bench.json");
    case StageKind::refine:
      return there("bench.json");
    case StageKind::report:
      return there("report.html");
    default:
      return !files.empty();
  }
}

void finish_design(const LoopProject& loop, int number) {
  const fs::path round = loop.project.round(number);
  copy_whole(round / "design" / "scratches.csv", round / "scratches.csv");
}

bool make_stage(const LoopProject& loop, const StageOfRound& at) {
  const Project& project = loop.project;
  const fs::path round = folder_of(project, at);
  switch (at.stage) {
    case StageKind::design:
      return make_design(loop, at.round);
    case StageKind::toolpath:
      make_toolpath(loop, at.round);
      break;
    case StageKind::board:
      make_board(project, at.round);
      break;
    case StageKind::check:
      make_check(loop, at.round);
      break;
    case StageKind::photos:
      make_photos(project, at.round);
      break;
    case StageKind::capture:
      make_capture(loop, at.round);
      break;
    case StageKind::calibrate:
      make_calibration(project, at.round);
      break;
    case StageKind::refine:
      make_refinement(project, at.round);
      break;
    case StageKind::report:
      make_report(round);
      break;
  }
  return true;
}

std::vector<fs::path> photos_of(const Project& project, int round) { return photos_of_round(project, round); }

bool is_photographed(const Project& project, int round) {
  const fs::path folder = project.round(round);
  return fs::exists(folder / "session.json") || fs::exists(record_file(project, {round, StageKind::capture})) ||
         !photos_of(project, round).empty();
}

int next_to_carve(const Project& project) {
  int round = 1;
  while (is_photographed(project, round)) ++round;
  return round;
}

void require_one_truth_to_carve(const Project& project) {
  const int round = next_to_carve(project);
  if (fs::exists(project.bench_before(round))) require_one_truth(project, round);
}

}  // namespace burin

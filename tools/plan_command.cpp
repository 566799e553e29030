#include <CLI/Error.hpp>
#include <CLI/Validators.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <utility>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/base/files/file_names.h"
#include "burin/base/files/files_together.h"
#include "burin/base/files/json_file.h"
#include "burin/calib/plan.h"
#include "burin/calib/verdict/planned_tags.h"
#include "burin/optimize/design/lamp_places.h"
#include "burin/optimize/design_file.h"
#include "burin/render/brdf.h"
#include "burin/scene/bench_of_board.h"
#include "burin/scene/parameter_name.h"
#include "tools/commands.h"
#include "tools/plan_drawing.h"
#include "tools/plan_words.h"
#include "tools/progress_bar.h"
#include "tools/project_settings.h"
#include "tools/wanted_bench.h"
#include "tools/work_lock.h"

namespace burin {
namespace {

// Before the first photos, the depth is an assumption: prints the plan's results for other depths.
void report_depths(const Plan& plan, Report& report) {
  const auto at = [&](const std::string& name) {
    return static_cast<std::size_t>(std::find_if(plan.parameters.begin(), plan.parameters.end(),
                                                 [&](const PlanParameter& p) { return p.name == name; }) -
                                    plan.parameters.begin());
  };
  const std::size_t depth = at(parameter::kDepth), alpha = at(parameter::kAlpha);
  report.line("\nIf the grooves are not as deep as believed, after all shots:\n");
  for (const PlanAtDepth& d : plan.at_depth) {
    Facts at_depth = report.add("at_depth");
    at_depth.set("depth_sigma", d.sigma[depth], "%");
    at_depth.set("alpha_sigma", d.sigma[alpha], "%");
    at_depth.set("depth_determined", d.straddles);
    at_depth.line("  {:>5.1f} um: depth to {} %, alpha to {} %{}\n", fact("depth", d.depth_um, "um"),
                  significant(d.sigma[depth]), significant(d.sigma[alpha]),
                  d.straddles ? "" : "; the depth stays unknown");
  }
  report.all().set("depth_determined", plan.straddles);
  if (plan.straddles) return;
  report.line(
      "The depth of the grooves stays unknown{}: with this lamp no place has half vectors on both sides of the "
      "grooves' "
      "cut-off. Put the lamp further to the side, or give --lamp-places 2.\n",
      std::any_of(plan.at_depth.begin(), plan.at_depth.end(), [](const PlanAtDepth& d) { return d.straddles; })
          ? " where that is said"
          : "");
}

void report_plan(const Plan& plan, const Board& board, Report& report) {
  report.line("Board on the table, its lower edge towards you; mm above the face, and from the edges.\n");
  std::size_t lamp = plan.bench.lights.size();
  for (std::size_t i = 0; i < plan.shots.size(); ++i) {
    const PlannedShot& shot = plan.shots[i];
    const Light& of = plan.bench.lights[shot.light];
    Facts facts = report.add("shots");
    facts.set("view", shot.view);
    facts.set("lamp", of.id);
    facts.set("lamp_position", to_json(of.position_mm), "mm");
    facts.set("place", place_in_words(shot.camera, board));
    if (shot.light != lamp) {
      lamp = shot.light;
      const Light& light = plan.bench.lights[lamp];
      report.line("     lamp \"{}\" {}\n", light.id, place_in_words(light.position_mm, board));
    }
    report.line("{:3}. {}{}\n     {}\n", i + 1, shot.view.empty() ? "" : "view \"" + shot.view + "\" of the design: ",
                place_in_words(shot.camera, board), exposures_in_words(plan, shot));
  }
  // Sigmas by number of shots: at most six columns.
  std::vector<std::size_t> columns;
  for (const double share : {0., 0.1, 0.25, 0.5, 0.75, 1.})
    columns.push_back(static_cast<std::size_t>(std::lround(share * static_cast<double>(plan.shots.size() - 1))));
  columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
  report.line("\nExpected sigma after {:>13}", "no shot");
  for (const std::size_t c : columns) report.line("{:>9}", c + 1);
  report.line("  shots; good enough\n");
  for (std::size_t p = 0; p < plan.parameters.size(); ++p) {
    const PlanParameter& parameter = plan.parameters[p];
    Facts facts = report.add("parameters");
    facts.set("parameter", parameter.name);
    facts.set("goal", parameter.goal, in_words(parameter.unit));
    facts.set("before", parameter.before, in_words(parameter.unit));
    std::vector<double> after;
    for (const PlannedShot& shot : plan.shots) after.push_back(shot.sigma[p]);
    facts.set("after_shot", after, in_words(parameter.unit));
    const std::string name =
        parameter.unit == Unit::none ? parameter.name : fmt::format("{}, {}", parameter.name, in_words(parameter.unit));
    report.line("  {:<26}{:>6}", name, significant(parameter.before, 3));
    for (const std::size_t c : columns) report.line("{:>9}", significant(plan.shots[c].sigma[p]));
    report.line("{:>12}\n", significant(parameter.goal));
  }
  report_depths(plan, report);
}

// Default bench of a plan: a 50 mm lens on 24 x 36 mm with 6000 x 4000 pixels. Its lamp is beyond the upper edge, one
// and a half board diagonals away.
Bench usual_bench(const Board& board) {
  Bench bench;
  constexpr int kWidth = 6000, kHeight = 4000;
  bench.lens.model = "LENSMODEL_OPENCV5";
  bench.lens.width = kWidth;
  bench.lens.height = kHeight;
  const double focal_px = 50.0 / 36.0 * kWidth;
  bench.lens.intrinsics = {focal_px, focal_px, (kWidth - 1) / 2.0, (kHeight - 1) / 2.0, 0, 0, 0, 0, 0};
  Light light;
  const double reach = 1.5 * board.size_mm.norm(), tilt = 35 * std::numbers::pi / 180;
  light.position_mm = {board.size_mm.x() / 2, board.size_mm.y() / 2 + reach * std::sin(tilt), reach * std::cos(tilt)};
  bench.lights = {light};
  bench.material = board.material;
  return bench;
}

// Replaces the bench's lamps by the given ones.
void put_lamps(const std::vector<std::vector<double>>& places, const Board& board, Bench& bench) {
  const Light usual = bench.lights.empty() ? Light{} : bench.lights.front();
  bench.lights.clear();
  for (const std::vector<double>& p : places) {
    if (p.size() != 3) throw CLI::ValidationError("--lamp", "takes three numbers, X Y Z in mm");
    Light light = usual;
    light.id = places.size() == 1 ? usual.id : fmt::format("lamp{}", bench.lights.size() + 1);
    light.position_mm = {p[0], p[1], p[2]};
    light.axis = (Eigen::Vector3d(board.size_mm.x() / 2, board.size_mm.y() / 2, 0) - light.position_mm).normalized();
    if (!(light.position_mm.z() > 0))
      fail("--lamp", fmt::format("{} mm above the face is behind the board", p[2]), "give a place in front of it");
    bench.lights.push_back(light);
  }
}

// Inputs of a plan.
struct Inputs {
  Board board;
  Bench bench;
  std::filesystem::path board_file, bench_file, scratches;
  std::vector<DesignedPlace> designed;
  std::vector<Finding> lamps;  // notes on the lamps of a design in color
  bool is_project = false;
};

Inputs inputs_of_project(const std::filesystem::path& folder) {
  const WantedBench wanted = wanted_bench({folder});
  return {wanted.board,
          wanted.bench,
          wanted.board_file,
          wanted.bench_file,
          wanted.scratches,
          designed_places(wanted.design, wanted.bench),
          lamps_in_color(wanted.design, wanted.board, wanted.bench),
          true};
}

Inputs inputs_of_files(const std::filesystem::path& board_file, const std::filesystem::path& bench_file,
                       const std::filesystem::path& design_file) {
  Inputs in;
  in.board_file = std::filesystem::is_directory(board_file) ? board_file / "board.json" : board_file;
  in.bench_file = bench_file;
  in.board = read_board(in.board_file);
  in.scratches = in.board.scratches;
  if (bench_file.empty()) {
    in.bench = usual_bench(in.board);
    tell(make_note(FindingCode::value_assumed, "no --bench: planned for a 50 mm lens on full frame, and a lamp " +
                                                   place_in_words(in.bench.lights[0].position_mm, in.board)));
  } else {
    in.bench = read_bench_of(in.board, in.board_file, bench_file);
  }
  if (design_file.empty()) return in;
  const DesignSpec design = read_design(design_file);
  in.designed = designed_places(design, in.bench);
  in.lamps = lamps_in_color(design, in.board, in.bench);
  return in;
}

bool plans_several_lamps(const Inputs& in) {
  return std::any_of(in.designed.begin(), in.designed.end(),
                     [&](const DesignedPlace& place) { return place.light != in.designed.front().light; });
}

struct PlanArguments {
  std::filesystem::path board, bench, design, scratches, camera, out;
  std::vector<std::vector<double>> lamps;
  PlanOptions plan;
  double focus_mm = 0;
  std::string focus_range;
  std::vector<std::string> free;
};

Report run(const PlanArguments& arguments) {
  std::optional<WorkLock> lock;
  if (!arguments.out.empty()) lock.emplace(arguments.out, "burin plan", WorkLock::Where::new_folders);
  // A project's board.json alone stands for the project, which knows the bench.
  const std::optional<PlaceInProject> own = project_of(arguments.board);
  const bool is_board = arguments.board.filename() == "board.json" && own && arguments.design.empty();
  const std::filesystem::path folder = is_board ? own->project.folder : project_folder(arguments.board, "BOARD.json");
  const bool is_project = arguments.bench.empty() && std::filesystem::is_directory(folder);
  Inputs in = is_project ? inputs_of_project(folder)
                         : inputs_of_files(arguments.board.empty() ? folder : arguments.board, arguments.bench,
                                           arguments.design);
  PlanOptions plan_options = arguments.plan;
  if (!arguments.camera.empty()) {
    in.bench.lens = read_cameramodel(arguments.camera);
    plan_options.fix_lens = arguments.free.empty();
  }
  if (!arguments.lamps.empty()) put_lamps(arguments.lamps, in.board, in.bench);
  const std::filesystem::path file = arguments.scratches.empty() ? in.scratches : arguments.scratches;
  Sent sent;
  if (!file.empty() && (!arguments.scratches.empty() || std::filesystem::exists(file))) {
    sent = Sent(read_scratches(file));
  } else {
    sent = test_strokes(in.board);
    tell(make_note(FindingCode::value_assumed,
                   fmt::format("no scratches yet: planned with {} test strokes in all directions", sent.size())));
  }
  if (in.board.tags.list.size() > kMostPlannedTags)
    tell(make_note(FindingCode::value_assumed,
                   fmt::format("planned with {} of the board's {} tags, spread over it: more change no place",
                               kMostPlannedTags, in.board.tags.list.size())));
  for (const Finding& finding : in.lamps) tell(finding);
  plan_options.designed = in.designed;
  const PlanFocus focus = plan_focus(in.board, in.bench, in.designed, arguments.focus_mm, arguments.focus_range);
  plan_options.focus = focus.range;
  ProgressBar bar;
  bar.progress()("planning", 0);
  const Plan plan = plan_shots(in.board, in.bench, sent, plan_options, bar.progress());
  bar.clear();
  for (const Finding& finding : focus_findings(plan, focus)) tell(finding);
  Report report;
  report.line("{}\n", fact("focus", focus_in_words(focus)));
  report_plan(plan, in.board, report);
  std::string next = "take these photos; next: burin capture PHOTOS_DIR --board " + shell_word(in.board_file.string());
  if (!in.bench_file.empty()) next += " --bench " + shell_word(in.bench_file.string());
  next += " --out DIR";
  if (in.is_project)
    next = std::string("take these photos into the round's photos folder") +
           (plans_several_lamps(in) ? ", each into the folder of the lamp that shone on it alone (photos/" +
                                          file_name_of(in.designed.front().light) + " and so on)"
                                    : "") +
           "; next: burin loop " + shell_word(folder.string());
  if (in.is_project) report.next.push_back({"burin", "loop", folder.string()});
  if (arguments.out.empty()) {
    report.line("Planned {} (--out DIR keeps the plan and draws it): {}\n", counted(plan.shots.size(), "shot"), next);
    return report;
  }
  make_output_folder(arguments.out);
  FilesTogether all;
  write_text(plan_text(plan, in.board, focus, arguments.out / "plan.json"), arguments.out / "plan.json");
  write_text(plan_drawing(plan, in.board), arguments.out / "plan.svg");
  all.put();
  report.line("Wrote {}, plan.svg shows where to stand: {}\n", (arguments.out / "plan.json").string(), next);
  return report;
}

}  // namespace

void add_plan_command(CLI::App& burin) {
  auto options = std::make_shared<PlanArguments>();
  CLI::App* command = burin.add_subcommand(
      "plan", "Plan the photos of a board: camera and lamp positions, with their expected accuracy");
  command->add_option("BOARD.json", options->board,
                      "Plan for this board (board.json) or project folder [default: the working directory's project]");
  command->add_option(
      "--bench", options->bench,
      "Use lens and lamps of this setup (bench.json) [default: the project's, else 50 mm lens, lamp above]");
  command->add_option("--design", options->design,
                      "Plan the views of this design.json first, and focus on them [default: the project's]");
  add_length_option(*command, "--focus", options->focus_mm,
                    "Focus the lens at this distance [default: the views of the design or bench]")
      ->check(CLI::PositiveNumber);
  command->add_option(
      "--focus-range", options->focus_range,
      "Limit shots to this range of sharp distances: 900-1500mm or 0.9-1.5m [default: this lens at f/8]");
  command->add_option("--scratches", options->scratches,
                      "Plan with these scratches (CSV) [default: the board's, else test strokes]");
  auto* camera = command->add_option("--camera", options->camera,
                                     "Use this lens (.cameramodel) and keep it fixed [default: the bench's]");
  command
      ->add_option("--free", options->free, "Plan for a calibration that also solves for the lens (lens) of --camera")
      ->take_all()
      ->expected(1)
      ->check(CLI::IsMember({"lens"}))
      ->needs(camera);
  command
      ->add_option("--lamp", options->lamps,
                   "Place a lamp at X Y Z, mm; repeat for several lamps [default: the bench's]")
      ->type_size(3);
  command
      ->add_option("--lamp-places", options->plan.lamp_places,
                   "Use this total number of lamp positions; the plan proposes those not given")
      ->capture_default_str()
      ->check(CLI::Range(1, 12));
  command->add_option("--shots", options->plan.shots, "Plan this number of shots")
      ->capture_default_str()
      ->check(CLI::Range(1, 12));
  command->add_option("--out", options->out, "Write plan.json and plan.svg to this folder [default: print only]");
  command->footer(example("burin plan board.json --bench bench.json --design design.json --shots 8 --out plan"));
  command->callback([options] { print(run(*options)); });
}

}  // namespace burin

// burin check: inspects G-code before carving, and compares Burin with known results.
#include <CLI/Error.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <system_error>
#include <vector>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/render/footprint/ndf_cases.h"
#include "tools/check_file.h"
#include "tools/commands.h"
#include "tools/loop/say.h"
#include "tools/loop/state.h"
#include "tools/progress_bar.h"
#include "tools/project_settings.h"
#include "tools/report/carve_check.h"
#include "tools/steps.h"
#include "tools/work_lock.h"

namespace burin {
namespace {

struct CheckArguments {
  std::filesystem::path cases;
  bool brief = false;
};

Report check_ndf(const CheckArguments& options) {
  Report report;
  std::vector<NdfComparison> rows;
  const auto cases = read_ndf_cases(options.cases);
  report.line("{}\n", ndf_table_header());
  for (const auto& c : cases) {
    rows.push_back(compare(c));
    report.line("{}\n", ndf_line(rows.back()));
    if (!options.brief) report.line("{}\n", ndf_gradient_line(rows.back()));
  }
  const auto failed = std::count_if(rows.begin(), rows.end(), [](const auto& r) { return !r.ok(); });
  report.line("{}\n", fact("summary", ndf_summary(rows)));
  report.data["rows"] = rows.size();
  report.data["failed"] = failed;
  if (failed > 0)
    report.failure.emplace(ErrorCode::refused, options.cases.string(),
                           fmt::format("{} of {} rows are beyond their tolerance", failed, rows.size()),
                           "see the rows whose verdict is not ok: the table or Burin is wrong there");
  return report;
}

// Checked files and output page.
struct CarveJob {
  CarveCheckFiles files;
  std::filesystem::path page;
  std::optional<LoopProject> loop;  // set if the G-code belongs to the loop's `round`
  int round = 0;
  bool is_loops_own = false;  // under the loop's own settings, into the loop's page
};

// Reports G-code that is older than the probed heights or than another of its inputs. For a round, the loop's record
// decides.
std::vector<Finding> outdated(const CarveJob& job) {
  ContentHashes hashes;
  if (StageState state = job.loop ? state_of(*job.loop, {job.round, StageKind::toolpath}, hashes) : StageState();
      state.record) {
    std::vector<StageChange>& changes = state.changes;
    std::erase_if(changes, [](const StageChange& change) { return change.kind != StageChange::Kind::input; });
    if (changes.empty()) return {};
    return {{FindingCode::outdated, Finding::Severity::error, job.loop->project.round(job.round) / "board.gcode",
             "was written before " + in_words(changes),
             "write it again: " + loop_line(job.loop->project, "--force toolpath")}};
  }
  std::error_code error;
  const auto time_of = [&](const std::filesystem::path& file) { return std::filesystem::last_write_time(file, error); };
  for (const std::filesystem::path& file : job.files.gcode)
    if (!job.files.heights.empty() && time_of(file) < time_of(job.files.heights) && !error)
      return {{FindingCode::outdated, Finding::Severity::error, file,
               "was written before " + job.files.heights.string(),
               "write it again: burin toolpath --heights " + shell_word(job.files.heights.string()) + " ..."}};
  return {};
}

bool same_file(const std::filesystem::path& a, const std::filesystem::path& b) {
  std::error_code ignored;
  return a == b || std::filesystem::equivalent(a, b, ignored);
}

// Returns the loop's round for `what`: a round itself, the newest designed one of a project, or the one with the given
// table or tool path. Empty: none.
std::filesystem::path round_of(const std::filesystem::path& what, const std::optional<ProjectSettings>& project) {
  const bool is_folder = std::filesystem::is_directory(what);
  const std::filesystem::path otherwise = is_folder ? what : std::filesystem::path();
  if (!project || !project_of(what)) return otherwise;
  const Project& of = project->at.project;
  int round = project->at.round;
  if (round > 0) {
    const std::string name = what.filename().string();
    const bool of_round = name == "scratches.csv" || (name.starts_with("board") && what.extension() == ".gcode");
    return is_folder || of_round ? of.round(round) : otherwise;
  }
  if (!is_folder || !same_file(what, of.folder)) return otherwise;
  for (round = of.rounds(); round > 1; --round)
    if (std::filesystem::exists(of.round(round) / "scratches.csv")) break;
  return round > 0 ? of.round(round) : otherwise;
}

// Returns true if the loop has checked that round.
bool has_page(const Project& project, int round) {
  return std::filesystem::exists(record_file(project, {round, StageKind::check}));
}

// Returns true if the settings equal the loop's own; then the page belongs to the loop.
bool is_loops_own(const CarveCheckFiles& files, const CarveCheckFiles& own, const ProjectSettings& project) {
  const std::string machine = project.machine.empty() ? CarveCheckFiles().machine : project.machine;
  bool same = files.follow_bow == project.follow_bow && files.gcode == own.gcode &&
              (files.machine == machine || same_file(files.machine, machine));
  for (const auto member : {&CarveCheckFiles::board, &CarveCheckFiles::bench, &CarveCheckFiles::design,
                            &CarveCheckFiles::folder, &CarveCheckFiles::heights, &CarveCheckFiles::scratches})
    same = same && same_file(files.*member, own.*member);
  return same;
}

CarveJob job_of(const CarveCheckArguments& options, const CLI::App* command) {
  const CarveCheckFiles& said = options.files;
  CarveJob job{said, options.out, std::nullopt, 0};
  const std::optional<ProjectSettings> project = settings_around(options.what);
  SettingsToTake take{.machine = &job.files.machine};
  if (said.heights.empty()) take.follow_bow = &job.files.follow_bow;
  const std::filesystem::path round = said.gcode.empty() || std::filesystem::is_directory(options.what)
                                          ? round_of(options.what, project)
                                          : std::filesystem::path();
  if (round.empty()) {
    if (!std::filesystem::exists(options.what))
      fail(options.what.string(), "does not exist", "name scratches, or the folder of a loop's round");
    take.board = &job.files.board;
    take.bench = &job.files.bench;
    if (project && command != nullptr) take_from_project(*command, *project, take);
    job.files.scratches = options.what;
    if (job.files.board.empty() || job.files.gcode.empty())
      throw CLI::RequiredError("--board and --gcode (or the folder of a loop's round)");
    if (job.page.empty()) job.page = "carve-check.html";
    return job;
  }
  if (project && command != nullptr) take_from_project(*command, *project, take);
  const CarveCheckFiles own = round_files(round, job.files.machine);
  for (const auto member : {&CarveCheckFiles::board, &CarveCheckFiles::bench, &CarveCheckFiles::design,
                            &CarveCheckFiles::folder, &CarveCheckFiles::heights})
    if ((job.files.*member).empty()) job.files.*member = own.*member;
  if (job.files.gcode.empty()) job.files.gcode = own.gcode;
  job.files.scratches = own.scratches;
  if (job.files.follow_bow) job.files.heights.clear();
  const std::optional<PlaceInProject> at = project_of(round);
  const bool of_loop = project && at && at->round > 0;
  const bool as_loop = of_loop && is_loops_own(job.files, own, *project);
  const bool beside = of_loop && !as_loop && has_page(at->project, at->round);
  if (job.page.empty()) job.page = round / (beside ? "carve-check-otherwise.html" : "carve-check.html");
  if (beside)
    note(FindingCode::settings, "the loop checks this round under other settings (machine " +
                                    (project->machine.empty() ? CarveCheckFiles().machine : project->machine) +
                                    "), and its page stays as it is");
  if (of_loop && job.files.gcode == own.gcode && (job.files.follow_bow || job.files.heights == own.heights)) {
    job.loop = LoopProject{at->project, read_loop_options(at->project.folder)};
    job.round = at->round;
    job.is_loops_own = as_loop && same_file(job.page, round / "carve-check.html");
  }
  return job;
}

}  // namespace

Report run_carve_check(const CarveCheckArguments& options, const CLI::App* command) {
  CarveJob job = job_of(options, command);
  job.files.outdated = outdated(job);
  const auto& [files, page, loop, round, is_loops_own] = job;
  const WorkLock lock(page.parent_path(), "burin check carve", WorkLock::Where::projects);
  ProgressBar bar;
  bar.progress()("replaying", 0);
  const CheckedCarving checked = check_carve_files(files);
  const CarveCheck& check = checked.check;
  bar.progress()("writing", 0);
  write_carve_check_page(checked, files, page);
  if (is_loops_own) record_check(*loop, round, check.good());
  bar.clear();
  Report report;
  report.data = {{"good", check.good()}, {"page", page.string()}, {"findings", to_json(check.findings)}};
  report.line("{}", carve_check_text(check));
  if (!check.good()) {
    const auto errors = std::count_if(check.findings.begin(), check.findings.end(),
                                      [](const Finding& f) { return f.severity == Finding::Severity::error; });
    report.failure.emplace(ErrorCode::refused, page.string(),
                           "do not carve this: " + counted(static_cast<std::size_t>(errors), "error"),
                           "open it in a browser and correct these errors");
  } else {
    report.line("{}\nWrote {}: open it in a browser, and carve if it is as you want it.\n",
                carve_question(checked, files), page.string());
  }
  return report;
}

namespace {

void add_carve_check(CLI::App& check) {
  auto options = std::make_shared<CarveCheckArguments>();
  CarveCheckFiles& files = options->files;
  CLI::App* carve = check.add_subcommand(
      "carve", "Check tool path and board before carving, and write a page of errors and warnings");
  carve
      ->add_option("SCRATCHES.csv", options->what,
                   "Check these scratches, or this round folder with its project's machine, board and bench")
      ->required();
  carve->add_option("--gcode", files.gcode, "Check these G-code files, in carving order");
  carve->add_option("--board", files.board, "Use this board (board.json) [default: the project's]");
  carve->add_option("--bench", files.bench,
                    "Use the setup given to burin toolpath (bench.json) [default: the project's]");
  carve->add_option("--design", files.design, "Check the views of this design.json against the scratches");
  carve->add_option("--previews", files.folder, "Show the previews from this output folder of burin design");
  carve
      ->add_option("--machine", files.machine,
                   "Use this machine instead of the project's: " + built_in_machines() +
                       ", or a burin/machine file (JSON or TOML)")
      ->capture_default_str();
  CLI::Option* heights =
      carve->add_option("--heights", files.heights, "Use the height map that the G-code follows (heights.json)");
  carve->add_flag("--follow-bow", files.follow_bow, "Expect G-code that follows the measured warp of the board")
      ->excludes(heights);
  carve->add_option("--out", options->out,
                    "Write this page [default: carve-check.html in the round's or working folder]");
  carve->footer(example("burin check carve round-01\n"
                        "  burin check carve scratches.csv --board board.json --bench bench.json --gcode board.gcode "
                        "--out check.html") +
                "\nThe exit code is 1 if the page has an error.");
  carve->callback([options, carve] { print(run_carve_check(*options, carve)); });
}

}  // namespace

void add_check_command(CLI::App& burin) {
  CLI::App* check = burin.add_subcommand(
      "check", "Check a file of ours, run pre-flight checks before carving, or a numerical self-test");
  check->require_subcommand(0, 1);
  auto file = std::make_shared<std::filesystem::path>();
  check->add_option("FILE", *file, "Read this file as strictly as the commands, and name line and column of an error");
  check->footer(example("burin check board.json\n  burin check carve round-01\n  burin check ndf CASES.csv"));
  check->callback([file, check] {
    if (!check->get_subcommands().empty()) return;
    if (file->empty()) throw CLI::RequiredError("FILE, carve or ndf");
    print(check_file(*file));
  });
  add_carve_check(*check);
  auto options = std::make_shared<CheckArguments>();
  CLI::App* ndf = check->add_subcommand(
      "ndf", "Compare the footprint integral with reference values, and print the error of each row");
  ndf->add_option("CASES.csv", options->cases,
                  "Read the reference values, with the columns of burin/render/footprint/ndf_cases.h")
      ->required();
  ndf->add_flag("--brief", options->brief, "Omit the gradients");
  ndf->footer(
      example("burin check ndf CASES.csv") +
      "\nThe exit code is 1 if a row exceeds its tolerance (1e-9 relative; gradients 1e-8 of the row's largest).");
  ndf->callback([options] { print(check_ndf(*options)); });
}

}  // namespace burin

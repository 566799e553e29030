// burin check: looks before metal moves; compares Burin with known answers.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <vector>

#include "burin/render/error.h"
#include "burin/render/footprint/ndf_cases.h"
#include "tools/commands.h"
#include "tools/progress_bar.h"
#include "tools/report/carve_check.h"
#include "tools/work_lock.h"

namespace burin {
namespace {

struct CheckArguments {
  std::filesystem::path cases;
  bool brief = false;
};

void check_ndf(const CheckArguments& options) {
  std::vector<NdfComparison> rows;
  const auto cases = read_ndf_cases(options.cases);
  print_text("{}\n", ndf_table_header());
  for (const auto& c : cases) {
    rows.push_back(compare(c));
    print_text("{}\n", ndf_line(rows.back()));
    if (!options.brief) print_text("{}\n", ndf_gradient_line(rows.back()));
  }
  const auto failed = std::count_if(rows.begin(), rows.end(), [](const auto& r) { return !r.ok(); });
  print_text("{}\n", ndf_summary(rows));
  if (failed > 0) {
    std::fflush(stdout);
    fail(options.cases.string(), fmt::format("{} of {} rows are beyond their tolerance", failed, rows.size()),
         "see the rows whose verdict is not ok: the table or Burin is wrong there");
  }
}

struct CarveOptions {
  std::filesystem::path what, out;
  CarveCheckFiles files;
};

CarveCheckFiles files_of(const CarveOptions& options) {
  if (!std::filesystem::is_directory(options.what)) {
    CarveCheckFiles files = options.files;
    files.scratches = options.what;
    if (files.board.empty() || files.gcode.empty())
      throw CLI::RequiredError("--board and --gcode (or the folder of a loop's round)");
    return files;
  }
  CarveCheckFiles files = round_files(options.what, options.files.machine);
  const CarveCheckFiles& said = options.files;
  for (const auto member : {&CarveCheckFiles::board, &CarveCheckFiles::bench, &CarveCheckFiles::design,
                            &CarveCheckFiles::folder, &CarveCheckFiles::heights})
    if (!(said.*member).empty()) files.*member = said.*member;
  if (!said.gcode.empty()) files.gcode = said.gcode;
  files.follow_bow = said.follow_bow;
  return files;
}

void check_before_carving(const CarveOptions& options) {
  std::filesystem::path page = options.out;
  if (page.empty())
    page = std::filesystem::is_directory(options.what) ? options.what / "carve-check.html" : "carve-check.html";
  const WorkLock lock(page.parent_path(), "burin check carve", WorkLock::Where::projects);
  const CarveCheckFiles files = files_of(options);
  ProgressBar bar;
  bar.progress()("replaying", 0);
  const CarveCheck check = check_carve_files(files);
  bar.progress()("writing", 0);
  write_carve_check_page(check, files, page);
  bar.clear();
  print_text("{}", carve_check_text(check));
  if (!check.good()) {
    const auto red = std::count_if(check.findings.begin(), check.findings.end(),
                                   [](const Finding& f) { return f.severity == Finding::Severity::error; });
    std::fflush(stdout);
    fail(page.string(), fmt::format("do not carve this: {} red line{}", red, red == 1 ? "" : "s"),
         "open it in a browser and mend what it says");
  }
  print_text("{}\nWrote {}: open it in a browser, and carve if it is as you want it.\n", carve_question(check, files),
             page.string());
}

void add_carve_check(CLI::App& check) {
  auto options = std::make_shared<CarveOptions>();
  CarveCheckFiles& files = options->files;
  CLI::App* carve = check.add_subcommand(
      "carve", "Before metal moves: one page of what the G-code will do to the board, and what would spoil it in red");
  carve
      ->add_option("SCRATCHES.csv", options->what,
                   "The scratches that are to be carved, or the folder of a loop's round")
      ->required();
  carve->add_option("--gcode", files.gcode, "The files that the machine will get, in order");
  carve->add_option("--board", files.board, "board.json");
  carve->add_option("--bench", files.bench, "bench.json, as given to burin toolpath");
  carve->add_option("--design", files.design, "design.json: the views that the scratches must glint for");
  carve->add_option("--previews", files.folder, "The folder that burin design filled");
  carve->add_option("--machine", files.machine, built_in_machines() + ", or a burin/machine file in JSON or TOML")
      ->capture_default_str();
  CLI::Option* heights = carve->add_option("--heights", files.heights, "heights.json that the G-code follows");
  carve->add_flag("--follow-bow", files.follow_bow, "The G-code follows the bench's measured bow")->excludes(heights);
  carve->add_option("--out", options->out, "The page (carve-check.html in the round's or the working folder)");
  carve->footer(example("burin check carve round-01\n"
                        "  burin check carve scratches.csv --board board.json --gcode board.gcode --out check.html") +
                "\nExit code 1 if there is a red line.");
  carve->callback([options] { check_before_carving(*options); });
}

}  // namespace

void add_check_command(CLI::App& burin) {
  CLI::App* check = burin.add_subcommand("check", "Look before metal moves; compare Burin with known answers");
  check->require_subcommand(1);
  check->footer(example("burin check carve round-01\n  burin check ndf CASES.csv"));
  add_carve_check(*check);
  auto options = std::make_shared<CheckArguments>();
  CLI::App* ndf = check->add_subcommand(
      "ndf",
      "Compare the footprint integral with a table of known values: prints value, gradient and error of each row");
  ndf->add_option("CASES.csv", options->cases,
                  "Table with the columns that burin/render/footprint/ndf_cases.h describes")
      ->required();
  ndf->add_flag("--brief", options->brief, "Leave out the gradients");
  ndf->footer(example("burin check ndf CASES.csv") +
              "\nExit code 1 if a row is beyond its tolerance (1e-9 relative; gradients 1e-8 of the row's largest).");
  ndf->callback([options] { check_ndf(*options); });
}

}  // namespace burin

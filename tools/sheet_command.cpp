#include <CLI/App.hpp>
#include <CLI/Validators.hpp>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/base/files/files_together.h"
#include "burin/base/files/json_file.h"
#include "burin/scene/scratches.h"
#include "tools/commands.h"
#include "tools/drawing/pdf.h"
#include "tools/loop/printed_sheet.h"
#include "tools/plan_words.h"
#include "tools/print/printed_page.h"
#include "tools/progress_bar.h"
#include "tools/project_settings.h"
#include "tools/sheet/sheet.h"
#include "tools/wanted_bench.h"
#include "tools/work_lock.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

struct SheetArguments {
  fs::path project;
  std::vector<fs::path> out;
  std::optional<std::string> paper;
  std::string focus_range;
  std::optional<double> hang_height_mm;
  double focus_mm = 0;
  int shots = PlanOptions{}.shots;
};

Report run(SheetArguments options) {
  options.project = project_folder(options.project, "PROJECT");
  std::vector<fs::path> out = options.out;
  if (out.empty()) out = {options.project / "sheet.pdf", options.project / "sheet.html"};
  for (const fs::path& file : out)
    if (file.extension() != ".pdf" && file.extension() != ".html")
      fail(file.string(), "is the name of neither a PDF nor a page",
           "write --out " + shell_word(fs::path(file).replace_extension(".pdf").string()) + " or .html");
  const WorkLock lock(out.front().parent_path(), "burin sheet", WorkLock::Where::projects);
  const Paper paper = find_paper(options.paper.value_or(usual_paper().name));
  const WantedBench wanted = wanted_bench({options.project});
  Sheet sheet;
  sheet.name = fs::absolute(options.project / "x").lexically_normal().parent_path().filename().string();
  sheet.board = wanted.board;
  sheet.places = sheet_places(wanted);
  sheet.measured_rounds = wanted.measured_rounds;
  sheet.hang_height_mm = options.hang_height_mm.value_or(usual_hang_height_mm(sheet.board, sheet.places));
  PlanOptions plan_options;
  plan_options.shots = options.shots;
  plan_options.designed = designed_places(wanted.design, wanted.bench);
  sheet.focus = plan_focus(wanted.board, wanted.bench, plan_options.designed, options.focus_mm, options.focus_range);
  plan_options.focus = sheet.focus.range;
  const Sent sent = wanted.scratches.empty() ? test_strokes(wanted.board) : Sent(read_scratches(wanted.scratches));
  ProgressBar bar;
  sheet.plan = plan_shots(wanted.board, wanted.bench, sent, plan_options, bar.progress());
  bar.clear();
  std::string written;
  FilesTogether all;
  for (const fs::path& file : out) {
    if (file.has_parent_path()) make_output_folder(file.parent_path());
    write_text(file.extension() == ".pdf"
                   ? pdf(sheet_pages(sheet, paper.size_mm), {paper.size_mm, {1, 1}, sheet.name + ": where to stand"})
                   : sheet_html(sheet),
               file);
    written += (written.empty() ? "" : " and ") + file.string();
  }
  const fs::path plan = options.project / "plan.json";  // `burin watch` needs the same photos
  write_text(plan_text(sheet.plan, wanted.board, sheet.focus, plan), plan);
  all.put();
  record_sheet({options.project}, wanted, out);
  for (const Finding& finding : findings(sheet)) tell(finding);
  for (const Finding& finding : focus_findings(sheet.plan, sheet.focus)) tell(finding);
  Report report;
  report.data = {{"places", sheet.places.size()}, {"photos", sheet.plan.shots.size()}};
  report.next = {{"burin", "loop", options.project.string()}};
  report.line("Wrote {}: {} and {} in order; print it, or open it on a phone; next: {}\n", written,
              counted(sheet.places.size(), "place"), counted(sheet.plan.shots.size(), "photo"),
              command_text(report.next.front()));
  return report;
}

}  // namespace

void add_sheet_command(CLI::App& burin) {
  auto options = std::make_shared<SheetArguments>();
  CLI::App* command =
      burin.add_subcommand("sheet", "Draw lamp and eye positions and the photos to take, for wall and phone");
  command->add_option("PROJECT", options->project,
                      "Draw the setup of this project [default: the working directory's project]");
  command
      ->add_option("--out", options->out,
                   "Write this .pdf or .html; give it twice for both [default: sheet.pdf and sheet.html in PROJECT]")
      ->take_all()
      ->expected(1);
  add_length_option(*command, "--hang-height", options->hang_height_mm,
                    "Set the height of the board's center above the floor [default: for a standing adult's eyes]")
      ->check(CLI::Range(1.0, 10'000.0));
  command->add_option("--shots", options->shots, "Plan this number of photos in addition to the designed views")
      ->capture_default_str()
      ->check(CLI::Range(1, 12));
  add_length_option(*command, "--focus", options->focus_mm,
                    "Focus the lens at this distance [default: the designed views]")
      ->check(CLI::PositiveNumber);
  command->add_option(
      "--focus-range", options->focus_range,
      "Limit shots to this range of sharp distances: 900-1500mm or 0.9-1.5m [default: this lens at f/8]");
  command->add_option("--paper", options->paper,
                      "Print on this paper: a4, letter, a3 or tabloid [default: the locale's (LC_PAPER)]");
  command->footer(example("burin sheet my-board --hang-height 1800"));
  command->callback([options] { print(run(*options)); });
}

}  // namespace burin

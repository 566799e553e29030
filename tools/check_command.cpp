// burin check: compares Burin with known answers.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <vector>

#include "burin/render/error.h"
#include "burin/render/footprint/ndf_cases.h"
#include "tools/commands.h"

namespace burin {
namespace {

struct Options {
  std::filesystem::path cases;
  bool brief = false;
};

void check_ndf(const Options& options) {
  std::vector<NdfComparison> rows;
  const auto cases = read_ndf_cases(options.cases);
  fmt::print("{}\n", ndf_table_header());
  for (const auto& c : cases) {
    rows.push_back(compare(c));
    fmt::print("{}\n", ndf_line(rows.back()));
    if (!options.brief) fmt::print("{}\n", ndf_gradient_line(rows.back()));
  }
  const auto failed = std::count_if(rows.begin(), rows.end(), [](const auto& r) { return !r.ok(); });
  fmt::print("{}\n", ndf_summary(rows));
  if (failed > 0) {
    std::fflush(stdout);
    fail(options.cases.string(), fmt::format("{} of {} rows are beyond their tolerance", failed, rows.size()),
         "see the rows whose verdict is not ok: the table or Burin is wrong there");
  }
}

}  // namespace

void add_check_command(CLI::App& burin) {
  CLI::App* check = burin.add_subcommand("check", "Compare Burin with known answers");
  check->require_subcommand(1);
  check->footer(example("burin check ndf CASES.csv"));
  auto options = std::make_shared<Options>();
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

#include <filesystem>
#include <memory>

#include "render/error.h"
#include "render/json_file.h"
#include "tools/commands.h"
#include "tools/progress_bar.h"
#include "tools/report/section.h"

namespace burin {

void add_report_command(CLI::App& burin) {
  struct Options {
    std::filesystem::path folder, session;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command =
      burin.add_subcommand("report", "Show a measured session, a design or a loop project as one HTML page");
  command->add_option("DIR", options->folder, "A folder with bench.json, a design, or a loop project")->required();
  command->add_option("--session", options->session,
                      "The session that DIR/bench.json was measured from, if not DIR/session.json");
  command->footer(example("burin report round-01"));
  command->callback([options] {
    ProgressBar bar;
    const std::string outcome = write_report(options->folder, options->session, bar.progress());
    bar.clear();
    fmt::print("{}\nWrote {}; open it in a browser.\n", outcome, (options->folder / "report.html").string());
  });
}

}  // namespace burin

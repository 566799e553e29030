#include <filesystem>
#include <memory>
#include <optional>

#include "burin/base/error.h"
#include "burin/base/files/json_file.h"
#include "tools/commands.h"
#include "tools/progress_bar.h"
#include "tools/project_settings.h"
#include "tools/report/rerun.h"
#include "tools/report/section.h"
#include "tools/work_lock.h"

namespace burin {

void add_report_command(CLI::App& burin) {
  struct Options {
    std::filesystem::path folder, session, before, under, board;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = burin.add_subcommand("report", "Write an HTML page of a measured session, a design or a project");
  command->add_option(
      "DIR", options->folder,
      "Show this folder of a bench.json, a design or a project [default: the working directory's project]");
  command->add_option("--session", options->session,
                      "Use the session that gave DIR/bench.json [default: DIR/session.json]");
  CLI::Option* before =
      command->add_option("--before", options->before, "Compare the design in DIR with this earlier design's folder");
  CLI::Option* under =
      command->add_option("--under", options->under, "Evaluate both designs in this measured setup (bench.json)");
  CLI::Option* board = command->add_option("--board", options->board, "Use this board for both designs (board.json)");
  before->needs(under)->needs(board);
  under->needs(before);
  board->needs(before);
  command->footer(
      example("burin report round-01\n"
              "  burin report second --before first --under bench.json --board board.json"));
  command->callback([options] {
    if (options->folder.empty()) options->folder = project_folder({}, "DIR");
    const WorkLock lock(options->folder, "burin report", WorkLock::Where::projects);
    ProgressBar bar;
    std::optional<Section> rerun;
    if (!options->before.empty())
      rerun = rerun_section({options->before, options->folder, options->under, options->board}, bar.progress());
    const WrittenReport report = write_report(options->folder, options->session, rerun, bar.progress());
    bar.clear();
    print_text("{}\nWrote {} ({:.1f} MB); open it in a browser.\n", report.told, report.page.string(),
               static_cast<double>(report.bytes) / 1e6);
  });
}

}  // namespace burin

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
#include "tools/steps.h"
#include "tools/work_lock.h"

namespace burin {

Report run_report(const ReportArguments& o) {
  const WorkLock lock(o.folder, "burin report", WorkLock::Where::projects);
  ProgressBar bar;
  std::optional<Section> rerun;
  if (!o.before.empty()) rerun = rerun_section({o.before, o.folder, o.under, o.board}, bar.progress());
  const WrittenReport page = write_report(o.folder, o.session, rerun, bar.progress());
  bar.clear();
  Report report;
  report.line("{}\nWrote {} ({:.1f} MB); open it in a browser.\n", fact("summary", page.told),
              fact("page", page.page.string()), fact("size", static_cast<double>(page.bytes) / 1e6, "MB"));
  return report;
}

void add_report_command(CLI::App& burin) {
  auto options = std::make_shared<ReportArguments>();
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
    print(run_report(*options));
  });
}

}  // namespace burin

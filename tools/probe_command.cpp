// burin probe - measures the sheet's face on the machine: writes G-code that touches it, and converts the controller's
// answers to a height map. The work is in burin/optimize/toolpath/probe.h.
#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/base/files/json_file.h"
#include "burin/base/files/write_file.h"
#include "burin/optimize/toolpath.h"
#include "burin/optimize/toolpath/gcode.h"
#include "burin/optimize/toolpath/probe.h"
#include "burin/optimize/toolpath/probe_check.h"
#include "burin/optimize/toolpath/release_check.h"
#include "tools/commands.h"
#include "tools/probe_light_command.h"
#include "tools/progress_bar.h"
#include "tools/project_settings.h"

namespace burin {
namespace {

struct ProbeArguments {
  std::filesystem::path board, log, probed, out;
  std::string machine = "grbl";
  double spacing_mm = 15;
};

Report write_probing(ProbeArguments options, const CLI::App& command) {
  if (options.out != "-" && !has_gcode_name(options.out))
    fail(options.out.string(), "is no name of G-code",
         "give the output another name, which ends in .gcode, .nc, .ngc, .cnc or .tap");
  if (std::filesystem::is_directory(options.board)) options.board /= "board.json";
  if (const std::optional<ProjectSettings> project = settings_around(options.board))
    take_from_project(command, *project, {.machine = &options.machine});
  const MachineProfile machine = machine_in_project(options.machine, options.board);
  const Board board = read_board(options.board);
  ProgressBar bar;
  bar.progress()("choosing where to touch the face", 0);
  const ProbePlan plan = probe_plan(board, options.spacing_mm);
  const std::string gcode = probe_gcode(plan, machine);
  bar.progress()("writing", 0);
  write_file(gcode, options.out, Durability::on_disk, [&](const std::filesystem::path& written) {
    const std::string name = options.out.string();
    fail_unless_probes(read_back(written, gcode, name), plan, machine, name);
  });
  bar.clear();
  for (const Finding& finding : reach_findings(machine)) tell(finding);
  const Eigen::Vector2d& first = plan.points_mm.front();
  Report report;
  report.data["points"] = plan.points_mm.size() - 1;
  report.all().set("first", {first.x(), first.y()}, "mm");
  report.line("touches the face at {}, X{:.2f} Y{:.2f} first and last, and sets Z zero there\n",
              counted(plan.points_mm.size() - 1, "point"), first.x(), first.y());
  const bool linuxcnc = machine.dialect == GcodeDialect::linuxcnc;
  report.line("Wrote {}: try the probe's contact by hand, run it, {}; then: burin probe read {} --probed {} --out {}\n",
              options.out.string(),
              linuxcnc ? "and fetch burin-probe.txt, which LinuxCNC writes into the folder of its configuration"
                       : "and save the whole serial log",
              linuxcnc ? "burin-probe.txt" : "SERIAL_LOG", shell_word(options.out.string()),
              shell_word((options.out.parent_path() / "heights.json").string()));
  return report;
}

Report read_heights_of(const ProbeArguments& options) {
  ProgressBar bar;
  bar.progress()("reading the log", 0);
  const ProbedHeights probed =
      read_probe_log(read_text(options.log), options.log, read_text(options.probed), options.probed);
  bar.clear();
  for (const Finding& finding : probed.findings) tell(finding);
  write_heights(probed.map, options.out);
  const auto points = std::count(probed.map.probed.begin(), probed.map.probed.end(), true);
  Report report;
  report.line("{} points, {:.1f} um from the lowest to the highest; the zero moved by {:.1f} um meanwhile\n",
              fact("points", points), fact("range", 1e3 * range_mm(probed.map), "um"),
              fact("drift", 1e3 * probed.map.drift_mm, "um"));
  report.line(
      "Wrote {}: keep Z zero as it is; then: burin toolpath SCRATCHES.csv --board BOARD.json --heights {} --out "
      "board.gcode\n",
      options.out.string(), shell_word(options.out.string()));
  return report;
}

}  // namespace

void add_probe_command(CLI::App& burin) {
  CLI::App* probe = burin.add_subcommand(
      "probe", "Measure the sheet's height map on the machine, or the room's light by a mirror ball");
  probe->require_subcommand(1);
  probe->footer(example("burin probe write board.json --machine grbl --out probe.gcode"));
  auto options = std::make_shared<ProbeArguments>();
  CLI::App* write = probe->add_subcommand(
      "write", "Write G-code that probes a grid over the carve area, clear of tags and keep-outs");
  write->add_option("BOARD.json", options->board, "Probe the carve area of this board (board.json) or project folder")
      ->required();
  write
      ->add_option("--machine", options->machine,
                   "Use this machine instead of the project's: " + built_in_machines() +
                       ", or a burin/machine file (JSON or TOML)")
      ->capture_default_str();
  add_length_option(*write, "--spacing", options->spacing_mm, "Set the approximate spacing of the grid")
      ->capture_default_str();
  write->add_option("--out", options->out, "Write the G-code to this file")->required();
  write->footer(example("burin probe write board.json --machine grbl --out probe.gcode"));
  write->callback([options, write] { print(write_probing(*options, *write)); });
  CLI::App* read = probe->add_subcommand("read", "Convert the controller's log of a probing file into a height map");
  read->add_option("LOG", options->log, "Read grbl's serial log, or the file that LinuxCNC's PROBEOPEN wrote")
      ->required();
  read->add_option("--probed", options->probed, "Read the probing G-code that the machine ran")->required();
  read->add_option("--out", options->out, "Write the height map to this file (heights.json)")->required();
  read->footer(example("burin probe read serial.log --probed probe.gcode --out heights.json"));
  read->callback([options] { print(read_heights_of(*options)); });
  add_probe_light(*probe);
}

}  // namespace burin

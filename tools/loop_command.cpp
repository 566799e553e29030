// burin loop - designs scratches for pictures, measures the bench from photos of the carved board, and designs a better
// board. The work is in tools/loop: stages.h describes a project, turn.h runs it.
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "burin/base/error.h"
#include "burin/base/files/json_file.h"
#include "burin/optimize/machine_profile.h"
#include "tools/commands.h"
#include "tools/loop/options.h"
#include "tools/loop/round_design.h"
#include "tools/loop/turn.h"
#include "tools/new/ask.h"
#include "tools/project_settings.h"
#include "tools/work_lock.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

struct LoopArguments {
  Project project;
  LoopCommandLine said;
  LoopAnswers answers;
  std::vector<std::string> views, lamps;
  bool dry_run = false;
};

// Asks once for the machine's reach. Without a user at the terminal, the tool path has a note about it.
void ask_for_travel(LoopProject& loop, LoopCommandLine& said) {
  const MachineProfile machine = machine_of(loop.options, loop.project.folder);
  const bool person = is_person_there();
  if (!person || machine.travel || machine.travel_is_unknown) return;
  Conversation talk{std::cin, std::cout};
  ask(talk,
      "How far does " + machine.name +
          " go to the right and up from the board's lower left corner (300x180 in mm)? "
          "What lies farther is refused",
      "unknown", [&](const std::string& answer) {
        said.travel = answer;
        loop.options = remember_options(said, loop.project.folder);
      });
}

void run(LoopArguments o) {
  o.project.folder = project_folder(o.project.folder, "PROJECT_DIR");
  for (const char* file : {"board.json", "design.json", "bench.json"})
    if (!fs::exists(o.project.folder / file))
      fail((o.project.folder / file).string(), "a loop project needs this file",
           "see samples/small-bench for a complete project");
  require_own_files(o.project);
  if (o.dry_run) {
    print(dry_run({o.project, read_loop_options(o.project.folder)}, o.answers));
    return;
  }
  const WorkLock lock(o.project.folder, "burin loop");
  // Refuses a round that is a link out of the project, before any file moves.
  for (int round = 1; round <= o.project.rounds(); ++round) make_output_folder(o.project.round(round));
  remember_names(o.project, o.views, o.lamps);
  if (!o.said.machine.empty()) machine_profile(o.said.machine);  // refused before it is stored
  LoopProject loop{o.project, remember_options(o.said, o.project.folder)};
  ask_for_travel(loop, o.said);  // and refuses the machine before any file moves
  turn_loop(loop, o.answers);
}

}  // namespace

void add_loop_command(CLI::App& burin) {
  auto o = std::make_shared<LoopArguments>();
  CLI::App* command =
      burin.add_subcommand("loop", "Run all steps from design to redesign in order, and resume after an interruption");
  command->add_option("PROJECT_DIR", o->project.folder,
                      "Use this folder with board.json, design.json and a nominal bench.json [default: the working "
                      "directory's project]");
  command->add_option("--force", o->answers.again,
                      "Repeat this stage and its successors: design, toolpath, board, capture, calibrate, refine, "
                      "report, or round-02/refine");
  command->add_flag("--allow-stale", o->answers.keep,
                    "Continue with outdated, edited, unfinished or unrecorded results as they are");
  command->add_flag("--dry-run", o->dry_run,
                    "List the stages that would be made, with the stored options; change nothing");
  command->add_flag("--another", o->answers.another, "Design another board although its expected gain is not visible");
  command->add_option("--allow-undetermined", o->answers.accept_unknown,
                      "Continue with this undetermined or weakly determined parameter: depth_um, alpha, machine.affine "
                      "or light.ID.position_mm");
  command->add_option("--view", o->views,
                      "Assign a photographed view to a designed one, in names.json: middle=v01 (undo: middle=)");
  command->add_option("--lamp", o->lamps,
                      "Assign a measured lamp to a designed one, in names.json: ceiling=lamp (undo: ceiling=)");
  command
      ->add_option("--rounds", o->answers.simulated_rounds,
                   "Simulate this number of boards in a project that has a truth.json")
      ->check(CLI::Range(1, 99))
      ->capture_default_str();
  add_loop_options(*command, o->said);
  command->footer(
      example("burin loop samples/small-bench\n"
              "  burin loop my-board --machine spring.toml --tolerance 3 --chunks 30min\n"
              "  burin loop my-board --force design"));
  command->callback([o] { run(*o); });
}

}  // namespace burin

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "burin/simulate/simulated_camera.h"
#include "tools/commands.h"
#include "tools/progress_bar.h"
#include "tools/work_lock.h"

namespace burin {

void add_simulate_command(CLI::App& burin) {
  struct Options {
    std::filesystem::path truth, out;
    SimulateOptions simulate;
    int samples = 0;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = burin.add_subcommand("simulate", "Render synthetic photos of a setup with known ground truth");
  command->add_option("TRUTH.json", options->truth, "Read the ground truth of the setup from this file")->required();
  command->add_option("--out", options->out, "Write photos, board.json and session.json to this folder")->required();
  command->add_option("--scratches", options->simulate.scratches,
                      "Carve these scratches (CSV) [default: the ground truth's]");
  command->add_option("--views", options->simulate.views, "Render these views only [default: all]");
  command
      ->add_option("--samples", options->samples,
                   "Use this number of samples per pixel on scratches [default: the ground truth's]")
      ->check(CLI::Range(1, 1000000));
  command->footer(example("burin simulate truth.json --out bench --views d0 d1"));
  command->callback([options] {
    const WorkLock lock(options->out, "burin simulate", WorkLock::Where::new_folders);
    ProgressBar bar;
    if (options->samples > 0) options->simulate.samples = options->samples;
    simulate(options->truth, options->out, options->simulate, bar.progress());
    bar.clear();
    const auto in_out = [&](const char* name) { return shell_word((options->out / name).string()); };
    const std::string out = shell_word(options->out.string());
    if (std::filesystem::exists(options->out / "session.json"))
      print_text("Wrote {}: photos, board.json, session.json; next: burin calibrate {} --out {}\n",
                 options->out.string(), in_out("session.json"), out);
    else
      print_text("Wrote {}: photos and board.json; next: burin capture {} --board {} --out {}\n", options->out.string(),
                 in_out("photos"), in_out("board.json"), out);
  });
}

}  // namespace burin

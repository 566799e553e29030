#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "burin/simulate/simulated_camera.h"
#include "tools/commands.h"
#include "tools/progress_bar.h"
#include "tools/steps.h"
#include "tools/work_lock.h"

namespace burin {

Report run_simulate(const SimulateArguments& o) {
  const WorkLock lock(o.out, "burin simulate", WorkLock::Where::new_folders);
  ProgressBar bar;
  SimulateOptions options = o.simulate;
  if (o.samples > 0) options.samples = o.samples;
  simulate(o.truth, o.out, options, bar.progress());
  bar.clear();
  const auto in_out = [&](const char* name) { return (o.out / name).string(); };
  Report report;
  const bool session = std::filesystem::exists(o.out / "session.json");
  report.data["session"] = session ? Json(in_out("session.json")) : Json();
  if (session)
    report.next = {{"burin", "calibrate", in_out("session.json"), "--out", o.out.string()}};
  else
    report.next = {{"burin", "capture", in_out("photos"), "--board", in_out("board.json"), "--out", o.out.string()}};
  report.line("Wrote {}: photos{} board.json{}; next: {}\n", o.out.string(), session ? "," : " and",
              session ? ", session.json" : "", command_text(report.next.front()));
  return report;
}

void add_simulate_command(CLI::App& burin) {
  auto options = std::make_shared<SimulateArguments>();
  CLI::App* command = burin.add_subcommand("simulate", "Render synthetic photos of a setup with known ground truth");
  command->add_option("TRUTH.json", options->truth, "Read the ground truth of the setup from this file")->required();
  command->add_option("--out", options->out, "Write photos, board.json and session.json to this folder")->required();
  command->add_option("--scratches", options->simulate.scratches,
                      "Carve these scratches (CSV) [default: the ground truth's]");
  command->add_option("--view", options->simulate.views, "Render this view only; repeat for several [default: all]");
  command
      ->add_option("--samples", options->samples,
                   "Use this number of samples per pixel on scratches [default: the ground truth's]")
      ->check(CLI::Range(1, 1000000));
  command->footer(example("burin simulate truth.json --out bench --view d0 --view d1"));
  command->callback([options] { print(run_simulate(*options)); });
}

}  // namespace burin

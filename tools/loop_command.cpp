// burin loop: pictures to scratches, photographs of the carved board to a measured bench, and a better board from it.
//
// A project is a folder with board.json, design.json and a nominal bench.json. Every step is a burin command that a
// person could have typed (and sees); it leaves files whose presence means that it is done, because they are moved into
// place whole. So the loop goes on where it stopped, whatever stopped it; to do a step again, delete what it left.
//
//   round-NN/design.json          what this round designs for: the measured bench of the round before
//   round-NN/design/              `burin design`: previews, design-report.json
//   round-NN/scratches.csv        as designed
//   round-NN/board.gcode, .svg    `burin toolpath`: compensated by the machine's measured map
//   round-NN/ordered.csv          the scratches as designed, in carving order
//   round-NN/sent.csv             the same as the machine is told them: compensated, with width, depth and alpha
//   round-NN/board.json           the board to be photographed: its scratches are sent.csv
//   round-NN/photos/              a person's; or, where the project holds a truth.json, the simulated camera's
//   round-NN/session.json         `burin capture`
//   round-NN/bench.json, ...      `burin calibrate`, completed by `burin refine`
//   round-NN/report.html          `burin report`
//
// truth.json stands for the workshop: it is read by `burin simulate` alone, to carve and to photograph.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "burin/optimize/carving/toolpath_check.h"
#include "burin/optimize/design_file.h"
#include "burin/optimize/machine_profile.h"
#include "burin/render/bench_of_board.h"
#include "burin/render/board.h"
#include "burin/render/carve.h"
#include "burin/render/error.h"
#include "burin/render/files/json_file.h"
#include "burin/render/scratches.h"
#include "tools/command_line.h"
#include "tools/commands.h"
#include "tools/project.h"
#include "tools/round_names.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPartSuffix = ".part";

struct Loop {
  Project project;
  std::string machine = "grbl";
  int simulated_rounds = 1;
};

class Steps {
 public:
  /// Whether the step's result is still to be made. Says once where the loop goes on.
  bool needed(const fs::path& result, const std::string& name) {
    if (fs::exists(result)) {
      some_done_ = true;
      return false;
    }
    if (some_done_ && !said_) fmt::print("Going on with: {}\n", name);
    said_ = true;
    fmt::print("\n== {}\n", name);
    std::fflush(stdout);
    return true;
  }

 private:
  bool some_done_ = false, said_ = false;
};

void run_step(const std::vector<std::string>& arguments) {
  std::string line = "burin";
  for (const std::string& a : arguments) line += " " + shell_word(a);
  fmt::print("> {}\n", line);
  std::fflush(stdout);
  run_command(arguments);
}

// A folder that a step fills and that takes its final name only when the step is done.
fs::path part_folder(const fs::path& result) {
  fs::path part = result;
  part += kPartSuffix;
  fs::remove_all(part);
  return part;
}

void copy_atomically(const fs::path& from, const fs::path& to) {
  write_atomically(
      to, [&](const fs::path& temporary) { fs::copy_file(from, temporary, fs::copy_options::overwrite_existing); });
}

// This round's design.json: the project's pictures, for the bench as it is known now.
void write_round_design(const Project& project, int number, const fs::path& file) {
  DesignSpec spec = read_design(project.folder / "design.json");
  if (number > 1) {  // what was measured, under the names of the design
    const fs::path measured_file = project.bench_before(number), named = file.parent_path() / "bench-before.json";
    const Matching matching = match_round(project, number - 1);
    require_complete(matching, measured_file);
    for (const Finding& finding : matched_findings(matching, measured_file)) note(sentence(finding));
    write_bench(matching.bench, read_board(spec.board).tool_width_um, named);
    spec.bench = named;
  }
  write_design(spec, file);
}

// What the machine is told, in its order: ends and depths read back from the files that it is given, width and
// roughness as designed.
void write_sent_scratches(const Loop& loop, int number, const fs::path& ordered) {
  const fs::path round = loop.project.round(number);
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(round)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("board") && entry.path().extension() == ".gcode") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  const MachineProfile machine = machine_profile(loop.machine);
  std::vector<ReplayedScratch> told;
  for (const fs::path& file : files) {
    const Replay replay = replay_gcode(read_text(file), machine, file.string());
    told.insert(told.end(), replay.scratches.begin(), replay.scratches.end());
  }
  const Board board = read_board(loop.project.folder / "board.json");
  Scratches sent =
      compensated(Designed(read_scratches(ordered)),
                  read_bench_of(board, loop.project.folder / "board.json", loop.project.bench_before(number)), board)
          .scratches;
  sent.carved.clear();
  if (sent.size() != told.size())
    fail(round.string(), fmt::format("its G-code carves {} scratches of {}", told.size(), sent.size()),
         "delete its board.json and run burin loop again");
  for (std::size_t i = 0; i < told.size(); ++i) {
    sent.x0_mm[i] = told[i].from_mm.x();
    sent.y0_mm[i] = told[i].from_mm.y();
    sent.x1_mm[i] = told[i].to_mm.x();
    sent.y1_mm[i] = told[i].to_mm.y();
    // A head that presses is told a force instead.
    if (!sent.depth_um.empty() && std::isfinite(told[i].depth_mm)) sent.depth_um[i] = 1e3 * told[i].depth_mm;
  }
  write_scratches(sent, round / "sent.csv");
}

void write_round_board(const Project& project, const fs::path& round) {
  Board board = read_board(project.folder / "board.json");
  board.scratches = round / "sent.csv";
  write_board(board, round / "board.json");
}

void design_round(const Loop& loop, int number, Steps& steps) {
  const Project& project = loop.project;
  const fs::path round = project.round(number);
  make_output_folder(round);
  const std::string name = round.filename().string();
  if (steps.needed(round / "scratches.csv", name + ": design")) {
    write_round_design(project, number, round / "design.json");
    const fs::path part = part_folder(round / "design");
    run_step({"design", (round / "design.json").string(), "--out", part.string(), "--machine", loop.machine});
    fs::remove_all(round / "design");
    fs::rename(part, round / "design");
    copy_atomically(round / "design" / "scratches.csv", round / "scratches.csv");
  }
  if (steps.needed(round / "board.json", name + ": tool path")) {
    const fs::path ordered = round / "ordered.csv";
    for (const char* file : {"board.svg", "board.gcode"})
      run_step({"toolpath", (round / "scratches.csv").string(), "--board", (project.folder / "board.json").string(),
                "--bench", project.bench_before(number).string(), "--machine", loop.machine, "--ordered",
                ordered.string(), "--out", (round / file).string()});
    write_sent_scratches(loop, number, ordered);
    write_round_board(project, round);
  }
}

// The workshop, where the project holds a truth.json. Returns false if a person has to go there.
bool carve_and_photograph(const Loop& loop, int number, Steps& steps) {
  const Project& project = loop.project;
  const fs::path round = project.round(number), photos = round / "photos";
  if (fs::exists(photos) && !fs::is_empty(photos)) {
    steps.needed(photos, "");
    return true;
  }
  if (!fs::exists(project.folder / "truth.json") || number > loop.simulated_rounds) return false;
  fs::remove(photos);
  steps.needed(photos, round.filename().string() + ": carve and photograph (simulated from truth.json)");
  const fs::path part = part_folder(round / "workshop");
  run_step({"simulate", (project.folder / "truth.json").string(), "--scratches", (round / "sent.csv").string(), "--out",
            part.string()});
  fs::rename(part / "photos", photos);
  fs::remove_all(part);
  return true;
}

void measure_round(const Loop& loop, int number, Steps& steps) {
  const Project& project = loop.project;
  const fs::path round = project.round(number);
  const std::string name = round.filename().string();
  if (steps.needed(round / "session.json", name + ": capture"))
    run_step({"capture", (round / "photos").string(), "--board", (round / "board.json").string(), "--bench",
              project.bench_before(number).string(), "--out", round.string()});
  if (steps.needed(round / "calibration" / "bench.json", name + ": calibrate")) {
    const fs::path part = part_folder(round / "calibration");
    run_step({"calibrate", (round / "session.json").string(), "--out", part.string()});
    fs::remove_all(round / "calibration");
    fs::rename(part, round / "calibration");
  }
  if (steps.needed(round / "bench.json", name + ": refine")) {
    const fs::path part = part_folder(round / "refinement");
    fs::copy(round / "calibration", part, fs::copy_options::recursive);
    run_step({"refine", (round / "session.json").string(), "--bench", (part / "bench.json").string()});
    for (const auto& entry : fs::directory_iterator(part))
      if (entry.path().filename() != "bench.json") copy_atomically(entry.path(), round / entry.path().filename());
    copy_atomically(part / "bench.json", round / "bench.json");
    fs::remove_all(part);
  }
  if (steps.needed(round / "report.html", name + ": report")) run_step({"report", round.string()});
}

// The command that turns this loop on.
std::string loop_line(const Loop& loop) {
  std::string line = "burin loop " + shell_word(loop.project.folder.string());
  if (loop.machine != Loop().machine) line += " --machine " + shell_word(loop.machine);
  return line;
}

void say_what_to_do(const Loop& loop, int number) {
  const Project& project = loop.project;
  const fs::path round = project.round(number);
  const DesignSpec spec = read_design(round / "design.json");
  std::string views;
  for (const DesignView& view : spec.views) views += (views.empty() ? "" : ", ") + view.view;
  fmt::print(
      "Your turn:\n"
      "  1. Carve {} (work zero at the board's lower left corner, on its face).\n"
      "  2. Stick the tags of {} on it, lay it under the lamp, and photograph it: from each designed view ({}), from\n"
      "     three places near the mirror direction, where the plain face shines, and from five or more further ones, "
      "with\n"
      "     the camera tilted and the board in other parts of the frame. Two exposures each, three stops apart; keep\n"
      "     focus and zoom as they are. Some views must hardly glint: only half vectors on both sides of the grooves'\n"
      "     cut-off angle tell how deep they are.\n"
      "  3. Put the photos into {}; then: {}\n\n",
      (round / "board.gcode").string(), (project.folder / "board.json").string(), views, (round / "photos").string(),
      loop_line(loop));
}

void run_loop(const Loop& loop) {
  const Project& project = loop.project;
  for (const char* file : {"board.json", "design.json", "bench.json"})
    if (!fs::exists(project.folder / file))
      fail((project.folder / file).string(), "a loop project needs this file",
           "see samples/small-bench for a complete project");
  Steps steps;
  int number = 1;
  for (;; ++number) {
    design_round(loop, number, steps);
    if (!carve_and_photograph(loop, number, steps)) break;
    measure_round(loop, number, steps);
  }
  // The last round is designed and not yet carved: for the bench as it is, if any board was photographed.
  fmt::print("\n== report\n");
  run_step({"report", project.folder.string()});
  const bool simulated = fs::exists(project.folder / "truth.json");
  if (!simulated) say_what_to_do(loop, number);
  fmt::print("The loop has turned {} time{}; the next board to carve is {}.{}\n", number - 1, number == 2 ? "" : "s",
             (project.round(number) / "board.gcode").string(),
             simulated ? fmt::format(" To simulate that too: {} --rounds {}", loop_line(loop), number) : "");
}

}  // namespace

void add_loop_command(CLI::App& burin) {
  auto loop = std::make_shared<Loop>();
  CLI::App* command = burin.add_subcommand(
      "loop", "Design, carve, photograph, measure, and design again for the bench as it is; goes on where it stopped");
  command
      ->add_option("PROJECT_DIR", loop->project.folder,
                   "A folder with board.json, design.json and a nominal bench.json")
      ->required();
  command->add_option("--rounds", loop->simulated_rounds, "With a truth.json: how many boards to carve and photograph")
      ->check(CLI::Range(1, 99))
      ->capture_default_str();
  command->add_option("--machine", loop->machine, "grbl, linuxcnc, marlin, or a burin/machine file in JSON or TOML")
      ->capture_default_str();
  command->footer(example("burin loop samples/small-bench"));
  command->callback([loop] { run_loop(*loop); });
}

}  // namespace burin

#include "tools/wanted_bench.h"

#include "burin/base/error.h"
#include "burin/scene/bench_of_board.h"
#include "tools/commands.h"
#include "tools/round_names.h"

namespace burin {

namespace fs = std::filesystem;

WantedBench wanted_bench(const Project& project) {
  if (!fs::is_directory(project.folder))
    fail(project.folder.string(), "is no project's folder", "name the folder that holds design.json and board.json");
  WantedBench out;
  out.measured_rounds = project.measured();
  const int rounds = project.rounds();
  fs::path design = project.folder / "design.json";
  // A round stores the design of its carved board.
  if (rounds > out.measured_rounds && fs::exists(project.round(rounds) / "design.json"))
    design = project.round(rounds) / "design.json";
  out.design = read_design(design);
  out.board_file = out.design.board;
  out.board = read_board(out.board_file);
  if (out.measured_rounds > 0 && design.parent_path() == project.folder) {
    out.bench_file = project.bench_before(out.measured_rounds + 1);
    const Matching matching = match_round(project, out.measured_rounds);
    require_complete(matching, out.bench_file);
    out.bench = matching.bench;
    settle_material(out.bench, out.bench_file, out.board, out.board_file);
  } else {
    out.bench_file = out.design.bench;
    out.bench = read_bench_of(out.board, out.board_file, out.bench_file);
  }
  fs::path report;
  if (rounds > 0) {
    report = project.round(rounds) / "design" / "design-report.json";
    for (const char* file : {"sent.csv", "scratches.csv"})
      if (out.scratches.empty() && fs::exists(project.round(rounds) / file))
        out.scratches = project.round(rounds) / file;
  }
  out.tolerances = shown_tolerances(out.design, out.bench, out.board, report);
  return out;
}

std::vector<Eigen::Vector3d> designed_eyes(const WantedBench& wanted) {
  std::vector<Eigen::Vector3d> eyes;
  for (const DesignView& v : wanted.design.views)
    eyes.push_back(find_view(wanted.bench, v.view, "the design").T_camera_board.inverse().translation());
  return eyes;
}

}  // namespace burin

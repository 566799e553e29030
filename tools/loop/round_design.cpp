#include "tools/loop/round_design.h"

#include <string>
#include <utility>

#include "burin/optimize/design_file.h"
#include "burin/render/bench.h"
#include "burin/render/bench_of_board.h"
#include "burin/render/board.h"
#include "burin/render/error.h"
#include "tools/commands.h"
#include "tools/round_names.h"

namespace burin {

namespace fs = std::filesystem;

void write_round_design(const Project& project, int number, const fs::path& file) {
  DesignSpec spec = read_design(project.folder / "design.json");
  if (number > 1) {  // what was measured, under the names of the design
    const fs::path measured = project.bench_before(number), named = file.parent_path() / "bench-before.json";
    const Matching matching = match_round(project, number - 1);
    require_complete(matching, measured);
    for (const Finding& finding : matched_findings(matching, measured)) note(finding);
    write_bench(matching.bench, read_board(spec.board).tool_width_um, named);
    spec.bench = named;
  }
  write_design(spec, file);
}

void require_own_files(const Project& project) {
  const fs::path design = project.folder / "design.json";
  const DesignSpec spec = read_design(design);
  for (const auto& [named, own] : {std::pair{spec.board, "board.json"}, std::pair{spec.bench, "bench.json"}})
    if (fs::weakly_canonical(named) != fs::weakly_canonical(project.folder / own))
      fail(design.string(),
           "names " + named.string() + ", but tool path and photos of a loop are made with " +
               (project.folder / own).string(),
           std::string("write \"") + own + "\" there, and put that file in its place if it is the one that is meant");
}

void require_one_truth(const Project& project, int number) {
  const DesignSpec spec = read_design(project.folder / "design.json");
  read_bench_of(read_board(spec.board), spec.board, number == 1 ? spec.bench : project.bench_before(number));
}

void require_designable(const Project& project, int number) {
  require_one_truth(project, number);
  if (number > 1) require_complete(match_round(project, number - 1), project.bench_before(number));
}

void remember_names(const Project& project, const std::vector<std::string>& views,
                    const std::vector<std::string>& lamps) {
  if (views.empty() && lamps.empty()) return;
  const int measured = project.measured();
  if (measured == 0)
    fail(views.empty() ? "--lamp" : "--view", "says which photo is which, and no board of this project is measured yet",
         "leave it out until the loop asks for it");
  GivenNames said;
  for (const std::string& words : views) add_given_name("--view", words, said.views);
  for (const std::string& words : lamps) add_given_name("--lamp", words, said.lamps);
  const fs::path file = project.round(measured) / "names.json";
  const GivenNames kept = read_names(file);
  said.views.insert(kept.views.begin(), kept.views.end());
  said.lamps.insert(kept.lamps.begin(), kept.lamps.end());
  write_names(said, file);
}

}  // namespace burin

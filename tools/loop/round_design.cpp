#include "tools/loop/round_design.h"

#include <string>

#include "burin/optimize/design_file.h"
#include "burin/render/bench.h"
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
    for (const Finding& finding : matched_findings(matching, measured)) note(sentence(finding));
    write_bench(matching.bench, read_board(spec.board).tool_width_um, named);
    spec.bench = named;
  }
  write_design(spec, file);
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

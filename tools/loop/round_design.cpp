#include "tools/loop/round_design.h"

#include <fmt/format.h>

#include <map>
#include <set>
#include <string>
#include <utility>

#include "burin/base/error.h"
#include "burin/optimize/design_file.h"
#include "burin/scene/bench.h"
#include "burin/scene/bench_of_board.h"
#include "burin/scene/board.h"
#include "tools/commands.h"
#include "tools/round_names.h"

namespace burin {

namespace fs = std::filesystem;

void write_round_design(const Project& project, int number, const fs::path& file) {
  DesignSpec spec = read_design(project.folder / "design.json");
  if (number > 1) {  // the measured bench with the design's names
    const fs::path measured = project.bench_before(number), named = file.parent_path() / "bench-before.json";
    const Matching matching = match_round(project, number - 1);
    require_complete(matching, measured);
    for (const Finding& finding : matched_findings(matching, measured)) tell(finding);
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

namespace {

std::string listed(const std::set<std::string>& names) {
  std::string out;
  for (const std::string& name : names) out += (out.empty() ? "" : ", ") + name;
  return out;
}

void require_among(const std::string& option, const std::string& name, const std::set<std::string>& names,
                   const std::string& whose) {
  if (!names.contains(name))
    fail(option, fmt::format("\"{}\" is no name of {}", name, whose), fmt::format("choose among {}", listed(names)));
}

// Adds the names of one option to the stored ones; "middle=" removes one.
void say_names(const std::string& option, const std::vector<std::string>& said, const std::set<std::string>& designed,
               const std::set<std::string>& measured, std::map<std::string, std::string>& names) {
  std::map<std::string, std::string> pairs;
  for (const std::string& words : said) {
    if (words.size() < 2 || words.find('=') + 1 != words.size()) {
      add_given_name(option, words, pairs);
    } else if (names.erase(words.substr(0, words.size() - 1)) == 0) {
      fail(option + " " + words, "takes back a name, and none was said",
           names.empty() ? "leave it out" : "names.json holds one of " + names.begin()->first);
    }
  }
  for (const auto& [wanted, found] : pairs) {
    require_among(option, wanted, designed, "the design");
    require_among(option, found, measured, "the measured bench");
    names[wanted] = found;
  }
}

}  // namespace

void remember_names(const Project& project, const std::vector<std::string>& views,
                    const std::vector<std::string>& lamps) {
  if (views.empty() && lamps.empty()) return;
  const int measured = project.measured();
  if (measured == 0)
    fail(views.empty() ? "--lamp" : "--view", "says which photo is which, and no board of this project is measured yet",
         "leave it out until the loop asks for it");
  const fs::path file = project.round(measured) / "names.json";
  std::set<std::string> designed_views, designed_lamps, measured_views, measured_lamps;
  for (const DesignView& view : read_design(project.folder / "design.json").views) {
    designed_views.insert(view.view);
    for (const std::string& lamp : light_names(view.light)) designed_lamps.insert(lamp);
  }
  const Bench bench = read_bench(project.round(measured) / "bench.json");
  for (const View& view : bench.views) measured_views.insert(view.name);
  for (const Light& light : bench.lights) measured_lamps.insert(light.id);
  GivenNames names = read_names(file);
  say_names("--view", views, designed_views, measured_views, names.views);
  say_names("--lamp", lamps, designed_lamps, measured_lamps, names.lamps);
  if (names.views.empty() && names.lamps.empty())
    fs::remove(file);
  else
    write_names(names, file);
}

}  // namespace burin

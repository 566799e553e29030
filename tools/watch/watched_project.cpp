#include "tools/watch/watched_project.h"

#include <algorithm>
#include <set>
#include <string>

#include "burin/base/error.h"
#include "burin/base/files/json_file.h"
#include "burin/optimize/design_file.h"
#include "burin/scene/bench_of_board.h"
#include "tools/commands.h"
#include "tools/loop/printed_sheet.h"
#include "tools/loop/round_lamps.h"
#include "tools/loop/say.h"
#include "tools/photographed_lamps.h"
#include "tools/project.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

fs::path first_there(std::initializer_list<fs::path> files) {
  std::error_code ignored;
  for (const fs::path& file : files)
    if (!file.empty() && fs::is_regular_file(file, ignored)) return file;
  return {};
}

fs::path plan_of(const Project& project, const fs::path& round) {
  // The sheet's own plan is valid as long as the sheet.
  const bool stale = !changed_since_sheet(project).empty();
  return first_there({round.empty() ? fs::path() : round / "plan.json",
                      round.empty() ? fs::path() : round / "plan" / "plan.json",
                      stale ? fs::path() : project.folder / "plan.json", project.folder / "plan" / "plan.json"});
}

// Sets the folder of photos: the given one, or the round's.
void find_photos(const Project& project, const fs::path& round, const fs::path& given, WatchedProject& out) {
  std::error_code ignored;
  if (!round.empty()) out.keep = round / "photos";
  if (!given.empty()) {
    if (!fs::is_directory(given, ignored))
      fail(given.string(), "there is no such folder", "give the folder that the photos arrive in");
    out.photos = given;
    return;
  }
  if (round.empty())
    fail(project.folder.string(), "has no board to be photographed yet",
         "make one: " + loop_line(project) + "; or name the photos' folder with --photos DIR");
  if (fs::exists(round / "bench.json", ignored))
    fail(round.string(), "its photos are measured already",
         "go on: " + loop_line(project) + "; or name the photos to judge with --photos DIR");
  if (!fs::is_directory(out.keep, ignored)) make_output_folder(out.keep);
  out.photos = out.keep;
}

}  // namespace

WatchedProject watched_project(const fs::path& folder, const fs::path& photos, const fs::path& plan) {
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored)) fail(folder.string(), "there is no such folder", "give a project's folder");
  const Project project{folder};
  const int rounds = project.rounds();
  const fs::path round = rounds > 0 ? project.round(rounds) : fs::path();
  const fs::path board = first_there({round.empty() ? fs::path() : round / "board.json", folder / "board.json"});
  if (board.empty())
    fail((folder / "board.json").string(), "there is no board to look for",
         "give the folder of a project: it holds a board.json");
  WatchedProject out;
  out.shoot.board = read_board(board);
  if (out.shoot.board.tags.list.empty())
    fail(board.string(), "lists no tags, and photos are judged by them", "give the board its tags (tags.list)");
  find_photos(project, round, photos, out);
  ContentHashes hashes;
  if (rounds > 1) out.other_rounds = photos_of_other_rounds(project, rounds, hashes);

  const fs::path bench_file =
      first_there({rounds > 0 ? project.bench_before(rounds) : fs::path(), folder / "bench.json"});
  const fs::path design_file =
      first_there({round.empty() ? fs::path() : round / "design.json", folder / "design.json"});
  std::optional<Bench> bench;
  if (!bench_file.empty()) {
    bench = read_bench_of(out.shoot.board, board, bench_file);
    out.shoot.lens = bench->lens;
  }
  std::vector<MatchTolerance> tolerances;
  std::optional<DesignSpec> design;
  if (!design_file.empty() && bench) {
    design = read_design(design_file);
    const Bench designed = read_bench_of(out.shoot.board, board, design->bench);
    tolerances = match_tolerances(*design, designed, out.shoot.board,
                                  round.empty() ? fs::path() : round / "design" / "design-report.json");
    if (const fs::path found = plan.empty() ? plan_of(project, round) : plan; found.empty())
      out.shoot.wanted = designed_shots(*design, designed, out.shoot.board, tolerances);
  }
  if (const fs::path found = plan.empty() ? plan_of(project, round) : plan; !found.empty()) {
    out.shoot.wanted = planned_shots(found, out.shoot.board);
    take_tolerances(tolerances, out.shoot.wanted);
    out.wanted_from = found.string();
  } else {
    std::set<std::string> designed;
    for (const WantedShot& shot : out.shoot.wanted) designed.insert(shot.name);
    out.shoot.least_places = designed.size() + kFewestPlaces;
    if (design) out.wanted_from = design_file.string();
    out.plan_line = design ? "burin sheet " + shell_word(folder.string())
                           : "burin plan " + shell_word(board.string()) +
                                 (bench ? " --bench " + shell_word(bench_file.string()) : "") + " --out " +
                                 shell_word(((round.empty() ? folder : round) / "plan").string());
    if (const std::string changed = changed_since_sheet(project); !changed.empty())
      out.plan_line += " (the printed sheet is out of date: " + changed + " changed)";
  }
  if (bench)
    for (const std::string& lamp : lamps_of(*bench))
      if (std::any_of(out.shoot.wanted.begin(), out.shoot.wanted.end(),
                      [&](const WantedShot& shot) { return shot.light == lamp; }))
        out.lamps.push_back(lamp);
  out.next = out.photos == out.keep
                 ? loop_line(project)
                 : "burin capture " + shell_word(out.photos.string()) + " --board " + shell_word(board.string()) +
                       (bench ? " --bench " + shell_word(bench_file.string()) : "") + " --out DIR";
  return out;
}

}  // namespace burin

#include "tools/round_names.h"

#include <algorithm>
#include <set>

#include "burin/base/error.h"
#include "burin/base/files/json_file.h"
#include "burin/capture/session.h"
#include "burin/scene/bench_of_board.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

std::map<std::string, std::string> read_map(JsonObject& root, const std::string& key) {
  std::map<std::string, std::string> names;
  if (!root.has(key)) return names;
  JsonObject json = root.object(key);
  for (const std::string& designed : json.keys()) names[designed] = json.text(designed);
  json.finish();
  return names;
}

Json map_json(const std::map<std::string, std::string>& names) {
  Json json = Json::object();
  for (const auto& [designed, measured] : names) json[designed] = measured;
  return json;
}

// Adds to `known` the missing items of `nominal`.
template <typename Item, typename SameName>
void complete_by(std::vector<Item>& known, const std::vector<Item>& nominal, SameName same_name) {
  for (const Item& item : nominal)
    if (std::none_of(known.begin(), known.end(), [&](const Item& other) { return same_name(item, other); }))
      known.push_back(item);
}

// Returns the lamps under which each view of a round was photographed; nothing without its session.
std::map<std::string, std::set<std::string>> lamps_by_view(const fs::path& round) {
  std::map<std::string, std::set<std::string>> out;
  if (!fs::exists(round / "session.json")) return out;
  for (const Photo& photo : read_session(round / "session.json").photos) out[photo.view].insert(photo.light);
  return out;
}

// Several measured views near a designed one, each under other lamps, come from a camera that was put back between
// lamps. They count as that view, and the nearest represents it. By designed names.
std::map<std::string, std::string> one_place_by_lamps(const Matching& matching,
                                                      const std::map<std::string, std::set<std::string>>& lamps_of) {
  std::map<std::string, int> times;  // number of designed views near a measured one
  for (const Match& match : matching.views)
    for (const Candidate& candidate : match.near) ++times[candidate.name];
  std::map<std::string, std::string> out;
  for (const Match& match : matching.views) {
    if (!match.measured.empty() || match.near.size() < 2) continue;
    std::set<std::string> lamps;
    bool one_place = true;
    for (const Candidate& candidate : match.near) {
      const auto found = lamps_of.find(candidate.name);
      one_place = one_place && found != lamps_of.end() && times[candidate.name] == 1;
      if (!one_place) break;
      for (const std::string& lamp : found->second) one_place = lamps.insert(lamp).second && one_place;
    }
    if (one_place) out[match.designed] = match.near.front().name;
  }
  return out;
}

}  // namespace

GivenNames read_names(const fs::path& file) {
  if (!fs::exists(file)) return {};
  const Json json = read_json(file, "burin/names", 1);
  JsonObject root(json, file.string());
  root.text("format");
  root.integer("version");
  GivenNames names;
  names.views = read_map(root, "views");
  names.lamps = read_map(root, "lamps");
  root.finish();
  return names;
}

void write_names(const GivenNames& names, const fs::path& file) {
  Json json;
  json["format"] = "burin/names";
  json["version"] = 1;
  json["views"] = map_json(names.views);
  json["lamps"] = map_json(names.lamps);
  write_json(json, file);
}

Matching match_round(const Project& project, int number, const GivenNames& given) {
  const fs::path round = project.round(number);
  const DesignSpec wanted = read_design(project.folder / "design.json"), carved = read_design(round / "design.json");
  const Board board = read_board(carved.board);
  Bench designed = read_bench(carved.bench);
  const Bench nominal = read_bench(wanted.bench);
  complete_by(designed.views, nominal.views, [](const View& a, const View& b) { return a.name == b.name; });
  complete_by(designed.lights, nominal.lights, [](const Light& a, const Light& b) { return a.id == b.id; });
  fill_material(designed, board);
  GivenNames names = given;
  const GivenNames kept = read_names(round / "names.json");
  names.views.insert(kept.views.begin(), kept.views.end());
  names.lamps.insert(kept.lamps.begin(), kept.lamps.end());
  const Bench measured = read_bench(round / "bench.json");
  const std::vector<MatchTolerance> tolerances =
      match_tolerances(wanted, designed, board, round / "design" / "design-report.json");
  Matching matching = match_bench(wanted, designed, measured, board, tolerances, names);
  if (matching.complete()) return matching;
  const std::map<std::string, std::string> by_lamps = one_place_by_lamps(matching, lamps_by_view(round));
  if (by_lamps.empty()) return matching;
  names.views.insert(by_lamps.begin(), by_lamps.end());
  matching = match_bench(wanted, designed, measured, board, tolerances, names);
  for (Match& match : matching.views)
    if (by_lamps.contains(match.designed)) match.given = false;
  return matching;
}

}  // namespace burin

#include "tools/round_names.h"

#include <algorithm>

#include "burin/render/bench_of_board.h"
#include "burin/render/error.h"
#include "burin/render/files/json_file.h"

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

// `known` with what it lacks of `nominal`.
template <typename Item, typename SameName>
void complete_by(std::vector<Item>& known, const std::vector<Item>& nominal, SameName same_name) {
  for (const Item& item : nominal)
    if (std::none_of(known.begin(), known.end(), [&](const Item& other) { return same_name(item, other); }))
      known.push_back(item);
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
  return match_bench(wanted, designed, read_bench(round / "bench.json"), board,
                     match_tolerances(wanted, designed, board, round / "design" / "design-report.json"), names);
}

}  // namespace burin

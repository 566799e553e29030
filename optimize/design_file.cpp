#include "burin/optimize/design_file.h"

#include <algorithm>
#include <set>

#include "burin/base/error.h"
#include "burin/base/files/json_file.h"
#include "burin/optimize/white.h"
#include "burin/pictures/picture.h"
#include "burin/scene/bench.h"

namespace burin {
namespace {

std::string read_lights(JsonObject& json, const std::string& fallback) {
  if (!json.has("lights")) return json.text("light", fallback);
  if (json.has("light")) json.fail_field("lights", "contradicts light", "keep one of both");
  const Json& list = json.raw("lights");
  std::vector<std::string> names;
  for (const Json& name : list.is_array() ? list : Json::array()) {
    if (!name.is_string() || name.get<std::string>().empty()) {
      names.clear();
      break;
    }
    names.push_back(name.get<std::string>());
    if (std::count(names.begin(), names.end(), names.back()) > 1)
      json.fail_field("lights", "names \"" + names.back() + "\" twice", "name each light once");
  }
  if (names.empty())
    json.fail_field("lights", "is no list of names", "write names of the bench's lights, as [\"sun\", \"room\"]");
  return joined_lights(names);
}

White read_white(JsonObject& json, bool color) {
  const char* remedy = "give \"paper\", \"each\" or a light [r, g, b] that is to look white";
  if (!color) json.fail_field("white", "is set for a picture in gray", "add \"color\": true, or leave it out");
  if (json.raw("white").is_string()) {
    const std::string kind = json.text("white");
    if (kind == "paper") return {};
    if (kind == "each") return {White::Kind::each, {1, 1, 1}};
    json.fail_field("white", "is \"" + kind + "\"", remedy);
  }
  const std::vector<double> rgb = json.numbers("white", 3);
  if (!(rgb[0] > 0 && rgb[1] > 0 && rgb[2] > 0)) json.fail_field("white", "is no light of three colors", remedy);
  const Eigen::Vector3d light(rgb[0], rgb[1], rgb[2]);
  if (!can_be_white(light)) json.fail_field("white", "has a thousand times less of a color than of another", remedy);
  return {White::Kind::light, light};
}

DesignView read_view(JsonObject& json, const std::filesystem::path& folder) {
  DesignView v;
  v.view = json.text("view");
  v.light = read_lights(json, v.light);
  v.target.picture = folder / json.text("target");
  if (json.has("rotation_deg") && json.raw("rotation_deg").is_string()) {
    if (json.text("rotation_deg") != "viewer")
      json.fail_field("rotation_deg", "is \"" + json.text("rotation_deg") + "\"", "give degrees or \"viewer\"");
    v.target.upright_in_view = true;
  } else {
    v.target.rotation_deg = json.number("rotation_deg", 0);
  }
  const std::string fit = json.text("fit", "cover");
  if (fit != "cover" && fit != "contain") json.fail_field("fit", "is \"" + fit + "\"", "give \"cover\" or \"contain\"");
  v.target.fit = fit == "cover" ? Fit::cover : Fit::contain;
  if (json.has("keep")) {
    v.target.keep = keep_named(json.text("keep"));
    if (!v.target.keep)
      json.fail_field("keep", "is \"" + json.text("keep") + "\"",
                      "give \"top\", \"middle\", \"bottom\", \"left\" or \"right\"");
  }
  if (json.has("levels")) {
    const auto levels = json.numbers("levels", 2);
    if (!(levels[0] < levels[1]) || levels[0] < 0 || levels[1] > 1)
      json.fail_field("levels", "is not a black below a white", "give two numbers from 0 to 1, such as [0.05, 0.95]");
    v.target.levels = std::array<double, 2>{levels[0], levels[1]};
  }
  if (json.has("mask")) v.target.mask = folder / json.text("mask");
  v.weight = json.positive("weight", 1);
  v.color = json.boolean("color", false);
  if (json.has("white")) v.white = read_white(json, v.color);
  if (json.has("exposure")) {
    v.exposure = json.positive("exposure");
    v.target.may_be_even = true;
    if (v.white.kind == White::Kind::each)
      json.fail_field("exposure", "contradicts \"white\": \"each\", which gives each channel its own",
                      "leave one of both out");
  }
  json.finish();
  return v;
}

constexpr std::array<const char*, 5> kKeepNames{"middle", "top", "bottom", "left", "right"};

}  // namespace

const char* keep_name(Keep keep) { return kKeepNames[static_cast<std::size_t>(keep)]; }

std::optional<Keep> keep_named(const std::string& name) {
  for (std::size_t i = 0; i < kKeepNames.size(); ++i)
    if (name == kKeepNames[i]) return static_cast<Keep>(i);
  return std::nullopt;
}

DesignSpec read_design(const std::filesystem::path& file) {
  const Json json = read_json(file, "burin/design", 1);
  JsonObject root(json, file.string());
  root.text("format");
  root.integer("version");
  const std::filesystem::path folder = file.parent_path();
  DesignSpec spec;
  spec.board = folder / root.text("board");
  spec.bench = folder / root.text("bench");
  spec.scratches = root.integer("scratches");
  if (spec.scratches < 1 || spec.scratches > 2'000'000)
    root.fail_field("scratches", "is " + std::to_string(spec.scratches),
                    "give a number from 1 to 2000000; 40000 suits three pictures");
  std::set<std::string> seen;
  for (JsonObject& view : root.objects("views")) {
    spec.views.push_back(read_view(view, folder));
    const DesignView& v = spec.views.back();
    if (!seen.insert(v.view + " under " + v.light).second)
      view.fail_field("view", "\"" + v.view + "\" has two pictures under \"" + v.light + "\"",
                      "give each picture a view or a lamp of its own");
  }
  if (spec.views.empty()) root.fail_field("views", "is empty", "name at least one view and its target");
  root.finish();
  return spec;
}

void write_design(const DesignSpec& spec, const std::filesystem::path& file) {
  const std::filesystem::path folder = std::filesystem::absolute(file).parent_path();
  const auto relative = [&](const std::filesystem::path& p) {
    return std::filesystem::absolute(p).lexically_normal().lexically_proximate(folder.lexically_normal()).string();
  };
  Json json;
  json["format"] = "burin/design";
  json["version"] = 1;
  json["board"] = relative(spec.board);
  json["bench"] = relative(spec.bench);
  json["scratches"] = spec.scratches;
  json["views"] = Json::array();
  for (const DesignView& v : spec.views) {
    Json view;
    view["view"] = v.view;
    if (const std::vector<std::string> names = light_names(v.light); names.size() > 1)
      view["lights"] = names;
    else
      view["light"] = v.light;
    if (v.target.image.width > 0 || v.target.mask_image.width > 0)
      fail("view " + v.view, "has a target in memory, which a file cannot name", "write_picture() it, and name that");
    view["target"] = relative(v.target.picture);
    if (v.target.upright_in_view)
      view["rotation_deg"] = "viewer";
    else
      view["rotation_deg"] = v.target.rotation_deg;
    if (v.target.fit == Fit::contain) view["fit"] = "contain";
    if (v.target.keep) view["keep"] = keep_name(*v.target.keep);
    if (v.target.levels) view["levels"] = *v.target.levels;
    if (!v.target.mask.empty()) view["mask"] = relative(v.target.mask);
    if (v.weight != 1) view["weight"] = v.weight;
    if (v.color) view["color"] = true;
    if (v.color && v.white.kind == White::Kind::each) view["white"] = "each";
    if (v.color && v.white.kind == White::Kind::light) view["white"] = to_json(v.white.rgb);
    if (v.exposure) view["exposure"] = *v.exposure;
    json["views"].push_back(view);
  }
  write_json(json, file);
}

}  // namespace burin

#include "burin/scene/bench.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/base/files/files_together.h"
#include "burin/base/files/input_file.h"
#include "burin/base/files/json_file.h"
#include "burin/base/limits.h"
#include "burin/scene/files/bend_json.h"
#include "burin/scene/files/camera_effects_json.h"
#include "burin/scene/files/camera_json.h"
#include "burin/scene/files/far_light_json.h"
#include "burin/scene/files/lamp_size_json.h"
#include "burin/scene/files/machine_json.h"
#include "burin/scene/files/material_json.h"
#include "burin/scene/files/misfit_json.h"
#include "burin/scene/files/profile_json.h"
#include "burin/scene/files/verdict_json.h"
#include "burin/scene/groove.h"
#include "burin/scene/physical_bounds.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

constexpr int kVersion = 2;  // of bench.json: verdicts as facts
constexpr const char* kStrayId = "stray";

std::optional<double> optional_sigma(JsonObject& json, const std::string& key) {
  if (!json.has(key)) return std::nullopt;
  double v = json.number(key);
  if (v < 0) json.fail_field(key, "is " + Json(v).dump(), "a standard deviation is 0 or greater");
  return v;
}

template <typename Vector>
Vector of_no_sign(const Vector& v, const JsonObject& json, const std::string& key) {
  if ((v.array() < 0).any()) json.fail_field(key, "is " + to_json(v).dump(), "standard deviations are 0 or greater");
  return v;
}

std::optional<Eigen::Vector2d> optional_sigma2(JsonObject& json, const std::string& key) {
  if (!json.has(key)) return std::nullopt;
  return of_no_sign(json.vec2(key), json, key);
}

std::optional<Eigen::Vector3d> optional_sigma3(JsonObject& json, const std::string& key) {
  if (!json.has(key)) return std::nullopt;
  return of_no_sign(json.vec3(key), json, key);
}

void read_own_lens(JsonObject json, View& view) {
  const auto read = [&](const char* shift_key, const char* ratio_key, const OwnLens& usual) {
    OwnLens out = usual;
    if (json.has(shift_key)) out.shift_px = json.vec2(shift_key);
    out.focal_ratio = json.number(ratio_key, out.focal_ratio);
    return out;
  };
  view.own_lens = read("shift_px", "focal_ratio", {});
  if (!(view.own_lens->focal_ratio > 0))
    json.fail_field("focal_ratio", "is not above 0", "write the photo's focal length over that of the camera file");
  if (json.has("shift_sigma_px") || json.has("focal_ratio_sigma")) {
    view.own_lens_sigma = read("shift_sigma_px", "focal_ratio_sigma", {{0, 0}, 0});
    if (view.own_lens_sigma->shift_px.minCoeff() < 0 || view.own_lens_sigma->focal_ratio < 0)
      json.fail_field("shift_sigma_px", "or focal_ratio_sigma is negative", "standard deviations are 0 or greater");
  }
  json.finish();
}

View read_view(JsonObject& json) {
  View view;
  view.name = json.text("view");
  if (view.name.empty()) json.fail_field("view", "is empty", "give the view a name");
  const SaidPose pose = read_pose(json);
  view.T_camera_board = pose.T_camera_board;
  view.roll_to_middle_deg = pose.roll_to_middle_deg;
  view.center_sigma_mm = optional_sigma3(json, "center_sigma_mm");
  view.reprojection_rms_px = optional_sigma(json, "reprojection_rms_px");
  if (json.has("tags")) {
    view.tags = json.integer("tags");
    if (*view.tags < 0) json.fail_field("tags", "is " + std::to_string(*view.tags), "a number of tags is 0 or greater");
  }
  if (json.has("own_lens")) read_own_lens(json.object("own_lens"), view);
  json.finish();
  return view;
}

Light read_light(JsonObject& json, const fs::path& file) {
  Light light;
  light.id = json.text("id", light.id);
  if (light.id.empty()) json.fail_field("id", "is empty", "give the lamp a name");
  if (light.id.find(kBesides) != std::string::npos)
    json.fail_field("id", "holds \"" + std::string(kBesides) + "\", which joins the names of lights",
                    "write it without the spaces, or with a -");
  if (says_far_light(json)) {
    read_far_light(json, file, light);
    json.finish();
    return light;
  }
  light.position_mm = json.vec3("position_mm");
  light.position_sigma_mm = optional_sigma3(json, "position_sigma_mm");
  light.intensity = light_color(json, "intensity", light.intensity);
  light.intensity_sigma = optional_sigma3(json, "intensity_sigma");
  light.axis = json.vec3("axis", light.axis);
  const double length = light.axis.norm();
  if (!(length > 1e-9)) json.fail_field("axis", "has no direction", "write the direction the lamp points in");
  // A person's three digits give no exact unit vector. A vector written by Burin is a unit vector and stays unchanged,
  // to the last bit.
  if (std::abs(length - 1) > 1e-12) light.axis /= length;
  light.falloff_exponent = json.number("falloff_exponent", light.falloff_exponent);
  if (light.falloff_exponent < 0)
    json.fail_field("falloff_exponent", "is negative", "write 0 for a bare lamp, more for a spot");
  light.falloff_exponent_sigma = optional_sigma(json, "falloff_exponent_sigma");
  light.size = read_lamp_size(json, light.position_mm);
  json.finish();
  return light;
}

Sensor read_sensor(JsonObject json) {
  Sensor sensor;
  sensor.gain = json.positive("gain", sensor.gain);
  sensor.vignette = json.vec3("vignette", sensor.vignette);
  sensor.vignette_sigma = optional_sigma3(json, "vignette_sigma");
  sensor.psf_sigma_px = json.number("psf_sigma_px", sensor.psf_sigma_px);
  if (sensor.psf_sigma_px < 0) json.fail_field("psf_sigma_px", "is negative", "a blur is 0 or greater");
  sensor.psf_sigma_sigma_px = optional_sigma(json, "psf_sigma_sigma_px");
  read_camera_effects(json, sensor);
  json.finish();
  return sensor;
}

PaperCoat read_paper(JsonObject json) {
  PaperCoat out;
  out.f0 = json.positive("f0", 0);
  out.alpha = json.positive("alpha", out.alpha);
  for (const auto& [name, value] : {std::pair("f0", out.f0), std::pair("alpha", out.alpha)})
    if (!(value <= 1)) json.fail_field(name, "is " + significant(value), "it must be above 0 and at most 1");
  json.finish();
  return out;
}

std::vector<Tag> read_measured_tags(JsonObject& json) {
  std::vector<Tag> tags;
  std::set<int> ids;
  for (JsonObject& item : json.objects("tags")) {
    Tag tag;
    tag.id = item.integer("id");
    if (!ids.insert(tag.id).second)
      item.fail_field("id", "tag " + std::to_string(tag.id) + " is listed twice", "keep one of them");
    tag.center_mm = item.vec2("center_mm");
    tag.size_mm = item.positive("size_mm", 0);
    tag.rotation_deg = item.number("rotation_deg", 0);
    tag.center_sigma_mm = optional_sigma2(item, "center_sigma_mm");
    tag.rotation_sigma_deg = optional_sigma(item, "rotation_sigma_deg");
    item.finish();
    tags.push_back(tag);
  }
  return tags;
}

template <typename List, typename Name>
void fail_unless_unique(const List& list, Name name, const JsonObject& json, const std::string& key) {
  std::set<std::string> seen;
  for (const auto& item : list)
    if (!seen.insert(name(item)).second)
      json.fail_field(key, "\"" + name(item) + "\" is listed twice", "give each a name of its own");
}

void fail_unless_aimed(const View& view, std::string_view where) {
  if (view.roll_to_middle_deg)
    fail(std::string(where),
         "view \"" + view.name + "\" has an eye_mm that looks at the board's middle, and no board is known here",
         "write its aim_mm into bench.json");
}

Json view_json(const View& view) {
  Json json;
  json["view"] = view.name;
  json["T_camera_board"] = to_json(view.T_camera_board.matrix());
  if (view.center_sigma_mm) json["center_sigma_mm"] = to_json(*view.center_sigma_mm);
  if (view.reprojection_rms_px) json["reprojection_rms_px"] = *view.reprojection_rms_px;
  if (view.tags) json["tags"] = *view.tags;
  if (view.own_lens) {
    Json& own = json["own_lens"];
    own["shift_px"] = to_json(view.own_lens->shift_px);
    own["focal_ratio"] = view.own_lens->focal_ratio;
    if (view.own_lens_sigma) {
      own["shift_sigma_px"] = to_json(view.own_lens_sigma->shift_px);
      own["focal_ratio_sigma"] = view.own_lens_sigma->focal_ratio;
    }
  }
  return json;
}

Json light_json(const Light& light, const fs::path& file) {
  Json json;
  json["id"] = light.id;
  if (light.far) {
    put_far_light(light, file, json);
    return json;
  }
  json["position_mm"] = to_json(light.position_mm);
  if (light.position_sigma_mm) json["position_sigma_mm"] = to_json(*light.position_sigma_mm);
  json["intensity"] = to_json(light.intensity);
  if (light.intensity_sigma) json["intensity_sigma"] = to_json(*light.intensity_sigma);
  json["axis"] = to_json(light.axis);
  json["falloff_exponent"] = light.falloff_exponent;
  if (light.falloff_exponent_sigma) json["falloff_exponent_sigma"] = *light.falloff_exponent_sigma;
  put_lamp_size(light.size, json);
  return json;
}

// {"linear": [gx, gy], "quadratic": [qxx, qxy, qyy], "wear": w}, each with its sigma; missing keys mean 0.
struct FieldPart {
  const char* name;
  int first, count;
};
constexpr std::array<FieldPart, 3> kFieldParts{{{"linear", 0, 2}, {"quadratic", 2, 3}, {"wear", 5, 1}}};

GrooveField read_field(JsonObject& material, const std::string& name) {
  GrooveField field;
  if (!material.has(name)) return field;
  JsonObject json = material.object(name);
  for (const FieldPart& part : kFieldParts) {
    const std::string sigma_name = std::string(part.name) + "_sigma";
    if (json.has(part.name)) {
      const auto values = json.numbers(part.name, part.count);
      std::copy(values.begin(), values.end(), field.terms.begin() + part.first);
    }
    if (json.has(sigma_name)) {
      const auto values = json.numbers(sigma_name, part.count);
      if (!field.sigma) field.sigma.emplace();
      std::copy(values.begin(), values.end(), field.sigma->begin() + part.first);
    }
  }
  json.finish();
  return field;
}

Json field_json(const GrooveField& field) {
  Json json = Json::object();
  for (const FieldPart& part : kFieldParts) {
    const auto begin = field.terms.begin() + part.first, end = begin + part.count;
    if (std::all_of(begin, end, [](double v) { return v == 0; })) continue;
    json[part.name] = std::vector<double>(begin, end);
    if (field.sigma)
      json[std::string(part.name) + "_sigma"] =
          std::vector<double>(field.sigma->begin() + part.first, field.sigma->begin() + part.first + part.count);
  }
  return json;
}

void put_scatter(const Scatter& scatter, const std::string& key, Json& json) {
  if (!(scatter.value > 0)) return;
  json[key] = scatter.value;
  if (scatter.sigma) json[key + "_sigma"] = *scatter.sigma;
}

Scatter read_scatter(JsonObject& json, const std::string& key) {
  if (!json.has(key)) return {};
  Scatter scatter{json.number(key), {}};
  scatter.sigma = optional_sigma(json, key + "_sigma");
  return scatter;
}

// Reads the sigmas of `brushed` and `profile`; read_material() reads their numbers.
void read_profile_sigmas(JsonObject& material, MaterialSigma& sigma) {
  if (material.has("brushed")) {
    JsonObject json = material.object("brushed");
    if (json.has("sigma")) sigma.grain = json.vec2("sigma");
  }
  if (!material.has("profile")) return;
  JsonObject json = material.object("profile");
  sigma.flank_deg = optional_sigma(json, "flank_sigma_deg");
  sigma.across = optional_sigma(json, "alpha_across_sigma");
  sigma.burr_width_um = optional_sigma(json, "burr_width_sigma_um");
  if (json.has("burr_height_sigma_um")) {
    const Eigen::Vector2d v = json.vec2("burr_height_sigma_um");
    sigma.burr_left_um = v.x();
    sigma.burr_right_um = v.y();
  }
}

// {"alpha": 0.04, "depth_um": 11, "width_um": 400}
ToldMaterial read_told(JsonObject json) {
  ToldMaterial told;
  if (json.has("alpha")) told.alpha = json.positive("alpha");
  if (json.has("depth_um")) told.depth_um = read_depth_um(json, "depth_um");
  if (json.has("width_um")) told.tool_width_um = read_tool_width_um(json, "width_um");
  json.finish();
  return told;
}

Json told_json(const ToldMaterial& told) {
  Json json = Json::object();
  if (told.alpha) json["alpha"] = *told.alpha;
  if (told.depth_um) json["depth_um"] = *told.depth_um;
  if (told.tool_width_um) json["width_um"] = *told.tool_width_um;
  return json;
}

Crossings read_crossings(JsonObject& json) {
  const std::string text = json.text("crossings", "add");
  const auto found =
      std::find_if(kCrossingsNames.begin(), kCrossingsNames.end(), [&](const auto& one) { return one.second == text; });
  if (found == kCrossingsNames.end())
    json.fail_field(
        "crossings", "is \"" + text + "\"",
        "write \"add\" (their light adds), \"last\" (the later groove replaces the earlier) or \"deepest\" (the "
        "lower surface is left)");
  return found->first;
}

Json measured_grain_json(const Material& m, const MaterialSigma& sigma) {
  Json json = grain_json(m);
  if (sigma.grain) json["sigma"] = to_json(*sigma.grain);
  return json;
}

Json measured_profile_json(const GrooveProfile& profile, const MaterialSigma& sigma) {
  Json json = profile_json(profile);
  const auto put = [&](const char* key, const std::optional<double>& s) {
    if (s) json[key] = *s;
  };
  put("flank_sigma_deg", sigma.flank_deg);
  put("alpha_across_sigma", sigma.across);
  if (sigma.burr_left_um && sigma.burr_right_um)
    json["burr_height_sigma_um"] = {*sigma.burr_left_um, *sigma.burr_right_um};
  put("burr_width_sigma_um", sigma.burr_width_um);
  return json;
}

Json material_json(const Bench& bench, double tool_width_um) {
  Json json;
  json["alpha"] = bench.material.alpha;
  if (bench.material_sigma.alpha) json["alpha_sigma"] = *bench.material_sigma.alpha;
  json["depth_um"] = bench.material.depth_um;
  if (bench.material_sigma.depth_um) json["depth_sigma_um"] = *bench.material_sigma.depth_um;
  json["half_width_um"] = half_width_um(bench.material.profile, tool_width_um, bench.material.depth_um);
  json["base_alpha"] = bench.material.base_alpha;
  if (bench.material_sigma.base_alpha) json["base_alpha_sigma"] = *bench.material_sigma.base_alpha;
  json["f0"] = to_json(bench.material.f0);
  if (!bench.material.grain.none()) json["brushed"] = measured_grain_json(bench.material, bench.material_sigma);
  if (!bench.material.profile.is_paper())
    json["profile"] = measured_profile_json(bench.material.profile, bench.material_sigma);
  if (!bench.depth_field.is_constant()) json["depth_field"] = field_json(bench.depth_field);
  if (!bench.alpha_field.is_constant()) json["alpha_field"] = field_json(bench.alpha_field);
  for (const auto& [crossings, name] : kCrossingsNames)
    if (bench.crossings == crossings) json["crossings"] = name;
  put_scatter(bench.alpha_scatter, "alpha_scatter", json);
  put_scatter(bench.depth_scatter, "depth_scatter", json);
  if (const Json told = told_json(bench.told); !told.empty()) json["told"] = told;
  return json;
}

}  // namespace

Bench read_bench(const std::filesystem::path& file) {
  const Json content = read_json(file, "burin/bench", kVersion, 1);
  JsonObject json(content, file.string());
  const int version = json.integer("version");

  Bench bench;
  const bool in_words = json.has("camera") && json.raw("camera").is_object();
  if (!in_words) bench.camera = resolve_path(file, json.text("camera"));
  if (json.has("lens_scatter")) {
    JsonObject scatter = json.object("lens_scatter");
    bench.lens_scatter = {optional_sigma(scatter, "shift_px").value_or(0),
                          optional_sigma(scatter, "focal").value_or(0)};
    scatter.finish();
  }
  if (json.has("views"))
    for (JsonObject& item : json.objects("views")) bench.views.push_back(read_view(item));
  if (json.has("lights"))
    for (JsonObject& item : json.objects("lights")) bench.lights.push_back(read_light(item, file));
  if (json.has("stray_light")) {
    JsonObject stray = json.object("stray_light");
    bench.stray = read_light(stray, file);
    bench.stray->id = kStrayId;
    if (!bench.stray->is_near())
      json.fail_field("stray_light", "is no near lamp", "write its position_mm, and how large it is as disk_mm");
  }
  require_at_most(bench.views.size(), limit::kViews, file.string() + ": views", "views", "keep those that are used");
  require_at_most(bench.lights.size(), limit::kLights, file.string() + ": lights", "lamps", "keep those that are used");
  fail_unless_unique(
      bench.views, [](const View& v) { return v.name; }, json, "views");
  fail_unless_unique(
      bench.lights, [](const Light& l) { return l.id; }, json, "lights");
  bench.said = {false, false, false, false, false, false};
  if (json.has("material")) {
    JsonObject material = json.object("material");
    bench.material = read_material(material);
    bench.said = said_material(material);
    if (material.has("told")) bench.told = read_told(material.object("told"));
    bench.material_sigma.alpha = optional_sigma(material, "alpha_sigma");
    bench.material_sigma.depth_um = optional_sigma(material, "depth_sigma_um");
    bench.material_sigma.base_alpha = optional_sigma(material, "base_alpha_sigma");
    bench.depth_field = read_field(material, "depth_field");
    bench.alpha_field = read_field(material, "alpha_field");
    read_profile_sigmas(material, bench.material_sigma);
    bench.crossings = read_crossings(material);
    bench.alpha_scatter = read_scatter(material, "alpha_scatter");
    bench.depth_scatter = read_scatter(material, "depth_scatter");
    material.positive("half_width_um", 1);  // derived from depth_um and the tool's width: for people; readers ignore it
    material.finish();
  }
  if (json.has("sensor")) bench.sensor = read_sensor(json.object("sensor"));
  bench.ambient = light_color(json, "ambient", bench.ambient);
  bench.ambient_sigma = optional_sigma3(json, "ambient_sigma");
  if (json.has("board")) {
    JsonObject board = json.object("board");
    bench.bow_mm = read_bow_mm(board, "bow_mm");
    bench.bow_sigma_mm = optional_sigma3(board, "bow_sigma_mm");
    if (board.has("bend")) {
      bench.bend = read_bend(board.object("bend"), {});
      if (board.has("bend_sigma")) bench.bend_sigma = read_bend_sigma(board.object("bend_sigma"));
    }
    if (board.has("tags")) bench.tags = read_measured_tags(board);
    if (board.has("paper")) bench.paper = read_paper(board.object("paper"));
    board.finish();
  }
  if (json.has("machine")) {
    JsonObject machine = json.object("machine");
    bench.machine_affine = read_machine_affine(machine, bench.machine_affine);
    if (machine.has("affine_sigma")) {
      bench.machine_affine_sigma = machine.matrix("affine_sigma", 2, 3);
      if ((bench.machine_affine_sigma->array() < 0).any())
        machine.fail_field("affine_sigma", "has a negative entry", "standard deviations are 0 or greater");
    }
    bench.machine_errors = read_machine_errors(machine);
    machine.finish();
  }
  bench.misfits = read_misfits(json);
  if (json.has("verdict")) {
    JsonObject verdicts = json.object("verdict");
    for (const std::string& name : verdicts.keys()) {
      const JsonObject item = verdicts.object(name);
      bench.verdict[name] = version == 1 ? read_verdict_of_version_1(item) : read_verdict(item);
    }
  }
  if (in_words) {
    JsonObject camera = json.object("camera");
    bench.lens = read_nominal_lens(camera);
    camera.finish();
  }
  json.finish();
  if (!in_words) bench.lens = read_cameramodel(bench.camera);
  // A nominal setup is complete: only measurements can have been lost.
  if (version == 1 && bench.material_sigma.alpha)
    bench.findings.push_back({FindingCode::old_version, Finding::Severity::note, file,
                              "is of version 1, which lacks the look of crossing grooves and how much grooves "
                              "differ from one another",
                              "burin refine measures both and writes version 2"});
  return bench;
}

void write_bench(const Bench& bench, double tool_width_um, const std::filesystem::path& file) {
  const fs::path camera = bench.camera.empty() ? file.parent_path() / "camera.cameramodel" : bench.camera;
  const fs::path folder = fs::absolute(file).lexically_normal().parent_path();
  FilesTogether all;
  if (fs::absolute(camera).lexically_normal().parent_path() == folder) write_cameramodel(bench.lens, camera);

  Json json;
  json["format"] = "burin/bench";
  json["version"] = kVersion;
  json["camera"] = path_beside(file, camera);
  if (bench.lens_scatter)
    json["lens_scatter"] = {{"shift_px", bench.lens_scatter->shift_px}, {"focal", bench.lens_scatter->focal}};
  json["views"] = Json::array();
  for (const View& view : bench.views) {
    fail_unless_aimed(view, file.string());
    json["views"].push_back(view_json(view));
  }
  json["lights"] = Json::array();
  for (const Light& light : bench.lights) json["lights"].push_back(light_json(light, file));
  if (bench.stray) json["stray_light"] = light_json(*bench.stray, file);
  json["material"] = material_json(bench, tool_width_um);
  json["sensor"] = {{"gain", bench.sensor.gain},
                    {"vignette", to_json(bench.sensor.vignette)},
                    {"psf_sigma_px", bench.sensor.psf_sigma_px}};
  if (bench.sensor.vignette_sigma) json["sensor"]["vignette_sigma"] = to_json(*bench.sensor.vignette_sigma);
  if (bench.sensor.psf_sigma_sigma_px) json["sensor"]["psf_sigma_sigma_px"] = *bench.sensor.psf_sigma_sigma_px;
  put_camera_effects(bench.sensor, json["sensor"]);
  json["ambient"] = to_json(bench.ambient);
  if (bench.ambient_sigma) json["ambient_sigma"] = to_json(*bench.ambient_sigma);
  json["board"]["bow_mm"] = to_json(bench.bow_mm);
  if (bench.bow_sigma_mm) json["board"]["bow_sigma_mm"] = to_json(*bench.bow_sigma_mm);
  if (bench.bend) json["board"]["bend"] = bend_json(*bench.bend);
  if (bench.bend && bench.bend_sigma) json["board"]["bend_sigma"] = bend_json(*bench.bend_sigma);
  if (bench.paper.f0 > 0) json["board"]["paper"] = {{"f0", bench.paper.f0}, {"alpha", bench.paper.alpha}};
  if (!bench.tags.empty()) {
    Json& tags = json["board"]["tags"] = Json::array();
    for (const Tag& tag : bench.tags) {
      Json item{{"id", tag.id}, {"center_mm", to_json(tag.center_mm)}};
      if (tag.size_mm > 0) item["size_mm"] = tag.size_mm;
      if (tag.rotation_deg != 0) item["rotation_deg"] = tag.rotation_deg;
      if (tag.center_sigma_mm) item["center_sigma_mm"] = to_json(*tag.center_sigma_mm);
      if (tag.rotation_sigma_deg) item["rotation_sigma_deg"] = *tag.rotation_sigma_deg;
      tags.push_back(item);
    }
  }
  json["machine"] = machine_json(bench.machine_affine, bench.machine_errors);
  if (bench.machine_affine_sigma) json["machine"]["affine_sigma"] = to_json(*bench.machine_affine_sigma);
  if (!bench.misfits.empty()) json["misfits"] = misfits_json(bench.misfits);
  for (const auto& [name, verdict] : bench.verdict) json["verdict"][name] = verdict_json(verdict);
  write_json(json, file);
  all.put();
}

namespace {

template <typename Item, typename Name>
const Item& find_named(const std::vector<Item>& list, std::string_view wanted, Name name, std::string_view kind,
                       std::string_view where) {
  const auto found = std::find_if(list.begin(), list.end(), [&](const Item& item) { return name(item) == wanted; });
  if (found != list.end()) return *found;
  std::string names;
  for (const Item& item : list) names += (names.empty() ? "" : ", ") + name(item);
  fail(std::string(where), "the bench has no " + std::string(kind) + " \"" + std::string(wanted) + "\"",
       list.empty() ? "it has none at all: add it to bench.json" : "choose one of: " + names);
}

}  // namespace

const Verdict* find_verdict(const Bench& bench, const std::string& parameter) {
  const auto found = bench.verdict.find(parameter);
  return found == bench.verdict.end() ? nullptr : &found->second;
}

Lens lens_of(const Bench& bench, const View& view) {
  return view.own_lens ? with_own(bench.lens, *view.own_lens) : bench.lens;
}

const View& find_view(const Bench& bench, std::string_view name, std::string_view where) {
  const View& view = find_named(
      bench.views, name, [](const View& v) { return v.name; }, "view", where);
  fail_unless_aimed(view, where);
  return view;
}

Light find_light(const Bench& bench, std::string_view id, std::string_view where) {
  std::optional<Light> out;
  for (const std::string& one : light_names(id)) {
    const Light& light = find_named(
        bench.lights, one, [](const Light& l) { return l.id; }, "lamp", where);
    if (!out)
      out = light;
    else
      out->also.push_back(light);
  }
  out->id = id;
  return *out;
}

Light find_lit(const Bench& bench, std::string_view id, std::string_view where) {
  Light out = find_light(bench, id, where);
  const auto is_near = [](const Light& light) { return light.is_near(); };
  if (bench.stray && is_near(out) && std::all_of(out.also.begin(), out.also.end(), is_near))
    out.also.push_back(*bench.stray);
  return out;
}

std::string joined_lights(const std::vector<std::string>& ids) {
  std::string out;
  for (const std::string& id : ids) out += (out.empty() ? "" : std::string(kBesides)) + id;
  return out;
}

std::vector<std::string> light_names(std::string_view joined) {
  std::vector<std::string> out;
  for (;;) {
    const std::size_t at = joined.find(kBesides);
    out.emplace_back(joined.substr(0, at));
    if (at == std::string_view::npos) return out;
    joined.remove_prefix(at + kBesides.size());
  }
}

}  // namespace burin

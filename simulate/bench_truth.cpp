#include "burin/simulate/bench_truth.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>

#include "burin/base/error.h"
#include "burin/base/files/input_file.h"
#include "burin/base/files/json_file.h"
#include "burin/base/image.h"
#include "burin/base/limits.h"
#include "burin/scene/files/bend_json.h"
#include "burin/scene/files/camera_json.h"
#include "burin/scene/files/far_light_json.h"
#include "burin/scene/files/lamp_size_json.h"
#include "burin/scene/files/machine_json.h"
#include "burin/scene/files/profile_json.h"
#include "burin/scene/physical_bounds.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

double not_negative(JsonObject& json, const std::string& key, double fallback) {
  const double v = json.number(key, fallback);
  if (v < 0) json.fail_field(key, "is " + Json(v).dump(), "write 0 or more");
  return v;
}

double roughness(JsonObject& json, const std::string& key, double fallback) {
  const double v = json.number(key, fallback);
  if (!(v > 0 && v <= 1)) json.fail_field(key, "is " + Json(v).dump(), "write a roughness above 0 and up to 1");
  return v;
}

Eigen::Vector3d color(JsonObject& json, const std::string& key, const Eigen::Vector3d& fallback) {
  Eigen::Vector3d v = json.vec3(key, fallback);
  if ((v.array() < 0).any()) json.fail_field(key, "is " + to_json(v).dump(), "write three numbers, none negative");
  return v;
}

std::uint64_t seed_of(JsonObject& json, const std::string& key, std::uint64_t fallback) {
  const double v = json.number(key, static_cast<double>(fallback));
  if (v < 0 || v != std::floor(v) || v > 9e15) json.fail_field(key, "is no seed", "write a whole number from 0");
  return static_cast<std::uint64_t>(v);
}

int at_least(JsonObject& json, const std::string& key, int least, int fallback) {
  const int v = json.integer(key, fallback);
  if (v < least) json.fail_field(key, "is " + std::to_string(v), "write " + std::to_string(least) + " or more");
  return v;
}

// Reads the fields of a material; missing fields keep their values. The caller calls finish().
void read_material_into(JsonObject& json, Material& material) {
  material.alpha = roughness(json, "alpha", material.alpha);
  material.depth_um = read_depth_um(json, "depth_um", material.depth_um);
  material.base_alpha = roughness(json, "base_alpha", material.base_alpha);
  material.f0 = color(json, "f0", material.f0);
}

void read_brushed(JsonObject json, BenchTruth& truth) {
  read_grain_into(json, truth.board.material);
  truth.streaks.slope = not_negative(json, "streak_slope", 0);
  if (json.has("streak_mm")) {
    const Eigen::Vector2d size = json.vec2("streak_mm");
    if (!(size.array() > 0).all()) json.fail_field("streak_mm", "is not positive", "write [length, width] in mm");
    truth.streaks.length_mm = size.x();
    truth.streaks.width_mm = size.y();
  }
  json.finish();
}

void read_board_truth(JsonObject json, BenchTruth& truth) {
  Board& board = truth.board;
  board.size_mm = read_board_size(json);
  const Eigen::MatrixXd carve = json.matrix("carve_mm", 2, 2);
  board.carve_min_mm = carve.row(0).transpose();
  board.carve_max_mm = carve.row(1).transpose();
  if (!(board.carve_min_mm.array() < board.carve_max_mm.array()).all())
    json.fail_field("carve_mm", "is no rectangle", "write the lower-left and the upper-right corner");
  truth.surface = {board.size_mm, read_bow_mm(json, "bow_mm")};
  if (json.has("bend")) {
    board.bend = read_bend(json.object("bend"), board.size_mm);
    if (!truth.surface.bow_mm.isZero())
      json.fail_field("bow_mm", "contradicts bend", "a bent sheet has no bow: leave it out");
  }
  if (json.has("tags")) {
    JsonObject tags = json.object("tags");
    board.tags.family = tags.text("family", board.tags.family);
    board.tags.z_mm = tags.number("z_mm", board.tags.z_mm);
    board.tags.sigma_mm = tags.positive("sigma_mm", board.tags.sigma_mm);
    board.tags.white_albedo = not_negative(tags, "white_albedo", board.tags.white_albedo);
    board.tags.black_albedo = not_negative(tags, "black_albedo", board.tags.black_albedo);
    truth.quiet_mm = not_negative(tags, "quiet_mm", 0);
    truth.tag_gloss_alpha = tags.has("gloss_alpha") ? roughness(tags, "gloss_alpha", 0.3) : 0;
    truth.tag_gloss_f0 = not_negative(tags, "gloss_f0", 0);
    if (truth.tag_gloss_f0 > 0 && truth.tag_gloss_alpha == 0)
      tags.fail_field("gloss_alpha", "is missing", "paper that shines needs its roughness");
    for (JsonObject& item : tags.objects("list")) {
      Tag tag;
      tag.id = at_least(item, "id", 0, -1);
      tag.center_mm = item.vec2("center_mm");
      tag.size_mm = item.positive("size_mm");
      tag.rotation_deg = item.number("rotation_deg", 0);
      item.finish();
      board.tags.list.push_back(tag);
    }
    tags.finish();
  }
  JsonObject tool = json.object("tool");
  board.tool_width_um = read_tool_width_um(tool, "width_um");
  tool.finish();
  json.finish();
}

void read_believed(JsonObject& root, BenchTruth& truth) {
  truth.believed = truth.board;
  if (!root.has("believed")) return;
  JsonObject json = root.object("believed");
  if (json.has("material")) {
    JsonObject material = json.object("material");
    read_material_into(material, truth.believed.material);
    material.finish();
  }
  if (json.has("bend")) truth.believed.bend = read_bend(json.object("bend"), truth.board.size_mm);
  if (json.has("tag_overrides"))
    for (JsonObject& item : json.objects("tag_overrides")) {
      const int id = item.integer("id");
      auto& list = truth.believed.tags.list;
      const auto tag = std::find_if(list.begin(), list.end(), [&](const Tag& t) { return t.id == id; });
      if (tag == list.end()) item.fail_field("id", "there is no tag " + std::to_string(id), "name a tag of board.tags");
      tag->center_mm = item.vec2("center_mm");
      item.finish();
    }
  json.finish();
}

void read_scratch_source(JsonObject& root, BenchTruth& truth) {
  if (!root.has("scratches")) return;
  if (root.raw("scratches").is_string()) {
    truth.scratches = resolve_path(truth.file, root.text("scratches"));
    return;
  }
  JsonObject json = root.object("scratches");
  JsonObject random = json.object("random");
  truth.random.count = at_least(random, "count", 0, 0);
  require_at_most(static_cast<std::size_t>(truth.random.count), limit::kScratches, random.where(), "random scratches",
                  "ask for fewer");
  const auto length = random.numbers("length_mm", 2);
  if (!(length[0] > 0) || length[1] < length[0])
    random.fail_field("length_mm", "is no range", "write [shortest, longest] in mm");
  truth.random.shortest_mm = length[0];
  truth.random.longest_mm = length[1];
  truth.random.seed = seed_of(random, "seed", truth.seed);
  random.finish();
  json.finish();
}

void read_lens(JsonObject json, BenchTruth& truth) {
  if (json.has("focal_35mm")) {
    truth.lens = read_nominal_lens(json);
    json.finish();
    return;
  }
  truth.lens.model = json.text("lensmodel");
  const auto size = json.numbers("imagersize", 2);
  for (const double v : size)
    if (!(v >= 1 && v <= limit::kPhotoSide && v == std::floor(v)))
      json.fail_field("imagersize", "is no picture's size", "write [width, height] in whole pixels");
  truth.lens.width = static_cast<int>(size[0]);
  truth.lens.height = static_cast<int>(size[1]);
  require_picture_size(truth.lens.width, truth.lens.height, limit::kPhotoPixels, json.where() + ".imagersize",
                       "a photo");
  truth.lens.intrinsics = json.numbers("intrinsics", lens_parameter_count(truth.lens.model));
  json.finish();
}

void read_sensor_truth(JsonObject json, BenchTruth& truth) {
  SensorTruth& sensor = truth.sensor;
  sensor.channels = json.integer("channels", 1);
  if (sensor.channels != 1 && sensor.channels != 3) json.fail_field("channels", "is neither 1 nor 3", "write 1 or 3");
  const std::string encoding = json.text("encoding");
  if (encoding != "linear" && encoding != "srgb")
    json.fail_field("encoding", "\"" + encoding + "\" cannot be simulated", "write \"linear\" or \"srgb\"");
  sensor.encoding = encoding == "linear" ? Encoding::linear : Encoding::srgb;
  sensor.bits = json.integer("bits", 16);
  if (sensor.bits < 8 || sensor.bits > 16) json.fail_field("bits", "is out of range", "write 8 to 16");
  sensor.jpeg_quality = json.integer("jpeg_quality", sensor.jpeg_quality);
  if (sensor.jpeg_quality < 1 || sensor.jpeg_quality > 100)
    json.fail_field("jpeg_quality", "is out of range", "write 1 to 100");
  truth.optics.gain = json.positive("gain");
  sensor.full_well_e = json.positive("full_well_e", sensor.full_well_e);
  sensor.read_noise_e = not_negative(json, "read_noise_e", sensor.read_noise_e);
  read_camera_truth(json, sensor.camera);
  json.finish();
}

Light read_light(JsonObject& json, const fs::path& file) {
  Light light;
  light.id = json.text("id", light.id);
  if (says_far_light(json)) {
    read_far_light(json, file, light);
    json.finish();
    return light;
  }
  light.position_mm = json.vec3("position_mm");
  light.intensity = color(json, "intensity", light.intensity);
  light.axis = json.vec3("axis", light.axis);
  if (!(light.axis.norm() > 1e-9)) json.fail_field("axis", "has no direction", "write where the lamp points");
  light.axis.normalize();
  light.falloff_exponent = not_negative(json, "falloff_exponent", 0);
  light.size = read_lamp_size(json, light.position_mm);
  json.finish();
  return light;
}

TruthView read_view(JsonObject& json, const BenchTruth& truth) {
  TruthView view;
  view.name = json.text("view");
  const SaidPose pose = read_pose(json);
  view.T_camera_board = pose.T_camera_board;
  if (pose.roll_to_middle_deg) {
    const Eigen::Vector3d middle(truth.board.size_mm.x() / 2, truth.board.size_mm.y() / 2, 0);
    view.T_camera_board = aimed_at(pose.T_camera_board, middle, *pose.roll_to_middle_deg);
  }
  if (json.has("own_lens")) {
    JsonObject own = json.object("own_lens");
    const Eigen::Vector2d shift_px = own.has("shift_px") ? own.vec2("shift_px") : Eigen::Vector2d::Zero();
    const double ratio = own.positive("focal_ratio", 1);
    own.finish();
    view.lens = truth.lens;
    std::vector<double>& fxycxy = view.lens->intrinsics;
    fxycxy[0] *= ratio;
    fxycxy[1] *= ratio;
    fxycxy[2] += shift_px.x();
    fxycxy[3] += shift_px.y();
  }
  for (JsonObject& item : json.objects("photos")) {
    TruthPhoto photo;
    photo.file = fs::path(item.text("file")).lexically_normal();
    if (photo.file.is_absolute() || photo.file.empty() || *photo.file.begin() == ".." || !photo.file.has_filename())
      item.fail_field("file", "leads out of the output folder", "write a path within it, as photos/v00.png");
    photo.photo.view = view.name;
    photo.photo.light = item.text("light", "lamp");
    for (const std::string& name : light_names(photo.photo.light))
      if (std::none_of(truth.lights.begin(), truth.lights.end(), [&](const Light& l) { return l.id == name; }))
        item.fail_field("light", "there is no light \"" + name + "\"",
                        "name one of lights, or several as \"sun + sky\"");
    photo.photo.exposure_s = item.positive("exposure_s");
    photo.photo.iso = item.positive("iso", 100);
    photo.photo.f_number = item.positive("f_number");
    photo.photo.encoding = truth.sensor.encoding;
    photo.datetime = item.text("datetime", "");
    item.finish();
    view.photos.push_back(std::move(photo));
  }
  json.finish();
  return view;
}

ShapeOnBoard read_shape(JsonObject& json) {
  ShapeOnBoard shape;
  const std::string kind = json.text("kind");
  if (kind != "rectangle" && kind != "ellipse")
    json.fail_field("kind", "\"" + kind + "\" is not known", "write \"rectangle\" or \"ellipse\"");
  shape.ellipse = kind == "ellipse";
  shape.center_mm = json.vec2("center_mm");
  shape.half_mm = json.vec2("half_mm");
  if (!(shape.half_mm.array() > 0).all()) json.fail_field("half_mm", "is not positive", "write half width and height");
  shape.rotation_deg = json.number("rotation_deg", 0);
  shape.z_mm = json.number("z_mm", 0);
  shape.albedo = color(json, "albedo", shape.albedo);
  shape.gloss_alpha = json.has("gloss_alpha") ? roughness(json, "gloss_alpha", 0.1) : 0;
  shape.gloss_f0 = not_negative(json, "gloss_f0", 0);
  if (shape.gloss_f0 > 0 && shape.gloss_alpha == 0)
    json.fail_field("gloss_alpha", "is missing", "a glossy shape needs its roughness");
  shape.smudge = json.number("smudge", 1);
  if (shape.smudge < 0 || shape.smudge > 1) json.fail_field("smudge", "is out of range", "write 0 to 1");
  json.text("note", "");
  json.finish();
  return shape;
}

Dust read_dust(JsonObject json, std::uint64_t seed) {
  Dust dust;
  dust.specks = at_least(json, "specks", 0, 0);
  dust.fibers = at_least(json, "fibres", 0, 0);  // spelling of existing files
  for (const int count : {dust.specks, dust.fibers})
    require_at_most(static_cast<std::size_t>(count), limit::kDust, json.where(), "pieces of dust", "strew less");
  const auto size = json.has("speck_mm") ? json.numbers("speck_mm", 2) : std::vector{dust.smallest_mm, dust.largest_mm};
  if (!(size[0] > 0) || size[1] < size[0])
    json.fail_field("speck_mm", "is no range", "write [smallest, largest] in mm");
  dust.smallest_mm = size[0];
  dust.largest_mm = size[1];
  dust.albedo = color(json, "albedo", dust.albedo);
  dust.seed = seed_of(json, "seed", seed);
  json.finish();
  return dust;
}

}  // namespace

BenchTruth read_bench_truth(const fs::path& file) {
  const Json content = read_json(file, "burin/rig-truth", 1);
  JsonObject root(content, file.string());
  BenchTruth truth;
  truth.file = file;
  truth.name = root.text("name", file.stem().string());
  truth.seed = seed_of(root, "seed", 0);
  truth.samples = at_least(root, "samples", 1, truth.samples);
  truth.samples_plain = at_least(root, "samples_plain", 1, truth.samples_plain);
  for (const int samples : {truth.samples, truth.samples_plain})
    require_at_most(static_cast<std::size_t>(samples), limit::kSamples, file.string() + ": samples", "points a pixel",
                    "ask for fewer: 1,024 are enough for every figure in the docs");
  const std::string overlap = root.text("overlap", "sum");
  if (overlap != "sum" && overlap != "last" && overlap != "deepest")
    root.fail_field("overlap", "\"" + overlap + "\" is not known", "write \"sum\", \"last\" or \"deepest\"");
  truth.deepest_rules = overlap == "deepest";
  truth.last_rules = overlap != "sum";
  root.number("tolerance", 0);
  root.text("sampling", "");
  const std::string h_at = root.text("h_at", "sample");
  if (h_at != "sample" && h_at != "center")
    root.fail_field("h_at", "\"" + h_at + "\" is not known", "write \"sample\" or \"center\"");
  truth.h_at_center = h_at == "center";

  read_board_truth(root.object("board"), truth);
  JsonObject material = root.object("material");
  read_material_into(material, truth.board.material);
  if (material.has("profile")) {
    truth.board.material.profile = read_profile(material.object("profile"));
    const GrooveProfile& p = truth.board.material.profile;
    if (std::max(p.burr_left_um, p.burr_right_um) > truth.board.material.depth_um)
      material.fail_field("profile.burr_height_um", "is larger than depth_um",
                          "burrs stand lower than their groove is deep");
  }
  if (material.has("brushed")) read_brushed(material.object("brushed"), truth);
  if (material.has("depth_gradient")) truth.depth_gradient = material.vec2("depth_gradient");
  truth.alpha_jitter = not_negative(material, "alpha_jitter", 0);
  truth.depth_jitter = not_negative(material, "depth_jitter", 0);
  truth.wear = material.number("wear", 0);
  if (std::abs(truth.wear) >= 2) material.fail_field("wear", "leaves no depth", "write a number between -2 and 2");
  material.finish();
  read_believed(root, truth);
  read_scratch_source(root, truth);
  if (root.has("machine")) {
    JsonObject machine = root.object("machine");
    truth.machine_affine = machine.matrix("affine", 2, 3);
    truth.machine_errors = read_machine_errors(machine);
    machine.finish();
  }
  read_lens(root.object("camera"), truth);
  read_sensor_truth(root.object("sensor"), truth);
  if (root.has("glare")) truth.sensor.camera.glare = read_glare_truth(root.object("glare"));
  truth.optics.psf_sigma_px = not_negative(root, "psf_sigma_px", 0);
  truth.optics.vignette = root.vec3("vignette", truth.optics.vignette);
  for (JsonObject& light : root.objects("lights")) truth.lights.push_back(read_light(light, file));
  if (root.has("stray_lights"))
    for (JsonObject& light : root.objects("stray_lights")) truth.stray_lights.push_back(read_light(light, file));
  truth.lamp_samples = at_least(root, "lamp_samples", 1, truth.lamp_samples);
  for (JsonObject& view : root.objects("views")) truth.views.push_back(read_view(view, truth));
  require_at_most(truth.views.size(), limit::kViews, file.string() + ": views", "views", "photograph in several runs");
  require_at_most(truth.lights.size(), limit::kLights, file.string() + ": lights", "lamps", "name fewer");
  require_at_most(truth.board.tags.list.size(), limit::kTags, file.string() + ": board.tags", "tags", "list fewer");
  if (truth.views.empty()) root.fail_field("views", "the list is empty", "a camera needs at least one place");
  truth.ambient = color(root, "ambient", truth.ambient);
  if (root.has("background")) {
    JsonObject cloth = root.object("background");
    truth.cloth.albedo = color(cloth, "albedo", truth.cloth.albedo);
    truth.cloth.noise = not_negative(cloth, "noise", 0);
    truth.cloth.z_mm = cloth.number("z_mm", truth.cloth.z_mm);
    cloth.finish();
  }
  if (root.has("dust")) truth.dust = read_dust(root.object("dust"), truth.seed);
  if (root.has("shapes"))
    for (JsonObject& shape : root.objects("shapes")) truth.shapes.push_back(read_shape(shape));
  if (root.has("exif")) {
    JsonObject exif = root.object("exif");
    truth.make = exif.text("make", "");
    truth.model = exif.text("model", "");
    if (exif.has("focal_mm")) truth.focal_mm = exif.positive("focal_mm");
    if (exif.has("focal_35mm")) truth.focal_35mm = exif.positive("focal_35mm");
    exif.finish();
  }
  truth.writes_session = root.boolean("session", true);
  root.finish();
  return truth;
}

Sent sent_scratches(const BenchTruth& truth) {
  if (!truth.scratches.empty()) return Sent(read_scratches(truth.scratches));
  Scratches scratches;
  std::mt19937_64 random(truth.random.seed);
  const Eigen::Vector2d low = truth.board.carve_min_mm, high = truth.board.carve_max_mm;
  using Uniform = std::uniform_real_distribution<>;
  Uniform length(truth.random.shortest_mm, truth.random.longest_mm), angle(0, std::numbers::pi);
  // Drawn again until both ends are inside; one hundred tries suffice unless scratches outgrow the carve area.
  for (long tries = 0; static_cast<int>(scratches.size()) < truth.random.count; ++tries) {
    if (tries > 100L * truth.random.count + 1000)
      fail(truth.file.string() + ": scratches.random.length_mm", "is too long for the carve area",
           "shorten it, or enlarge carve_mm");
    const double a = angle(random), half = length(random) / 2;
    const Eigen::Vector2d center(Uniform(low.x(), high.x())(random), Uniform(low.y(), high.y())(random));
    const Eigen::Vector2d reach(half * std::cos(a), half * std::sin(a));
    const Eigen::Vector2d p0 = center - reach, p1 = center + reach;
    const auto inside = [&](const Eigen::Vector2d& p) {
      return (p.array() >= low.array()).all() && (p.array() <= high.array()).all();
    };
    if (!inside(p0) || !inside(p1)) continue;
    scratches.x0_mm.push_back(p0.x());
    scratches.y0_mm.push_back(p0.y());
    scratches.x1_mm.push_back(p1.x());
    scratches.y1_mm.push_back(p1.y());
  }
  return Sent(std::move(scratches));
}

namespace {

// Shift of a commanded place by uneven screws, point by point; independent of scene/machine_errors.h.
Eigen::Vector2d screw_at(const BenchTruth& truth, const Eigen::Vector2d& p) {
  const MachineErrors& m = truth.machine_errors;
  Eigen::Vector2d out;
  for (int i = 0; i < 2; ++i) {
    const double turn = 2 * std::numbers::pi * p[i] / m.screw_period_mm[i];
    out[i] = m.screw_sin_mm[i] * std::sin(turn) + m.screw_cos_mm[i] * std::cos(turn);
  }
  return out;
}

// The commanded scratches shifted by half the backlash against their direction, as steps of the axes' screws.
Sent lagging(const BenchTruth& truth, const Sent& sent) {
  Sent out = sent;
  Scratches& s = out.scratches;
  const Eigen::Vector2d half = truth.machine_errors.backlash_mm / 2;
  for (std::size_t i = 0; i < s.size(); ++i) {
    if (s.is_carved(i)) continue;
    const double dx = s.x1_mm[i] - s.x0_mm[i], dy = s.y1_mm[i] - s.y0_mm[i];
    const double x = dx > 0 ? -half.x() : dx < 0 ? half.x() : 0, y = dy > 0 ? -half.y() : dy < 0 ? half.y() : 0;
    s.x0_mm[i] += x, s.x1_mm[i] += x;
    s.y0_mm[i] += y, s.y1_mm[i] += y;
  }
  return out;
}

// Each carved scratch as a chain of pieces of half a millimeter, moved by the screws.
Carved bent(const BenchTruth& truth, const Sent& sent, const Carved& straight) {
  const Scratches &told = sent.scratches, &from = straight.scratches;
  Carved out;
  Scratches& s = out.scratches;
  constexpr double kPieceMm = 0.5;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const Eigen::Vector2d p0(from.x0_mm[i], from.y0_mm[i]), p1(from.x1_mm[i], from.y1_mm[i]);
    const Eigen::Vector2d t0(told.x0_mm[i], told.y0_mm[i]), t1(told.x1_mm[i], told.y1_mm[i]);
    const int n = std::max(1, static_cast<int>(std::ceil((p1 - p0).norm() / kPieceMm)));
    const auto at = [&](int k) -> Eigen::Vector2d {
      const double share = static_cast<double>(k) / n;
      Eigen::Vector2d straight_place = p0 + share * (p1 - p0);
      if (told.is_carved(i)) return straight_place;
      return straight_place + truth.machine_affine.leftCols<2>() * screw_at(truth, t0 + share * (t1 - t0));
    };
    for (int k = 0; k < n; ++k) {
      const Eigen::Vector2d a = at(k), b = at(k + 1);
      s.x0_mm.push_back(a.x()), s.y0_mm.push_back(a.y()), s.x1_mm.push_back(b.x()), s.y1_mm.push_back(b.y());
      s.width_um.push_back(from.width_um[i]);
      s.depth_um.push_back(from.depth_um[i]);
      s.alpha.push_back(from.alpha[i]);
    }
  }
  return out;
}

}  // namespace

Carved carved_by(const BenchTruth& truth, const Sent& sent) {
  Bench bench;
  bench.machine_affine = truth.machine_affine;
  bench.material = truth.board.material;
  bench.depth_field.terms = {truth.depth_gradient.x(), truth.depth_gradient.y(), 0, 0, 0, truth.wear};
  // Crossing grooves stay whole: the sampler decides at each point which of them rules.
  Carved carved = carve(lagging(truth, sent), bench, truth.believed);
  Scratches& s = carved.scratches;
  const std::size_t n = s.size();
  if (s.width_um.empty()) s.width_um.assign(n, truth.board.tool_width_um);
  if (s.depth_um.empty()) s.depth_um.assign(n, truth.board.material.depth_um);
  if (s.alpha.empty()) s.alpha.assign(n, truth.board.material.alpha);
  std::mt19937_64 random(truth.seed ^ 0x9e3779b97f4a7c15ULL);
  std::normal_distribution<> normal;
  for (std::size_t i = 0; i < n; ++i) {
    const double depth_noise = normal(random), alpha_noise = normal(random);
    s.depth_um[i] *= std::exp(truth.depth_jitter * depth_noise);
    s.alpha[i] = std::min(1.0, s.alpha[i] * std::exp(truth.alpha_jitter * alpha_noise));
  }
  return truth.machine_errors.uneven() ? bent(truth, sent, carved) : carved;
}

}  // namespace burin

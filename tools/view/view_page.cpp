#include "tools/view/view_page.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "burin/base/error.h"
#include "burin/base/files/json_file.h"
#include "embedded/view.h"
#include "tools/content_policy.h"
#include "tools/report/html.h"
#include "tools/report/pictures.h"
#include "tools/version.h"
#include "tools/view/bench_scene.h"
#include "tools/view/packed_scratches.h"

namespace burin {
namespace {

constexpr int kFlatSide_px = 320;

// Returns the length of a piece with nearly linear light between its ends. The half vector turns by less than a third
// of the lobe's width, alpha (docs/model.md 3.4). The error of linear interpolation is an eighth of this, squared.
double longest_piece_mm(const ViewedBoard& viewed) {
  double nearest = INFINITY;
  for (const View& view : viewed.bench.views)
    nearest = std::min(nearest, view.T_camera_board.inverse().translation().norm());
  for (const Light& light : viewed.bench.lights) nearest = std::min(nearest, light.position_mm.norm());
  double alpha = viewed.bench.material.alpha;
  for (const double a : viewed.carved.scratches.alpha) alpha = std::min(alpha, a);
  return std::max(0.5, alpha * nearest / 3);
}

Json lens_json(const Lens& lens) {
  std::array<double, 12> k{};
  if (is_lens_drawn(lens))
    for (std::size_t i = 4; i < lens.intrinsics.size(); ++i) k[i - 4] = lens.intrinsics[i];
  Json fxycxy = Json::array(), list = Json::array();
  for (std::size_t i = 0; i < 4; ++i) fxycxy.push_back(lens.intrinsics.at(i));
  for (const double v : k) list.push_back(v);
  return {{"width", lens.width}, {"height", lens.height}, {"fxycxy", fxycxy}, {"k", list}};
}

// The view's name, or "view under lamp" if several lamps light the same view.
std::string name_of(const ViewedBoard& viewed, const ViewedPicture& picture) {
  const auto same = std::count_if(viewed.pictures.begin(), viewed.pictures.end(),
                                  [&](const ViewedPicture& p) { return p.view == picture.view; });
  return same > 1 ? picture.view + " under " + picture.light : picture.view;
}

// Returns the lights of a picture that the page draws: its lamps, or the first light if there are none.
std::vector<std::string> drawn_lights(const Bench& bench, const std::string& joined) {
  std::vector<std::string> out;
  const std::vector<std::string> ids = light_names(joined);
  for (const std::string& id : ids)
    if (find_light(bench, id, "the viewer").is_near()) out.push_back(id);
  if (out.empty()) out.push_back(ids.front());
  return out;
}

Json picture_json(const ViewedBoard& viewed, const ViewedPicture& picture, const FlatPicture& flat, const Json& scene) {
  const View& view = find_view(viewed.bench, picture.view, "the viewer");
  Json json{{"name", name_of(viewed, picture)},
            {"view", picture.view},
            {"light", picture.light},
            {"lights", drawn_lights(viewed.bench, picture.light)},
            {"gains", to_json(flat.gains)},
            {"eye_mm", to_json(Eigen::Vector3d(view.T_camera_board.inverse().translation()))},
            {"R", to_json(Eigen::MatrixXd(view.T_camera_board.linear()))},
            {"exposure", flat.exposure}};
  for (const Json& eye : scene["eyes"])
    if (eye["name"] == picture.view && eye.contains("tolerance_mm")) json["tolerance_mm"] = eye["tolerance_mm"];
  return json;
}

Json lights_json(const Bench& bench) {
  Json json = Json::object();
  for (const Light& light : bench.lights)
    json[light.id] = {{"at_mm", to_json(light.position_mm)},
                      {"intensity", to_json(light.intensity)},
                      {"axis", to_json(light.axis)},
                      {"falloff_exponent", light.falloff_exponent}};
  return json;
}

std::string image(const Image& shown, const std::string& alt, const char* of_class) {
  return fmt::format("<img class=\"{}\" width=\"{}\" height=\"{}\" alt=\"{}\" src=\"{}\">", of_class, shown.width,
                     shown.height, html(alt), data_address(shown, PictureKind::jpeg));
}

std::string card(const std::string& name, const ViewedPicture& picture, const FlatPicture& flat) {
  std::string pair;
  if (!picture.target.data.empty())
    pair += "<figure>" + image(picture.target, "The picture that " + name + " is to show", "target") +
            "<figcaption>to show</figcaption></figure>";
  pair += "<figure>" + image(flat.shown, "How the board looks from " + name, "seen") +
          "<figcaption>shows, laid flat</figcaption></figure>";
  return fmt::format(
      "<li class=\"card\"><h3>{}</h3><div class=\"pair\">{}</div><button type=\"button\" hidden>Stand "
      "here</button></li>\n",
      html(name), pair);
}

// Replaces each {{name}} of the template; inserted text is not searched again.
std::string filled(std::string_view text, const std::map<std::string, std::string>& values) {
  std::string out;
  while (true) {
    const std::size_t begin = text.find("{{"), end = text.find("}}", begin);
    if (begin == std::string_view::npos || end == std::string_view::npos) return out.append(text);
    out.append(text.substr(0, begin)).append(values.at(std::string(text.substr(begin + 2, end - begin - 2))));
    text.remove_prefix(end + 2);
  }
}

std::string shaders() {
  std::string out;
  for (const auto& [id, file] :
       {std::pair{"camera", "camera.glsl"}, std::pair{"light", "light.glsl"},
        std::pair{"scratch_vert", "scratch.vert.glsl"}, std::pair{"scratch_frag", "scratch.frag.glsl"},
        std::pair{"board_vert", "board.vert.glsl"}, std::pair{"board_frag", "board.frag.glsl"}})
    out += fmt::format("<script type=\"x-shader\" id=\"{}\">\n{}</script>\n", id, embedded::view(file));
  return out;
}

}  // namespace

bool is_lens_drawn(const Lens& lens) {
  for (const char* model :
       {"LENSMODEL_PINHOLE", "LENSMODEL_OPENCV4", "LENSMODEL_OPENCV5", "LENSMODEL_OPENCV8", "LENSMODEL_OPENCV12"})
    if (lens.model == model) return true;
  return false;
}

std::string view_page(const BoardView& view, const Progress& progress) {
  if (view.boards.empty()) fail(view.title, "there is no board to show", "design one");
  Json data{{"size_mm", to_json(view.board.size_mm)},
            {"carve_mm", {to_json(view.board.carve_min_mm), to_json(view.board.carve_max_mm)}},
            {"boards", Json::array()},
            {"rows", Json::array()}};
  std::vector<std::string> rows;
  std::string galleries;
  std::size_t count = 0, done = 0;
  for (const ViewedBoard& viewed : view.boards) count += viewed.pictures.size();
  for (const ViewedBoard& viewed : view.boards) {
    const Material& material = viewed.bench.material;
    const std::string packed = packed_scratches(
        viewed.carved, {view.board.tool_width_um, material.depth_um, material.alpha}, longest_piece_mm(viewed));
    auto same = std::find(rows.begin(), rows.end(), packed);
    if (same == rows.end()) {
      rows.push_back(packed);
      data["rows"].push_back(Json::parse(packed));
      same = rows.end() - 1;
    }
    const Json scene = Json::parse(bench_scene_json(view.board, viewed.bench, viewed.tolerances));
    Json pictures = Json::array();
    std::string cards;
    for (const ViewedPicture& picture : viewed.pictures) {
      if (progress) progress("rendering the views", static_cast<double>(done++) / static_cast<double>(count));
      const FlatPicture flat = flat_picture(view.board, viewed, picture, kFlatSide_px);
      pictures.push_back(picture_json(viewed, picture, flat, scene));
      cards += card(name_of(viewed, picture), picture, flat);
    }
    galleries += fmt::format("<section class=\"gallery\"><h2>{}</h2><ul class=\"cards\">\n{}</ul></section>\n",
                             html(viewed.name + ": the places to look from"), cards);
    data["boards"].push_back({{"name", viewed.name},
                              {"sentence", viewed.sentence},
                              {"rows", same - rows.begin()},
                              {"bow_mm", to_json(viewed.bench.bow_mm)},
                              {"material", {{"base_alpha", material.base_alpha}, {"f0", to_json(material.f0)}}},
                              {"ambient", to_json(viewed.bench.ambient)},
                              {"lens", lens_json(viewed.bench.lens)},
                              {"lights", lights_json(viewed.bench)},
                              {"scene", scene},
                              {"pictures", pictures}});
  }
  const auto text = [](const char* file) { return std::string(embedded::view(file)); };
  const std::vector<std::string> scripts{bench_scene_script(), text("board_gl.js"), text("viewer.js")},
      styles{text("viewer.css"), bench_scene_style()};
  return filled(embedded::view("viewer.html"), {{"policy", content_policy(scripts, styles)},
                                                {"generator", "burin " + version()},
                                                {"title", html(view.title)},
                                                {"sentence", html(view.boards.front().sentence)},
                                                {"style", styles[0]},
                                                {"scene_style", styles[1]},
                                                {"galleries", galleries},
                                                {"data", json_in_page(data.dump())},
                                                {"shaders", shaders()},
                                                {"scene_script", scripts[0]},
                                                {"board_script", scripts[1]},
                                                {"script", scripts[2]}});
}

}  // namespace burin

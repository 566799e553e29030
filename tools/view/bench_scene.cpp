#include "tools/view/bench_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "burin/base/files/json_file.h"
#include "embedded/view.h"
#include "tools/report/html.h"

namespace burin {
namespace {

// Returns the field of view: slopes of the rays through the centers of the picture's sides.
Json field_of_view(const Lens& lens) {
  if (lens.intrinsics.size() < 2 || !(lens.intrinsics[0] > 0) || !(lens.intrinsics[1] > 0)) return {0.4, 0.3};
  return {0.5 * lens.width / lens.intrinsics[0], 0.5 * lens.height / lens.intrinsics[1]};
}

// Returns the three half axes of an eye's tolerance: sideways, up, in depth (tolerance.h).
Json tolerance_axes(const PlaceTolerance& t, const Eigen::Vector3d& eye, const Eigen::Vector3d& middle) {
  const Eigen::Vector3d away = (eye - middle).normalized();
  Eigen::Vector3d sideways = Eigen::Vector3d::UnitZ().cross(away);
  if (sideways.norm() < 1e-6) sideways = Eigen::Vector3d::UnitX();
  sideways.normalize();
  const Eigen::Vector3d up = away.cross(sideways);
  return Json::array({to_json(Eigen::Vector3d(t.sideways.least() * sideways)),
                      to_json(Eigen::Vector3d(t.up.least() * up)), to_json(Eigen::Vector3d(t.depth.least() * away))});
}

std::string place(const Eigen::Vector3d& p, const std::optional<Eigen::Vector3d>& sigma) {
  std::string words = fmt::format("x {:.0f}, y {:.0f}, z {:.0f} mm", p.x(), p.y(), p.z());
  if (sigma) words += fmt::format(" (known to {:.2g} mm)", sigma->maxCoeff());
  return words;
}

}  // namespace

std::string json_in_page(std::string json) {
  for (std::size_t at = 0; (at = json.find('<', at)) != std::string::npos; at += 6) json.replace(at, 1, "\\u003c");
  return json;
}

std::string bench_scene_json(const Board& board, const Bench& bench, const std::vector<MatchTolerance>& tolerances) {
  Json json;
  json["size_mm"] = to_json(board.size_mm);
  json["carve_mm"] = {to_json(board.carve_min_mm), to_json(board.carve_max_mm)};
  json["tags"] = Json::array();
  for (const Tag& tag : bench.tags.empty() ? board.tags.list : bench.tags) {
    Json corners = Json::array();
    for (const Eigen::Vector2d& corner : tag_corners_mm(tag)) corners.push_back(to_json(corner));
    json["tags"].push_back({{"id", tag.id}, {"corners_mm", corners}});
  }
  json["field_of_view"] = field_of_view(bench.lens);
  const Eigen::Vector2d middle = (board.carve_min_mm + board.carve_max_mm) / 2;
  json["eyes"] = Json::array();
  for (const View& view : bench.views) {
    const Eigen::Vector3d center = view.T_camera_board.inverse().translation();
    const Eigen::Matrix3d axes = view.T_camera_board.linear();  // rows: the camera's right, down, forward
    Json eye{{"name", view.name}, {"at_mm", to_json(center)}, {"camera", to_json(Eigen::MatrixXd(axes))}};
    if (view.center_sigma_mm) eye["sigma_mm"] = to_json(*view.center_sigma_mm);
    const auto found = std::find_if(tolerances.begin(), tolerances.end(),
                                    [&](const MatchTolerance& t) { return t.view == view.name; });
    if (found != tolerances.end())
      eye["tolerance_mm"] = tolerance_axes(found->eye, center, {middle.x(), middle.y(), 0});
    json["eyes"].push_back(eye);
  }
  json["lamps"] = Json::array();
  for (const Light& light : bench.lights) {
    Json lamp{{"name", light.id}, {"at_mm", to_json(light.position_mm)}};
    if (light.position_sigma_mm) lamp["sigma_mm"] = to_json(*light.position_sigma_mm);
    if (light.falloff_exponent > 0) lamp["axis"] = to_json(light.axis);
    json["lamps"].push_back(lamp);
  }
  return json.dump();
}

std::string bench_scene_html(const Board& board, const Bench& bench, const std::vector<MatchTolerance>& tolerances,
                             const std::string& alt) {
  std::string places;
  for (const View& view : bench.views)
    places += fmt::format("<li>camera {}: {}</li>\n", html(view.name),
                          place(Eigen::Vector3d(view.T_camera_board.inverse().translation()), view.center_sigma_mm));
  for (const Light& light : bench.lights)
    places += fmt::format("<li>lamp {}: {}</li>\n", html(light.id), place(light.position_mm, light.position_sigma_mm));
  return fmt::format(
      "<div class=\"bench-scene\" data-alt=\"{}\"><script type=\"application/json\">{}</script>\n"
      "<details class=\"bench-scene-places\" open><summary>The places in "
      "words</summary><ul>\n{}</ul></details></div>\n",
      html(alt), json_in_page(bench_scene_json(board, bench, tolerances)), places);
}

std::string bench_scene_script() { return std::string(embedded::view("bench_scene.js")); }
std::string bench_scene_style() { return std::string(embedded::view("bench_scene.css")); }

}  // namespace burin

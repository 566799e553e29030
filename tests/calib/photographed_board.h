// tests/calib/photographed_board.h - the truth of a board of 120 mm with 16 tags and 2,500 scratches, photographed
// under one lamp from up to eight places by the point sampler with noise, blur and a lens; what is believed of it is
// off.
#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <tuple>
#include <utility>

#include "burin/base/files/json_file.h"

namespace burin {

/// The camera at `eye` (board, mm) that looks at `aim`, as four rows.
inline Json pose_json(const Eigen::Vector3d& eye, const Eigen::Vector3d& aim) {
  const Eigen::Vector3d z = (aim - eye).normalized(), x = z.cross(Eigen::Vector3d::UnitY()).normalized(),
                        y = z.cross(x);
  Json rows = Json::array();
  for (const Eigen::Vector3d& axis : {x, y, z}) rows.push_back({axis.x(), axis.y(), axis.z(), -axis.dot(eye)});
  rows.push_back({0, 0, 0, 1});
  return rows;
}

/// alpha 0.06, depth 15 um, base_alpha 0.12, the lamp at 69, -319, 452.5 mm with an intensity of 320,000. Photos name
/// `light`; cameras look at `aim_mm` from the first `views` places.
inline Json photographed_board(const std::string& name, int seed, const std::string& light,
                               const Eigen::Vector3d& aim_mm, std::size_t views) {
  Json truth = Json::parse(R"({
    "format": "burin/rig-truth", "version": 1, "samples_plain": 9,
    "board": { "size_mm": [120, 120], "carve_mm": [[20, 20], [100, 100]],
               "tags": { "family": "tagStandard41h12", "z_mm": 0.1, "sigma_mm": 0.1, "white_albedo": 0.85,
                         "black_albedo": 0.04, "quiet_mm": 0.5, "list": [] },
               "tool": { "width_um": 400 } },
    "believed": { "material": { "alpha": 0.05, "depth_um": 13, "base_alpha": 0.1, "f0": [0.91, 0.92, 0.92] } },
    "material": { "alpha": 0.06, "depth_um": 15, "base_alpha": 0.12, "f0": [0.91, 0.92, 0.92] },
    "scratches": { "random": { "count": 2500, "length_mm": [3, 5], "seed": 4211 } },
    "camera": { "lensmodel": "LENSMODEL_OPENCV4", "imagersize": [800, 640],
                "intrinsics": [2054, 2053, 401.3, 317.9, -0.07, 0.05, 0.0002, -0.0001] },
    "sensor": { "channels": 1, "bits": 12, "encoding": "linear", "gain": 11500, "full_well_e": 18000, "read_noise_e": 9 },
    "lights": [ { "id": "lamp", "position_mm": [69, -319, 452.5], "intensity": [320000, 320000, 320000] } ],
    "psf_sigma_px": 0.45,
    "background": { "albedo": [0.03, 0.03, 0.03], "noise": 0.4, "z_mm": -60 },
    "exif": { "make": "Altair", "model": "M07", "focal_mm": 50 }, "session": true, "views": []
  })");
  truth["name"] = name;
  truth["seed"] = seed;
  int id = 0;
  for (const double y : {10., 35., 60., 85., 110.})
    for (const double x : {10., 35., 60., 85., 110.})
      if (x == 10 || x == 110 || y == 10 || y == 110)
        truth["board"]["tags"]["list"].push_back({{"id", id++}, {"center_mm", {x, y}}, {"size_mm", 10}});
  const double degree = std::numbers::pi / 180;
  std::size_t n = 0;
  for (const auto& [across, along, distance] : {std::tuple(0., 2., 520.),
                                                {28., 5., 530.},
                                                {-28., 8., 540.},
                                                {12., 25., 520.},
                                                {-15., -22., 530.},
                                                {35., -15., 540.},
                                                {-35., 15., 535.},
                                                {5., 32., 540.}}) {
    if (n == views) break;
    const double a = across * degree, b = along * degree;
    const Eigen::Vector3d eye =
        aim_mm + distance * Eigen::Vector3d(std::sin(a), std::cos(a) * std::sin(b), std::cos(a) * std::cos(b));
    Json view{{"view", "v" + std::to_string(n)}, {"T_camera_board", pose_json(eye, aim_mm)}};
    for (const auto& [letter, exposure] : {std::pair("a", 0.0125), {"b", 0.0015625}, {"c", 0.0002}})
      view["photos"].push_back({{"file", "photos/v" + std::to_string(n) + letter + ".png"},
                                {"light", light},
                                {"exposure_s", exposure},
                                {"iso", 100},
                                {"f_number", 8}});
    truth["views"].push_back(view);
    ++n;
  }
  return truth;
}

/// Photos of 500 x 400 pixels in place of its 800 x 640, by 36 points a pixel: quick, and sharp enough for what grooves
/// share.
inline void make_photos_smaller(Json& truth) {
  constexpr double kSmaller = 500. / 800;
  truth["samples"] = 36;
  for (Json& size : truth["camera"]["imagersize"]) size = static_cast<int>(kSmaller * size.get<int>());
  for (int k = 0; k < 4; ++k)
    truth["camera"]["intrinsics"][k] = kSmaller * truth["camera"]["intrinsics"][k].get<double>();
}

}  // namespace burin

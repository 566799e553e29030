// tests/tools/coupon_bench.h - a coupon carved by a machine that does not do what its table says, and photographed by
// the point sampler. For tests only.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "burin/scene/board.h"
#include "burin/scene/coupon.h"
#include "burin/scene/scratches.h"
#include "tests/temporary_folder.h"

namespace burin {

/// What the machine does, and how it is photographed.
struct CouponTruth {
  unsigned seed = 1;
  double deeper = 1.2, power = 0.9;  ///< depth = deeper * middle * (believed / middle)^power
  double alpha = 0.045;
  double by_speed_depth = -0.05, by_speed_alpha = 0.15;  ///< exponents of the speed that is reached
  double repeat = 0.015, grooves = 0.02;                 ///< scatter of fans, and of grooves: logarithms
  double wear = -0.04;                                   ///< of depth, from first to last scratch
  double travel = 0.03, travel_towards_deg = 40;         ///< deeper that way than back
  int pixels = 520;
  std::vector<double> exposures_s{0.0125, 0.0016, 0.0002};
  bool mirror = false;  ///< cameras near where the face mirrors the lamp
};

/// What came of each cell, halfway.
struct CarvedCell {
  double depth_um = 0, alpha = 0;
};

/// Writes `folder`/NAME.json and NAME.csv for `burin simulate`, and NAME.cameramodel, the lens; the coupon lies in
/// `coupon_dir`.
inline std::vector<CarvedCell> write_coupon_truth(const std::filesystem::path& folder, const std::string& name,
                                                  const std::filesystem::path& coupon_dir, const CouponTruth& t) {
  using nlohmann::json;
  const Coupon coupon = read_coupon(coupon_dir / "coupon.json");
  const Board board = read_board(coupon_dir / "board.json");
  Scratches s = read_scratches(board.scratches);
  std::mt19937_64 random(t.seed);
  std::normal_distribution<> normal;
  const double middle_um = coupon.cells[2].depth_um;
  std::vector<CarvedCell> cells;
  for (const CouponCell& cell : coupon.cells) {
    const double speed = cell.reached_mm_min / 500;
    cells.push_back(
        {t.deeper * middle_um * std::pow(cell.depth_um / middle_um, t.power) * std::pow(speed, t.by_speed_depth),
         t.alpha * std::pow(speed, t.by_speed_alpha)});
  }
  s.depth_um.assign(s.size(), cells[2].depth_um);
  s.alpha.assign(s.size(), t.alpha);
  s.width_um.assign(s.size(), board.tool_width_um);
  for (const CouponFan& fan : coupon.fans) {
    const double deeper = t.repeat * normal(random), rougher = t.repeat * normal(random);
    for (std::size_t i = fan.first_row; i < fan.first_row + fan.rows; ++i) {
      const double angle = std::atan2(s.y1_mm[i] - s.y0_mm[i], s.x1_mm[i] - s.x0_mm[i]);
      const double age = static_cast<double>(i) / static_cast<double>(s.size() - 1);
      s.depth_um[i] = cells[fan.cell].depth_um * std::exp(deeper + t.grooves * normal(random)) *
                      (1 + t.wear * (age - 0.5)) *
                      (1 + t.travel / 2 * std::cos(angle - t.travel_towards_deg * std::numbers::pi / 180));
      s.alpha[i] = cells[fan.cell].alpha * std::exp(rougher + t.grooves * normal(random));
    }
  }
  write_scratches(s, folder / (name + ".csv"));

  std::ifstream stream(coupon_dir / "board.json");
  const json as_told = json::parse(stream);
  const auto vector = [](const Eigen::Vector3d& v) { return json{v.x(), v.y(), v.z()}; };
  const Eigen::Vector3d middle(30, 30, 0);
  const Eigen::Vector3d lamp = coupon.lamp_mm + 8 * Eigen::Vector3d(normal(random), normal(random), normal(random));
  json views = json::array();
  for (std::size_t k = 0; k < coupon.shots.size(); ++k) {
    Eigen::Vector3d eye = coupon.shots[k].eye_mm;
    if (t.mirror) {
      // Sixteen degrees from the mirror's direction: nearer, no tag could be read. Half vectors lean eight.
      const double tilt = std::acos((coupon.lamp_mm - middle).normalized().z()) - 16 * std::numbers::pi / 180;
      eye = middle + 300 * Eigen::Vector3d(0.04 * (static_cast<double>(k) - 1), std::sin(tilt), std::cos(tilt));
    }
    eye += 5 * Eigen::Vector3d(normal(random), normal(random), normal(random));
    const Eigen::Vector3d z = (middle + Eigen::Vector3d(normal(random), normal(random), 0) - eye).normalized();
    const Eigen::Vector3d x = z.cross(Eigen::Vector3d::UnitY()).normalized(), y = z.cross(x);
    json T = json::array();
    for (const Eigen::Vector3d& axis : {x, y, z}) T.push_back({axis.x(), axis.y(), axis.z(), -axis.dot(eye)});
    T.push_back({0, 0, 0, 1});
    json photos = json::array();
    for (std::size_t e = 0; e < t.exposures_s.size(); ++e)
      photos.push_back({{"file", "photos/v" + std::to_string(k) + "_" + std::to_string(e) + ".png"},
                        {"light", "lamp"},
                        {"exposure_s", t.exposures_s[e]},
                        {"iso", 100},
                        {"f_number", 8},
                        {"datetime", "2026:11:22 14:0" + std::to_string(3 * k) + ":0" + std::to_string(2 * e)}});
    views.push_back({{"view", "v" + std::to_string(k)}, {"T_camera_board", T}, {"photos", photos}});
  }
  json tags = as_told["tags"], believed_tags = json::array();
  for (json& tag : tags["list"]) {
    believed_tags.push_back({{"id", tag["id"]}, {"center_mm", tag["center_mm"]}});
    for (int i = 0; i < 2; ++i) tag["center_mm"][i] = tag["center_mm"][i].get<double>() + 0.08 * normal(random);
  }
  json material = as_told["material"];
  material["base_alpha"] = 0.13;
  const double focal = 3.92 * t.pixels, center = 0.5 * (t.pixels - 1);
  const json truth = {
      {"format", "burin/rig-truth"},
      {"version", 1},
      {"name", name},
      {"seed", t.seed},
      {"samples", 81},
      {"samples_plain", 16},
      {"board",
       {{"size_mm", as_told["size_mm"]},
        {"carve_mm", as_told["carve_mm"]},
        {"bow_mm", {0.01, 0, -0.008}},
        {"tags", tags},
        {"tool", {{"width_um", board.tool_width_um}}}}},
      {"believed", {{"tag_overrides", believed_tags}, {"material", as_told["material"]}}},
      {"scratches", name + ".csv"},
      {"material", material},
      {"machine", {{"affine", {{1.0005, 0.003, 0.25}, {-0.003, 0.9996, -0.3}}}}},
      {"camera",
       {{"lensmodel", "LENSMODEL_OPENCV4"},
        {"imagersize", {t.pixels, t.pixels}},
        {"intrinsics", {focal, 1.002 * focal, center + 4, center - 3, -0.05, 0.02, 0.0005, -0.0003}}}},
      {"sensor",
       {{"channels", 1},
        {"encoding", "linear"},
        {"bits", 16},
        {"gain", 11500},
        {"full_well_e", 18000},
        {"read_noise_e", 9}}},
      {"psf_sigma_px", 0.7},
      {"vignette", {-0.1, 0.01, 0}},
      {"ambient", {0.004, 0.004, 0.004}},
      {"background", {{"albedo", {0.03, 0.03, 0.03}}, {"noise", 0.1}, {"z_mm", -2}}},
      {"lights", {{{"id", "lamp"}, {"position_mm", vector(lamp)}, {"intensity", {360000, 360000, 360000}}}}},
      {"views", views},
      {"exif", {{"make", "Altair"}, {"model", "M07"}, {"focal_mm", 50}}}};
  std::ofstream(folder / (name + ".json")) << truth.dump(1);
  std::ofstream model(folder / (name + ".cameramodel"));
  model.precision(12);
  model << "{ 'lensmodel': 'LENSMODEL_OPENCV4', 'intrinsics': [";
  for (const json& v : truth["camera"]["intrinsics"]) model << v.get<double>() << ",";
  model << "], 'extrinsics': [0,0,0,0,0,0,], 'imagersize': [" << t.pixels << "," << t.pixels << ",] }\n";
  return cells;
}

}  // namespace burin

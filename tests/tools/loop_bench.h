// tests/tools/loop_bench.h - a tiny copy of the sample, to turn its loop in seconds: two pictures, 600 scratches whose
// light adds, on a coarser face, few and small photos. The truth lies beside the project: the workshop is the test's.
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/places.h"
#include "tests/temporary_folder.h"

namespace burin {

inline nlohmann::ordered_json read_json_file(const std::filesystem::path& file) {
  return nlohmann::ordered_json::parse(file_text(file));
}

/// FOLDER/project and FOLDER/truth.json; photos of these views of the sample, `scale` of its 900 x 700 pixels.
inline void make_tiny_project(const TemporaryFolder& folder, const std::vector<std::string>& views, double scale) {
  namespace fs = std::filesystem;
  using Json = nlohmann::ordered_json;
  const fs::path project = folder / "project";
  fs::copy(fs::path(places::source()) / "samples" / "small-bench", project, fs::copy_options::recursive);
  Json design = read_json_file(project / "design.json");
  design["scratches"] = 600;
  design["views"].erase(2);
  Json truth = read_json_file(project / "truth.json");
  truth["camera"]["imagersize"] = {static_cast<int>(900 * scale + 0.5), static_cast<int>(700 * scale + 0.5)};
  for (int i = 0; i < 4; ++i) truth["camera"]["intrinsics"][i] = truth["camera"]["intrinsics"][i].get<double>() * scale;
  const auto set_material = [](Json& of, double alpha, double depth_um, double base_alpha) {
    of["material"].update({{"alpha", alpha}, {"depth_um", depth_um}, {"base_alpha", base_alpha}});
  };
  Json board = read_json_file(project / "board.json"), bench = read_json_file(project / "bench.json");
  set_material(board, 0.04, 11, 0.1);
  set_material(bench, 0.04, 11, 0.1);
  bench["material"]["crossings"] = "add";
  set_material(truth, 0.06, 15, 0.12);
  truth["believed"]["material"] = board["material"];
  truth["overlap"] = "sum";
  truth["lights"][0]["position_mm"] = {69, -319, 452.5};
  truth["samples"] = 16;
  truth["samples_plain"] = 9;
  Json kept = Json::array();
  for (const Json& view : truth["views"])
    for (const std::string& name : views)
      if (view["view"] == name) kept.push_back(view);
  truth["views"] = kept;
  fs::remove(project / "truth.json");
  std::ofstream(project / "design.json") << design;
  std::ofstream(project / "board.json") << board;
  std::ofstream(project / "bench.json") << bench;
  std::ofstream(folder / "truth.json") << truth;
}

/// One more view for the workshop: the camera at `eye_mm`, aimed at the board's middle, later than all others.
inline void add_view_to_truth(const TemporaryFolder& folder, const std::string& name, const Eigen::Vector3d& eye_mm) {
  using Json = nlohmann::ordered_json;
  Json truth = read_json_file(folder / "truth.json");
  const Eigen::Vector3d z = (Eigen::Vector3d(60, 60, 0) - eye_mm).normalized();
  const Eigen::Vector3d x = z.cross(Eigen::Vector3d::UnitY()).normalized(), y = z.cross(x);
  Json pose = Json::array();
  for (const Eigen::Vector3d& row : {x, y, z}) pose.push_back({row.x(), row.y(), row.z(), -row.dot(eye_mm)});
  pose.push_back({0, 0, 0, 1});
  Json view{{"view", name}, {"T_camera_board", pose}, {"photos", Json::array()}};
  for (Json photo : truth["views"][0]["photos"]) {
    const std::string file = photo["file"], time = photo["datetime"];
    photo["file"] = "photos/" + name + file.substr(file.rfind('_'));
    photo["datetime"] = std::string("2025:05:17 11:30:").append(time, time.size() - 2);
    view["photos"].push_back(photo);
  }
  truth["views"].push_back(view);
  std::ofstream(folder / "truth.json") << truth;
}

}  // namespace burin

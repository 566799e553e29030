// tests/calib/rig_bench.h - photographed benches with known truth, as sessions with true poses. For tests only.
#pragma once

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "burin/capture/photo.h"
#include "burin/capture/session.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"
#include "burin/scene/scratches.h"
#include "tests/places.h"

#define BURIN_NEEDS_RIG(name)                                      \
  if (!std::filesystem::exists(places::rig(name) + "/truth.json")) \
  GTEST_SKIP() << "needs the photographed bench " << places::rig(name)

namespace burin {

struct Rig {
  nlohmann::json truth;
  Board board;
  Sent sent;
  Session session;   ///< from truth.json's list, so that a folder without a session.json serves too
  Bench true_poses;  ///< lens, poses, bow and tags as they are; no lamp, no material
};

/// `views`: which views to take; all if empty.
inline Rig read_rig(const std::string& name, const std::set<std::string>& views = {}) {
  Rig rig;
  const std::filesystem::path folder = places::rig(name);
  std::ifstream stream(folder / "truth.json");
  rig.truth = nlohmann::json::parse(stream);
  rig.board = read_board(folder / "board.json");
  rig.sent = Sent(read_scratches(rig.board.scratches));
  Bench& bench = rig.true_poses;
  const auto& camera = rig.truth["camera"];
  bench.lens.model = camera["lensmodel"].get<std::string>();
  bench.lens.intrinsics = camera["intrinsics"].get<std::vector<double>>();
  bench.lens.width = camera["imagersize"][0].get<int>();
  bench.lens.height = camera["imagersize"][1].get<int>();
  for (int i = 0; i < 3; ++i) bench.bow_mm[i] = rig.truth["board"]["bow_mm"][i].get<double>();
  bench.tags = rig.board.tags.list;
  for (const auto& truth : rig.truth["board"]["tags"]["list"])
    for (Tag& tag : bench.tags)
      if (tag.id == truth["id"].get<int>())
        tag.center_mm << truth["center_mm"][0].get<double>(), truth["center_mm"][1].get<double>();
  const bool linear = rig.truth["sensor"]["encoding"] == "linear";
  for (const auto& v : rig.truth["views"]) {
    View view;
    view.name = v["view"].get<std::string>();
    if (!views.empty() && views.count(view.name) == 0) continue;
    for (int row = 0; row < 4; ++row)
      for (int column = 0; column < 4; ++column)
        view.T_camera_board.matrix()(row, column) = v["T_camera_board"][row][column].get<double>();
    bench.views.push_back(view);
    for (const auto& p : v["photos"]) {
      Photo photo;
      photo.file = folder / p["file"].get<std::string>();
      photo.view = view.name;
      photo.light = p["light"].get<std::string>();
      photo.exposure_s = p["exposure_s"].get<double>();
      photo.iso = p["iso"].get<double>();
      photo.f_number = p["f_number"].get<double>();
      photo.encoding = linear ? Encoding::linear : Encoding::srgb;
      rig.session.photos.push_back(photo);
    }
  }
  return rig;
}

inline Eigen::Vector3d true_lamp_position(const nlohmann::json& truth) {
  const auto& p = truth["lights"][0]["position_mm"];
  return {p[0].get<double>(), p[1].get<double>(), p[2].get<double>()};
}

inline Affine2 true_affine(const nlohmann::json& truth) {
  Affine2 affine;
  for (int row = 0; row < 2; ++row)
    for (int column = 0; column < 3; ++column)
      affine(row, column) = truth["machine"]["affine"][row][column].get<double>();
  return affine;
}

/// Largest distance between two affine maps over the carve area, mm.
inline double affine_error_mm(const Affine2& a, const Affine2& b, const Board& board) {
  double worst = 0;
  for (const double x : {board.carve_min_mm.x(), board.carve_max_mm.x()})
    for (const double y : {board.carve_min_mm.y(), board.carve_max_mm.y()})
      worst = std::max(worst, ((a - b) * Eigen::Vector3d(x, y, 1)).norm());
  return worst;
}

}  // namespace burin

// tests/calib/rig_truth.h - what a photographed bench really is, for comparing only. tests/data/README.md
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "burin/base/image.h"
#include "burin/pictures/picture.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"
#include "burin/scene/surface.h"

namespace burin {

struct RigTruth {
  struct PhotoTruth {
    std::string file;
    double exposure_s = 0, iso = 100, f_number = 0;
  };
  struct ViewTruth {
    std::string name;
    Eigen::Isometry3d T_camera_board = Eigen::Isometry3d::Identity();
    std::vector<PhotoTruth> photos;
  };
  Lens lens;
  TagSet tags;  // where they really are
  Surface surface;
  bool srgb = false;
  std::vector<ViewTruth> views;
};

inline RigTruth read_rig_truth(const std::filesystem::path& folder) {
  std::ifstream stream(folder / "truth.json");
  const auto j = nlohmann::json::parse(stream);
  auto pair = [](const nlohmann::json& v) { return Eigen::Vector2d(v[0].get<double>(), v[1].get<double>()); };
  RigTruth truth;
  truth.lens.model = j["camera"]["lensmodel"];
  truth.lens.intrinsics = j["camera"]["intrinsics"].get<std::vector<double>>();
  truth.lens.width = j["camera"]["imagersize"][0];
  truth.lens.height = j["camera"]["imagersize"][1];
  const auto& t = j["board"]["tags"];
  truth.tags.family = t["family"];
  truth.tags.z_mm = t["z_mm"];
  for (const auto& e : t["list"])
    truth.tags.list.push_back(
        {e["id"].get<int>(), pair(e["center_mm"]), e["size_mm"].get<double>(), e["rotation_deg"].get<double>()});
  truth.surface.size_mm = pair(j["board"]["size_mm"]);
  for (int i = 0; i < 3; ++i) truth.surface.bow_mm[i] = j["board"]["bow_mm"][i].get<double>();
  truth.srgb = j["sensor"]["encoding"] == "srgb";
  for (const auto& v : j["views"]) {
    RigTruth::ViewTruth view;
    view.name = v["view"];
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 4; ++c) view.T_camera_board.matrix()(r, c) = v["T_camera_board"][r][c];
    if (v.contains("photos"))
      for (const auto& p : v["photos"]) view.photos.push_back({p["file"], p["exposure_s"], p["iso"], p["f_number"]});
    truth.views.push_back(view);
  }
  return truth;
}

/// The bracket of one view merged in the simplest way: the longest exposure that is not clipped.
struct RigPhoto {
  Image linear;
  std::vector<std::uint8_t> valid;
};

inline RigPhoto merge_for_test(const std::filesystem::path& folder, const RigTruth& truth,
                               const RigTruth::ViewTruth& view) {
  auto photos = view.photos;
  std::sort(photos.begin(), photos.end(), [](const auto& a, const auto& b) { return a.exposure_s > b.exposure_s; });
  RigPhoto out;
  for (const auto& photo : photos) {
    Image image = read_picture(folder / photo.file);
    const double scale = photos.front().exposure_s / photo.exposure_s;
    const std::size_t n = static_cast<std::size_t>(image.width) * image.height;
    const bool first = out.valid.empty();
    if (first) {
      out.linear = Image(image.width, image.height, image.channels);
      out.valid.assign(n, 0);
    }
    for (std::size_t i = 0; i < n; ++i) {
      if (out.valid[i]) continue;
      bool ok = true;
      for (int c = 0; c < image.channels; ++c) {
        const float v = image.data[i * image.channels + c];
        ok = ok && v < 0.98F;
        out.linear.data[i * image.channels + c] = static_cast<float>(scale * (truth.srgb ? srgb_to_linear(v) : v));
      }
      out.valid[i] = ok;
    }
  }
  return out;
}

inline Eigen::Vector2d true_point_px(const RigTruth& truth, const RigTruth::ViewTruth& view,
                                     const Eigen::Vector2d& xy) {
  const Eigen::Vector3d p(xy.x(), xy.y(), height_mm(truth.surface, xy.x(), xy.y()) + truth.tags.z_mm);
  const std::array<Eigen::Vector3d, 1> p_camera = {view.T_camera_board * p};
  std::array<Eigen::Vector2d, 1> q;
  project(truth.lens, p_camera, q);
  return q[0];
}

inline const Tag& true_tag(const RigTruth& truth, int id) {
  return *std::find_if(truth.tags.list.begin(), truth.tags.list.end(), [id](const Tag& t) { return t.id == id; });
}

inline std::array<Eigen::Vector2d, 4> true_corners_px(const RigTruth& truth, const RigTruth::ViewTruth& view, int id) {
  const auto corners = tag_corners_mm(true_tag(truth, id));
  std::array<Eigen::Vector2d, 4> q;
  for (int c = 0; c < 4; ++c) q[c] = true_point_px(truth, view, corners[c]);
  return q;
}

inline Eigen::Vector2d true_side_point_px(const RigTruth& truth, const RigTruth::ViewTruth& view, int id, int side,
                                          double t) {
  const auto corners = tag_corners_mm(true_tag(truth, id));
  return true_point_px(truth, view, corners[side] + t * (corners[(side + 1) % 4] - corners[side]));
}

}  // namespace burin

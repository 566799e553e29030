#include "tools/watch/wanted_shots.h"

#include <algorithm>

#include "burin/base/error.h"
#include "burin/base/files/json_file.h"
#include "burin/calib/verdict/camera_place.h"
#include "tools/photographed_lamps.h"

namespace burin {
namespace {

// A planned place is not critical: up to seven degrees aside and a seventh in depth, a photo has the same information.
PlaceTolerance planned_tolerance(const Eigen::Vector3d& eye_mm, const Board& board) {
  const Eigen::Vector3d middle(board.size_mm.x() / 2, board.size_mm.y() / 2, 0);
  const double aside = 0.12 * (eye_mm - middle).norm() / kReach, depth = 0.15 * (eye_mm - middle).norm() / kReach;
  return {{aside, aside}, {aside, aside}, {depth, depth}};
}

void require_in_front(const Eigen::Vector3d& eye_mm, const std::string& where) {
  if (!(eye_mm.z() > 0)) fail(where, "lies behind the board", "plan again with burin plan");
}

// Describes the places of lights that shine together.
std::string lamps_in_words(const std::string& light, const Bench& bench, const Board& board) {
  const std::vector<std::string> ids = light_names(light);
  std::string out;
  for (const std::string& id : ids)
    out += (out.empty() ? "" : "; ") + (ids.size() > 1 ? "\"" + id + "\" " : std::string()) +
           place_in_words(find_light(bench, id, "the design").position_mm, board);
  return out;
}

// Returns true for the light of a picture, or for one of its several lights.
bool shines_in(const std::string& light, const std::string& of_picture) {
  const std::vector<std::string> ids = light_names(of_picture);
  return light == of_picture || std::find(ids.begin(), ids.end(), light) != ids.end();
}

}  // namespace

std::vector<WantedShot> planned_shots(const std::filesystem::path& plan, const Board& board) {
  // Not strict: a program writes the plan, with more fields than needed here.
  const Json json = read_json(plan, "burin/plan", 1);
  JsonObject root(json, plan.string());
  std::vector<WantedShot> shots;
  for (JsonObject& item : root.objects("shots")) {
    WantedShot shot;
    shot.name = item.text("view");
    shot.designed = item.boolean("designed", false);
    shot.eye_mm = item.vec3("center_mm");
    require_in_front(shot.eye_mm, item.where() + ": center_mm");
    shot.place = item.text("camera", place_in_words(shot.eye_mm, board));
    if (!shot.designed && item.has("T_camera_board")) {
      shot.T_camera_board.emplace(Eigen::Isometry3d::Identity());
      shot.T_camera_board->matrix() = item.matrix("T_camera_board", 4, 4);
    }
    JsonObject light = item.object("light");
    shot.light = light.text("id");
    shot.lamp_place = place_in_words(light.vec3("position_mm"), board);
    if (item.has("exposure_s")) shot.exposure_s = item.positive("exposure_s");
    shot.tolerance = planned_tolerance(shot.eye_mm, board);
    shots.push_back(std::move(shot));
  }
  if (shots.empty()) fail(plan.string(), "holds no shots", "plan again with burin plan");
  return shots;
}

std::vector<WantedShot> designed_shots(const DesignSpec& design, const Bench& bench, const Board& board,
                                       const std::vector<MatchTolerance>& tolerances) {
  std::vector<WantedShot> shots;
  for (const DesignView& view : design.views)
    for (const std::string& light : photographed_lamps(view, bench)) {
      WantedShot shot;
      shot.name = view.view;
      shot.designed = true;
      shot.light = light;
      if (std::any_of(shots.begin(), shots.end(),
                      [&](const WantedShot& s) { return s.name == shot.name && s.light == shot.light; }))
        continue;
      shot.eye_mm = find_view(bench, view.view, "the design").T_camera_board.inverse().translation();
      require_in_front(shot.eye_mm, "the bench: view \"" + view.view + "\"");
      shot.place = place_in_words(camera_place_at(shot.eye_mm, board, 0), board);
      shot.lamp_place = lamps_in_words(light, bench, board);
      shot.tolerance = planned_tolerance(shot.eye_mm, board);
      shots.push_back(std::move(shot));
    }
  take_tolerances(tolerances, shots);
  return shots;
}

void take_tolerances(const std::vector<MatchTolerance>& tolerances, std::vector<WantedShot>& shots) {
  for (WantedShot& shot : shots) {
    const MatchTolerance* least = nullptr;  // smallest tolerance of the pictures under this light from there
    for (const MatchTolerance& t : tolerances) {
      if (!shot.designed || t.view != shot.name || !shines_in(shot.light, t.light)) continue;
      if (least == nullptr || t.eye.sideways.least() < least->eye.sideways.least()) least = &t;
    }
    if (least != nullptr) shot.tolerance = least->eye;
  }
}

}  // namespace burin

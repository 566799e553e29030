#include "tools/where_to_stand.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "burin/base/error.h"
#include "burin/base/median.h"
#include "burin/calib/verdict/camera_place.h"
#include "tools/photographed_lamps.h"

namespace burin {
namespace {

Eigen::Vector3d middle_of(const Board& board) { return {board.size_mm.x() / 2, board.size_mm.y() / 2, 0}; }

std::string rounded(double mm) { return fmt::format("{:.{}f}", mm, mm < 9.95 ? 1 : 0); }

// Exposure for white paper at the board's center at 60 % of white, at f/8 and ISO 100; 0 for a bench without scale.
double paper_exposure_s(const Light& light, const Bench& bench, const Board& board) {
  if (!light.intensity_sigma) return 0;
  const Eigen::Vector3d to_lamp = light.position_mm - middle_of(board), wi = to_lamp.normalized();
  const double spot = std::pow(std::max(0.0, light.axis.dot(-wi)), light.falloff_exponent);
  const double irradiance = light.intensity.mean() * spot * std::max(0.0, wi.z()) / to_lamp.squaredNorm();
  const double radiance = board.tags.white_albedo / std::numbers::pi * irradiance + bench.ambient.mean();
  constexpr double kPaperAt = 0.6, kAperture = 8;
  return radiance > 0 ? kPaperAt / (bench.sensor.gain * radiance) * kAperture * kAperture : 0;
}

std::string seconds_text(double s) { return s < 0.3 ? fmt::format("1/{:.0f} s", 1 / s) : fmt::format("{:.1f} s", s); }

}  // namespace

double focus_distance_mm(const std::vector<Eigen::Vector3d>& eyes_mm, const Board& board) {
  std::vector<double> distances;
  for (const Eigen::Vector3d& eye : eyes_mm) distances.push_back((eye - middle_of(board)).norm());
  return distances.empty() ? 0 : median_of(std::move(distances));
}

std::string where_to_stand(const DesignSpec& design, const Bench& bench, const Board& board,
                           const std::vector<MatchTolerance>& tolerances) {
  std::string out = "Board on the table, its lower edge towards you; mm above the face, and from its edges.\n";
  std::set<std::string> lamps;
  std::string exposures;
  for (const DesignView& v : design.views) {
    for (const std::string& id : light_names(v.light)) {
      if (!lamps.insert(id).second) continue;
      const Light light = find_light(bench, id, "the design");
      out += fmt::format("lamp \"{}\": {}\n", id, place_in_words(light.position_mm, board));
      if (const double s = paper_exposure_s(light, bench, board); s > 0)
        exposures += fmt::format("{}about {} at f/8 and ISO 100 under \"{}\"", exposures.empty() ? "" : ", ",
                                 seconds_text(s), id);
    }
  }
  std::vector<Eigen::Vector3d> eyes;
  double nearest = INFINITY, furthest = 0;
  for (std::size_t k = 0; k < design.views.size(); ++k) {
    const DesignView& v = design.views[k];
    const Eigen::Vector3d eye = find_view(bench, v.view, "the design").T_camera_board.inverse().translation();
    eyes.push_back(eye);
    const CameraPlace place = camera_place_at(eye, board, 0);
    nearest = std::min(nearest, place.distance_mm);
    furthest = std::max(furthest, place.distance_mm);
    out += fmt::format("view \"{}\" under \"{}\": {}", v.view, v.light, place_in_words(place, board));
    if (k < tolerances.size()) {
      const PlaceTolerance& t = tolerances[k].eye;
      out += fmt::format("; its picture holds within about {} mm sideways, {} mm up or down, {} mm in depth",
                         rounded(t.sideways.least()), rounded(t.up.least()), rounded(t.depth.least()));
    }
    if (photographed_lamps(v, bench).size() > 1) out += "; photographed under each of these lamps alone";
    out += "\n";
  }
  out +=
      fmt::format("focus: once, at {:.0f} mm, at f/8 or smaller; then leave focus and zoom as they are{}\n",
                  focus_distance_mm(eyes, board),
                  furthest > 1.5 * nearest ? " (these views are at very different distances: some will be soft)" : "");
  out += "exposures of each place: the tags' white paper at 60 % of white" +
         (exposures.empty() ? "" : " (" + exposures + ")") +
         ", then shorter until no glint is clipped: the sheet has the stops of each place\n";
  return out;
}

}  // namespace burin

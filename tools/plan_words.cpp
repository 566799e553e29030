#include "tools/plan_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

#include "burin/base/error.h"
#include "burin/base/files/json_file.h"
#include "tools/photographed_lamps.h"
#include "tools/where_to_stand.h"

namespace burin {
namespace {

constexpr double kPlannedPaper = 0.6, kPlannedAperture = 8;

// Removes a number from the start of `text`; returns false if there is none.
bool take_number(std::string_view& text, double& value) {
  const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
  if (read.ec != std::errc() || !(value > 0)) return false;
  text.remove_prefix(static_cast<std::size_t>(read.ptr - text.data()));
  return true;
}

}  // namespace

FocusRange read_focus_range(const std::string& text) {
  std::string_view rest = text;
  FocusRange range;
  const auto unit = [&]() -> double {
    for (const auto& [name, mm] : {std::pair<std::string_view, double>{"mm", 1}, {"cm", 10}, {"m", 1000}})
      if (rest.substr(0, name.size()) == name) {
        rest.remove_prefix(name.size());
        return mm;
      }
    return 0;
  };
  bool good = take_number(rest, range.near_mm);
  const double first = unit();
  good = good && rest.substr(0, 1) == "-";
  if (good) rest.remove_prefix(1);
  good = good && take_number(rest, range.far_mm);
  const double last = unit();
  const double mm = last > 0 ? last : 1;
  range.near_mm *= first > 0 ? first : mm;
  range.far_mm *= mm;
  if (!good || !rest.empty() || !(range.near_mm < range.far_mm) || !(range.far_mm < 1e6))
    fail("--focus-range", "\"" + text + "\" is no range of distances",
         "write the nearer and the further one, like 900-1500mm or 0.9-1.5m");
  return range;
}

std::vector<DesignedPlace> designed_places(const DesignSpec& design, const Bench& bench) {
  std::vector<DesignedPlace> places;
  for (const DesignView& v : design.views)
    for (const std::string& light : photographed_lamps(v, bench))  // one photo per lamp
      places.push_back({v.view, find_view(bench, v.view, "the design").T_camera_board.inverse().translation(), light});
  return places;
}

PlanFocus plan_focus(const Board& board, const Bench& bench, const std::vector<DesignedPlace>& designed,
                     double focus_mm, const std::string& range) {
  PlanFocus out;
  out.distance_mm = focus_mm;
  if (!range.empty()) {
    out.range = read_focus_range(range);
    out.given = true;
    // With the focus in the middle of 1/d, both ends have the same blur.
    if (!(focus_mm > 0)) out.distance_mm = 2 / (1 / out.range.near_mm + 1 / out.range.far_mm);
    if (!out.range.holds(out.distance_mm))
      fail("--focus", fmt::format("{:g} mm lies outside of --focus-range {}", focus_mm, range),
           "give a focus within the range, or one of both only");
    return out;
  }
  if (!(focus_mm > 0)) {
    std::vector<Eigen::Vector3d> eyes;
    eyes.reserve(designed.size());
    for (const DesignedPlace& place : designed) eyes.push_back(place.center_mm);
    if (designed.empty())
      for (const View& view : bench.views) eyes.push_back(view.T_camera_board.inverse().translation());
    constexpr double kAboveNearest = 1.2;
    out.distance_mm = eyes.empty() ? kAboveNearest * camera_places(board, bench.lens, false).front().distance_mm
                                   : focus_distance_mm(eyes, board);
  }
  out.range = depth_of_field(bench.lens, out.distance_mm);
  return out;
}

std::string focus_in_words(const PlanFocus& focus) {
  return fmt::format(
      "Focus once at {:.0f} mm, at f/8 or smaller: {:.0f} to {:.0f} mm {}. Leave focus and zoom as they are.",
      focus.distance_mm, focus.range.near_mm, focus.range.far_mm, focus.given ? "was said to be sharp" : "is sharp");
}

std::vector<Finding> focus_findings(const Plan& plan, const PlanFocus& focus) {
  std::vector<Finding> out;
  for (const std::string& view : plan.unseen)
    out.push_back(make_warning(
        FindingCode::tags_small,
        "from view \"" + view + "\" this lens sees no tag large enough to be measured: it is not photographed",
        "larger tags or a longer focal length would do"));
  if (plan.own_lens_widening > 1) {
    const LensScatter scatter = plan.bench.lens_scatter.value_or(LensScatter{});
    out.push_back(make_warning(
        FindingCode::camera_changed,
        "photos have lenses of their own, by " + significant(scatter.shift_px, 2) + " px and " +
            significant(100 * scatter.focal, 2) + " % of the focal length: from the same tags cameras are known " +
            significant(plan.own_lens_widening, 2) + " times less well",
        significant(plan.own_lens_widening * plan.own_lens_widening, 2) +
            " times as many tags or photos make up for it, as do focus by hand and a stabilizer that is off"));
  }
  bool others = false;
  for (const PlannedShot& shot : plan.shots) {
    others = others || shot.view.empty();
    constexpr double kSlack = 0.01;  // of the distance: nobody measures it better
    const double d = shot.camera.distance_mm;
    if (!shot.view.empty() && !focus.range.holds(d * (1 - kSlack)) && !focus.range.holds(d * (1 + kSlack)) &&
        !focus.range.holds(d))
      out.push_back(make_warning(
          FindingCode::photo_quality,
          fmt::format("view \"{}\" is seen from {:.0f} mm, outside of the one focus ({:.0f} to {:.0f} mm): its photo "
                      "will be soft",
                      shot.view, shot.camera.distance_mm, focus.range.near_mm, focus.range.far_mm),
          "a smaller aperture than f/8 helps"));
  }
  if (!others)
    out.push_back(make_warning(
        FindingCode::coverage,
        fmt::format(
            "from {:.0f} to {:.0f} mm this lens sees the whole board from nowhere: only the designed views are planned",
            focus.range.near_mm, focus.range.far_mm),
        "with --focus-range of your aperture, or a lens of shorter focal length, there are more places"));
  return out;
}

bool is_measured(const Plan& plan) {
  return std::any_of(plan.bench.lights.begin(), plan.bench.lights.end(),
                     [](const Light& light) { return light.intensity_sigma.has_value(); });
}

double exposure_s(const Plan& plan, const PlannedShot& shot) {
  return kPlannedPaper / (plan.bench.sensor.gain * shot.paper_radiance) * kPlannedAperture * kPlannedAperture;
}

std::string exposures_in_words(const Plan& plan, const PlannedShot& shot) {
  std::string out = shot.stops.size() == 1 ? "one exposure, the tags' paper at 60 % of white"
                                           : "bracket: the tags' paper at 60 % of white, then";
  for (std::size_t i = 1; i < shot.stops.size(); ++i)
    out += fmt::format("{} {:.0f} stops", i == 1 ? "" : ",", shot.stops[i]);
  if (is_measured(plan)) out += fmt::format("; {:.3g} s at f/8 and ISO 100 to begin with", exposure_s(plan, shot));
  return out;
}

std::string plan_text(const Plan& plan, const Board& board, const PlanFocus& focus, const std::filesystem::path& file) {
  Json json;
  json["format"] = "burin/plan";
  json["version"] = 1;
  json["straddles_cut_off"] = plan.straddles;
  if (plan.own_lens_widening > 1) json["own_lens_widening"] = plan.own_lens_widening;
  json["focus"] = {
      {"distance_mm", focus.distance_mm}, {"near_mm", focus.range.near_mm}, {"far_mm", focus.range.far_mm}};
  json["parameters"] = Json::array();
  for (const PlanParameter& p : plan.parameters)
    json["parameters"].push_back(
        {{"name", p.name}, {"unit", in_words(p.unit)}, {"goal", p.goal}, {"before", p.before}});
  json["shots"] = Json::array();
  for (std::size_t i = 0; i < plan.shots.size(); ++i) {
    const PlannedShot& shot = plan.shots[i];
    const Light& light = plan.bench.lights[shot.light];
    Json item;
    item["view"] = shot.view.empty() ? fmt::format("p{:02}", i + 1) : shot.view;
    if (!shot.view.empty()) item["designed"] = true;
    item["camera"] = place_in_words(shot.camera, board);
    item["center_mm"] = to_json(shot.camera.center_mm());
    item["T_camera_board"] = to_json(shot.camera.T_camera_board.matrix());
    item["distance_mm"] = shot.camera.distance_mm;
    item["tilt_deg"] = shot.camera.tilt_rad * 180 / std::numbers::pi;
    item["azimuth_deg"] = std::fmod(shot.camera.azimuth_rad * 180 / std::numbers::pi + 360, 360);
    item["roll_deg"] = shot.camera.roll_rad * 180 / std::numbers::pi;
    item["light"] = {{"id", light.id}, {"position_mm", to_json(light.position_mm)}};
    item["exposure_stops"] = shot.stops;
    if (is_measured(plan)) item["exposure_s"] = exposure_s(plan, shot);
    Json& sigma = item["sigma_after"];
    for (std::size_t p = 0; p < plan.parameters.size(); ++p) sigma[plan.parameters[p].name] = shot.sigma[p];
    json["shots"].push_back(item);
  }
  json["at_depth"] = Json::array();
  for (const PlanAtDepth& at : plan.at_depth) {
    Json item;
    item["depth_um"] = at.depth_um;
    item["straddles_cut_off"] = at.straddles;
    Json& sigma = item["sigma"];
    for (std::size_t p = 0; p < plan.parameters.size(); ++p) sigma[plan.parameters[p].name] = at.sigma[p];
    json["at_depth"].push_back(item);
  }
  return json_text(json, file);
}

}  // namespace burin

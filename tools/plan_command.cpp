#include <CLI/Error.hpp>
#include <CLI/Validators.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>

#include "burin/calib/plan.h"
#include "burin/optimize/design_file.h"
#include "burin/render/bench_of_board.h"
#include "burin/render/brdf.h"
#include "burin/render/error.h"
#include "burin/render/files/decimals.h"
#include "burin/render/files/json_file.h"
#include "tools/commands.h"
#include "tools/plan_drawing.h"
#include "tools/progress_bar.h"
#include "tools/where_to_stand.h"

namespace burin {
namespace {

// "0, -3 and -6 stops".
std::string stops_in_words(const std::vector<double>& stops) {
  if (stops.size() == 1) return "one exposure, the tags' paper at 60 % of white";
  std::string out = "bracket: the tags' paper at 60 % of white, then";
  for (std::size_t i = 1; i < stops.size(); ++i) out += fmt::format("{} {:.0f} stops", i == 1 ? "" : ",", stops[i]);
  return out;
}

// A bench that was measured knows its exposure too; a nominal one has no scale.
bool is_measured(const Plan& plan) {
  return std::any_of(plan.bench.lights.begin(), plan.bench.lights.end(),
                     [](const Light& light) { return light.intensity_sigma.has_value(); });
}

constexpr double kPaperAt = 0.6, kPlannedAperture = 8;
double exposure_s(const Plan& plan, const PlannedShot& shot) {
  return kPaperAt / (plan.bench.sensor.gain * shot.paper_radiance) * kPlannedAperture * kPlannedAperture;
}

Json plan_json(const Plan& plan, const Board& board) {
  Json json;
  json["format"] = "burin/plan";
  json["version"] = 1;
  json["straddles_cut_off"] = plan.straddles;
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
  return json;
}

void print_plan(const Plan& plan, const Board& board) {
  fmt::print("Board on the table, its lower edge towards you; mm above the face, and from the edges.\n");
  std::size_t lamp = plan.bench.lights.size();
  for (std::size_t i = 0; i < plan.shots.size(); ++i) {
    const PlannedShot& shot = plan.shots[i];
    if (shot.light != lamp) {
      lamp = shot.light;
      const Light& light = plan.bench.lights[lamp];
      fmt::print("     lamp \"{}\" {}\n", light.id, place_in_words(light.position_mm, board));
    }
    fmt::print("{:3}. {}{}\n     {}", i + 1, shot.view.empty() ? "" : "view \"" + shot.view + "\" of the design: ",
               place_in_words(shot.camera, board), stops_in_words(shot.stops));
    if (is_measured(plan)) fmt::print("; {:.3g} s at f/8 and ISO 100 to begin with", exposure_s(plan, shot));
    fmt::print("\n");
  }
  // Sigmas by shot: a column a number of shots, at most six.
  std::vector<std::size_t> columns;
  for (const double share : {0., 0.1, 0.25, 0.5, 0.75, 1.})
    columns.push_back(static_cast<std::size_t>(std::lround(share * static_cast<double>(plan.shots.size() - 1))));
  columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
  fmt::print("\nExpected sigma after {:>13}", "no shot");
  for (const std::size_t c : columns) fmt::print("{:>9}", c + 1);
  fmt::print("  shots; good enough\n");
  for (std::size_t p = 0; p < plan.parameters.size(); ++p) {
    const PlanParameter& parameter = plan.parameters[p];
    const std::string name =
        parameter.unit == Unit::none ? parameter.name : fmt::format("{}, {}", parameter.name, in_words(parameter.unit));
    fmt::print("  {:<26}{:>6}", name, significant(parameter.before, 3));
    for (const std::size_t c : columns) fmt::print("{:>9}", significant(plan.shots[c].sigma[p]));
    fmt::print("{:>12}\n", significant(parameter.goal));
  }
  if (!plan.straddles)
    fmt::print(
        "The depth of the grooves stays unknown: with this lamp no place has half vectors on both sides of the "
        "grooves' "
        "cut-off. Put the lamp further to the side, or give --lamp-places 2.\n");
}

// What a plan is made for where nobody gave a bench: a 50 mm lens on 24 x 36 mm with 6000 x 4000 pixels, and a lamp one
// and a half times the board's diagonal away, beyond its upper edge.
Bench usual_bench(const Board& board) {
  Bench bench;
  constexpr int kWidth = 6000, kHeight = 4000;
  bench.lens.model = "LENSMODEL_OPENCV5";
  bench.lens.width = kWidth;
  bench.lens.height = kHeight;
  const double focal_px = 50.0 / 36.0 * kWidth;
  bench.lens.intrinsics = {focal_px, focal_px, (kWidth - 1) / 2.0, (kHeight - 1) / 2.0, 0, 0, 0, 0, 0};
  Light light;
  const double reach = 1.5 * board.size_mm.norm(), tilt = 35 * std::numbers::pi / 180;
  light.position_mm = {board.size_mm.x() / 2, board.size_mm.y() / 2 + reach * std::sin(tilt), reach * std::cos(tilt)};
  bench.lights = {light};
  bench.material = board.material;
  return bench;
}

// The eyes of a design, under their lamps.
std::vector<DesignedPlace> designed_places(const DesignSpec& design, const Bench& bench) {
  std::vector<DesignedPlace> places;
  for (const DesignView& v : design.views)
    places.push_back({v.view, find_view(bench, v.view, "the design").T_camera_board.inverse().translation(), v.light});
  return places;
}

// The median distance of the designed eyes, or else of the bench's views; 0 where there are none.
double focus_of(const std::vector<DesignedPlace>& designed, const Bench& bench, const Board& board) {
  std::vector<Eigen::Vector3d> eyes;
  for (const DesignedPlace& place : designed) eyes.push_back(place.center_mm);
  if (designed.empty())
    for (const View& view : bench.views) eyes.push_back(view.T_camera_board.inverse().translation());
  return focus_distance_mm(eyes, board);
}

// The lamps that were given, instead of the bench's.
void put_lamps(const std::vector<std::vector<double>>& places, const Board& board, Bench& bench) {
  const Light usual = bench.lights.empty() ? Light{} : bench.lights.front();
  bench.lights.clear();
  for (const std::vector<double>& p : places) {
    if (p.size() != 3) throw CLI::ValidationError("--lamp", "takes three numbers, X Y Z in mm");
    Light light = usual;
    light.id = places.size() == 1 ? usual.id : fmt::format("lamp{}", bench.lights.size() + 1);
    light.position_mm = {p[0], p[1], p[2]};
    light.axis = (Eigen::Vector3d(board.size_mm.x() / 2, board.size_mm.y() / 2, 0) - light.position_mm).normalized();
    if (!(light.position_mm.z() > 0))
      fail("--lamp", fmt::format("{} mm above the face is behind the board", p[2]), "give a place in front of it");
    bench.lights.push_back(light);
  }
}

}  // namespace

void add_plan_command(CLI::App& burin) {
  struct Options {
    std::filesystem::path board, bench, design, scratches, camera, out;
    std::vector<std::vector<double>> lamps;
    PlanOptions plan;
    bool camera_as_seed = false;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = burin.add_subcommand(
      "plan", "Say which photos to take of a board: where to put camera and lamp, and what they would tell");
  command->add_option("BOARD.json", options->board, "The board that is to be photographed")->required();
  command->add_option("--bench", options->bench,
                      "The bench as it is believed or was measured: lens and lamps; without it, a 50 mm lens on full "
                      "frame and a lamp beyond the upper edge");
  command->add_option("--design", options->design,
                      "The design.json of the board: its views are photographed first, and at their focus");
  command
      ->add_option("--focus-mm", options->plan.focus_mm,
                   "Where the lens is focused, instead of at the views of the design or the bench")
      ->check(CLI::PositiveNumber);
  command->add_option("--scratches", options->scratches,
                      "The scratches on it, if not those that the board names; without any, test strokes");
  auto* camera = command->add_option("--camera", options->camera,
                                     "The lens (.cameramodel), instead of the bench's; it counts as known");
  command->add_flag("--camera-as-seed", options->camera_as_seed, "Plan as if the lens of --camera were solved for too")
      ->needs(camera);
  command
      ->add_option("--lamp", options->lamps,
                   "Where a lamp stands, X Y Z in mm, instead of the bench's; once for each lamp")
      ->type_size(3);
  command
      ->add_option("--lamp-places", options->plan.lamp_places,
                   "At how many places lamps may stand in all; places beyond the given lamps are proposed")
      ->capture_default_str()
      ->check(CLI::Range(1, 12));
  command->add_option("--shots", options->plan.shots, "How many to plan")
      ->capture_default_str()
      ->check(CLI::Range(1, 12));
  command->add_option("--out", options->out,
                      "The folder for plan.json and plan.svg; without it, the plan is printed only");
  command->footer(example("burin plan board.json --bench bench.json --design design.json --shots 8 --out plan"));
  command->callback([options] {
    const Board board = read_board(options->board);
    Bench bench;
    if (options->bench.empty()) {
      bench = usual_bench(board);
      note("no --bench: planned for a 50 mm lens on full frame, and a lamp " +
           place_in_words(bench.lights[0].position_mm, board));
    } else {
      bench = read_bench_of(board, options->board, options->bench);
    }
    PlanOptions plan_options = options->plan;
    if (!options->camera.empty()) {
      bench.lens = read_cameramodel(options->camera);
      plan_options.fix_lens = !options->camera_as_seed;
    }
    if (!options->lamps.empty()) put_lamps(options->lamps, board, bench);
    const std::filesystem::path file = options->scratches.empty() ? board.scratches : options->scratches;
    Sent sent;
    if (!file.empty() && (!options->scratches.empty() || std::filesystem::exists(file))) {
      sent = Sent(read_scratches(file));
    } else {
      sent = test_strokes(board);
      note(fmt::format("no scratches yet: planned with {} test strokes in all directions", sent.size()));
    }
    if (!options->design.empty()) plan_options.designed = designed_places(read_design(options->design), bench);
    if (!(plan_options.focus_mm > 0)) plan_options.focus_mm = focus_of(plan_options.designed, bench, board);
    ProgressBar bar;
    const Plan plan = plan_shots(board, bench, sent, plan_options, bar.progress());
    bar.clear();
    if (plan_options.focus_mm > 0)
      fmt::print("Focus once at {:.0f} mm, at f/8 or smaller, and leave focus and zoom as they are.\n",
                 plan_options.focus_mm);
    print_plan(plan, board);
    const std::string next = "burin capture PHOTOS_DIR --board " + shell_word(options->board.string()) +
                             (options->bench.empty() ? "" : " --bench " + shell_word(options->bench.string())) +
                             " --out DIR";
    if (options->out.empty()) {
      fmt::print("Planned {} shots (--out DIR keeps the plan and draws it): take these photos; next: {}\n",
                 plan.shots.size(), next);
      return;
    }
    make_output_folder(options->out);
    write_json(plan_json(plan, board), options->out / "plan.json");
    write_text(plan_drawing(plan, board), options->out / "plan.svg");
    fmt::print("Wrote {}, plan.svg shows where to stand: take these photos; next: {}\n",
               (options->out / "plan.json").string(), next);
  });
}

}  // namespace burin

#include <CLI/App.hpp>
#include <CLI/Error.hpp>
#include <CLI/Validators.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/base/files/json_file.h"
#include "burin/base/files/part_file.h"
#include "burin/base/image.h"
#include "burin/pictures/picture.h"
#include "burin/render/view_renderer.h"
#include "burin/scene/bench.h"
#include "burin/scene/bench_of_board.h"
#include "burin/scene/carve.h"
#include "burin/scene/scratches.h"
#include "tools/animate.h"
#include "tools/automatic_exposure.h"
#include "tools/commands.h"
#include "tools/progress_bar.h"
#include "tools/project_settings.h"
#include "tools/work_lock.h"

namespace burin {
namespace {

struct RenderArguments {
  std::filesystem::path board, bench, scratches, out, animation;
  std::vector<std::string> views, lights;
  std::string moving = "eye";
  AnimateOptions animate;
  double exposure = 0;
  bool as_sent = false;
};

void require_command_line(const RenderArguments& o) {
  if (o.out.empty() == o.animation.empty())
    throw CLI::ValidationError("--out", "give --out PICTURE, or --animate FILE");
  if (!o.out.empty() && o.views.size() != 1) throw CLI::ValidationError("--view", "a picture shows one view");
}

Report run_animation(const RenderArguments& o, const Board& board, const Bench& bench, const Carved& carved,
                     ProgressBar& bar) {
  std::vector<View> views;
  std::vector<Light> lights;
  for (const std::string& name : o.views) views.push_back(find_view(bench, name, "--view"));
  if (o.views.empty())
    for (const View& view : bench.views)
      views.push_back(find_view(bench, view.name, "--animate"));  // throws for a missing or unaimed view
  for (const std::string& id : o.lights) lights.push_back(find_light(bench, id, "--lamp"));
  if (o.lights.empty()) lights = bench.lights;
  AnimateOptions options = o.animate;
  options.moving = o.moving == "eye" ? Moving::eye : Moving::lamp;
  options.exposure = o.exposure;
  std::optional<WorkLock> lock;
  if (o.animation.extension().empty()) lock.emplace(o.animation, "burin render", WorkLock::Where::new_folders);
  const int frames = animate(board, bench, carved, views, lights, o.animation, options, bar.progress());
  bar.clear();
  const bool eye = options.moving == Moving::eye;
  Report report;
  report.data["frames"] = frames;
  report.line("Wrote {}: {} through {}, {} pixels; next: {}.\n", o.animation.string(),
              counted(static_cast<std::size_t>(frames), "frame"),
              eye ? counted(views.size(), "view") : counted(lights.size(), "lamp"), fact("pixels", options.pixels),
              o.animation.extension().empty() ? "make a film of these pictures" : "open it in a browser");
  return report;
}

bool is_float_format(const std::filesystem::path& file) {
  const std::string e = file.extension().string();
  return e == ".exr" || e == ".tif" || e == ".tiff";
}

// Fills options from the project of a board's folder or file. A round supplies its own scratches, as designed, and its
// measured bench, if there is one.
void take_board(const CLI::App& command, RenderArguments& o) {
  if (std::optional<ProjectSettings> settings = settings_around(o.board)) {
    if (std::filesystem::is_directory(o.board)) {
      const Project& project = settings->at.project;
      const int round = settings->at.round > 0 ? settings->at.round : project.rounds();
      const std::filesystem::path scratches = project.round(round) / "scratches.csv",
                                  measured = project.round(round) / "bench.json";
      if (round > 0 && std::filesystem::exists(scratches)) settings->scratches = scratches;
      if (round > 0 && std::filesystem::exists(measured)) settings->bench = measured;
      o.board = settings->board;
    }
    take_from_project(command, *settings, {.scratches = &o.scratches, .bench = &o.bench});
  }
  if (o.bench.empty()) throw CLI::RequiredError("--bench");
}

Report run(RenderArguments o, const CLI::App& command) {
  take_board(command, o);
  require_command_line(o);
  if (!o.out.empty()) find_place(o.out);  // refused before the work
  if (o.animation.has_extension()) find_place(o.animation);
  Board board = read_board(o.board);
  const Bench bench = read_bench_of(board, o.board, o.bench);
  for (const Finding& finding : bench.findings) tell(finding);
  if (bench.lights.empty()) fail(o.bench.string(), "has no lights", "add one, or calibrate the bench");
  if (!o.scratches.empty()) board.scratches = o.scratches;
  if (board.scratches.empty())
    fail(o.board.string(), "names no scratches", "name some in \"scratches\", or give --scratches FILE.csv");
  ProgressBar bar;
  bar.progress()("reading scratches", 0);
  const Scratches rows = read_scratches(board.scratches);
  bar.progress()("carving in thought", 0);
  const Carved carved = o.as_sent ? carve(Sent(rows), bench, board) : carve(Designed(rows), bench, board);
  if (!o.animation.empty()) {
    return run_animation(o, board, bench, carved, bar);
  }
  const View& view = find_view(bench, o.views.front(), "--view");
  const Light light = find_lit(bench, o.lights.empty() ? bench.lights.front().id : joined_lights(o.lights), "--lamp");

  fail_unless_sees(view, board);
  fail_unless_lights(light, board);
  if (!is_in_picture(bench, view, board))
    tell(make_warning(FindingCode::view_hidden, "view " + view.name + ": nothing of the board lies in its picture",
                      "check its T_camera_board and the lens in the bench"));

  bar.progress()("rendering", 0.2);
  const CameraView camera = make_camera_view(bench, board, view, {0, 0, bench.lens.width, bench.lens.height});
  ViewRenderer renderer(make_scene(bench, board, camera, light), {3});
  Image image;
  renderer.forward(carved, image);
  const bool is_linear = is_float_format(o.out);
  const double exposure = o.exposure > 0 ? o.exposure : is_linear ? 1 : automatic_exposure(image).value_or(1);
  for (float& v : image.data) {
    v *= static_cast<float>(exposure);
    if (!is_linear) v = linear_to_srgb(std::clamp(v, 0.0F, 1.0F));
  }
  bar.progress()("writing", 0);
  write_picture(image, o.out);
  bar.clear();
  Report report;
  report.data["scratches"] = rows.size();
  report.line("Wrote {}: view {} under {}, {}, {} x {} pixels, exposure {:.6g}.\n", o.out.string(),
              fact("view", view.name), fact("light", light.id), counted(rows.size(), "scratch"),
              fact("width", image.width, "px"), fact("height", image.height, "px"), fact("exposure", exposure));
  return report;
}

}  // namespace

void add_render_command(CLI::App& burin) {
  auto o = std::make_shared<RenderArguments>();
  CLI::App* c = burin.add_subcommand("render", "Render a board's metal as a camera of the setup sees it");
  c->add_option("BOARD.json", o->board, "Render this board, or the board of this project or round folder")->required();
  c->add_option(
      "--bench", o->bench,
      "Use lens, views, lamps and material of this setup (bench.json) [default: the project's last measured]");
  c->add_option("--view", o->views, "Render this view; repeat for an animation's path [default: all, animations only]");
  c->add_option(
      "--lamp", o->lights,
      "Use this lamp, sun or environment map; repeat for several [default: the first; all for an animated lamp]");
  c->add_option("--scratches", o->scratches, "Render these scratches (CSV) [default: the board's]");
  c->add_option(
      "--exposure", o->exposure,
      "Multiply the radiance by this factor [default: 1 for .exr and .tif, else the brightest 0.5 % is white]");
  c->add_flag("--as-carved", o->as_sent,
              "Treat the scratches as commanded positions (sent.csv) and apply the machine's calibration");
  c->add_option("--out", o->out, "Write this picture: .exr or .tif (linear), .png or .jpg (sRGB)");
  c->add_option("--animate", o->animation,
                "Write a walk-by animation: .png, .mp4 (by ffmpeg), or a folder of numbered pictures");
  c->add_option("--moving", o->moving, "Move the eye from view to view or the lamp from lamp to lamp in an animation")
      ->check(CLI::IsMember({"eye", "lamp"}))
      ->capture_default_str();
  c->add_option("--frames", o->animate.frames,
                "Set an animation's frames from first to last place; 0: 8 per place, at most 240 [default: 0]")
      ->check(CLI::Range(0, 5000));
  c->add_option("--duration", o->animate.seconds, "Set an animation's duration from first to last place, s")
      ->check(CLI::Range(0.1, 600.0))
      ->capture_default_str();
  c->add_option("--pixels", o->animate.pixels, "Set an animation's maximum side length, pixels")
      ->check(CLI::Range(16, 4096))
      ->capture_default_str();
  c->footer(example("burin render board.json --bench bench/bench.json --view v00 --out v00.exr"));
  c->callback([o, c] { print(run(*o, *c)); });
}

}  // namespace burin

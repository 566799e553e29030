#include <CLI/App.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "burin/render/bench.h"
#include "burin/render/bench_of_board.h"
#include "burin/render/carve.h"
#include "burin/render/error.h"
#include "burin/render/files/json_file.h"
#include "burin/render/files/part_file.h"
#include "burin/render/image.h"
#include "burin/render/scratches.h"
#include "burin/render/view_renderer.h"
#include "tools/commands.h"
#include "tools/progress_bar.h"

namespace burin {
namespace {

struct Options {
  std::filesystem::path board, bench, scratches, out;
  std::string view, light;
  double exposure = 0;
  bool as_sent = false;
};

bool is_float_format(const std::filesystem::path& file) {
  const std::string e = file.extension().string();
  return e == ".exr" || e == ".tif" || e == ".tiff";
}

// The exposure that puts all but the brightest half per cent of the lit pixels below white.
double automatic_exposure(const Image& radiance) {
  std::vector<float> lit;
  for (const float v : radiance.data)
    if (v > 0) lit.push_back(v);
  if (lit.empty()) return 1;
  const auto at = lit.begin() + static_cast<std::ptrdiff_t>(0.995 * static_cast<double>(lit.size() - 1));
  std::nth_element(lit.begin(), at, lit.end());
  return 1 / static_cast<double>(*at);
}

void run(const Options& o) {
  find_place(o.out);  // refused before the work
  Board board = read_board(o.board);
  const Bench bench = read_bench_of(board, o.board, o.bench);
  for (const Finding& finding : bench.findings) note(sentence(finding));
  if (bench.lights.empty()) fail(o.bench.string(), "has no lights", "add one, or calibrate the bench");
  if (!o.scratches.empty()) board.scratches = o.scratches;
  if (board.scratches.empty())
    fail(o.board.string(), "names no scratches", "name some in \"scratches\", or give --scratches FILE.csv");
  ProgressBar bar;
  bar.progress()("reading scratches", 0);
  const Scratches rows = read_scratches(board.scratches);
  const Carved carved = o.as_sent ? carve(Sent(rows), bench, board) : carve(Designed(rows), bench, board);
  const View& view = find_view(bench, o.view, "--view");
  const Light& light = o.light.empty() ? bench.lights.front() : find_light(bench, o.light, "--light");

  bar.progress()("rendering", 0.2);
  const CameraView camera = make_camera_view(bench, board, view, {0, 0, bench.lens.width, bench.lens.height});
  ViewRenderer renderer(make_scene(bench, board, camera, light), {3});
  Image image;
  renderer.forward(carved, image);
  const double exposure = o.exposure > 0 ? o.exposure : is_float_format(o.out) ? 1 : automatic_exposure(image);
  for (float& v : image.data) {
    v *= static_cast<float>(exposure);
    if (!is_float_format(o.out)) v = linear_to_srgb(std::clamp(v, 0.0F, 1.0F));
  }
  write_picture(image, o.out);
  bar.clear();
  fmt::print("Wrote {}: view {} under {}, {} scratches, {} x {} pixels, exposure {:.6g}.\n", o.out.string(), view.name,
             light.id, rows.size(), image.width, image.height, exposure);
}

}  // namespace

void add_render_command(CLI::App& burin) {
  auto o = std::make_shared<Options>();
  CLI::App* c = burin.add_subcommand("render", "Show what a camera of a bench sees of a board's metal");
  c->add_option("BOARD.json", o->board, "The board")->required();
  c->add_option("--bench", o->bench, "The bench: lens, views, lamps, material")->required();
  c->add_option("--view", o->view, "Name of the view")->required();
  c->add_option("--light", o->light, "Id of the lamp (default: the bench's first)");
  c->add_option("--scratches", o->scratches, "These scratches instead of the board's");
  c->add_option("--exposure", o->exposure,
                "Times the radiance (default: 1 for .exr and .tif, which stay linear; else the brightest half per cent "
                "is white)");
  c->add_flag("--as-carved", o->as_sent,
              "The scratches are what the machine was told (a loop's sent.csv): shows where the bench's machine put "
              "them. Without it they are where grooves are wanted, as a tool path compensates the machine");
  c->add_option("--out", o->out, "Picture to write: .exr or .tif linear, .png or .jpg as sRGB")->required();
  c->footer(example("burin render board.json --bench bench.json --view v00 --out v00.exr"));
  c->callback([o] { run(*o); });
}

}  // namespace burin

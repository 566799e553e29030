// tests/python/radiance.cpp - what C++ renders of a setup in files, as raw numbers: pyburin's must have the same bits.
//   radiance BOARD.json BENCH.json SCRATCHES.csv VIEW,VIEW,... LIGHT [REPEATS]
// Writes the photos' radiance (float32, one channel), then dE/dends of E = the sum of it (float64, x0 y0 x1 y1 a
// scratch), to standard output; to standard error the least CPU time of REPEATS of a rendering, and of a rendering with
// gradient, by one thread, in ms.
#include <burin/base/threads.h>
#include <burin/render/view_renderer.h>
#include <burin/scene/bench_of_board.h>
#include <burin/scene/carve.h>
#include <burin/scene/scratches.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <sstream>
#include <string>
#include <vector>

namespace {

template <typename Work>
double least_ms(int repeats, const Work& work) {
  double out = 1e30;
  for (int i = 0; i < repeats; ++i) {
    const std::clock_t begin = std::clock();
    work();
    out = std::min(out, 1000.0 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
  }
  return out;
}

}  // namespace

int main(int count, char** arguments) try {
  using namespace burin;
  if (count < 6) return 2;
  const ThreadLimit alone(1);
  const Board board = read_board(arguments[1]);
  const Bench bench = read_bench_of(board, arguments[1], arguments[2]);
  const Designed rows(read_scratches(arguments[3]));
  const bool own_material =
      !rows.scratches.width_um.empty() || !rows.scratches.depth_um.empty() || !rows.scratches.alpha.empty();
  RenderOptions options;
  options.material_gradients = own_material;
  const auto workspace = make_render_workspace();
  std::vector<ViewRenderer> renderers;
  std::istringstream names(arguments[4]);
  for (std::string name; std::getline(names, name, ',');) {
    const View& view = find_view(bench, name, "VIEW");
    const CameraView camera = make_camera_view(bench, board, view, {0, 0, bench.lens.width, bench.lens.height});
    renderers.emplace_back(make_scene(bench, board, camera, find_light(bench, arguments[5], "LIGHT")), options,
                           workspace);
  }
  std::vector<Image> radiance(renderers.size());
  const int repeats = count > 6 ? std::max(1, std::atoi(arguments[6])) : 1;
  const double render_ms = least_ms(repeats, [&] {
    const Carved carved = carve(rows, bench, board);
    for (std::size_t v = 0; v < renderers.size(); ++v) renderers[v].forward(carved, radiance[v]);
  });
  for (const Image& image : radiance) std::fwrite(image.data.data(), sizeof(float), image.data.size(), stdout);
  const Image ones(radiance[0].width, radiance[0].height, radiance[0].channels, 1.0F);
  ScratchGradients by;
  const double gradient_ms = least_ms(repeats, [&] {
    const Carved carved = carve(rows, bench, board);
    ScratchGradients sum;
    for (std::size_t v = 0; v < renderers.size(); ++v) {
      renderers[v].forward_with_jacobian(carved, radiance[v]);
      renderers[v].backward(ones, sum);
    }
    by = pull_back(carved, rows, bench, board, std::move(sum));
  });
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double ends[4] = {by.x0_mm[i], by.y0_mm[i], by.x1_mm[i], by.y1_mm[i]};
    std::fwrite(ends, sizeof(double), 4, stdout);
  }
  std::fprintf(stderr, "%.4f %.4f\n", render_ms, gradient_ms);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "radiance: %s\n", error.what());
  return 1;
}

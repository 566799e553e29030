// tests/python/radiance.cpp - what C++ renders of a setup in files, as raw numbers: pyburin's must have the same bits.
//   radiance BOARD.json BENCH.json SCRATCHES.csv VIEW LIGHT [REPEATS]
// Writes the photo's radiance (float32, one channel), then dE/dends of E = the sum of it (float64, x0 y0 x1 y1 a
// scratch), to standard output; the median time of a forward() in ms over REPEATS to standard error.
#include <burin/render/view_renderer.h>
#include <burin/scene/bench_of_board.h>
#include <burin/scene/carve.h>
#include <burin/scene/scratches.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <vector>

int main(int count, char** arguments) try {
  using namespace burin;
  if (count < 6) return 2;
  const Board board = read_board(arguments[1]);
  const Bench bench = read_bench_of(board, arguments[1], arguments[2]);
  const Designed rows(read_scratches(arguments[3]));
  const View& view = find_view(bench, arguments[4], "VIEW");
  const CameraView camera = make_camera_view(bench, board, view, {0, 0, bench.lens.width, bench.lens.height});
  ViewRenderer renderer(make_scene(bench, board, camera, find_light(bench, arguments[5], "LIGHT")));
  Image radiance;
  std::vector<double> ms;
  for (int i = 0; i < (count > 6 ? std::max(1, std::atoi(arguments[6])) : 1); ++i) {
    const auto begin = std::chrono::steady_clock::now();
    renderer.forward(carve(rows, bench, board), radiance);
    ms.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
  }
  std::fwrite(radiance.data.data(), sizeof(float), radiance.data.size(), stdout);
  const Carved carved = carve(rows, bench, board);
  renderer.forward_with_jacobian(carved, radiance);
  const ScratchGradients by = pull_back(
      carved, rows, bench, board, renderer.backward(Image(radiance.width, radiance.height, radiance.channels, 1.0F)));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double ends[4] = {by.x0_mm[i], by.y0_mm[i], by.x1_mm[i], by.y1_mm[i]};
    std::fwrite(ends, sizeof(double), 4, stdout);
  }
  std::ranges::nth_element(ms, ms.begin() + static_cast<std::ptrdiff_t>(ms.size() / 2));
  std::fprintf(stderr, "%.4f\n", ms[ms.size() / 2]);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "radiance: %s\n", error.what());
  return 1;
}

// Renders one view of a small board and computes the gradient of its light with respect to the scratches. Designs
// descend this gradient. Exits with 0 if the gradient agrees with a finite difference.
#include <burin/render/view_renderer.h>

#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>

int main() {
  using namespace burin;
  Board board;  // 40 mm square; a pinhole camera perpendicular to it, a lamp at the left
  board.size_mm = {40, 40};
  Bench bench;
  bench.lens = {"LENSMODEL_PINHOLE", {300, 300, 63.5, 63.5}, 128, 128};
  bench.material = {.alpha = 0.1, .depth_um = 12};
  View view;
  view.T_camera_board.linear() = Eigen::Vector3d(1, -1, -1).asDiagonal();  // x right, y down, z into the board
  view.T_camera_board.translation() = Eigen::Vector3d(-20, 20, 100);
  Light lamp;
  lamp.position_mm = {-30, 20, 90};
  lamp.intensity = {1e4, 1e4, 1e4};

  Scratches rows;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(5, 35), angle(0, std::numbers::pi);
  for (int i = 0; i < 400; ++i) {
    const double x = place(random), y = place(random), a = angle(random);
    rows.x0_mm.push_back(x), rows.y0_mm.push_back(y);
    rows.x1_mm.push_back(x + 3 * std::cos(a)), rows.y1_mm.push_back(y + 3 * std::sin(a));
  }

  const CameraView camera = make_camera_view(bench, board, view, {0, 0, 128, 128});
  ViewRenderer renderer(make_scene(bench, board, camera, lamp));
  const auto light_of = [&](const Scratches& scratches) {  // sum over all pixels
    Image radiance;
    renderer.forward(in_metal(scratches), radiance);
    double sum = 0;
    for (const float v : radiance.data) sum += v;
    return sum;
  };

  Image radiance;
  renderer.forward_with_jacobian(in_metal(rows), radiance);
  const ScratchGradients gradient = renderer.backward(Image(128, 128, 1, 1.0F));  // dE/dradiance = 1 everywhere

  std::size_t most = 0;  // scratch with the largest derivative with respect to y of its first end
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (std::abs(gradient.y0_mm[i]) > std::abs(gradient.y0_mm[most])) most = i;
  const double step_mm = 1e-3, here = light_of(rows);
  rows.y0_mm[most] += step_mm;
  const double up = light_of(rows);
  rows.y0_mm[most] -= 2 * step_mm;
  const double by_hand = (up - light_of(rows)) / (2 * step_mm);
  std::printf("light %.4f; by scratch %zu: gradient %.5f, by hand %.5f a mm\n", here, most, gradient.y0_mm[most],
              by_hand);
  return here > 0 && std::abs(by_hand - gradient.y0_mm[most]) < 0.01 * std::abs(by_hand) ? 0 : 1;
}

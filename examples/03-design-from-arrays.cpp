// Designs a board from pictures in memory: a disk for one viewpoint, a ramp for another. Exits with 0 if each view
// shows its own picture well, and not the other one.
#include <burin/optimize/design.h>

#include <cmath>
#include <cstdio>

int main() {
  using namespace burin;
  Board board;
  board.size_mm = {60, 60};
  board.carve_min_mm = {10, 10};
  board.carve_max_mm = {50, 50};
  Bench bench;
  bench.material = {.alpha = 0.06, .depth_um = 12};
  Light lamp;  // above the board; each camera sees glints of grooves across its own direction
  lamp.position_mm = {30, 30, 500};
  bench.lights = {lamp};
  const Eigen::Vector3d eyes[2] = {{230, 30, 450}, {30, 230, 450}};
  for (const Eigen::Vector3d& eye : eyes) {
    View view;  // a design uses a view's viewpoint, not its rotation
    view.name = bench.views.empty() ? "right" : "top";
    view.T_camera_board.linear() = Eigen::Vector3d(1, -1, -1).asDiagonal();
    view.T_camera_board.translation() = -(view.T_camera_board.linear() * eye);
    bench.views.push_back(view);
  }

  constexpr int kPixels = 96;
  Image disk(kPixels, kPixels, 1), ramp(kPixels, kPixels, 1);
  for (int y = 0; y < kPixels; ++y)
    for (int x = 0; x < kPixels; ++x) {
      disk.at(x, y) = std::hypot(x - 47.5, y - 47.5) < 30 ? 0.8F : 0.2F;
      ramp.at(x, y) = 0.2F + 0.6F * static_cast<float>(x) / (kPixels - 1);
    }

  DesignSpec spec;
  spec.scratches = 2500;
  spec.views.resize(2);
  spec.views[0].view = "right";
  spec.views[0].target.image = disk;
  spec.views[1].view = "top";
  spec.views[1].target.image = ramp;
  DesignOptions options;
  options.pixels = kPixels;
  options.iterations = 20;
  const DesignResult result = design(spec, board, bench, options, {});

  bool good = result.scratches.size() > 500;
  for (std::size_t k = 0; k < 2; ++k) {
    const DesignedView& view = result.views[k];
    std::printf("%s: %.1f dB; like its own picture %.2f, like the other's %.2f\n", view.view.c_str(), view.psnr_db,
                view.ghost[k], view.ghost[1 - k]);
    good = good && view.psnr_db > 18 && view.ghost[k] > 0.9 && view.ghost[k] > view.ghost[1 - k] + 0.3;
  }
  return good ? 0 : 1;
}

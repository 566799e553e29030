#include "tools/project.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "burin/render/brdf.h"

namespace burin {
namespace {

constexpr double kSameViewDegrees = 15;

Eigen::Vector3d direction_of(const View& view, const Board& board) {
  const Eigen::Vector3d center(board.size_mm.x() / 2, board.size_mm.y() / 2, 0);
  return (view.T_camera_board.inverse().translation() - center).normalized();
}

}  // namespace

std::filesystem::path Project::round(int number) const { return folder / fmt::format("round-{:02}", number); }

std::filesystem::path Project::bench_before(int number) const {
  return (number == 1 ? folder : round(number - 1)) / "bench.json";
}

int Project::rounds() const {
  int count = 0;
  while (std::filesystem::is_directory(round(count + 1))) ++count;
  return count;
}

const View* measured_view(const Bench& measured, const View& designed, const Board& board) {
  const View* nearest = nullptr;
  double largest_cosine = std::cos(kSameViewDegrees * std::numbers::pi / 180);
  for (const View& view : measured.views) {
    const double cosine = direction_of(view, board).dot(direction_of(designed, board));
    if (cosine < largest_cosine) continue;
    largest_cosine = cosine;
    nearest = &view;
  }
  return nearest;
}

}  // namespace burin

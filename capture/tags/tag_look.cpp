#include "burin/capture/tags/tag_look.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/calib3d.hpp>  // leads to the geometry of OpenCV 5
#include <opencv2/imgproc.hpp>

#include "burin/capture/tags/tag_family.h"

namespace burin {

std::vector<TagLook> look_at_tags(std::span<const TagDetection> found, const Image& gray,
                                  std::span<const std::uint8_t> clipped, const std::string& family_name) {
  std::vector<TagLook> looks;
  const TagFamily family = make_tag_family(family_name, "board.json: tags.family");
  for (const TagDetection& tag : found) {
    if (std::count_if(found.begin(), found.end(), [&](const TagDetection& t) { return t.id == tag.id; }) > 1) continue;
    TagLook look{tag.id, tag.coarse_px, 0, 0};
    const TagPattern pattern = tag_pattern(*family, tag.id, "board.json: tags.list");
    // Cells to pixels: AprilTag's corners enclose border_cells, y up.
    const float half = 0.5F * static_cast<float>(pattern.border_cells);
    const std::array<cv::Point2f, 4> cells{{{-half, -half}, {half, -half}, {half, half}, {-half, half}}};
    std::array<cv::Point2f, 4> pixels;
    for (int k = 0; k < 4; ++k)
      pixels[k] = {static_cast<float>(tag.coarse_px[k].x()), static_cast<float>(tag.coarse_px[k].y())};
    const cv::Matx33d H = cv::getPerspectiveTransform(cells.data(), pixels.data());
    std::vector<float> white;
    int lost = 0;
    const double middle = 0.5 * pattern.total_cells;
    for (int row = 0; row < pattern.total_cells; ++row)
      for (int column = 0; column < pattern.total_cells; ++column) {
        const double x = column + 0.5 - middle, y = middle - row - 0.5;
        if (pattern.color_at(x, y) != 1) continue;
        const cv::Vec3d q = H * cv::Vec3d(x, y, 1);
        const int u = static_cast<int>(std::lround(q[0] / q[2])), v = static_cast<int>(std::lround(q[1] / q[2]));
        if (u < 0 || v < 0 || u >= gray.width || v >= gray.height) continue;
        const std::size_t i = static_cast<std::size_t>(v) * gray.width + u;
        white.push_back(gray.data[i]);
        lost += clipped[i];
      }
    if (white.empty()) continue;
    look.clipped_fraction = lost / static_cast<double>(white.size());
    // The lower of the middle two, unlike median.h: results that depend on it keep their bits.
    const auto middle_one = white.begin() + static_cast<std::ptrdiff_t>((white.size() - 1) / 2);
    std::nth_element(white.begin(), middle_one, white.end());
    look.white = *middle_one;
    looks.push_back(look);
  }
  return looks;
}

}  // namespace burin

#include "burin/optimize/design/picture_pixels.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "burin/base/degrees.h"
#include "burin/base/files/decimals.h"

namespace burin {
namespace {

constexpr double kMost = 40, kUsual = 16;  // pixels per stroke
constexpr double kAcuity_rad = 1.5 / 60 * kDegree_rad;
constexpr int kStillAPicture = 64;  // along the longer side

double all_pixels(const std::vector<WorkView>& views) {
  const Image& one = views.front().target.picture;
  return static_cast<double>(one.width) * one.height * static_cast<double>(views_served(views).size());
}

int longer_side(const std::vector<WorkView>& views) {
  const Image& one = views.front().target.picture;
  return std::max(one.width, one.height);
}

// Distance from which eyes no longer resolve neighboring pixels.
std::string distance_m(double pixel_mm) { return fixed(1e-3 * pixel_mm / kAcuity_rad, 1) + " m"; }

}  // namespace

int pixels_of_eyes(const Eigen::Vector2d& area_mm, double distance_mm) {
  constexpr double kFewest = 16;
  return static_cast<int>(std::lround(
      std::clamp(area_mm.maxCoeff() / (kAcuity_rad * distance_mm), kFewest, static_cast<double>(kUsualPixels))));
}

double pixels_a_stroke(const std::vector<WorkView>& views, std::size_t strokes) {
  return all_pixels(views) / static_cast<double>(strokes);
}

std::optional<int> fewer_pixels(int pixels, double a_stroke, bool crowd) {
  constexpr double kAtOnce = 0.75;
  if (!(a_stroke > kMost || crowd) || pixels <= kStillAPicture) return std::nullopt;
  const double side = pixels * (crowd ? kAtOnce : std::max(kAtOnce, std::sqrt(kMost / a_stroke)));
  return std::max(kStillAPicture, static_cast<int>(side));
}

Finding pixels_were_chosen(const std::vector<WorkView>& views, std::size_t strokes, Crossings crossings) {
  const int pixels = longer_side(views);
  return {FindingCode::picture_pixels, Finding::Severity::note, "design",
          "pictures are made of " + std::to_string(pixels) + " pixels along the longer side, which eyes more than " +
              distance_m(views.front().pitch_mm) + " away do not see apart: to fill more, " +
              counted(strokes, "scratch") + " would be drawn long, and the pictures coarse",
          std::string(crossings == Crossings::add ? "more scratches" : "a larger board, a sharper tool") +
              " or fewer pictures show more; --pixels " + std::to_string(kUsualPixels) + " sets finer ones"};
}

std::optional<Finding> pixels_are_many(const std::vector<WorkView>& views, std::size_t strokes, Crossings crossings) {
  const double each = pixels_a_stroke(views, strokes);
  if (!(each > kMost)) return std::nullopt;
  const double enough = all_pixels(views) / kUsual, tens = std::pow(10, std::floor(std::log10(enough)) - 1);
  std::string remedy = crossings == Crossings::add
                           ? "take some " + std::to_string(std::lround(tens * std::round(enough / tens))) + " scratches"
                           : "a sharper tool or a larger board has room for more scratches";
  const double larger = std::sqrt(each / kUsual);
  const int fewer = static_cast<int>(std::lround(longer_side(views) / larger));
  if (fewer >= kStillAPicture)
    remedy = "for eyes that are more than " + distance_m(larger * views.front().pitch_mm) + " away --pixels " +
             std::to_string(fewer) + " shows more; or " + remedy;
  return Finding{FindingCode::scratch_count, Finding::Severity::warning, "design",
                 counted(strokes, "scratch") + (strokes == 1 ? " is" : " are") + " few for these pictures, " +
                     std::to_string(std::lround(each)) +
                     " pixels to a stroke: they will be drawn long, and the pictures coarse",
                 remedy};
}

}  // namespace burin

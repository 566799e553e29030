#include "burin/optimize/layout/view_places.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "burin/base/degrees.h"
#include "burin/optimize/design/glint.h"
#include "burin/scene/groove.h"

namespace burin {
namespace {

double square(double v) { return v * v; }

// One viewpoint for the scratches of one azimuth.
struct Candidate {
  Eigen::Vector3d towards{0, 0, 1};  // direction of the eye from the middle
  double cost = 0;                   // of this position, without the others' height
};

class Search {
 public:
  explicit Search(const PlaceQuestion& q)
      : q_(q),
        middle_((q.carve_min_mm.x() + q.carve_max_mm.x()) / 2, (q.carve_min_mm.y() + q.carve_max_mm.y()) / 2, 0) {
    to_lamp_ = (q.lamp_mm - middle_).normalized();
    // A tenth of a degree below the cutoff angle, because people round positions to whole mm.
    steepest_ = 2 * std::atan(groove_rim(q.width_um, q.depth_um)) - 0.1 * kDegree_rad;
  }

  std::optional<std::vector<Eigen::Vector3d>> best() const {
    constexpr int kTurns = 12;
    const double apart = std::numbers::pi / q_.count, lamp = std::atan2(to_lamp_.y(), to_lamp_.x());
    std::vector<Eigen::Vector3d> found;
    double least = INFINITY;
    for (int turn = 0; turn < kTurns; ++turn) {
      std::vector<std::vector<Candidate>> views;
      for (int j = 0; j < q_.count; ++j) {
        views.push_back(candidates(lamp + apart * (j + static_cast<double>(turn) / kTurns)));
        if (views.back().empty()) break;
      }
      if (views.size() < static_cast<std::size_t>(q_.count) || views.back().empty()) continue;
      level(views, least, found);
    }
    if (found.empty()) return std::nullopt;
    std::sort(found.begin(), found.end(), [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
      return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
    });
    for (Eigen::Vector3d& p : found) p = middle_ + q_.distance_mm * p;
    return found;
  }

 private:
  // The tilt stays below the cutoff angle all over the carve area, edges included.
  bool glints_everywhere(const Eigen::Vector3d& eye_mm) const {
    const GlintView view{"", eye_mm, q_.lamp_mm};
    constexpr int kPoints = 5;
    for (int j = 0; j < kPoints; ++j)
      for (int i = 0; i < kPoints; ++i) {
        const Eigen::Vector2d share(i / (kPoints - 1.0), j / (kPoints - 1.0));
        const Eigen::Vector2d p = q_.carve_min_mm + share.cwiseProduct(q_.carve_max_mm - q_.carve_min_mm);
        if (lean_at(view, {p.x(), p.y(), 0}).angle > steepest_) return false;
      }
    return true;
  }

  std::vector<Candidate> candidates(double azimuth) const {
    constexpr double kStep = 1 * kDegree_rad, kFurthest = 62 * kDegree_rad, kComfortable = 45 * kDegree_rad;
    constexpr double kDarkFace = 21 * kDegree_rad;  // the plain face's own reflection is small from here on
    constexpr double kLeast = 8 * kDegree_rad;
    constexpr double kFromLamp = 25 * kDegree_rad;                   // keeps a head out of the light
    const double mirror = std::asin(std::min(1.0, 3.2 * q_.alpha));  // 3 alpha as in check_glints, and a margin
    std::vector<Candidate> out;
    for (const double side : {0.0, std::numbers::pi})
      for (int k = 0;; ++k) {
        const double lean = std::max(kLeast, mirror) + k * kStep;
        if (lean >= steepest_) break;
        const Eigen::Vector3d h(std::sin(lean) * std::cos(azimuth + side), std::sin(lean) * std::sin(azimuth + side),
                                std::cos(lean));
        const Eigen::Vector3d wo = 2 * to_lamp_.dot(h) * h - to_lamp_;
        const double tilt = std::acos(std::clamp(wo.z(), -1.0, 1.0));
        if (tilt > kFurthest || !glints_everywhere(middle_ + q_.distance_mm * wo)) continue;
        const double from_lamp = std::acos(std::clamp(wo.dot(to_lamp_), -1.0, 1.0));
        out.push_back({wo, square(std::max(0.0, tilt - kComfortable) / (5 * kDegree_rad)) +
                               square(std::max(0.0, kDarkFace - lean) / (3 * kDegree_rad)) +
                               square(std::max(0.0, kFromLamp - from_lamp) / (6 * kDegree_rad))});
      }
    return out;
  }

  // The cheapest candidate of each view relative to a common height, for the best such height. The y of an eye is its
  // height in front of a wall, and its distance of leaning over a table.
  static void level(const std::vector<std::vector<Candidate>>& views, double& least,
                    std::vector<Eigen::Vector3d>& found) {
    constexpr double kEven = 0.15, kUsualHeight = -0.2, kUsualRange = 0.35;
    for (int step = -16; step <= 16; ++step) {
      const double height = 0.05 * step;
      double cost = square((height - kUsualHeight) / kUsualRange);
      std::vector<Eigen::Vector3d> eyes;
      for (const std::vector<Candidate>& view : views) {
        const auto total = [&](const Candidate& c) { return c.cost + square((c.towards.y() - height) / kEven); };
        const auto cheapest = std::min_element(
            view.begin(), view.end(), [&](const Candidate& a, const Candidate& b) { return total(a) < total(b); });
        cost += total(*cheapest);
        eyes.push_back(cheapest->towards);
      }
      if (cost >= least) continue;
      least = cost;
      found = eyes;
    }
  }

  PlaceQuestion q_;
  Eigen::Vector3d middle_, to_lamp_{0, 0, 1};
  double steepest_ = 0;
};

}  // namespace

std::optional<std::vector<Eigen::Vector3d>> view_places(const PlaceQuestion& question) {
  if (question.count < 1 || !(question.lamp_mm.z() > 0)) return std::nullopt;
  return Search(question).best();
}

}  // namespace burin

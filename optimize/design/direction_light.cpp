#include "burin/optimize/design/direction_light.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"

namespace burin {
namespace {

constexpr int kDirections = 90;
constexpr int kPlacesASide = 3;  // places along each side
constexpr double kHalf = 0.766;  // turn at which model.md 3.4 is a half: sqrt(2^(2/3) - 1)

double angle_of(double k) { return std::numbers::pi * k / kDirections; }

// The direction with most light, interpolated between the measured ones; within `reach` of `near`, if it is given.
double best_place(const std::vector<double>& light, double near, int reach) {
  const int n = static_cast<int>(light.size());
  const auto at = [&](int k) { return light[static_cast<std::size_t>(((k % n) + n) % n)]; };
  int best = static_cast<int>(std::lround(near));
  for (int k = best - reach, end = best + reach; k <= end; ++k)
    if (at(k) > at(best)) best = k;
  const double a = at(best - 1), b = at(best), c = at(best + 1), bend = a - 2 * b + c;
  return best + (bend < 0 ? std::clamp(0.5 * (a - c) / bend, -0.5, 0.5) : 0);
}

// The turn in radians after which a scratch has lost half of its light above the least; mean of both sides.
double half_turn(const std::vector<double>& light, double best) {
  const int n = static_cast<int>(light.size());
  const double least = *std::min_element(light.begin(), light.end());
  const auto at = [&](double place) {
    const double below = std::floor(place), part = place - below;
    const int k = static_cast<int>(below);
    const auto one = [&](int i) { return light[static_cast<std::size_t>(((i % n) + n) % n)]; };
    return (1 - part) * one(k) + part * one(k + 1);
  };
  const double level = 0.5 * (at(best) + least);
  double sum = 0;
  for (const double way : {-1.0, 1.0}) {
    double turn = 0.25;
    while (turn < 0.5 * n && at(best + way * turn) > level) turn += 0.25;
    sum += turn;
  }
  return angle_of(0.5 * sum);
}

}  // namespace

double DirectionLight::at(double angle) const {
  const double place = angle / std::numbers::pi * static_cast<double>(light.size());
  const double below = std::floor(place), part = place - below;
  const auto n = static_cast<long>(light.size());
  const auto one = [&](long k) { return light[static_cast<std::size_t>(((k % n) + n) % n)]; };
  return (1 - part) * one(static_cast<long>(below)) + part * one(static_cast<long>(below) + 1);
}

DirectionLight measure_directions(ViewRenderer& renderer, const Eigen::Vector2d& min_mm, const Eigen::Vector2d& max_mm,
                                  double alpha, const std::function<Carved(const Scratches&)>& carve) {
  DirectionLight out;
  out.field.side = kPlacesASide;
  out.field.min_mm = min_mm;
  out.field.max_mm = max_mm;
  const Eigen::Vector2d size = max_mm - min_mm;
  const double length = 3 * std::max(size.x() / renderer.width(), size.y() / renderer.height());
  Scratches tests;
  for (int j = 0; j < kPlacesASide; ++j)
    for (int i = 0; i < kPlacesASide; ++i)
      for (int k = 0; k < kDirections; ++k) {
        const Eigen::Vector2d p =
            min_mm + size.cwiseProduct(Eigen::Vector2d((i + 0.5) / kPlacesASide, (j + 0.5) / kPlacesASide));
        const Eigen::Vector2d half = length / 2 * Eigen::Vector2d(std::cos(angle_of(k)), std::sin(angle_of(k)));
        tests.x0_mm.push_back(p.x() - half.x());
        tests.y0_mm.push_back(p.y() - half.y());
        tests.x1_mm.push_back(p.x() + half.x());
        tests.y1_mm.push_back(p.y() + half.y());
      }
  Image radiance;
  renderer.forward({}, radiance);
  for (const float v : radiance.data) out.face += v / static_cast<double>(radiance.data.size());
  renderer.forward_with_jacobian(carve(tests), radiance);
  std::vector<double> light(tests.size(), 0.0);
  renderer.add_contributions(light);
  const auto of_place = [&](int place) {
    std::vector<double> one(light.begin() + static_cast<std::ptrdiff_t>(place) * kDirections,
                            light.begin() + static_cast<std::ptrdiff_t>(place + 1) * kDirections);
    for (double& v : one) v = std::max(0.0, v) / length;
    return one;
  };
  out.light = of_place(kPlacesASide * kPlacesASide / 2);
  out.best = *std::max_element(out.light.begin(), out.light.end());
  out.least = *std::min_element(out.light.begin(), out.light.end());
  const double middle = best_place(out.light, 0, kDirections / 2);
  for (int place = 0; place < kPlacesASide * kPlacesASide; ++place) {
    const std::vector<double> here = of_place(place);
    const double best = best_place(here, middle, kDirections / 4);
    const double sine =
        std::min(0.95, kHalf * alpha / std::sin(std::min(half_turn(here, best), 0.5 * std::numbers::pi)));
    const double azimuth = angle_of(best) - 0.5 * std::numbers::pi;
    out.field.shadow.push_back(sine * Eigen::Vector2d(std::cos(azimuth), std::sin(azimuth)));
  }
  return out;
}

std::vector<Finding> check_directions(const std::vector<MeasuredView>& views) {
  constexpr double kLittle = 4;   // contrast below which white and black hardly differ
  constexpr double kGhost = 0.3;  // crosstalk without a warning, without the floor
  std::vector<Finding> findings;
  for (const MeasuredView& v : views) {
    const DirectionLight& d = v.directions;
    if (!(d.best > 0))
      fail("view " + v.name, "no groove can glint there under " + v.light,
           "bring light and eye closer to the mirror direction, or carve deeper");
    const double contrast = d.contrast();
    const std::string what = "view " + v.name + ": under " + v.light + " a scratch of the best direction sends " +
                             coarse(contrast) + " times the light of one of the worst";
    if (contrast < kLittle)
      findings.push_back(make_warning(FindingCode::direction_light, what + ": the picture's darks will be gray",
                                      "seek a smaller and brighter light, or cover a part of the surroundings"));
    else
      findings.push_back({FindingCode::direction_light, Finding::Severity::note, "design", what, ""});
  }
  // Lights of one view in color have their own names.
  const auto called = [&](const MeasuredView& v) {
    const auto of_the_name =
        std::count_if(views.begin(), views.end(), [&](const MeasuredView& other) { return other.name == v.name; });
    return of_the_name > 1 ? v.name + " under " + v.light : v.name;
  };
  for (std::size_t a = 0; a < views.size(); ++a)
    for (std::size_t b = 0; b < views.size(); ++b) {
      if (a == b || (views[a].told_by_angles && views[b].told_by_angles)) continue;
      const auto best_of = [](const DirectionLight& d) {
        return std::numbers::pi *
               static_cast<double>(std::max_element(d.light.begin(), d.light.end()) - d.light.begin()) /
               static_cast<double>(d.light.size());
      };
      const DirectionLight& d = views[a].directions;
      const double other = (d.at(best_of(views[b].directions)) - d.least) / std::max(1e-12, d.best - d.least);
      if (other < kGhost) continue;
      findings.push_back(make_warning(FindingCode::views_collide,
                                      "views " + called(views[a]) + " and " + called(views[b]) +
                                          ": collide: a scratch made for " + called(views[b]) + " shows " +
                                          std::to_string(std::lround(100 * other)) + " % of its light in " +
                                          called(views[a]),
                                      views[a].name == views[b].name ? "move one of these lights around the board"
                                                                     : "move a view around the board, or its lights"));
    }
  return findings;
}

}  // namespace burin

#include "burin/optimize/design/stroke_tries.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "burin/optimize/design/random.h"

namespace burin {
namespace {

constexpr double kAnywhere = 0.25;  // share of the candidates away from the old stroke
constexpr double kHair = 1e-5;      // of a pixel: margin of ends to the edge of their box, larger than rounding

// exp(-3.5 t) for t over (0, 1): steps of all sizes. Wide ones find new places; fine ones align strokes with their
// neighbors.
constexpr std::size_t kScales = 64;
const std::array<float, kScales>& scales() {
  static const std::array<float, kScales> table = [] {
    std::array<float, kScales> t{};
    for (std::size_t i = 0; i < kScales; ++i) t[i] = static_cast<float>(std::exp(-3.5 * (i + 0.5) / kScales));
    return t;
  }();
  return table;
}

// 24 bits of a random number from `first` on, as a number in [0, 1).
float fraction_of(std::uint64_t bits, int first) { return static_cast<float>((bits >> first) & 0xffffffU) * 0x1p-24F; }

// Roughly normal, of variance 1.
float bell_of(std::uint64_t bits) {
  constexpr std::uint64_t kField = (1U << 21) - 1;
  const auto sum = static_cast<float>((bits & kField) + ((bits >> 21) & kField) + ((bits >> 42) & kField));
  return 2 * (sum * 0x1p-21F - 1.5F);
}

}  // namespace

StrokeTrier::StrokeTrier(const StrokeField& field, const StrokeRules& rules, const PixelBox& box, std::uint64_t seed)
    : field_(field),
      rules_(rules),
      box_(box),
      window_(field.window(box)),
      kernel_(try_strokes()),
      random_(seed),
      tries_{} {}

void StrokeTrier::survey() { field_.survey(box_, missing_); }

double StrokeTrier::alpha_at_pixel(const Eigen::Vector2d& in_window) const {
  if (rules_.alpha_field.is_constant()) return rules_.alpha;
  return rules_.alpha_at(field_.board(in_window + Eigen::Vector2d(box_.x0, box_.y0)));
}

void StrokeTrier::draw_anywhere(int lane) {
  const auto k = static_cast<int>(missing_.pixel_at(uniform(random_)));
  const int columns = box_.x1 - box_.x0, column = k % columns, row = k / columns;
  const std::uint64_t bits = random_();
  const auto x = static_cast<float>(column), y = static_cast<float>(row);
  // Within the pixel for any rounding of the sum.
  tries_.x[lane] = std::min(x + fraction_of(bits, 0), std::nextafter(x + 1, x));
  tries_.y[lane] = std::min(y + fraction_of(bits, 24), std::nextafter(y + 1, y));
  tries_.brighter[lane] = 0.2F + static_cast<float>((bits >> 48) & 0x7fffU) * 0x1p-15F;
  tries_.anywhere[lane] = 1;
  tries_.side[lane] = (bits >> 63) != 0 ? 1 : -1;
  tries_.alpha[lane] = static_cast<float>(alpha_at_pixel({tries_.x[lane], tries_.y[lane]}));
}

void StrokeTrier::draw_near(int lane, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const std::uint64_t bits = random_();
  const float scale = scales()[bits % kScales], along = fraction_of(bits, 16);
  const float aside = 0.7F * scale * bell_of(random_());
  const Eigen::Vector2d d = b - a, across = Eigen::Vector2d(-d.y(), d.x()).normalized();
  const Eigen::Vector2d p = a + along * d + aside * across;
  tries_.x[lane] = static_cast<float>(p.x());
  tries_.y[lane] = static_cast<float>(p.y());
  // exp(z), approximately, to the power -2/3, which converts a lobe to 1 + q^2.
  const float z = -2.0F / 3 * 0.35F * scale * bell_of(random_());
  tries_.brighter[lane] = (2 + z) / (2 - z);
  tries_.anywhere[lane] = 0;
  tries_.side[lane] = ((bits >> 8) & 7U) == 0 ? -1 : 1;
}

// The best of the lanes, if it is better than `best`.
bool StrokeTrier::take_best(Stroke& best) {
  kernel_(window_, tries_, found_);
  int lane = -1;
  double gain = best.gain + 1e-9;
  for (int i = 0; i < tries_.count; ++i)
    if (static_cast<double>(found_.gain[i]) > gain) {
      lane = i;
      gain = found_.gain[i];
    }
  if (lane < 0) return false;
  const auto end = [&](float s) {
    const double x = static_cast<double>(tries_.x[lane]) + static_cast<double>(s) * found_.ux[lane];
    const double y = static_cast<double>(tries_.y[lane]) + static_cast<double>(s) * found_.uy[lane];
    const Eigen::Vector2d p = field_.board({box_.x0 + std::clamp(x, kHair, window_.width - kHair),
                                            box_.y0 + std::clamp(y, kHair, window_.height - kHair)});
    return Eigen::Vector2d(p.cwiseMax(rules_.min_mm).cwiseMin(rules_.max_mm));
  };
  best.a_mm = end(found_.behind[lane]);
  best.b_mm = end(found_.ahead[lane]);
  best.gain = gain;
  return true;
}

Stroke StrokeTrier::best_anywhere(int candidates) {
  Stroke best;
  for (int left = candidates; left > 0; left -= kStrokeLanes) {
    tries_.count = std::min(left, kStrokeLanes);
    for (int lane = 0; lane < tries_.count; ++lane) draw_anywhere(lane);
    take_best(best);
  }
  return best;
}

Stroke StrokeTrier::best_instead(const Stroke& old, int candidates) {
  Stroke best = old;
  const Eigen::Vector2d corner(box_.x0, box_.y0);
  for (int left = candidates; left > 0; left -= kStrokeLanes) {
    tries_.count = std::min(left, kStrokeLanes);
    const Eigen::Vector2d a = field_.pixel(best.a_mm) - corner, b = field_.pixel(best.b_mm) - corner;
    const Eigen::Vector2d u = (best.b_mm - best.a_mm).normalized();
    tries_.old_x = static_cast<float>(u.x());
    tries_.old_y = static_cast<float>(u.y());
    const auto alpha = static_cast<float>(alpha_at_pixel(0.5 * (a + b)));
    for (int lane = 0; lane < tries_.count; ++lane) {
      if (misses_anything() && uniform(random_) < kAnywhere) {
        draw_anywhere(lane);
        continue;
      }
      draw_near(lane, a, b);
      tries_.alpha[lane] = alpha;
    }
    take_best(best);
  }
  return best;
}

}  // namespace burin

#include "burin/optimize/design/stroke_search.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <random>
#include <utility>

#include "burin/optimize/carving/ends.h"
#include "burin/optimize/design/random.h"
#include "burin/render/error.h"

namespace burin {
namespace {

// light^(1/2.2), clipped at white, from a table over the upper bits of a float: within 0.05 %.
class GammaTable {
 public:
  GammaTable() {
    for (std::size_t i = 0; i < table_.size(); ++i) {
      const auto middle =
          std::bit_cast<float>(((static_cast<std::uint32_t>(i) + kFirst) << kShift) + (1U << (kShift - 1)));
      table_[i] = std::min(1.0F, std::pow(middle, 1 / 2.2F));
    }
  }
  float operator()(float light) const {
    if (!(light > 0x1p-24F)) return 0;
    return table_[std::min<std::uint32_t>((std::bit_cast<std::uint32_t>(light) >> kShift) - kFirst, kCount - 1)];
  }

 private:
  static constexpr int kShift = 15;  // leaves 8 bits of mantissa
  static constexpr std::uint32_t kFirst = std::bit_cast<std::uint32_t>(0x1p-24F) >> kShift, kCount = 24 * 256 + 1;
  std::array<float, kCount> table_;
};

const GammaTable& encoded() {
  static const GammaTable table;
  return table;
}

// A straight way over pixels: at s along a line (in pixels) it goes from one pixel to the next.
struct Line {
  Eigen::Vector2d at, along;  // in pixels of the grid, y down; `along` has length 1
};

// One view's pictures while strokes are moved: the error of a pixel is cached.
class Field {
 public:
  Field(StrokeView& view, const StrokeRules& rules)
      : view_(view),
        rules_(rules),
        width_(view.light.width),
        height_(view.light.height),
        pitch_x_((rules.max_mm.x() - rules.min_mm.x()) / width_),
        pitch_y_((rules.max_mm.y() - rules.min_mm.y()) / height_) {
    if (view.asides.size() > kMostAsides)
      fail("stroke search", "a view has " + std::to_string(view.asides.size()) + " asides",
           "give at most " + std::to_string(kMostAsides));
    places_.push_back({&view.glint, &view.light, &view.unit, static_cast<float>(view.weight), {}});
    for (StrokeAside& aside : view.asides)
      places_.push_back({&aside.glint, &aside.light, &aside.unit, static_cast<float>(aside.weight), {}});
    for (Place& place : places_)
      for (const float light : place.light->data) place.shown.push_back(encoded()(light));
  }

  Eigen::Vector2d pixel(const Eigen::Vector2d& p_mm) const {
    return {(p_mm.x() - rules_.min_mm.x()) / pitch_x_, (rules_.max_mm.y() - p_mm.y()) / pitch_y_};
  }
  Eigen::Vector2d board(const Eigen::Vector2d& p) const {
    return {rules_.min_mm.x() + p.x() * pitch_x_, rules_.max_mm.y() - p.y() * pitch_y_};
  }
  double pitch() const { return pitch_x_; }

  // Direction on the board (angle) in which a scratch at p shows `part` of its lobe, turned to the given side.
  double direction(const Eigen::Vector2d& p_mm, double part, double side) const {
    const Lean lean = lean_at(view_.glint, {p_mm.x(), p_mm.y(), 0});
    return lean.scratch_direction() + side * turn_for(lean.angle, part, rules_.alpha_at(p_mm));
  }

  // h . u / alpha: where the lobe of a scratch of direction u stands at p.
  double lobe_place(const GlintView& glint, const Eigen::Vector2d& p_mm, const Eigen::Vector2d& u) const {
    const Eigen::Vector3d p(p_mm.x(), p_mm.y(), 0);
    const Eigen::Vector3d h = half_vector_at(glint, p);
    return (h.x() * u.x() + h.y() * u.y()) / (h.norm() * rules_.alpha_at(p_mm));
  }

  // The best stroke through a point in a direction.
  Stroke best_through(const Eigen::Vector2d& p_mm, double angle) const {
    const Eigen::Vector2d u(std::cos(angle), std::sin(angle));
    const double longest = rules_.longest_mm / pitch_;
    Line line{pixel(p_mm), Eigen::Vector2d(u.x() / pitch_x_, -u.y() / pitch_y_).normalized()};
    Stroke best;
    if (line.at.x() < 0 || line.at.y() < 0 || line.at.x() >= width_ || line.at.y() >= height_) return best;
    const double reach_mm = 0.5 * rules_.longest_mm;
    const Lobes lobes = lobes_along(p_mm - reach_mm * u, p_mm + reach_mm * u, u, longest / 2, longest);
    // From where the line enters the point's pixel, so that no pixel is shared between the two ways.
    const double entry = -to_border(line, -1);
    double ahead = 0, behind = 0, ahead_gain = -std::numeric_limits<double>::infinity(), behind_gain = 0, sum = 0;
    walk(line, entry, +1, longest / 2, [&](std::size_t i, double s, double length) {
      sum += gain(i, lobes, s + length / 2, static_cast<float>(length));
      if (sum > ahead_gain) {
        ahead_gain = sum;
        ahead = s + length;
      }
      return s - ahead < kPatience;
    });
    sum = 0;
    behind = entry;
    walk(line, entry, -1, longest / 2, [&](std::size_t i, double s, double length) {
      sum += gain(i, lobes, s - length / 2, static_cast<float>(length));
      if (sum > behind_gain) {
        behind_gain = sum;
        behind = s - length;
      }
      return behind - s < kPatience;
    });
    if ((ahead - behind) * pitch_ < rules_.shortest_mm) return best;
    best.gain = ahead_gain + behind_gain;
    // A hair inside the area, so that rounding cannot leave it.
    const auto inside = [&](const Eigen::Vector2d& q) {
      return Eigen::Vector2d(q.cwiseMax(rules_.min_mm).cwiseMin(rules_.max_mm));
    };
    best.a_mm = inside(board(line.at + behind * line.along));
    best.b_mm = inside(board(line.at + ahead * line.along));
    return best;
  }

  // Adds (times = 1) or takes away (-1) a stroke; returns by how much the squared error fell.
  double add(const Eigen::Vector2d& a_mm, const Eigen::Vector2d& b_mm, float times) {
    double fell = 0;
    each_pixel(a_mm, b_mm, [&](std::size_t i, const Lobes& lobes, double s, float length) {
      fell += gain(i, lobes, s, times * length);
      for (std::size_t k = 0; k < places_.size(); ++k) {
        Place& place = places_[k];
        place.light->data[i] += times * length * lobes[k].at(s) * place.unit->data[i];
        place.shown[i] = encoded()(place.light->data[i]);
      }
    });
    return fell;
  }

  // By how much the error falls when a stroke is added (times -1: taken away), nothing being changed.
  double fall(const Eigen::Vector2d& a_mm, const Eigen::Vector2d& b_mm, float times) const {
    double fell = 0;
    each_pixel(a_mm, b_mm, [&](std::size_t i, const Lobes& lobes, double s, float length) {
      fell += gain(i, lobes, s, times * length);
    });
    return fell;
  }

  // A stroke anywhere: a point drawn by how much the picture misses there, and a brightness that it might need.
  Stroke anywhere(std::mt19937_64& random) const {
    const double at = uniform(random) * missing_.back();
    const auto i = static_cast<std::size_t>(std::upper_bound(missing_.begin(), missing_.end(), at) - missing_.begin());
    const std::size_t k = std::min(i, missing_.size() - 1);
    const Eigen::Vector2d p_mm =
        board({static_cast<double>(k % width_) + uniform(random), static_cast<double>(k / width_) + uniform(random)});
    const double lacks = std::pow(view_.target.data[k], 2.2F) - view_.light.data[k];
    const double part = std::clamp(lacks / view_.unit.data[k] * (0.2 + uniform(random)), rules_.dimmest, 1.0);
    return best_through(p_mm, direction(p_mm, part, random() & 1 ? 1 : -1));
  }

  // A stroke near another: aside, turned to another brightness, with its own best ends.
  Stroke near(const Eigen::Vector2d& a_mm, const Eigen::Vector2d& b_mm, std::mt19937_64& random) const {
    const Eigen::Vector2d u = (b_mm - a_mm).normalized(), across(-u.y(), u.x());
    // Steps of all sizes: wide ones find new places, fine ones set strokes against their neighbors.
    const double scale = std::exp(-3.5 * uniform(random));
    const Eigen::Vector2d p_mm = a_mm + uniform(random) * (b_mm - a_mm) + 0.7 * scale * pitch_ * bell(random) * across;
    const double q = lobe_place(view_.glint, p_mm, u);
    const double part = std::pow(1 + q * q, -1.5) * std::exp(0.35 * scale * bell(random));
    double side = q > 0 ? 1 : -1;
    if (random() % 8 == 0) side = -side;
    return best_through(p_mm, direction(p_mm, std::clamp(part, rules_.dimmest, 1.0), side));
  }

  // Where anywhere() looks: pixels by their squared error, those that are too bright left out.
  void survey() {
    const std::vector<float>& shown = places_.front().shown;
    missing_.resize(shown.size());
    double sum = 0;
    for (std::size_t i = 0; i < shown.size(); ++i) {
      const float d = std::max(0.0F, view_.target.data[i] - shown[i]) * mask(i);
      missing_[i] = sum += static_cast<double>(d * d);
    }
  }

 private:
  static constexpr double kPatience = 12;  // pixels without gain after which a stroke ends

  struct Lobe {
    double start, slope;  // h . u / alpha at s = 0 and its change a pixel
    float at(double s) const {
      const auto q = static_cast<float>(start + slope * s);
      const float x = 1 + q * q;
      return 1 / (x * std::sqrt(x));
    }
  };

  using Lobes = std::array<Lobe, 1 + kMostAsides>;

  // Where eye and lamp may stand, and what is seen from there.
  struct Place {
    const GlintView* glint;
    Image* light;
    const Image* unit;
    float weight;
    std::vector<float> shown;
  };

  float mask(std::size_t i) const { return view_.mask.data.empty() ? 1.0F : view_.mask.data[i]; }

  // Linear between two points; s = 0 is `before` pixels after the first.
  Lobes lobes_along(const Eigen::Vector2d& first_mm, const Eigen::Vector2d& last_mm, const Eigen::Vector2d& u,
                    double before, double length) const {
    Lobes lobes{};
    for (std::size_t k = 0; k < places_.size(); ++k) {
      const double first = lobe_place(*places_[k].glint, first_mm, u), last = lobe_place(*places_[k].glint, last_mm, u);
      const double slope = (last - first) / length;
      lobes[k] = {first + before * slope, slope};
    }
    return lobes;
  }

  // By how much the error of a pixel falls when a scratch crosses it over this length around s.
  double gain(std::size_t i, const Lobes& lobes, double s, float length) const {
    const float target = view_.target.data[i];
    float sum = 0;
    for (std::size_t k = 0; k < places_.size(); ++k) {
      const Place& place = places_[k];
      const float before = place.shown[i] - target;
      const float after = encoded()(place.light->data[i] + length * lobes[k].at(s) * place.unit->data[i]) - target;
      sum += place.weight * (before * before - after * after);
    }
    const float m = mask(i);
    return static_cast<double>(m * m * sum);
  }

  // visit(pixel, lobes, s of the part's middle, length of the part in pixels).
  template <typename Visit>
  void each_pixel(const Eigen::Vector2d& a_mm, const Eigen::Vector2d& b_mm, const Visit& visit) const {
    const Eigen::Vector2d a = pixel(a_mm), b = pixel(b_mm);
    const double length = (b - a).norm(), length_mm = (b_mm - a_mm).norm();
    if (!(length > 1e-9)) return;
    const Lobes lobes = lobes_along(a_mm, b_mm, (b_mm - a_mm) / length_mm, 0, length);
    walk({a, (b - a) / length}, 0, +1, length, [&](std::size_t i, double s, double part) {
      visit(i, lobes, s + part / 2, static_cast<float>(part));
      return true;
    });
  }

  // How far along the line's direction times `way` its point's pixel ends.
  static double to_border(const Line& line, double way) {
    double nearest = std::numeric_limits<double>::infinity();
    for (int c = 0; c < 2; ++c) {
      const double step = way * line.along[c], in = line.at[c] - std::floor(line.at[c]);
      if (std::abs(step) > 1e-12) nearest = std::min(nearest, (step > 0 ? 1 - in : -in) / step);
    }
    return nearest;
  }

  // visit(pixel, s where the line enters, length inside) from s = `from` on, ahead (way 1) or back (-1), until it
  // returns false, the picture ends or `most` pixels are gone. (Amanatides & Woo, Eurographics 1987.)
  template <typename Visit>
  void walk(const Line& line, double from, double way, double most, const Visit& visit) const {
    const Eigen::Vector2d step = way * line.along;
    // A nudge decides which pixel a start on a border belongs to.
    const Eigen::Vector2d start = line.at + from * line.along;
    const Eigen::Vector2d inside = start + 1e-7 * step;
    std::array<int, 2> cell{static_cast<int>(std::floor(inside.x())), static_cast<int>(std::floor(inside.y()))};
    std::array<double, 2> next, each;
    std::array<int, 2> sign;
    for (int c = 0; c < 2; ++c) {
      sign[c] = step[c] > 0 ? 1 : -1;
      const bool moves = std::abs(step[c]) > 1e-12;
      each[c] = moves ? 1 / std::abs(step[c]) : std::numeric_limits<double>::infinity();
      next[c] = moves ? ((cell[c] + (sign[c] > 0 ? 1 : 0)) - start[c]) / step[c] : each[c];
    }
    double gone = 0;
    while (gone < most && cell[0] >= 0 && cell[1] >= 0 && cell[0] < width_ && cell[1] < height_) {
      const int c = next[0] < next[1] ? 0 : 1;
      const double until = std::min(next[c], most), length = std::max(0.0, until - gone);
      if (!visit(static_cast<std::size_t>(cell[1]) * width_ + cell[0], from + way * gone, length)) return;
      gone = until;
      cell[c] += sign[c];
      next[c] += each[c];
    }
  }

  StrokeView& view_;
  const StrokeRules& rules_;
  int width_, height_;
  double pitch_x_, pitch_y_;
  double pitch_ = pitch_x_;
  std::vector<Place> places_;    // the view's own first
  std::vector<double> missing_;  // running sums
};

// Strokes between two looks at whether to stop: some milliseconds.
constexpr std::size_t kAskEvery = 16;

std::uint64_t seed_of(std::uint64_t seed, std::size_t view) { return seed * 0x9E3779B97F4A7C15ULL + view; }

// The view that each scratch is meant for: the one that it sends most of its lobe to.
std::vector<std::size_t> views_of(const std::vector<StrokeView>& views, const StrokeRules& rules,
                                  const Scratches& scratches) {
  std::vector<std::size_t> view(scratches.size(), 0);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, scratches.size(), 256), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      const Ends e = ends_of(scratches, i);
      const Eigen::Vector2d m = (e.a + e.b) / 2, d = e.b - e.a;
      double most = -1;
      for (std::size_t v = 0; v < views.size(); ++v) {
        const Lean lean = lean_at(views[v].glint, {m.x(), m.y(), 0});
        const double part = lobe(lean.angle, std::atan2(d.y(), d.x()) - lean.scratch_direction(), rules.alpha_at(m));
        if (part <= most) continue;
        most = part;
        view[i] = v;
      }
    }
  });
  return view;
}

void change_strokes(std::vector<StrokeView>& views, const StrokeRules& rules, const Scratches& scratches,
                    const std::vector<std::size_t>& which, float times) {
  const std::vector<std::size_t> view = views_of(views, rules, scratches);
  std::vector<Field> fields;
  for (StrokeView& v : views) fields.emplace_back(v, rules);
  for (const std::size_t i : which) {
    const Ends e = ends_of(scratches, i);
    fields[view[i]].add(e.a, e.b, times);
  }
}

}  // namespace

Image measure_units(ViewRenderer& renderer, const GlintView& glint, const Eigen::Vector2d& min_mm,
                    const Eigen::Vector2d& max_mm, const std::function<Carved(const Scratches&)>& carve) {
  constexpr int kLattice = 33;
  const int width = renderer.width(), height = renderer.height();
  const double length = 3 * std::max((max_mm.x() - min_mm.x()) / width, (max_mm.y() - min_mm.y()) / height);
  const double margin = 0.5 * length / (max_mm - min_mm).minCoeff();
  Scratches tests;
  for (int j = 0; j < kLattice; ++j)
    for (int i = 0; i < kLattice; ++i) {
      const auto at = [&](int k) { return margin + (1 - 2 * margin) * k / (kLattice - 1.0); };
      const Eigen::Vector2d p(min_mm.x() + at(i) * (max_mm.x() - min_mm.x()),
                              max_mm.y() - at(j) * (max_mm.y() - min_mm.y()));
      const double direction = lean_at(glint, {p.x(), p.y(), 0}).scratch_direction();
      const Eigen::Vector2d half = length / 2 * Eigen::Vector2d(std::cos(direction), std::sin(direction));
      tests.x0_mm.push_back(p.x() - half.x());
      tests.y0_mm.push_back(p.y() - half.y());
      tests.x1_mm.push_back(p.x() + half.x());
      tests.y1_mm.push_back(p.y() + half.y());
    }
  Image radiance;
  renderer.forward_with_jacobian(carve(tests), radiance);
  std::vector<double> light(tests.size(), 0.0);
  renderer.add_contributions(light);
  Image lattice(kLattice, kLattice, 1), unit(width, height, 1);
  for (std::size_t k = 0; k < light.size(); ++k) lattice.data[k] = static_cast<float>(std::max(0.0, light[k]) / length);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double u = std::clamp((x + 0.5) / width, 0.0, 1.0) * (kLattice - 1);
      const double v = std::clamp((y + 0.5) / height, 0.0, 1.0) * (kLattice - 1);
      const int i = std::min(kLattice - 2, static_cast<int>(u)), j = std::min(kLattice - 2, static_cast<int>(v));
      const auto fu = static_cast<float>(u - i), fv = static_cast<float>(v - j);
      unit.at(x, y) = (1 - fv) * ((1 - fu) * lattice.at(i, j) + fu * lattice.at(i + 1, j)) +
                      fv * ((1 - fu) * lattice.at(i, j + 1) + fu * lattice.at(i + 1, j + 1));
    }
  return unit;
}

std::vector<Stroke> place_strokes(std::vector<StrokeView>& views, const StrokeRules& rules, std::size_t count,
                                  std::uint64_t seed, const std::function<bool()>& stop) {
  if (views.empty()) fail("stroke search", "there are no views", "give at least one");
  constexpr std::size_t kRounds = 40;
  constexpr int kTries = 20;  // times that no candidate gains anything, after which a view is full
  const std::size_t n = views.size();
  std::vector<Field> fields;
  std::vector<std::mt19937_64> random;
  for (std::size_t v = 0; v < n; ++v) {
    fields.emplace_back(views[v], rules);
    random.emplace_back(seed_of(seed, v));
  }
  std::vector<double> marginal(n, 1.0);  // what a stroke of the last round gained
  std::vector<Stroke> all;
  for (std::size_t round = 0; round < kRounds && all.size() < count; ++round) {
    if (stop && stop()) break;
    double total = 0;
    for (const double m : marginal) total += m;
    if (!(total > 0)) break;
    const std::size_t left = count - all.size(), each = (left + kRounds - round - 1) / (kRounds - round);
    // Shares rounded so that they add up to `each`.
    std::vector<std::size_t> wanted(n);
    double sum = 0;
    for (std::size_t v = 0; v < n; ++v) {
      const double before = std::floor(sum * static_cast<double>(each) / total + 0.5);
      sum += marginal[v];
      wanted[v] = static_cast<std::size_t>(std::floor(sum * static_cast<double>(each) / total + 0.5) - before);
    }
    std::vector<std::vector<Stroke>> placed(n);
    tbb::parallel_for(std::size_t{0}, n, [&](std::size_t v) {
      fields[v].survey();
      for (int failures = 0; placed[v].size() < wanted[v] && failures < kTries;) {
        if (stop && placed[v].size() % kAskEvery == 0 && stop()) break;
        Stroke best;
        for (int c = 0; c < rules.candidates; ++c) {
          const Stroke candidate = fields[v].anywhere(random[v]);
          if (candidate.gain > best.gain) best = candidate;
        }
        if (!(best.gain > 0)) {
          ++failures;
          continue;
        }
        fields[v].add(best.a_mm, best.b_mm, 1);
        placed[v].push_back(best);
      }
      double gained = 0;
      for (const Stroke& s : placed[v]) gained += s.gain;
      if (wanted[v] > 0) marginal[v] = placed[v].size() < wanted[v] ? 0 : gained / static_cast<double>(wanted[v]);
    });
    for (const auto& strokes : placed) all.insert(all.end(), strokes.begin(), strokes.end());
  }
  return all;
}

std::vector<std::size_t> improve_strokes(std::vector<StrokeView>& views, const StrokeRules& rules, Scratches& scratches,
                                         std::size_t movable, std::uint64_t seed, const std::function<bool()>& stop) {
  constexpr double kAnywhere = 0.25;  // share of the candidates that do not lie near the old stroke
  constexpr std::size_t kSurveyEvery = 1000;
  const std::vector<std::size_t> view = views_of(views, rules, scratches);
  std::vector<char> changed(movable, 0);
  tbb::parallel_for(std::size_t{0}, views.size(), [&](std::size_t v) {
    std::vector<std::size_t> mine;
    for (std::size_t i = 0; i < movable; ++i)
      if (view[i] == v) mine.push_back(i);
    std::mt19937_64 random(seed_of(seed, v));
    for (std::size_t k = mine.size(); k > 1; --k) std::swap(mine[k - 1], mine[random() % k]);
    Field field(views[v], rules);
    for (std::size_t k = 0; k < mine.size(); ++k) {
      if (stop && k % kAskEvery == 0 && stop()) break;
      if (k % kSurveyEvery == 0) field.survey();
      const std::size_t i = mine[k];
      const Ends old = ends_of(scratches, i);
      // What the error grows by without it: its worth, which a better one has to beat.
      Stroke best{old.a, old.b, -field.add(old.a, old.b, -1)};
      bool better = false;
      for (int c = 0; c < rules.candidates; ++c) {
        const Stroke candidate =
            uniform(random) < kAnywhere ? field.anywhere(random) : field.near(best.a_mm, best.b_mm, random);
        if (!(candidate.gain > best.gain + 1e-9)) continue;
        best = candidate;
        better = true;
      }
      field.add(best.a_mm, best.b_mm, 1);
      if (!better) continue;
      changed[i] = 1;
      set_ends(scratches, i, {best.a_mm, best.b_mm});
    }
  });
  std::vector<std::size_t> moved;
  for (std::size_t i = 0; i < changed.size(); ++i)
    if (changed[i]) moved.push_back(i);
  return moved;
}

double squared_error(const StrokeView& view) {
  double sum = 0;
  const auto add = [&](const Image& light, double weight) {
    for (std::size_t i = 0; i < light.data.size(); ++i) {
      const double m = view.mask.data.empty() ? 1 : view.mask.data[i];
      const double d = m * (encoded()(light.data[i]) - view.target.data[i]);
      sum += weight * d * d;
    }
  };
  add(view.light, view.weight);
  for (const StrokeAside& aside : view.asides) add(aside.light, aside.weight);
  return sum;
}

double squared_error(const std::vector<StrokeView>& views) {
  double sum = 0;
  for (const StrokeView& v : views) sum += squared_error(v);
  return sum;
}

std::vector<double> worth_of(const std::vector<StrokeView>& views, const StrokeRules& rules,
                             const Scratches& scratches) {
  const std::vector<std::size_t> view = views_of(views, rules, scratches);
  std::vector<double> worth(scratches.size(), 0.0);
  tbb::parallel_for(std::size_t{0}, views.size(), [&](std::size_t v) {
    StrokeView copy = views[v];
    const Field field(copy, rules);
    for (std::size_t i = 0; i < scratches.size(); ++i) {
      if (view[i] != v) continue;
      const Ends e = ends_of(scratches, i);
      worth[i] = -field.fall(e.a, e.b, -1);
    }
  });
  return worth;
}

std::vector<std::size_t> spare_order(std::vector<StrokeView> views, const StrokeRules& rules,
                                     const Scratches& scratches, std::size_t movable, const std::vector<double>& cost,
                                     const std::function<bool(std::size_t, double)>& spare) {
  const std::vector<std::size_t> view = views_of(views, rules, scratches);
  std::vector<Field> fields;
  for (StrokeView& v : views) fields.emplace_back(v, rules);
  const auto worth = [&](std::size_t i) {
    const Ends e = ends_of(scratches, i);
    return -fields[view[i]].fall(e.a, e.b, -1);
  };
  const auto price = [&](std::size_t i, double w) { return cost.empty() ? w : w / cost[i]; };
  // Worth mostly grows when neighbors go, so an old one is looked at again before it counts (lazy greedy).
  using Entry = std::pair<double, std::size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (std::size_t i = 0; i < movable; ++i) queue.emplace(price(i, worth(i)), i);
  std::vector<std::size_t> order;
  while (!queue.empty()) {
    const auto [old, i] = queue.top();
    queue.pop();
    const double now = worth(i), priced = price(i, now);
    if (!queue.empty() && priced > queue.top().first) {
      queue.emplace(priced, i);
      continue;
    }
    if (!spare(i, now)) break;
    const Ends e = ends_of(scratches, i);
    fields[view[i]].add(e.a, e.b, -1);
    order.push_back(i);
  }
  return order;
}

void lift_strokes(std::vector<StrokeView>& views, const StrokeRules& rules, const Scratches& scratches,
                  const std::vector<std::size_t>& which) {
  change_strokes(views, rules, scratches, which, -1);
}

void add_strokes(std::vector<StrokeView>& views, const StrokeRules& rules, const Scratches& scratches,
                 const std::vector<std::size_t>& which) {
  change_strokes(views, rules, scratches, which, 1);
}

}  // namespace burin

#include "burin/optimize/design/lamp_places.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <random>
#include <set>

#include "burin/base/degrees.h"
#include "burin/base/files/decimals.h"
#include "burin/optimize/design/collisions.h"
#include "burin/optimize/design/color_views.h"
#include "burin/optimize/design/curved_views.h"
#include "burin/optimize/design/to_metal.h"
#include "burin/scene/steepest_lean.h"

namespace burin {
namespace {

constexpr std::size_t kMostSearched = 40;

std::string in_degrees(double radians, int decimals) { return fixed(radians / kDegree_rad, decimals); }

// Whether a lamp may move: for all its views or not at all.
bool moves(const std::vector<ServedGlint>& served, const std::string& light) {
  return std::all_of(served.begin(), served.end(), [&](const ServedGlint& one) {
    return one.light != light || (one.may_move && one.glint.field == nullptr);
  });
}

// The lamps of a design, and the views of each.
class LampSearch {
 public:
  LampSearch(const std::vector<ServedGlint>& served, const LampQuestion& q)
      : served_(served), q_(q), p_mm_(q.middle_mm().x(), q.middle_mm().y(), 0) {
    for (std::size_t i = 0; i < served.size(); ++i) {
      leans_.push_back(lean_at(served[i].glint, p_mm_));
      if (!moves(served, served[i].light)) continue;
      const auto known =
          std::find_if(lamps_.begin(), lamps_.end(), [&](const Lamp& lamp) { return lamp.id == served[i].light; });
      if (known != lamps_.end())
        known->serves.push_back(i);
      else
        lamps_.push_back({served[i].light, {i}, {}});
    }
    for (Lamp& lamp : lamps_) list_places(lamp);
  }

  std::vector<LampPlace> best() {
    constexpr int kSweeps = 12;
    constexpr std::size_t kMany = 18;  // half vectors, of six views in color
    const int beginnings = served_.size() > kMany ? 3 : 8;
    if (lamps_.empty()) return {};
    for (const Lamp& lamp : lamps_)
      if (lamp.places.empty()) return {};
    std::mt19937_64 random(1);
    double least = std::numeric_limits<double>::infinity();
    std::vector<std::size_t> best;
    for (int beginning = 0; beginning < beginnings; ++beginning) {
      std::vector<std::size_t> at;
      for (const Lamp& lamp : lamps_) at.push_back(random() % lamp.places.size());
      for (std::size_t l = 0; l < lamps_.size(); ++l) move(l, at[l]);
      double cost = std::numeric_limits<double>::infinity();
      for (int sweep = 0; sweep < kSweeps; ++sweep) {
        const double before = cost;
        for (std::size_t l = 0; l < lamps_.size(); ++l) cost = put_best(l, at[l]);
        if (!(cost < before)) break;
      }
      if (cost >= least) continue;
      least = cost;
      best = at;
    }
    std::vector<LampPlace> out;
    for (std::size_t l = 0; l < lamps_.size(); ++l)
      out.push_back({lamps_[l].id, lamps_[l].places[best[l]].position_mm});
    return out;
  }

 private:
  struct Place {
    Eigen::Vector3d position_mm{0, 0, 0};
    std::vector<Lean> leans;  // one per view served
    double cost = 0;          // of the position itself: the face's reflection if half vectors tilt little
  };
  struct Lamp {
    std::string id;
    std::vector<std::size_t> serves;
    std::vector<Place> places;
  };

  bool within_walls(const GlintView& glint) const {
    for (const double x : {q_.min_mm.x(), q_.max_mm.x()})
      for (const double y : {q_.min_mm.y(), q_.max_mm.y()})
        if (!(lean_at(glint, {x, y, 0}).angle < q_.steepest)) return false;
    return true;
  }

  void list_places(Lamp& lamp) const {
    constexpr int kStep_deg = 5, kLowest_deg = 15, kHighest_deg = 85;
    constexpr double kHead = 20 * kDegree_rad;   // below this angle, the observer blocks the light
    constexpr double kShine = 20 * kDegree_rad;  // the plain face's own reflection is small from here on
    const double distance = (served_[lamp.serves.front()].glint.light_mm - p_mm_).norm();
    for (int height = kLowest_deg; height <= kHighest_deg; height += kStep_deg)
      for (int azimuth = 0; azimuth < 360; azimuth += kStep_deg) {
        const double up = height * kDegree_rad, around = azimuth * kDegree_rad;
        const Eigen::Vector3d towards(std::cos(up) * std::cos(around), std::cos(up) * std::sin(around), std::sin(up));
        Place place{(p_mm_ + distance * towards).array().round().matrix(), {}, 0};
        bool good = true;
        for (const std::size_t i : lamp.serves) {
          GlintView glint = served_[i].glint;
          glint.light_mm = place.position_mm;
          place.leans.push_back(lean_at(glint, p_mm_));
          const double lean = place.leans.back().angle;
          good = good && std::sin(lean) > 3 * q_.alpha && within_walls(glint);
          const double from_eye = std::acos(std::clamp(towards.dot((glint.camera_mm - p_mm_).normalized()), -1.0, 1.0));
          const double shines = std::max(0.0, kShine - lean) / kShine, hides = std::max(0.0, kHead - from_eye) / kHead;
          place.cost += 0.01 * shines * shines + 0.1 * hides * hides;
        }
        if (good) lamp.places.push_back(std::move(place));
      }
  }

  void move(std::size_t l, std::size_t to) {
    for (std::size_t n = 0; n < lamps_[l].serves.size(); ++n)
      leans_[lamps_[l].serves[n]] = lamps_[l].places[to].leans[n];
  }

  // Puts a lamp at its cheapest position relative to the others' present ones. Costs are squares, so the worst pairs
  // count most.
  double put_best(std::size_t l, std::size_t& at) {
    const std::vector<std::size_t>& own = lamps_[l].serves;
    std::vector<char> is_own(leans_.size(), 0);
    for (const std::size_t i : own) is_own[i] = 1;
    double others = 0;  // costs between the other lamps are constant
    for (std::size_t a = 0; a < leans_.size(); ++a)
      for (std::size_t b = a + 1; b < leans_.size(); ++b)
        if (!is_own[a] && !is_own[b]) others += shared(leans_[a], leans_[b]);
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < lamps_[l].places.size(); ++k) {
      const Place& place = lamps_[l].places[k];
      double cost = place.cost + others;
      for (std::size_t n = 0; n < own.size() && cost < least; ++n) {
        for (std::size_t m = n + 1; m < own.size(); ++m) cost += shared(place.leans[n], place.leans[m]);
        for (std::size_t i = 0; i < leans_.size(); ++i)
          if (!is_own[i]) cost += shared(place.leans[n], leans_[i]);
      }
      if (cost >= least) continue;
      least = cost;
      at = k;
    }
    move(l, at);
    return least;
  }

  double shared(const Lean& a, const Lean& b) const {
    const double ghost = ghost_of(a, b, q_.alpha);
    return ghost * ghost;
  }

  const std::vector<ServedGlint>& served_;
  LampQuestion q_;
  Eigen::Vector3d p_mm_;
  std::vector<Lean> leans_;
  std::vector<Lamp> lamps_;
};

std::string lamp_place_text(const Eigen::Vector3d& p) {
  return "[" + fixed(p.x(), 0) + ", " + fixed(p.y(), 0) + ", " + fixed(p.z(), 0) + "]";
}

}  // namespace

LampAngles angles_of(const std::vector<ServedGlint>& served, const Eigen::Vector2d& p_mm, double alpha) {
  LampAngles out{std::numbers::pi / 2, 0, 0, 0};
  std::vector<Lean> leans;
  std::vector<char> movable;
  for (const ServedGlint& one : served) {
    leans.push_back(lean_at(one.glint, {p_mm.x(), p_mm.y(), 0}));
    movable.push_back(moves(served, one.light) ? 1 : 0);
  }
  for (std::size_t a = 0; a < leans.size(); ++a)
    for (std::size_t b = a + 1; b < leans.size(); ++b) {
      if (!movable[a] && !movable[b]) continue;
      out.least_apart = std::min(out.least_apart, turn_between(leans[a].azimuth, leans[b].azimuth));
      const double ghost = ghost_of(leans[a], leans[b], alpha);
      if (ghost > out.worst_ghost) out = {out.least_apart, ghost, a, b};
    }
  return out;
}

std::vector<LampPlace> better_lamps(const std::vector<ServedGlint>& served, const LampQuestion& question) {
  if (served.size() > kMostSearched) return {};
  return LampSearch(served, question).best();
}

std::vector<Finding> check_lamps(const std::vector<ServedGlint>& served, const LampQuestion& question) {
  if (served.size() < 2 ||
      std::none_of(served.begin(), served.end(), [&](const ServedGlint& s) { return moves(served, s.light); }))
    return {};
  const Eigen::Vector2d p_mm = question.middle_mm();
  const LampAngles now = angles_of(served, p_mm, question.alpha);
  const auto percent = [](double share) { return fixed(100 * share, share < 0.0995 ? 1 : 0) + " %"; };
  std::string half_vectors;
  for (const ServedGlint& one : served) {
    const Lean lean = lean_at(one.glint, {p_mm.x(), p_mm.y(), 0});
    const double towards = std::fmod(lean.azimuth + 2 * std::numbers::pi, 2 * std::numbers::pi);
    half_vectors += (half_vectors.empty() ? "" : ", ") + one.glint.name + " " + in_degrees(lean.angle, 1) +
                    " towards " + in_degrees(towards, 0);
  }
  const std::string what = "lamps: half vectors lean, in degrees, " + half_vectors + "; their scratches run at least " +
                           in_degrees(now.least_apart, 1) + " degrees apart (at best " +
                           fixed(180.0 / static_cast<double>(served.size()), 1) +
                           "), and one made for one shows at most " + percent(now.worst_ghost) +
                           " of its light in another";
  if (now.worst_ghost < kGhost) return {{FindingCode::views_collide, Finding::Severity::note, "design", what, ""}};
  const std::vector<LampPlace> places = better_lamps(served, question);
  std::vector<ServedGlint> moved = served;
  std::string words;
  for (const LampPlace& place : places) {
    words += (words.empty() ? "" : ", ") + place.light + " at " + lamp_place_text(place.position_mm);
    for (ServedGlint& one : moved)
      if (one.light == place.light) one.glint.light_mm = place.position_mm;
  }
  const LampAngles then = places.empty() ? now : angles_of(moved, p_mm, question.alpha);
  const bool better = then.worst_ghost < 0.7 * now.worst_ghost;
  return {make_warning(
      FindingCode::views_collide, what + " (" + served[now.a].glint.name + ", " + served[now.b].glint.name + ")",
      better ? "with lamps (position_mm) " + words + " that would be at most " + percent(then.worst_ghost)
             : "take fewer views or lamps, smoother grooves, or half vectors that lean more")};
}

std::vector<Finding> lamps_in_color(const DesignSpec& spec, const Board& board, const Bench& bench) {
  if (std::none_of(spec.views.begin(), spec.views.end(), [](const DesignView& v) { return v.color; })) return {};
  std::vector<ServedGlint> served;
  const std::shared_ptr<const BoardFace> curved = curved_face(board, bench);
  std::set<std::string> of_colors, of_gray_together;
  for (const DesignView& view : spec.views) {
    require_light(view, bench);
    const std::vector<std::string> names = light_names(view.light);
    if (view.color)
      of_colors.insert(names.begin(), names.end());
    else if (names.size() > 1)
      of_gray_together.insert(names.begin(), names.end());
  }
  for (const DesignView& view : spec.views) {
    const std::vector<std::string> lights = lights_served(view);
    std::vector<GlintView> glints = glints_served(view, bench);
    for (std::size_t l = 0; l < lights.size(); ++l) {
      if (!find_light(bench, lights[l], "design").is_lamp()) continue;
      glints[l].face = curved;
      const bool may_move = of_colors.count(lights[l]) > 0 && of_gray_together.count(lights[l]) == 0;
      served.push_back({glints[l], lights[l], may_move});
    }
  }
  LampQuestion question{board.carve_min_mm, board.carve_max_mm, 0, 0};
  const auto here = [&](const GrooveField& field, double shared) {
    return at_place(field, shared, board.size_mm, question.middle_mm());
  };
  question.alpha = std::min(1.0, here(bench.alpha_field, bench.material.alpha));
  question.steepest =
      steepest_lean(bench.material.profile, board.tool_width_um, here(bench.depth_field, bench.material.depth_um));
  return check_lamps(served, question);
}

}  // namespace burin

#include "burin/optimize/design/collisions.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <tuple>

#include "burin/base/degrees.h"
#include "burin/base/files/decimals.h"

namespace burin {
namespace {

constexpr std::size_t kToldOneByOne = 6;
constexpr int kPlacesASide = 9;  // lattice points along each side of a curved board

std::string in_degrees(double radians) { return fixed(radians / kDegree_rad, 1); }
std::string in_percent(double share) { return std::to_string(static_cast<int>(std::lround(100 * share))) + " %"; }

// Each view's half vector at the sampled places, the middle first.
struct AskedPlaces {
  std::vector<double> alpha;
  std::vector<std::vector<Lean>> lean;  // index: place, then view
};

AskedPlaces look_at_places(const std::vector<GlintView>& views, const Eigen::Vector2d& min_mm,
                           const Eigen::Vector2d& max_mm, const GrooveAt& groove_at) {
  AskedPlaces out;
  const auto add = [&](const Eigen::Vector2d& p) {
    out.alpha.push_back(groove_at(p).alpha);
    std::vector<Lean>& leans = out.lean.emplace_back();
    for (const GlintView& view : views) leans.push_back(lean_at(view, {p.x(), p.y(), 0}));
  };
  add((min_mm + max_mm) / 2);
  const bool curved =
      std::any_of(views.begin(), views.end(), [](const GlintView& view) { return view.face != nullptr; });
  for (int j = 0; j < kPlacesASide && curved; ++j)
    for (int i = 0; i < kPlacesASide; ++i)
      add(min_mm + Eigen::Vector2d((i + 0.5) / kPlacesASide, (j + 0.5) / kPlacesASide).cwiseProduct(max_mm - min_mm));
  return out;
}

Finding one_told(const Collision& c, const std::vector<GlintView>& views) {
  const bool curved = views[c.a].face != nullptr;
  return make_warning(
      FindingCode::views_collide,
      "views " + views[c.a].name + " and " + views[c.b].name + ": collide: their scratches run only " +
          in_degrees(c.apart) + " degrees apart " + (curved ? "in the middle " : "") +
          "(a scratch counts modulo 180 degrees), so one made for one shows " + in_percent(c.ghost) +
          " of its light in the other" + (curved ? ", the board being curved: up to " + in_percent(c.worst) : ""),
      in_degrees(c.needed) + " degrees would bring that down to 10 %: move a view or its lamp around the board");
}

}  // namespace

std::vector<Collision> collisions_of(const std::vector<GlintView>& views, const Eigen::Vector2d& min_mm,
                                     const Eigen::Vector2d& max_mm, const GrooveAt& groove_at) {
  const AskedPlaces places = look_at_places(views, min_mm, max_mm, groove_at);
  std::vector<Collision> out;
  for (std::size_t a = 0; a < views.size(); ++a)
    for (std::size_t b = a + 1; b < views.size(); ++b) {
      const std::vector<Lean>& middle = places.lean.front();
      Collision c{a, b, turn_between(middle[a].azimuth, middle[b].azimuth), 0, 0, 0};
      const std::size_t first = places.lean.size() > 1 ? 1 : 0;  // a curved board's middle is among the others
      for (std::size_t i = first; i < places.lean.size(); ++i) {
        const double ghost = ghost_of(places.lean[i][a], places.lean[i][b], places.alpha[i]);
        c.ghost += ghost / static_cast<double>(places.lean.size() - first);
        c.worst = std::max(c.worst, ghost);
      }
      if (c.ghost < kGhost) continue;
      c.needed = std::max(turn_for(middle[a].angle, kGhost, places.alpha.front()),
                          turn_for(middle[b].angle, kGhost, places.alpha.front()));
      out.push_back(c);
    }
  std::stable_sort(out.begin(), out.end(), [](const Collision& x, const Collision& y) { return x.ghost > y.ghost; });
  return out;
}

std::vector<Finding> told(const std::vector<Collision>& collisions, const std::vector<GlintView>& views) {
  std::vector<Finding> findings;
  if (collisions.size() <= kToldOneByOne) {
    std::vector<Collision> in_order = collisions;
    std::sort(in_order.begin(), in_order.end(),
              [](const Collision& x, const Collision& y) { return std::tie(x.a, x.b) < std::tie(y.a, y.b); });
    for (const Collision& c : in_order) findings.push_back(one_told(c, views));
    return findings;
  }
  const auto neighbors =
      std::count_if(collisions.begin(), collisions.end(), [](const Collision& c) { return c.b == c.a + 1; });
  std::string worst;
  for (std::size_t i = 0; i < 3; ++i)
    worst += (i == 0 ? "" : ", ") + views[collisions[i].a].name + " and " + views[collisions[i].b].name + " " +
             in_percent(collisions[i].ghost);
  const auto strangers = static_cast<std::ptrdiff_t>(collisions.size()) - neighbors;
  double stranger = 0;
  for (const Collision& c : collisions)
    if (c.b != c.a + 1) stranger = std::max(stranger, c.ghost);
  findings.push_back(make_warning(
      FindingCode::views_collide,
      std::to_string(collisions.size()) + " of " + std::to_string(views.size() * (views.size() - 1) / 2) +
          " pairs of views collide: scratches made for one show more than 10 % of their light in the other (" + worst +
          "); " + std::to_string(neighbors) + " of the pairs are neighbors in the list" +
          (strangers > 0 ? ", " + std::to_string(strangers) + " are not (up to " + in_percent(stranger) + ")" : ""),
      strangers > 0 ? "neighbors that show nearly the same picture may share; for the others take fewer views, a wider "
                      "arc, a half vector that leans more, or smoother grooves"
                    : "neighbors that show nearly the same picture may share: let the picture change slowly"));
  return findings;
}

}  // namespace burin

#include "burin/render/surroundings/table_range.h"

#include <algorithm>
#include <cmath>

#include "burin/render/groove.h"

namespace burin {
namespace {

constexpr double kAlphaRatio = 1.05;  // from a table's roughness to the next

struct Wanted {
  double least, most, steepest;
};

Wanted wanted(const ViewScene& scene, const Scratches& s) {
  Wanted out{scene.material.alpha, scene.material.alpha, 0};
  if (!s.alpha.empty()) {
    const auto [low, high] = std::minmax_element(s.alpha.begin(), s.alpha.end());
    out.least = *low;
    out.most = *high;
  }
  for (std::size_t i = 0; i < (s.depth_um.empty() && s.width_um.empty() ? 1 : s.size()); ++i)
    out.steepest = std::max(out.steepest, groove_rim(s.width_um.empty() ? scene.tool_width_um : s.width_um[i],
                                                     s.depth_um.empty() ? scene.material.depth_um : s.depth_um[i]));
  return out;
}

}  // namespace

TableRange table_range(const ViewScene& scene, const Scratches& scratches, bool by_alpha) {
  const auto [least, most, steepest] = wanted(scene, scratches);
  TableRange out;
  out.steepest_t = std::min(0.99, 1.02 * steepest);
  if (!by_alpha && !(most > least * (1 + 1e-9))) {
    out.alphas = {least};
    return out;
  }
  const double spread = std::log(most / least);
  const int steps = std::max(0, static_cast<int>(std::ceil(spread / std::log(kAlphaRatio))));
  for (int k = -1; k <= steps + 1; ++k)
    out.alphas.push_back(std::min(1.0, least * std::exp(steps > 0 ? spread * k / steps : k * std::log(kAlphaRatio))));
  while (out.alphas.size() > 1 && out.alphas[out.alphas.size() - 2] >= 1) out.alphas.pop_back();
  while (out.alphas.size() < 3) out.alphas.insert(out.alphas.begin(), out.alphas.front() / kAlphaRatio);
  return out;
}

bool serves(const TableRange& range, const ViewScene& scene, const Scratches& scratches) {
  const auto [least, most, steepest] = wanted(scene, scratches);
  return !range.alphas.empty() && steepest <= range.steepest_t && least >= range.alphas.front() * (1 - 1e-9) &&
         most <= range.alphas.back() * (1 + 1e-9);
}

}  // namespace burin

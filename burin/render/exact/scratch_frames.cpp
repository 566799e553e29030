#include <tbb/parallel_for.h>

#include <algorithm>
#include <numeric>
#include <tuple>
#include <utility>

#include "burin/render/exact/scratch_pair.h"

namespace burin {
namespace {

// The same for grooves whose sections are.
std::tuple<double, double, bool> section_key(const Scratches& s, const ScratchFrame& frame, std::size_t i) {
  return {frame.groove.width_um, frame.groove.depth_um, !s.rimless.empty() && s.rimless[i] != 0};
}

}  // namespace

std::vector<ScratchFrame> scratch_frames(const Scratches& scratches, double width_um, const Material& material) {
  std::vector<ScratchFrame> out(scratches.size());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = scratch_frame(scratches, i, width_um, material);
  if (material.profile.is_paper()) return out;
  const auto key = [&](std::size_t i) { return section_key(scratches, out[i], i); };
  std::vector<std::size_t> order(out.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return key(a) < key(b); });
  std::vector<std::pair<std::size_t, std::size_t>> runs;  // of one section, in `order`
  for (std::size_t from = 0, to = 0; from < order.size(); from = to) {
    while (to < order.size() && key(order[to]) == key(order[from])) ++to;
    runs.emplace_back(from, to);
  }
  tbb::parallel_for(std::size_t{0}, runs.size(), [&](std::size_t run) {
    const auto [from, to] = runs[run];
    const ScratchFrame& first = out[order[from]];
    GrooveProfile profile = material.profile;
    if (std::get<2>(key(order[from]))) profile.burr_left_um = profile.burr_right_um = 0;
    const auto bands = std::make_shared<const std::vector<ProfileBand>>(
        profile_bands(profile, first.groove.width_um, first.groove.depth_um));
    for (std::size_t k = from; k < to; ++k) out[order[k]].bands = bands;
  });
  return out;
}

}  // namespace burin

#include <tbb/parallel_for.h>

#include <bit>
#include <cstdint>
#include <unordered_map>

#include "burin/render/exact/scratch_pair.h"

namespace burin {
namespace {

// Grooves of one key share a section.
struct SectionKey {
  double width_um, depth_um;
  bool narrowed;
  bool operator==(const SectionKey&) const = default;
};
struct SectionHash {
  std::size_t operator()(const SectionKey& key) const {
    constexpr std::uint64_t kOdd = 0x9e3779b97f4a7c15;
    const std::uint64_t mixed =
        (std::bit_cast<std::uint64_t>(key.width_um) * kOdd) ^ std::bit_cast<std::uint64_t>(key.depth_um);
    return (mixed ^ (mixed >> 29)) * kOdd + (key.narrowed ? 1 : 0);
  }
};

}  // namespace

std::vector<ScratchFrame> scratch_frames(const Scratches& scratches, double width_um, const Material& material,
                                         double widest_um) {
  std::vector<ScratchFrame> out(scratches.size());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = scratch_frame(scratches, i, width_um, material);
  if (material.profile.is_paper()) return out;
  std::unordered_map<SectionKey, std::size_t, SectionHash> known;
  std::vector<SectionKey> keys;
  std::vector<std::size_t> section(out.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    const SectionKey key{out[i].groove.width_um, out[i].groove.depth_um, scratches.is_narrowed(i)};
    section[i] = known.try_emplace(key, keys.size()).first->second;
    if (section[i] == keys.size()) keys.push_back(key);
  }
  std::vector<std::shared_ptr<const std::vector<ProfileBand>>> bands(keys.size());
  tbb::parallel_for(std::size_t{0}, keys.size(), [&](std::size_t k) {
    GrooveProfile profile = material.profile;
    if (keys[k].narrowed) profile.burr_left_um = profile.burr_right_um = 0;
    bands[k] = std::make_shared<const std::vector<ProfileBand>>(
        profile_bands(profile, keys[k].width_um, keys[k].depth_um, widest_um));
  });
  for (std::size_t i = 0; i < out.size(); ++i) out[i].bands = bands[section[i]];
  return out;
}

}  // namespace burin

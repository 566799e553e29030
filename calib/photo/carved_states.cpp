#include "burin/calib/photo/carved_states.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <utility>

namespace burin {
namespace {

// The parameters that carve() uses: states with equal keys have the same carved grooves.
std::vector<double> key_of(const Bench& bench) {
  const GrooveProfile& profile = bench.material.profile;
  const MachineErrors& errors = bench.machine_errors;
  std::vector<double> key{bench.material.depth_um, bench.material.alpha,  static_cast<double>(profile.kind),
                          profile.flank_deg,       profile.tip_radius_um, static_cast<double>(bench.crossings)};
  const auto add = [&](const auto& numbers) {  // one by one: GCC 14 warns of copies past the first six without reason
    for (const double number : numbers) key.push_back(number);
  };
  key.push_back(profile.has_burrs() ? 1 : 0);  // not their height
  add(bench.machine_affine.reshaped());
  add(errors.backlash_mm);
  add(errors.screw_sin_mm);
  add(errors.screw_cos_mm);
  add(errors.screw_period_mm);
  add(bench.depth_field.terms);
  add(bench.alpha_field.terms);
  return key;
}

// A few dozen states of an ordinary board; with a million pieces, the last two.
constexpr std::size_t kMostPieces = 2'000'000, kMostStates = 32;

}  // namespace

std::shared_ptr<const Carved> CarvedStates::at(const Unknowns& x) const {
  std::vector<double> key = key_of(bench_at(model_, x));
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found =
      std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) { return entry.key == key; });
  if (found != entries_.end()) {
    std::rotate(found, found + 1, entries_.end());
    return entries_.back().carved;
  }
  // A thread waiting for its helpers must not begin another photo, which would call this again.
  tbb::this_task_arena::isolate([&] {
    entries_.push_back({std::move(key), std::make_shared<const Carved>(carved_at(model_, x))});
  });
  const auto pieces_of = [](const Entry& entry) {
    constexpr std::size_t kSharesAPiece = 32;  // by their memory
    return entry.carved->size() + (entry.carved->lanes ? entry.carved->lanes->share.size() / kSharesAPiece : 0);
  };
  std::size_t pieces = 0;
  for (const Entry& entry : entries_) pieces += pieces_of(entry);
  while (entries_.size() > 2 && (pieces > kMostPieces || entries_.size() > kMostStates)) {
    pieces -= pieces_of(entries_.front());
    entries_.pop_front();
  }
  return entries_.back().carved;
}

}  // namespace burin

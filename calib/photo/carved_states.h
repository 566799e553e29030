// burin/calib/photo/carved_states.h - caches carved grooves at the states of a fit. All photos of an iteration share
// them, as do finite differences: cutting grooves at crossings takes longer than rendering them.
#pragma once

#include <deque>
#include <memory>
#include <mutex>
#include <vector>

#include "burin/calib/photo/model_data.h"

namespace burin {

/// carved_at() of one model, which must outlive it, with a cache of the latest results. Thread-safe.
class CarvedStates {
 public:
  explicit CarvedStates(const ModelData& model) : model_(model) {}

  /// carved_at(model, x).
  std::shared_ptr<const Carved> at(const Unknowns& x) const;

 private:
  struct Entry {
    std::vector<double> key;
    std::shared_ptr<const Carved> carved;
  };

  const ModelData& model_;
  mutable std::mutex mutex_;
  mutable std::deque<Entry> entries_;  // the latest last
};

}  // namespace burin

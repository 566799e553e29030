// burin/optimize/design/stroke_sweep.h - the steps of the search (stroke_search.h) for those who make several of them
// on the same pictures. In all of them tiles of all views are worked on at the same time, each with random numbers of
// its own: same seed, same bits, for any number of threads.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "burin/optimize/design/stroke_field.h"
#include "burin/optimize/design/stroke_tiles.h"
#include "burin/optimize/design/stroke_types.h"
#include "burin/optimize/toolpath/ends.h"
#include "burin/scene/scratches.h"

namespace burin {

/// Asks whether to stop until somebody says so; by several threads at once. `stop` may be empty, and must outlive it.
class Stopping {
 public:
  explicit Stopping(const std::function<bool()>& stop) : stop_(stop) {}
  bool operator()() {
    if (!over_ && stop_ && stop_()) over_ = true;
    return over_;
  }

 private:
  const std::function<bool()>& stop_;
  std::atomic<bool> over_{false};
};

/// A number that is another one for every (seed, view, step, tile).
std::uint64_t seed_of(std::uint64_t seed, std::size_t view, std::size_t step, std::size_t tile);

/// The tilings of one sweep: small tiles twice, laid differently, then larger and larger ones for the strokes that fit
/// into none, in the end all that a kernel can count.
std::vector<Tiling> tilings_of_sweep(const StrokeField& field, std::uint64_t seed);

/// The tile that a stroke lies in, or none (size()).
std::size_t tile_of(const StrokeField& field, const Tiling& tiling, const Ends& ends);

/// The views' pictures, shared where views show the same one; `rules` must outlive them.
std::vector<StrokeField> stroke_fields(const std::vector<StrokeView>& views, const StrokeRules& rules);
/// The same, each view's images being given up once its field has them: both of a large design take a gigabyte.
std::vector<StrokeField> stroke_fields(std::vector<StrokeView>&& views, const StrokeRules& rules);

/// The fields that may be worked on at the same time: those that share pictures stand in one group, and are worked on
/// one after the other.
std::vector<std::vector<std::size_t>> field_groups(const std::vector<StrokeField>& fields);

/// The view that each scratch is meant for: the one that it sends most of its lobe to.
std::vector<std::size_t> views_of(const std::vector<StrokeField>& fields, const Scratches& scratches);

/// place_strokes().
std::vector<Stroke> place_in(std::vector<StrokeField>& fields, const StrokeRules& rules, std::size_t count,
                             std::uint64_t seed, const std::function<bool()>& stop);

/// improve_strokes(), `view` being that of each scratch.
std::vector<std::size_t> improve_in(std::vector<StrokeField>& fields, const StrokeRules& rules, Scratches& scratches,
                                    const std::vector<std::size_t>& view, std::size_t movable, std::uint64_t seed,
                                    const std::function<bool()>& stop);

/// worth_of().
std::vector<double> worth_in(const std::vector<StrokeField>& fields, const Scratches& scratches,
                             const std::vector<std::size_t>& view);

}  // namespace burin

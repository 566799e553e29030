// burin/optimize/design/stroke_sweep.h - the steps of the search (stroke_search.h) for callers that run several on the
// same pictures.
//
// All steps process tiles of all views in parallel, each with its own random numbers: the same seed gives the same bits
// for any number of threads.
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

/// Calls `stop` until it returns true, from several threads at once. `stop` may be empty, and must outlive this object.
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

/// A different number for every (seed, view, step, tile).
std::uint64_t seed_of(std::uint64_t seed, std::size_t view, std::size_t step, std::size_t tile);

/// The tilings of one sweep. Small tiles come twice, at different offsets. Larger and larger ones follow for longer
/// strokes, up to the largest size that a kernel can count.
std::vector<Tiling> tilings_of_sweep(const StrokeField& field, std::uint64_t seed);

/// The tile around a stroke, or none (size()).
std::size_t tile_of(const StrokeField& field, const Tiling& tiling, const Ends& ends);

/// The views' pictures, shared between views with the same one; `rules` must outlive them.
std::vector<StrokeField> stroke_fields(const std::vector<StrokeView>& views, const StrokeRules& rules);
/// As stroke_fields(), but frees each view's images once its field has them: both of a large design take a gigabyte.
std::vector<StrokeField> stroke_fields(std::vector<StrokeView>&& views, const StrokeRules& rules);

/// Groups of fields. Fields that share pictures form one group and are processed in turn; groups may run in parallel.
std::vector<std::vector<std::size_t>> field_groups(const std::vector<StrokeField>& fields);

/// The view for which each scratch is made: the one with most of its lobe.
std::vector<std::size_t> views_of(const std::vector<StrokeField>& fields, const Scratches& scratches);

/// place_strokes() on fields.
std::vector<Stroke> place_in(std::vector<StrokeField>& fields, const StrokeRules& rules, std::size_t count,
                             std::uint64_t seed, const std::function<bool()>& stop);

/// improve_strokes() on fields; `view` holds the view of each scratch.
std::vector<std::size_t> improve_in(std::vector<StrokeField>& fields, const StrokeRules& rules, Scratches& scratches,
                                    const std::vector<std::size_t>& view, std::size_t movable, std::uint64_t seed,
                                    const std::function<bool()>& stop);

/// worth_of() on fields.
std::vector<double> worth_in(const std::vector<StrokeField>& fields, const Scratches& scratches,
                             const std::vector<std::size_t>& view);

}  // namespace burin

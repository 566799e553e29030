#include "burin/render/fast/render_workspace.h"

#include <algorithm>
#include <cstring>
#include <span>
#include <type_traits>
#include <utility>

#include "burin/render/fast/grow.h"
#include "burin/scene/groove.h"

namespace burin {
namespace {

/// Places need 2 bytes per pair, derivatives by the ends 8.
constexpr std::size_t kPlaceShare = 5;

/// A multiple of 16 with space for a whole SIMD vector beyond the last pair.
std::size_t padded(std::size_t count) { return (count + 31) / 16 * 16; }

std::size_t jacobian_arrays(KernelMode mode, bool by_half_vector = false) {
  if (mode != KernelMode::material) return 2;
  return by_half_vector ? 7 : 5;
}

/// The arrays of a mode, one after the other, `padded`.
TileJacobian jacobian_at(float* at, KernelMode mode, std::size_t count, bool by_half_vector = false) {
  TileJacobian to;
  const std::size_t n = padded(count);
  const std::array<float**, 7> arrays{&to.shift, &to.turn, &to.width, &to.rim, &to.alpha, &to.h_across, &to.h_along};
  for (std::size_t i = 0; i < jacobian_arrays(mode, by_half_vector); ++i, at += n) {
    *arrays[i] = at;
    // Lanes beyond the last pair have no weight, but must be finite.
    std::fill(at + count / 16 * 16, at + n, 0.0F);
  }
  return to;
}

std::size_t shape_size(const ScratchLines& lines, const Each<float>& of) { return of.shared ? 1 : lines.count; }

}  // namespace

RenderWorkspace::RenderWorkspace(std::size_t most_jacobian_bytes, std::shared_ptr<TileCache> tiles)
    : jacobian_store(most_jacobian_bytes - most_jacobian_bytes / kPlaceShare),
      tiles_(tiles != nullptr ? std::move(tiles) : std::make_shared<TileCache>(0)),
      place_store_(most_jacobian_bytes / kPlaceShare) {}

std::shared_ptr<const TiledGrid> RenderWorkspace::tiles_of(const std::shared_ptr<const FootprintGrid>& grid) {
  return tiles_->of(grid);
}

std::shared_ptr<const GrooveShapes> RenderWorkspace::shapes_of(const Scratches& s, double width_um, double depth_um) {
  const std::array<double, 2> shared{width_um, depth_um};
  const auto of = [&](const std::vector<double>& own, int number) {
    return own.empty() ? std::span(&shared[number], 1) : std::span<const double>(own);
  };
  const auto widths = of(s.width_um, 0), depths = of(s.depth_um, 1);
  if (shapes_ != nullptr && std::ranges::equal(shapes_->width_um, widths) &&
      std::ranges::equal(shapes_->depth_um, depths))
    return shapes_;
  GrooveShapes made;
  made.width_um.assign(widths.begin(), widths.end());
  made.depth_um.assign(depths.begin(), depths.end());
  const std::size_t count = std::max(widths.size(), depths.size());
  made.per_mm.resize(count);
  made.rim.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double width = widths[widths.size() == 1 ? 0 : i];
    made.per_mm[i] = static_cast<float>(2000 / width);
    made.rim[i] = static_cast<float>(groove_rim(width, depths[depths.size() == 1 ? 0 : i]));
  }
  shapes_ = std::make_shared<const GrooveShapes>(std::move(made));
  return shapes_;
}

bool RenderWorkspace::is_sorted(const TiledGrid* grid, const ScratchLines& lines) const {
  if (sorted_grid_.get() != grid || sorted_ends_mm_[0].size() != lines.count) return false;
  const std::array<const double*, 4> ends{lines.x0_mm, lines.y0_mm, lines.x1_mm, lines.y1_mm};
  for (int i = 0; i < 4; ++i)
    if (!std::equal(sorted_ends_mm_[i].begin(), sorted_ends_mm_[i].end(), ends[i])) return false;
  const std::array<const Each<float>*, 3> shape{&lines.per_mm, &lines.rim, &lines.alpha};
  for (int i = 0; i < 3; ++i)
    if (sorted_shape_[i].size() != shape_size(lines, *shape[i]) ||
        !std::equal(sorted_shape_[i].begin(), sorted_shape_[i].end(), shape[i]->values))
      return false;
  return true;
}

void RenderWorkspace::sort(const std::shared_ptr<const TiledGrid>& grid, const ScratchLines& lines) {
  if (is_sorted(grid.get(), lines)) return;
  sorted_grid_ = grid;
  const std::array<const double*, 4> ends{lines.x0_mm, lines.y0_mm, lines.x1_mm, lines.y1_mm};
  for (int i = 0; i < 4; ++i) sorted_ends_mm_[i].assign(ends[i], ends[i] + lines.count);
  const std::array<const Each<float>*, 3> shape{&lines.per_mm, &lines.rim, &lines.alpha};
  for (int i = 0; i < 3; ++i)
    sorted_shape_[i].assign(shape[i]->values, shape[i]->values + shape_size(lines, *shape[i]));
  runs.sort(grid->index, lines);
  for (std::size_t t = 0; t < grid->tiles(); ++t) most_runs = std::max<std::size_t>(most_runs, runs.count(t));
  places_.assign(grid->tiles(), {});
  pair_count.assign(grid->tiles(), 0);
  place_store_.clear();
}

TilePlaces RenderWorkspace::places_of(std::size_t tile, const TileTask& task, const TileKernels& kernels,
                                      FoundPlaces& found) {
  if (places_[tile].begin != nullptr) return places_[tile];
  kernels.find(task, found);
  const std::size_t runs_here = task.run_count + 1, count = found.begin[task.run_count];
  pair_count[tile] = static_cast<std::uint32_t>(count);
  const std::size_t begin_bytes = runs_here * sizeof(std::uint32_t), place_bytes = (count + 16) * sizeof(std::uint16_t);
  std::byte* const space = place_store_.take(begin_bytes + place_bytes);
  if (space == nullptr) return found.places();
  std::memcpy(space, found.begin.data(), begin_bytes);
  std::memcpy(space + begin_bytes, found.place.data(), place_bytes);
  places_[tile] = {reinterpret_cast<const std::uint32_t*>(space),
                   reinterpret_cast<const std::uint16_t*>(space + begin_bytes)};
  return places_[tile];
}

TileJacobian RenderWorkspace::make_jacobian(KernelMode mode, std::size_t count, Work& work, bool by_half_vector) {
  if (mode == KernelMode::value) return {};
  grow_to(work.jacobian, jacobian_arrays(mode, by_half_vector) * padded(count));
  return jacobian_at(work.jacobian.data(), mode, count, by_half_vector);
}

TileJacobian RenderWorkspace::keep_jacobian(KernelMode mode, std::size_t count) {
  std::byte* const space = jacobian_store.take(jacobian_arrays(mode) * padded(count) * sizeof(float));
  return space == nullptr ? TileJacobian{} : jacobian_at(reinterpret_cast<float*>(space), mode, count);
}

void RenderWorkspace::keep_ends(std::size_t tile, TileJacobian made, const std::vector<EndPair>& ends) {
  static_assert(std::is_trivially_copyable_v<EndPair>);
  jacobian[tile] = {};
  if (made.shift == nullptr) return;
  std::byte* const space = jacobian_store.take(ends.size() * sizeof(EndPair));
  if (space == nullptr) return;
  if (!ends.empty()) std::memcpy(space, ends.data(), ends.size() * sizeof(EndPair));
  made.ends = reinterpret_cast<EndPair*>(space);
  made.end_count = ends.size();
  jacobian[tile] = made;
}

}  // namespace burin

// burin/render/view_scene.h - inputs and options of a rendered view. view_renderer.h renders it. Frame: board, mm.
// docs/model.md 5.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "burin/base/simd_width.h"
#include "burin/scene/footprint_grid.h"
#include "burin/scene/light.h"
#include "burin/scene/material.h"

namespace burin {

/// All inputs of one rendered view except the scratches.
struct ViewScene {
  std::shared_ptr<const FootprintGrid> grid;  ///< see share()
  Eigen::Vector3d camera_center_mm{0, 0, 0};
  Light light;
  Material material;           ///< shared alpha and depth, for scratches without their own
  double tool_width_um = 400;  ///< shared width, for scratches without their own
  Eigen::Vector3d ambient{0, 0, 0};
  /// 1 for pixels that the lamp does not reach, width * height. Several lights follow one another, or no pixel is
  /// hidden. Empty: the lamp reaches all pixels that face it. make_scene fills it for faces that hide parts of
  /// themselves (burin/scene/board_face.h); for other occluders fill it with hidden_pixels().
  std::vector<std::uint8_t> hidden_from_light;
};

/// Options of the renderer.
struct RenderOptions {
  int channels = 1;         ///< 1: mean of R, G, B, as a mono sensor sees it; 3: R, G, B
  bool use_double = false;  ///< slow double-precision reference
  /// If true, forward_with_jacobian() also keeps derivatives by width, depth, alpha and base_alpha (always with
  /// use_double). Without them, designs with fixed width, depth and alpha are faster and need less memory.
  bool material_gradients = true;
  SimdWidth simd = SimdWidth::best;  ///< SIMD vectors of the fast path
};

/// Work buffers and sparse Jacobian of the fast path (burin/render/fast/render_workspace.h). Renderers that share one
/// need the memory of one view. Each must then finish with a forward()'s results before the next renderer's forward().
/// Renderers with a common grid also share its data, and find the pairs of the same scratches once.
class RenderWorkspace;
/// Data of grids that workspaces render in turn (burin/render/fast/tile_cache.h), with a limit in bytes.
class TileCache;
std::shared_ptr<TileCache> make_tile_cache(std::size_t most_bytes = 300'000'000);
inline constexpr std::size_t kUsualJacobianBytes = 320'000'000;
/// The backward pass recomputes the part of the Jacobian beyond `most_jacobian_bytes`, with the same bits. `tiles`:
/// several workspaces may share one; without it a workspace keeps the data of its last grid alone.
std::shared_ptr<RenderWorkspace> make_render_workspace(std::size_t most_jacobian_bytes = kUsualJacobianBytes,
                                                       std::shared_ptr<TileCache> tiles = nullptr);

}  // namespace burin

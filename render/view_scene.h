// burin/render/view_scene.h - what a rendered view depends on, and how it is rendered. Rendering itself:
// view_renderer.h. Frame: board, mm. docs/model.md 5.
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

/// Everything that one rendered view depends on, besides the scratches.
struct ViewScene {
  std::shared_ptr<const FootprintGrid> grid;  ///< see share()
  Eigen::Vector3d camera_center_mm{0, 0, 0};
  Light light;
  Material material;           ///< shared alpha and depth where the scratches carry none
  double tool_width_um = 400;  ///< shared width where the scratches carry none
  Eigen::Vector3d ambient{0, 0, 0};
  /// 1 for pixels whose face the lamp does not reach, width * height (of several lights one after the other, or none
  /// are hidden); empty: it reaches all that face it. make_scene fills it for faces that hide parts of themselves
  /// (burin/scene/board_face.h); for other occluders fill it with hidden_pixels().
  std::vector<std::uint8_t> hidden_from_light;
};

/// How a view is rendered.
struct RenderOptions {
  int channels = 1;         ///< 1: mean of R, G, B (what a mono sensor sees); 3: R, G, B
  bool use_double = false;  ///< the slow exact twin
  /// Whether forward_with_jacobian() keeps derivatives by width, depth, alpha and base_alpha too (always with
  /// use_double). Designs that only move ends are faster and smaller without.
  bool material_gradients = true;
  SimdWidth simd = SimdWidth::best;  ///< packets of the fast path
};

/// The fast path's work buffers and sparse Jacobian (burin/render/fast/render_workspace.h). Renderers that share one
/// need the memory of one view; each must then finish with a forward()'s results before the next renderer's forward().
/// Those that also share a grid share all that comes from it, and find the pairs of the same scratches once.
class RenderWorkspace;
/// What workspaces know of grids that they render in turn (burin/render/fast/tile_cache.h), up to so many bytes.
class TileCache;
std::shared_ptr<TileCache> make_tile_cache(std::size_t most_bytes = 300'000'000);
inline constexpr std::size_t kUsualJacobianBytes = 320'000'000;
/// `most_jacobian_bytes`: what of the Jacobian does not fit into it is computed again on the way back. The results are
/// the same, bit for bit. `tiles`: several workspaces may share one; without it a workspace knows its last grid alone.
std::shared_ptr<RenderWorkspace> make_render_workspace(std::size_t most_jacobian_bytes = kUsualJacobianBytes,
                                                       std::shared_ptr<TileCache> tiles = nullptr);

}  // namespace burin

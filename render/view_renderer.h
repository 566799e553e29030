// burin/render/view_renderer.h - the picture of scratches in one view, and its derivatives. docs/model.md 5 and 8.
// Frame: board, mm. The unit of radiance is the unit of the lamp's intensity / mm^2, without exposure and gain.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "burin/base/image.h"
#include "burin/render/view_scene.h"
#include "burin/scene/bench.h"
#include "burin/scene/carve.h"
#include "burin/scene/footprint_grid.h"
#include "burin/scene/scratch_gradients.h"

namespace burin {

/// Renders one view repeatedly while the grooves move. The same input gives the same bits for any number of threads.
/// Throws Error for grooves with NaN.
class ViewRenderer {
 public:
  /// Without a `workspace` the renderer owns one.
  explicit ViewRenderer(ViewScene scene, RenderOptions options = {},
                        std::shared_ptr<RenderWorkspace> workspace = nullptr);
  ~ViewRenderer();
  ViewRenderer(ViewRenderer&&) noexcept;
  ViewRenderer& operator=(ViewRenderer&&) noexcept;

  int width() const;  ///< width of the view, pixels
  /// height of the view, pixels
  int height() const;

  /// Radiance of every pixel of the grid (width x height x channels); pixels that miss the face are 0.
  void forward(const Carved& carved, Image& radiance);

  /// forward(), which also keeps the data of backward().
  void forward_with_jacobian(const Carved& carved, Image& radiance);

  /// Gradient of E through this view, from dE/dradiance, for the grooves of the last forward_with_jacobian().
  /// pull_back() (carve.h) chains it to the design. The derivative of the clamp `covered <= 1` is that of its active
  /// side.
  ScratchGradients backward(const Image& dE_dradiance) const;

  /// Adds this gradient to `gradients`, which are empty or those of other views of the same grooves. Throws Error for
  /// gradients of another number of grooves.
  void backward(const Image& dE_dradiance, ScratchGradients& gradients) const;

  /// Adds each scratch's contribution to `contribution`, which has one number per scratch. The contribution is the sum
  /// over pixels of its radiance times the pixel's weight in dE/dradiance. Pruning drops the scratches with the
  /// smallest.
  void add_contributions(std::vector<double>& contribution) const;

  std::size_t pair_count() const;  ///< (pixel, scratch) pairs of the last forward

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Parameters of a bench for render_with_derivatives().
enum class SceneParameter {
  alpha,
  depth_um,
  width_um,
  // alpha to base_alpha are shared values. If scratches carry their own depth or alpha, the derivative is by a common
  // factor, in the unit of material.alpha / material.depth_um.
  base_alpha,
  light_x_mm,
  light_y_mm,
  light_z_mm,
  log_intensity,  // common factor on all channels
  light_axis_x,
  light_axis_y,
  light_axis_z,  // components of the axis, free and not renormalized
  falloff_exponent,
  machine_00,
  machine_01,
  machine_02,
  machine_10,
  machine_11,
  machine_12,  // affine map of the given ends of the scratches
  pose_rx,
  pose_ry,
  pose_rz,  // rotation vector, applied on the left of T_camera_board
  pose_tx_mm,
  pose_ty_mm,
  pose_tz_mm,  // added to the translation of T_camera_board
  bow_0_mm,
  bow_1_mm,
  bow_2_mm,
  grain_c,
  grain_s,  // of FaceGrain
};

/// Radiance and its derivatives by all `parameters`, for a Gauss-Newton fit to a photo. Derivatives by color
/// intensities and ambient follow from the radiance itself and are the caller's task.
struct RadianceDerivatives {
  Image radiance;
  std::vector<Image> d_radiance;  ///< one per entry of `parameters`
};

/// A camera's view with a pose that may be differentiated.
struct CameraView {
  Lens lens;
  Eigen::Isometry3d T_camera_board;
  Surface surface;
  PixelWindow window;
};

/// `scene.grid` and `scene.camera_center_mm` must be those of `camera` (see make_scene). Uses float SIMD vectors
/// (docs/model.md 8.7) in `workspace` or in its own. Works pair by pair in double if RenderOptions::use_double is set,
/// or if half vectors bend too much for SIMD vectors.
RadianceDerivatives render_with_derivatives(const ViewScene& scene, const CameraView& camera, const Carved& carved,
                                            std::span<const SceneParameter> parameters,
                                            const RenderOptions& options = {},
                                            const std::shared_ptr<RenderWorkspace>& workspace = nullptr);

/// Scene of a view of a bench through a window of its photo. For a board with a mesh, rays give the footprints on the
/// mesh; `camera.surface` has no effect, and render_with_derivatives does not support it.
ViewScene make_scene(const Bench& bench, const Board& board, const CameraView& camera, const Light& light);
CameraView make_camera_view(const Bench& bench, const Board& board, const View& view, const PixelWindow& window);

/// Scene with the bench's metal, tool and environment. No pixel is hidden from light if its face turns to the light.
ViewScene make_scene(const Bench& bench, const Board& board, std::shared_ptr<const FootprintGrid> grid,
                     const Eigen::Vector3d& camera_center_mm, const Light& light);

/// The carve area on the grid of board_grid(), from one viewpoint. Places are dark if the face hides them from lamp or
/// eye. Designs use it for their pictures and comparisons.
ViewScene make_board_scene(const Bench& bench, const Board& board, int width, int height,
                           const Eigen::Vector3d& camera_center_mm, const Light& light);

/// Reference for small tests: all pairs of pixels and grooves in double, without a search for pairs.
Image render_brute_force(const ViewScene& scene, const Carved& carved, int channels = 1);

}  // namespace burin

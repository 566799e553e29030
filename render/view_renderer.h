// burin/render/view_renderer.h - the picture that scratches show in one view, and its derivatives. docs/model.md 5
// and 8. Frame: board, mm. Radiance is in the unit of the lamp's intensity / mm^2; exposure and gain are not applied.
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

/// Renders one view again and again while the grooves move. Deterministic: same input, same bits, for any number of
/// threads. Throws Error for grooves with NaN.
class ViewRenderer {
 public:
  /// Without a `workspace` it has one of its own.
  explicit ViewRenderer(ViewScene scene, RenderOptions options = {},
                        std::shared_ptr<RenderWorkspace> workspace = nullptr);
  ~ViewRenderer();
  ViewRenderer(ViewRenderer&&) noexcept;
  ViewRenderer& operator=(ViewRenderer&&) noexcept;

  int width() const;  ///< pixels of the view
  /// Of the picture, pixels.
  int height() const;

  /// Radiance of every pixel of the grid (width x height x channels); pixels that miss the face are 0.
  void forward(const Carved& carved, Image& radiance);

  /// forward(), keeping what backward() needs.
  void forward_with_jacobian(const Carved& carved, Image& radiance);

  /// The gradient of E through this view, given dE/dradiance, for the grooves of the last forward_with_jacobian();
  /// pull_back() (carve.h) takes it to the design. The derivative of the clamp `covered <= 1` is that of the side it is
  /// on.
  ScratchGradients backward(const Image& dE_dradiance) const;

  /// Adds that to `gradients`, which are empty or those of other views of the same grooves. Throws Error for gradients
  /// of another number of grooves.
  void backward(const Image& dE_dradiance, ScratchGradients& gradients) const;

  /// dE/dradiance back to light that each scratch sends to this view: sum over pixels of its radiance times pixel
  /// weight. Used to drop the scratches that contribute least. `contribution` gets one number a scratch, added.
  void add_contributions(std::vector<double>& contribution) const;

  std::size_t pair_count() const;  ///< (pixel, scratch) pairs of the last forward

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The parameters of a bench that a photo can tell about, for render_with_derivatives().
enum class SceneParameter {
  alpha,
  depth_um,
  width_um,
  base_alpha,  // shared; where scratches carry their own depth or alpha,
               // the derivative is by a common factor's change, in the
               // unit of material.alpha / material.depth_um
  light_x_mm,
  light_y_mm,
  light_z_mm,
  log_intensity,  // common factor on all channels
  light_axis_x,
  light_axis_y,
  light_axis_z,  // free components of the (not renormalized) axis
  falloff_exponent,
  machine_00,
  machine_01,
  machine_02,
  machine_10,
  machine_11,
  machine_12,  // affine on the scratches' ends as given
  pose_rx,
  pose_ry,
  pose_rz,  // rotation vector, applied on the left of T_camera_board
  pose_tx_mm,
  pose_ty_mm,
  pose_tz_mm,  // added to its translation
  bow_0_mm,
  bow_1_mm,
  bow_2_mm,
  grain_c,
  grain_s,  // of FaceGrain
};

/// Radiance and its derivative by each of `parameters`, all at once: what a Gauss-Newton fit to a photo needs.
/// Derivatives by color intensities and ambient follow from the radiance itself and are left to the caller.
struct RadianceDerivatives {
  Image radiance;
  std::vector<Image> d_radiance;  ///< one an entry of `parameters`
};

/// A camera's view for which the pose may be differentiated too.
struct CameraView {
  Lens lens;
  Eigen::Isometry3d T_camera_board;
  Surface surface;
  PixelWindow window;
};

/// `scene.grid` and `scene.camera_center_mm` must be those of `camera` (see make_scene). By float packets
/// (docs/model.md 8.7) in `workspace`, or one of its own; pair by pair with RenderOptions::use_double, and where half
/// vectors bend too much for packets.
RadianceDerivatives render_with_derivatives(const ViewScene& scene, const CameraView& camera, const Carved& carved,
                                            std::span<const SceneParameter> parameters,
                                            const RenderOptions& options = {},
                                            const std::shared_ptr<RenderWorkspace>& workspace = nullptr);

/// The scene of a view of a bench, seen by a window of its photo. A board with a mesh is cast through it: its
/// footprints are the mesh's, `camera.surface` is not used, and render_with_derivatives does not serve it.
ViewScene make_scene(const Bench& bench, const Board& board, const CameraView& camera, const Light& light);
CameraView make_camera_view(const Bench& bench, const Board& board, const View& view, const PixelWindow& window);

/// What every scene of a bench has: its metal, its tool, what surrounds it. Light reaches all of the grid that faces
/// it.
ViewScene make_scene(const Bench& bench, const Board& board, std::shared_ptr<const FootprintGrid> grid,
                     const Eigen::Vector3d& camera_center_mm, const Light& light);

/// The carve area laid out as board_grid() does, as it looks from a place; dark where the face hides itself from lamp
/// or eye. (A design's pictures, and what is compared with them.)
ViewScene make_board_scene(const Bench& bench, const Board& board, int width, int height,
                           const Eigen::Vector3d& camera_center_mm, const Light& light);

/// Grooves by the brute force of all pairs in double, without pair finding: the oracle for small tests.
Image render_brute_force(const ViewScene& scene, const Carved& carved, int channels = 1);

}  // namespace burin

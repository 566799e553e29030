// burin/render/view_renderer.h - the picture that scratches show in one view, and its derivatives. docs/model.md 5
// and 8. Frame: board, mm. Radiance is in the unit of the lamp's intensity / mm^2; exposure and gain are not applied.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "burin/render/bench.h"
#include "burin/render/carve.h"
#include "burin/render/footprint_grid.h"
#include "burin/render/image.h"
#include "burin/render/scratch_gradients.h"
#include "burin/render/simd_width.h"

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
  /// (burin/render/board_face.h); for other occluders fill it with hidden_pixels().
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
  /// Whether light in grooves of another cross-section than the paper's is found at a few places along each instead of
  /// at every pixel (docs/model.md 4.27): good to 1e-5, and less than half the work with derivatives where grooves are
  /// many pixels long. Photos that are compared to the last digit go without. Not with use_double.
  bool light_along_grooves = false;
};

/// The fast path's work buffers and sparse Jacobian (burin/render/fast/render_workspace.h). Renderers that share one
/// need the memory of one view; each must then finish with a forward()'s results before the next renderer's forward().
/// Those that also share a grid share all that comes from it, and find the pairs of the same scratches once.
class RenderWorkspace;
/// `most_jacobian_bytes`: what of the Jacobian does not fit into it is computed again on the way back. The results are
/// the same, bit for bit.
std::shared_ptr<RenderWorkspace> make_render_workspace(std::size_t most_jacobian_bytes = 320'000'000);

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
  light_axis_z,  // free components of the (not renormalised) axis
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

/// `scene.grid` and `scene.camera_center_mm` must be those of `camera` (see make_scene).
RadianceDerivatives render_with_derivatives(const ViewScene& scene, const CameraView& camera, const Carved& carved,
                                            std::span<const SceneParameter> parameters,
                                            const RenderOptions& options = {});

/// The scene of a view of a bench, seen by a window of its photo. A board with a mesh is cast through it: its
/// footprints are the mesh's, `camera.surface` is not used, and render_with_derivatives does not serve it.
ViewScene make_scene(const Bench& bench, const Board& board, const CameraView& camera, const Light& light);
CameraView make_camera_view(const Bench& bench, const Board& board, const View& view, const PixelWindow& window);

/// Grooves by the brute force of all pairs in double, without pair finding: the oracle for small tests.
Image render_brute_force(const ViewScene& scene, const Carved& carved, int channels = 1);

}  // namespace burin

// python/scene.h - views of a bench that Python renders again and again, with gradients. docs/model.md 5,
// docs/python.md. Frame: board, mm.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "burin/base/image.h"
#include "burin/render/view_renderer.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"
#include "burin/scene/scratches.h"

namespace burin::python {

/// Numbers that replace those of the bench in one call. Empty: the bench's.
struct Changes {
  std::optional<double> base_alpha;
  std::optional<std::vector<Eigen::Vector3d>> lamp_mm;        ///< a light
  std::optional<std::vector<double>> lamp_log_intensity;      ///< a light: factors exp(.) on all its channels
  std::optional<std::vector<Eigen::Vector<double, 6>>> pose;  ///< a view: rotation vector on the left, then mm added
  std::optional<Eigen::Vector3d> bow_mm;

  bool any() const { return base_alpha || lamp_mm || lamp_log_intensity || pose || bow_mm; }
};

/// dE by everything that was given.
struct Gradients {
  ScratchGradients scratches;
  double base_alpha = 0;
  std::vector<Eigen::Vector3d> lamp_mm;
  std::vector<double> lamp_log_intensity;
  std::vector<Eigen::Vector<double, 6>> pose;
  Eigen::Vector3d bow_mm{0, 0, 0};
};

/// What the pixels of a scene are: a window of the views' photos, or a grid of `width` x `height` on the carve area.
struct Pixels {
  bool on_board = false;
  PixelWindow window;
};

/// Views under lights, safe to be rendered by several threads at once: every call works with renderers of its own,
/// which are kept for later calls.
class Scene {
 public:
  /// `lights` shine at once. Throws Error for names that the bench does not have, for a camera behind the board and for
  /// a light that reaches nothing.
  Scene(Bench bench, Board board, const std::vector<std::string>& views, const std::vector<std::string>& lights,
        const Pixels& pixels, int channels, bool use_double);

  std::size_t views() const { return views_.size(); }
  std::size_t lights() const { return lights_.size(); }
  int width() const { return pixels_.window.width; }
  int height() const { return pixels_.window.height; }
  int channels() const { return options_.channels; }
  bool use_double() const { return options_.use_double; }

  /// Radiance, a view. `carved`: rows lie in the metal as given; otherwise carve() takes them there.
  std::vector<Image> render(const Scratches& rows, const Changes& changes, bool carved);

  /// The gradient of E, given dE/dradiance of every view. Those by lamps, poses and bow are summed if `changes` has
  /// them; they need near lamps, and pose and bow a photo's pixels.
  Gradients gradients(const Scratches& rows, const Changes& changes, bool carved,
                      const std::vector<Image>& dE_dradiance);

 private:
  /// The bench, views and lights of one call.
  struct Setup {
    Bench bench;
    std::vector<View> views;
    std::vector<Light> lights;
  };
  struct Renderers {
    bool material = false;  ///< whether they keep derivatives by width, depth and roughness
    std::shared_ptr<RenderWorkspace> workspace;
    std::vector<ViewRenderer> views;
  };

  Setup changed(const Changes& changes) const;
  ViewScene scene_of(const Setup& setup, std::size_t view, const Light& light) const;
  CameraView camera_of(const Setup& setup, std::size_t view) const;
  Renderers make_renderers(const Setup& setup, bool material) const;
  Renderers take_renderers(const Setup& setup, const Changes& changes, bool material);
  void give_back(Renderers renderers, const Changes& changes);
  void add_scene_gradients(const Setup& setup, const Changes& changes, const Carved& carved,
                           const std::vector<Image>& dE_dradiance, Gradients& out) const;

  Bench bench_;
  Board board_;
  std::vector<View> views_;
  std::vector<Light> lights_;
  Pixels pixels_;
  RenderOptions options_;
  std::shared_ptr<TileCache> tiles_;
  std::mutex mutex_;  // of kept_
  std::vector<Renderers> kept_;
};

}  // namespace burin::python

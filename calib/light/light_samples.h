// burin/calib/light/light_samples.h - gathers evidence of the lamp outside of scratches: the brightness of the tags'
// white and black paper, and of the plain face between tags and scratches. docs/model.md 9, 'Lamp'. Frame: board, mm.
// Values are linear photo values over the exposure factor: gain * vignette * radiance.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "burin/base/finding.h"
#include "burin/base/image.h"
#include "burin/capture/photo.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"
#include "burin/scene/carve.h"
#include "burin/scene/footprint_grid.h"
#include "burin/scene/lens.h"

namespace burin {

/// One view under one lamp for the light fits: the colors' mean, cropped to the board's window.
struct LightView {
  std::size_t merged = 0;           ///< index into the session's merged views, the source of the pixels
  std::size_t view = 0, light = 0;  ///< indices into bench.views and bench.lights
  /// Index into bench.lights of the surroundings in addition to the lamp; the same for all views. Empty: the ambient
  /// light is uniform.
  std::optional<std::size_t> surroundings;
  Lens lens;  ///< of the pixels below (lens_of() the view, or of binned pixels)
  /// The view's own lens (OwnLens): its pixel q corresponds to pixel (q - ray_shift_px) / focal_ratio of the lens of
  /// all views, in the session's pixels.
  double focal_ratio = 1;
  Eigen::Vector2d ray_shift_px{0, 0};
  PixelWindow window;               ///< of the whole (binned) photo; the images below have its size
  Image value, sigma;               ///< one channel
  std::vector<std::uint8_t> valid;  ///< 1 if some exposure holds the value
  Image scattered;                  ///< image of glare of share 1, from the whole photo (glare_fit.h); or empty
  int bin = 1;                      ///< of binned(): side in the session's pixels
  /// Rays of the region of the session's views, in its pixels, by the lens of all views. Computed once, since inverting
  /// a lens for millions of pixels takes longer than rendering them. Empty: from the lens.
  std::shared_ptr<const CornerRays> rays;
};

/// Gives unbinned views of make_light_views() the bench's present lenses, and their rays. The session's pixels are
/// `bin` x `bin` of the photos'.
void take_lenses(const Bench& bench, int bin, std::span<LightView> views);

/// The footprints of a light view's pixels.
FootprintGrid grid_of(const LightView& view, const Eigen::Isometry3d& T_camera_board, const Surface& surface);

/// The lens of pixels that are averages of bin x bin pixels.
Lens binned_lens(const Lens& lens, int bin);

/// Binning of photos for the light fits: photos of 16 megapixels and more, while a tag's side keeps 30 pixels. Poses
/// and lens come from the photos as taken.
int light_bin(int width, int height, double tag_side_px);

/// The window that holds the board, and `margin_px` around it, in a photo of bin x bin pixels averaged into one.
PixelWindow board_window(const Board& board, const Bench& bench, const View& view, int bin, int margin_px);

/// The view with bin x bin pixels averaged into one, and the lens scaled with it. A pixel is valid if all its parts
/// are.
LightView binned(const LightView& view, int bin);

/// Pairs merged photos with the bench's views and lamps. Appends missing lamps to `bench.lights`. Leaves out photos of
/// views without a pose and names them in `findings`. A photo under one lamp and one of the bench's surroundings ("lamp
/// + room") counts as one under this lamp; then all photos must. Missing surroundings are reported and taken as
/// uniform. Throws Error for other combinations of lights.
std::vector<LightView> make_light_views(std::span<const MergedView> merged, const Board& board, Bench& bench,
                                        std::vector<Finding>& findings);

enum class SampleKind { white_paper, black_paper, face };

/// The mean of some pixels of one material.
struct LightSample {
  SampleKind kind = SampleKind::face;
  std::size_t light_view = 0;  ///< index into the light views
  std::size_t light = 0;
  Eigen::Vector3d p_board{0, 0, 0};
  Eigen::Vector3d normal{0, 0, 1};
  Eigen::Vector3d to_camera{0, 0, 1};  ///< unit
  double radius2 = 0;                  ///< vignetting's r^2 (see Sensor)
  double value = 0, sigma = 0;
  /// Light from around per unit of ambient light: on paper irradiance / pi, on the face reflection / F0.
  double around = 1;
  int tag = -1;  ///< id of the tag for paper
};

struct LightSampleOptions {
  double edge_margin_px = 2;     ///< distance of a pixel from the edge of its material
  double scratch_margin_mm = 1;  ///< distance of plain face from designed scratches: the machine's largest error
  int block_px = 6;              ///< plain face: side of the blocks of pixels whose median is taken
  int max_face_per_view = 1500;
};

/// One white and one black sample per tag and view (if the tag is unclipped), and samples of the plain face.
std::vector<LightSample> gather_light_samples(std::span<const LightView> views, const Board& board, const Bench& bench,
                                              const Sent& sent, const LightSampleOptions& options = {});

/// A raster of the board, row 0 at y = 0, `cell_mm` per pixel. It is 1 where only plain metal or scratches can be seen,
/// and 0 on the tags' paper, on keep-outs (and `margin_mm` around both), and beyond the board's edge.
struct BoardMask {
  double cell_mm = 0.25;
  int width = 0, height = 0;
  std::vector<std::uint8_t> free;

  bool is_free(double x_mm, double y_mm) const;
};
BoardMask metal_mask(const Board& board, const Bench& bench, double margin_mm);

}  // namespace burin

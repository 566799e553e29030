// burin/optimize/design/design_views.h - the views of a design during optimization: scenes, targets, pictures,
// exposures.
//
// With a tolerance, each view of the spec has two off-axis viewpoints. Eye and lamp move along the direction of the
// view's scratches, to one side and to the other, by tolerance / sqrt(2) each. Along this direction a scratch turned
// from its best direction gains or loses light. Sideways moves of eye and lamp add up in the half vector. Two
// independent moves of one size move it as much as both together moved sqrt(2) times less. Errors of the three
// positions count a third each.
//
// A view in color is three consecutive WorkViews, one per channel (color_views.h).
#pragma once

#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "burin/base/finding.h"
#include "burin/optimize/design/color_views.h"
#include "burin/optimize/design/glint_lines.h"
#include "burin/optimize/design/stroke_search.h"
#include "burin/optimize/design_file.h"
#include "burin/optimize/design_options.h"
#include "burin/optimize/target.h"
#include "burin/optimize/toolpath/carving_limits.h"
#include "burin/render/view_renderer.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"
#include "burin/scene/carve.h"

namespace burin {

/// Crosstalk of a scratch: another picture of the design in which it shows, and that picture's lamp.
struct WorkGhost {
  std::size_t view = 0, lamp = 0;  ///< index of the WorkView, and of its lamp
};

/// A light for which scratches are made, as one view (or channel) sees it.
struct WorkLamp {
  std::size_t light = 0;  ///< of lights_served()
  GlintView glint;
  Image unit{};       ///< measure_units() of this light's own share; no pixels: all dark
  bool leads = true;  ///< the light is strongest in this channel of its view; off-axis viewpoints never lead
  std::vector<WorkGhost> ghosts{};  ///< find_ghosts()
  bool outshone = false;            ///< another lamp's ghost replaces it in this channel
};

/// Loss of light at crossings of a view's grooves (crossing_loss.h).
struct CrossingLoss {
  Image kept{};      ///< remaining share of light; no pixels: all of it
  double cover = 0;  ///< covered part of a pixel, by a groove that crosses it along one pixel's length
};

struct WorkView {
  DesignView spec;
  std::vector<WorkLamp> lamps;
  Target target;
  double rotation_deg = 0;
  int exposure_group = 0;
  double pitch_mm = 0;            ///< of the pixels
  std::size_t of = 0;             ///< index in the spec of this view, or of the view whose off-axis viewpoint it is
  double share = 1;               ///< of the view's errors
  int channel = 0, channels = 1;  ///< channel, and number of channels of the spec's view
  bool aside = false;
  int exposed_by = 0;  ///< channel whose exposure it uses, if each has its own (White::Kind::each)
  ViewRenderer renderer;
  PictureLoss loss;
  Image radiance{}, picture{};
  LossValue value{};
  double balance = 1;   ///< factor of its errors if views compete for scratches (balance_views)
  Image face{};         ///< radiance of the face without scratches
  double contrast = 0;  ///< ratio of its light over a scratch's directions (DirectionLight); 0: not measured, one lamp
  CrossingLoss crossings{};  ///< empty if grooves are rendered as they are cut
  /// Whether grooves with cut rims are reduced to their glint lines (glint_lines.h).
  bool sees_lines = false;
  Image wanted{};                  ///< the original picture if `target` is lifted (lift_blacks); else no pixels
  Image mixable{};                 ///< the closest mixable target of the view's lights; no pixels: the target itself
  Eigen::Vector3d gains{1, 1, 1};  ///< white_gains(); the light of this scene contains the channel's gain
};

/// The pictures of each of the spec's views, without off-axis viewpoints: one, or three in color.
std::vector<std::span<WorkView>> shown_channels(std::vector<WorkView>& views);

/// The pixels of the carve area for all views of a design: `pixels` along its longer side.
std::shared_ptr<const FootprintGrid> design_grid(const Board& board, const Bench& bench, int pixels);

/// The scene of a view of the spec on these pixels, with eye and lamps moved, under a part of its light.
ViewScene design_scene(const DesignSpec& spec, std::size_t index, const Board& board, const Bench& bench,
                       std::shared_ptr<const FootprintGrid> grid, const Eigen::Vector3d& eye_moved_mm,
                       const Eigen::Vector3d& lamp_moved_mm, const LightPart& part = {});

/// The spec's views in its order, then their off-axis viewpoints, with face and unit light measured. `pixels` count
/// along the carve area's longer side. Throws Error for missing entries of the bench, unusable pictures, and views in
/// which nothing can glint.
std::vector<WorkView> prepare_views(const DesignSpec& spec, const Board& board, const Bench& bench,
                                    const DesignOptions& options, int pixels, const CarvingLimits& limits,
                                    std::vector<Finding>& findings);

/// Views for evaluation only, on other pixels, without off-axis viewpoints. Faces and unit lights are not measured.
/// Throws Error as above.
std::vector<WorkView> views_to_look_at(const DesignSpec& spec, const Board& board, const Bench& bench,
                                       const DesignOptions& options, int pixels, const CarvingLimits& limits);

/// Finds crosstalk in designs with a view in color. A ghost is a picture with more than a hundredth of the light of a
/// scratch in the best direction for a leading light. The search counts a scratch's effect on its two strongest ghosts
/// at most, so it turns the scratch to the side with less harm.
///
/// In another channel of its own view, a scratch shows its own light's share or its crosstalk of another light,
/// whichever is larger. Lamps are never pure, and a little of their own light must not hide much of their neighbors'. A
/// tolerance disables this, because it turns scratches to both sides.
void find_ghosts(std::vector<WorkView>& views, double alpha, const Eigen::Vector2d& middle_mm);

/// Input of the search at these exposures: the face alone, or the last rendered pictures. It has one entry per light
/// served of each view of the spec, for gray views in the spec's order. Without ghosts, each entry has pictures of its
/// own view only.
enum class Ghosts { count, leave_out };
std::vector<StrokeView> stroke_views(const std::vector<WorkView>& views, const std::vector<double>& log_exposure,
                                     bool from_face, Ghosts ghosts = Ghosts::count);

/// Index of the spec's view for each of them.
std::vector<std::size_t> views_served(const std::vector<WorkView>& views);

/// Sets the exposures of groups whose views have a fixed one (DesignView::exposure). The three functions below return
/// these as they are.
void hold_exposures(const std::vector<WorkView>& views, std::vector<double>& log_exposure);

/// The exposure of each group whose pictures, as last rendered, are closest to their targets (mean over the group's
/// views).
std::vector<double> fitting_exposures(const std::vector<WorkView>& views, const std::vector<double>& log_exposure);

/// Logarithms of the exposures, one per group. A scratch of the best direction brings `start_light` of white to a pixel
/// that it crosses along one pixel's length (geometric mean over the group's views).
std::vector<double> starting_exposures(const std::vector<WorkView>& views, std::size_t groups, double start_light);

/// fitting_exposures() for one view's pictures, starting from `guess`.
double fitting_exposure(std::span<const WorkView> channels, double guess);

/// The reference picture of a view's quality.
const Image& asked_for(const WorkView& view);

/// A view as one picture, in gray or in color: as optimized; at these exposures, one per channel, clipped at white; and
/// its target.
Image picture_of(std::span<const WorkView> channels);
Image shown_of(std::span<const WorkView> channels, std::span<const double> exposures);
Image target_of(std::span<const WorkView> channels);

/// The exposures at which a view's channels are closest to the original picture, as last rendered: one for all, or one
/// each (White::Kind::each).
std::vector<double> best_exposures(std::span<const WorkView> channels, const std::vector<double>& log_exposure);

/// best_exposures() as if the view had no fixed exposure.
std::vector<double> free_exposures(std::span<const WorkView> channels, const std::vector<double>& log_exposure);

/// Sets every view's balance for the search: (its weighted squared error, as last rendered, over the views' geometric
/// mean) ^ exponent, at most 8 and at least 1/8. Scratches then go to the place at which the sum of errors ^ (1 +
/// exponent) falls most. 0 serves the mean of all views; much more than 1 serves the worst of them.
void balance_views(std::vector<WorkView>& views, const std::vector<double>& log_exposure, double exponent);

/// Carved grooves of these scratches, prepared for these views.
LyingGrooves grooves_in(const Scratches& designed, const Metal& metal, const std::vector<WorkView>& views);

/// The grooves as a view sees them; only these rows, if `rows` are given.
Carved seen_by(const WorkView& view, const LyingGrooves& grooves);
Carved seen_by(const WorkView& view, const LyingGrooves& grooves, std::span<const std::size_t> rows);

/// Fills every view's radiance.
void render_all(std::vector<WorkView>& views, const LyingGrooves& grooves);

/// Mean light of a gamma-encoded picture, and mean value of an image.
double mean_light(const Image& encoded);
double mean_value(const Image& image);

}  // namespace burin

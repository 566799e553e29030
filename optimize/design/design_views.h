// burin/optimize/design/design_views.h - the views of a design while it is worked on: scenes, targets, pictures,
// exposures.
//
// With a tolerance, each view of the spec is seen from two further places as well: eye and lamp moved along the
// direction in which the view's scratches run, to one side and to the other, tolerance / sqrt(2) each. That is the
// direction in which a scratch turned from its best direction gains or loses light; sideways moves of eye and lamp add
// up in the half vector, and two independent ones of the same size move it by as much as both together moved sqrt(2)
// times less. Errors seen from the three places count a third each.
//
// A view in color is three here, one a channel (color_views.h), in a row.
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

/// What a scratch shows where it is not meant for: a picture of a design, and which of its lights it shows.
struct WorkGhost {
  std::size_t view = 0, lamp = 0;  ///< of the WorkViews, and of its lamps
};

/// A light that scratches are made for, as one view (or channel) sees it.
struct WorkLamp {
  std::size_t light = 0;  ///< of lights_served()
  GlintView glint;
  Image unit{};       ///< measure_units() of that light's own share; no pixels: all dark
  bool leads = true;  ///< of the views that see it the one that it brings most, eye and lamp in their places
  std::vector<WorkGhost> ghosts{};  ///< find_ghosts()
  bool outshone = false;            ///< there, a ghost stands for it
};

/// What crossings take from a view's grooves (crossing_loss.h).
struct CrossingLoss {
  Image kept{};      ///< the share of light that they leave; no pixels: all of it
  double cover = 0;  ///< of a pixel, by a groove that crosses it along one pixel's length
};

struct WorkView {
  DesignView spec;
  std::vector<WorkLamp> lamps;
  Target target;
  double rotation_deg = 0;
  int exposure_group = 0;
  double pitch_mm = 0;            ///< of the pixels
  std::size_t of = 0;             ///< the view of the spec that this is, or that it stands a little aside of
  double share = 1;               ///< of the view's errors
  int channel = 0, channels = 1;  ///< which of how many pictures the view of the spec is
  bool aside = false;
  int exposed_by = 0;  ///< the channel whose brightness it is shown with, where each has its own (White::Kind::each)
  ViewRenderer renderer;
  PictureLoss loss;
  Image radiance{}, picture{};
  LossValue value{};
  double balance = 1;        ///< of its errors where views compete for scratches (balance_views)
  Image face{};              ///< radiance of the face without scratches
  double contrast = 0;       ///< of its light by a scratch's direction (DirectionLight); 0: not measured, one lamp
  CrossingLoss crossings{};  ///< nothing where grooves are rendered as they are cut
  /// Whether grooves that cut each other are seen as the lines along which they glint (glint_lines.h).
  bool sees_lines = false;
  Image wanted{};                  ///< the picture as asked for, where `target` is lifted (lift_blacks); else no pixels
  Image mixable{};                 ///< the target as near as the view's lights can mix its colors; no pixels: as it is
  Eigen::Vector3d gains{1, 1, 1};  ///< white_gains(); the channel's stands in the light of its scene
};

/// The pictures of each of the spec's views, eye and lamp in their places: one, or three in color.
std::vector<std::span<WorkView>> shown_channels(std::vector<WorkView>& views);

/// The pixels of the carve area that all views of a design look at: `pixels` along its longer side.
std::shared_ptr<const FootprintGrid> design_grid(const Board& board, const Bench& bench, int pixels);

/// The scene of a view of the spec on those pixels, its eye and lamps moved, under a part of its light.
ViewScene design_scene(const DesignSpec& spec, std::size_t index, const Board& board, const Bench& bench,
                       std::shared_ptr<const FootprintGrid> grid, const Eigen::Vector3d& eye_moved_mm,
                       const Eigen::Vector3d& lamp_moved_mm, const LightPart& part = {});

/// The spec's views in its order, then those that stand aside, with face and unit measured. Throws Error for what the
/// bench does not have, pictures that cannot be used and views in which nothing can glint. On `pixels` along the carve
/// area's longer side.
std::vector<WorkView> prepare_views(const DesignSpec& spec, const Board& board, const Bench& bench,
                                    const DesignOptions& options, int pixels, const CarvingLimits& limits,
                                    std::vector<Finding>& findings);

/// The same views to be looked at alone, on other pixels, eyes and lamps in their places. Faces and units are not
/// measured. Throws Error as above.
std::vector<WorkView> views_to_look_at(const DesignSpec& spec, const Board& board, const Bench& bench,
                                       const DesignOptions& options, int pixels, const CarvingLimits& limits);

/// In designs with a view in color: where else a scratch for a light that leads shows, one of the best direction more
/// than a hundredth of the light there, the most two. What it does there counts in the search, so that of its two sides
/// it turns to the one where it harms less. In another channel of its own view it shows its own light's share or, where
/// that is more, what it throws of another light: lamps are never quite pure, and a little of their own light must not
/// hide much of their neighbors'. Not with a tolerance, where scratches are turned to both sides.
void find_ghosts(std::vector<WorkView>& views, double alpha, const Eigen::Vector2d& middle_mm);

/// What the search sees at these exposures: the face alone, or all that was rendered last. One for each light served of
/// each view of the spec, in gray in the spec's order. Without ghosts each has pictures of its own view alone.
enum class Ghosts { count, leave_out };
std::vector<StrokeView> stroke_views(const std::vector<WorkView>& views, const std::vector<double>& log_exposure,
                                     bool from_face, Ghosts ghosts = Ghosts::count);

/// The view of the spec that each of them is.
std::vector<std::size_t> views_served(const std::vector<WorkView>& views);

/// The one brightness a group with which its views, as rendered last, come closest to their targets (their mean).
std::vector<double> fitting_exposures(const std::vector<WorkView>& views, const std::vector<double>& log_exposure);

/// Logarithms of the exposures, a group, with which a scratch of the best direction brings `start_light` of white to a
/// pixel that it crosses along one pixel's length (geometric mean over the group's views).
std::vector<double> starting_exposures(const std::vector<WorkView>& views, std::size_t groups, double start_light);

/// As fitting_exposures() for one view's pictures, starting from `guess`.
double fitting_exposure(std::span<const WorkView> channels, double guess);

/// The picture by which a view is judged.
const Image& asked_for(const WorkView& view);

/// What a view shows, and is to show, as one picture, in gray or in color: as optimized; at these exposures, one a
/// channel, clipped at white; its target.
Image picture_of(std::span<const WorkView> channels);
Image shown_of(std::span<const WorkView> channels, std::span<const double> exposures);
Image target_of(std::span<const WorkView> channels);

/// The exposures of a view's channels with which they come closest to what was asked for, as rendered last: one for
/// all, or one each (White::Kind::each).
std::vector<double> best_exposures(std::span<const WorkView> channels, const std::vector<double>& log_exposure);

/// Sets every view's balance for the search: (its weighted squared error, as rendered last, over the views' geometric
/// mean) ^ exponent, at most 8 and at least 1/8. So scratches go where the sum of errors ^ (1 + exponent) falls most:
/// 0 serves the mean of all views, much more than 1 the worst of them.
void balance_views(std::vector<WorkView>& views, const std::vector<double>& log_exposure, double exponent);

/// Scratches as they will lie in the metal, for these views to look at.
LyingGrooves grooves_in(const Scratches& designed, const Metal& metal, const std::vector<WorkView>& views);

/// What of the grooves a view sees; of these rows alone, where `rows` are given.
Carved seen_by(const WorkView& view, const LyingGrooves& grooves);
Carved seen_by(const WorkView& view, const LyingGrooves& grooves, std::span<const std::size_t> rows);

/// Fills every view's radiance.
void render_all(std::vector<WorkView>& views, const LyingGrooves& grooves);

/// Means of a gamma-encoded picture's light, and of an image.
double mean_light(const Image& encoded);
double mean_value(const Image& image);

}  // namespace burin

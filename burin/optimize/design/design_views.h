// burin/optimize/design/design_views.h - the views of a design while it is worked on: scenes, targets, pictures,
// exposures.
//
// With a tolerance, each view of the spec is seen from two further places as well: eye and lamp moved along the
// direction in which the view's scratches run, to one side and to the other, tolerance / sqrt(2) each. That is the
// direction in which a scratch turned from its best direction gains or loses light; sideways moves of eye and lamp add
// up in the half vector, and two independent ones of the same size move it by as much as both together moved sqrt(2)
// times less. Errors seen from the three places count a third each.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "burin/optimize/carving/carving_limits.h"
#include "burin/optimize/design/stroke_search.h"
#include "burin/optimize/design_file.h"
#include "burin/optimize/design_options.h"
#include "burin/optimize/target.h"
#include "burin/render/bench.h"
#include "burin/render/board.h"
#include "burin/render/carve.h"
#include "burin/render/finding.h"
#include "burin/render/view_renderer.h"

namespace burin {

struct WorkView {
  DesignView spec;
  GlintView glint;
  Target target;
  double rotation_deg = 0;
  int exposure_group = 0;
  double pitch_mm = 0;  ///< of the pixels
  std::size_t of = 0;   ///< the view of the spec that this is, or that it stands a little aside of
  double share = 1;     ///< of the view's errors
  ViewRenderer renderer;
  PictureLoss loss;
  Image radiance{}, picture{}, dE_dpicture{}, dE_dradiance{};
  LossValue value{};
  double balance = 1;  ///< of its errors where views compete for scratches (balance_views)
  Image face{};        ///< radiance of the face without scratches
  Image unit{};        ///< measure_units()
};

/// The pixels of the carve area that all views of a design look at: `pixels` along its longer side.
std::shared_ptr<const FootprintGrid> design_grid(const Board& board, const Bench& bench, int pixels);

/// The scene of a view of the spec on those pixels, its eye and lamp moved.
ViewScene design_scene(const DesignSpec& spec, std::size_t index, const Board& board, const Bench& bench,
                       std::shared_ptr<const FootprintGrid> grid, const Eigen::Vector3d& eye_moved_mm,
                       const Eigen::Vector3d& lamp_moved_mm);

/// The spec's views in its order, then those that stand aside, with face and unit measured. Throws Error for what the
/// bench does not have, pictures that cannot be used and views in which nothing can glint.
std::vector<WorkView> prepare_views(const DesignSpec& spec, const Board& board, const Bench& bench,
                                    const DesignOptions& options, const CarvingLimits& limits,
                                    std::vector<Finding>& findings);

/// What the search sees at these exposures: the face alone, or all that was rendered last.
std::vector<StrokeView> stroke_views(const std::vector<WorkView>& views, const std::vector<double>& log_exposure,
                                     bool from_face);

/// The one brightness a group with which its views, as rendered last, come closest to their targets (their mean).
std::vector<double> fitting_exposures(const std::vector<WorkView>& views, const std::vector<double>& log_exposure);

/// Logarithms of the exposures, a group, with which a scratch of the best direction brings `start_light` of white to a
/// pixel that it crosses along one pixel's length (geometric mean over the group's views).
std::vector<double> starting_exposures(const std::vector<WorkView>& views, std::size_t groups, double start_light);

/// Sets every view's balance for the search: (its weighted squared error, as rendered last, over the views' geometric
/// mean) ^ exponent, at most 8 and at least 1/8. So scratches go where the sum of errors ^ (1 + exponent) falls most:
/// 0 serves the mean of all views, much more than 1 the worst of them.
void balance_views(std::vector<WorkView>& views, const std::vector<double>& log_exposure, double exponent);

/// Fills every view's radiance.
void render_all(std::vector<WorkView>& views, const Carved& carved);

/// Means of a gamma-encoded picture's light, and of an image.
double mean_light(const Image& encoded);
double mean_value(const Image& image);

}  // namespace burin

// burin/calib/photo/photo_problem.h - sets up all photos of a session as one least-squares problem, in one way for all
// callers. Frame: board, mm. photo_equations.h and paper_equation.h define the residuals. photo_weights.h weighs them,
// and photo_fit.h minimizes.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "burin/calib/geometry/geometry_prior.h"
#include "burin/calib/light/light_samples.h"
#include "burin/calib/photo/photo_equations.h"
#include "burin/calib/photo/unknowns.h"

namespace burin {

/// All unknowns: the shared ones of all photos, the paper's brightness, and a set for each lamp.
struct State {
  std::array<double, kSharedUnknowns> shared{};
  double log_paper[1] = {0};
  std::vector<std::array<double, kLampUnknowns>> lamps;

  /// The unknown whose first index is `first`; `light` matters only for a lamp's.
  double* block(int first, std::size_t light = 0) {
    return first < kSharedUnknowns ? shared.data() + first
           : first < kFitUnknowns  ? lamps[light].data() + (first - kSharedUnknowns)
                                   : log_paper;
  }
  const double* block(int first, std::size_t light = 0) const { return const_cast<State*>(this)->block(first, light); }
  /// Unknowns of a photo under one lamp; cameras, bow and lens, which do not move with the rest, are 0.
  Unknowns of(std::size_t light) const {
    Unknowns x = Unknowns::Zero();
    for (int i = 0; i < kSharedUnknowns; ++i) x[i] = shared[i];
    for (int i = 0; i < kLampUnknowns; ++i) x[kSharedUnknowns + i] = lamps[light][i];
    return x;
  }
};

/// The state moved by a step of all unknowns, in the order of global_index().
State moved_state(const State& state, const Eigen::VectorXd& step);
/// The step from one state to the other, as moved_state() takes it.
Eigen::VectorXd step_between(const State& from, const State& to);

/// The photos at one resolution, with their weights.
struct Problem {
  ModelData model;
  std::vector<PhotoData> photos;
  std::vector<LightSample> paper;
  PaperCoat coat;  ///< of that paper: held
  std::vector<double> photo_model_error;
  /// Scatter of pixels along their derivatives by log alpha and log depth, from any cause: standard deviations.
  Eigen::Vector2d slope_error{0, 0};
  std::vector<bool> is_spot;
  /// A lamp's axis and falloff are held: a large lamp's whose axis paper did not determine. Its sigma then covers the
  /// alternatives (RefineRun::find_large_lamps).
  std::vector<bool> spot_held;
  std::vector<LampSize> given_size;  ///< of lamps whose area a person gave: it is held
  bool has_stray = false;            ///< an unmodeled light is among the unknowns (stray_light.h)
  std::array<bool, 2> both_ways{};   ///< grooves go both ways along x and y
  std::array<bool, 2> uneven{};      ///< lead-screw errors of x and y are sought
  std::vector<bool> size_sought;     ///< a lamp's size is sought; else its area is the bench's
  int merged_bin = 1;                ///< side of a merged photo's pixel in the camera's pixels
  /// The bench's surroundings, in addition to every photo's lamp; unknown::ambient is their scale. Empty: ambient light
  /// is uniform.
  std::optional<std::size_t> surroundings;
  std::optional<GeometryPrior> geometry;  ///< none: poses and bow are exact
};

/// Sets up every problem (refine, held-out photos, plans, the next photo) from board, sent scratches and bench, without
/// photos. `board` and `sent` must outlive it.
Problem make_problem(const Board& board, const Sent& sent, const Bench& bench);

/// True if a lamp, or the bench, has this unknown: a bare lamp has no axis.
bool has_unknown(const Problem& problem, const UnknownRow& row, std::size_t light);

/// True if a lamp's size is among the unknowns.
bool seeks_size(const Problem& problem, std::size_t light);

/// Flags of the moving unknowns of `stage`, in the order of global_index(); the paper's always moves.
std::vector<bool> free_unknowns(const Problem& problem, const Stage& stage, std::size_t lights);

/// Bounds of one number of an unknown, in the fit's units; false if it has none. For the blur's logarithm see
/// log_blur_range().
bool bounds_of(const Problem& problem, const UnknownRow& row, double& low, double& high);

/// Range of the blur's logarithm. Corrections for binning follow the blur by their derivative at one state, which holds
/// for a third more or less. Beyond this range they would predict impossible photos, and the blur would diverge. It did
/// on sharp photos, whose derivative is nearly 0, until the blur exceeded every pixel's distance from a tag.
std::pair<double, double> log_blur_range(const Problem& problem);

/// Moves unknowns beyond their bounds onto them: a Gauss-Newton step has no bounds.
void keep_within_bounds(const Problem& problem, State& state);

/// Binning of the session's merged pixels at each step of a fit: side of a binned pixel.
struct Bins {
  int coarse = 1, middle = 1, finest = 1;
};
/// `finest_pixel_mm`: least size of a pixel on the board. `max_pixels`: limit for all photos together.
Bins bins_for(const std::vector<LightView>& views, const Bench& bench, double finest_pixel_mm, std::size_t max_pixels);

/// Corrects all photos (from photos_at() of `views`) for their binning, at `state`, by predictions of at most
/// `max_pixels` each: see photo_equations.h. The default fits in memory, at some 100 bytes per pixel.
void correct_binning(Problem& data, const std::vector<LightView>& views, const Board& board, const Bench& bench,
                     const State& state, std::size_t max_pixels = 4'000'000);

/// Computes the board's reflection of surroundings at `state` (photo_equations.h).
void light_around(const State& state, Problem& data);

/// Number of photos processed at the same time, each by all free cores. A photo needs considerable memory meanwhile, a
/// gigabyte and more if grooves are cut into many pieces.
int photos_at_once(const ModelData& model);

/// Calls body(k) for the photos 0 .. count - 1, `at_once` of them at a time; for all photos of a problem.
void each_photo(std::size_t count, int at_once, const std::function<void(std::size_t)>& body);
void each_photo(const Problem& data, const std::function<void(std::size_t)>& body);

/// Cost of every `stride`-th photo.
double cost_of(const Problem& data, const State& state, std::size_t stride);
/// Cost of each photo.
std::vector<double> costs_of_photos(const Problem& data, const State& state);

/// The binned photos, with weights from noise alone. Pixels near tags and edges, within the blur's reach, are left out.
std::vector<PhotoData> photos_at(const std::vector<LightView>& views, int bin, const Board& board, const Bench& bench,
                                 double blur_px);

/// Restricts the problem to a sample of the board if cut grooves make more than about `most_pieces` pieces in the
/// photos: pixels elsewhere do not count. Returns true if it did. Call it again for rebuilt photos.
bool look_at_sample(double most_pieces, const State& state, Problem& data);

/// Pieces in trials of crossing rules and of groove profiles: a hundred renderings of a few times as many take minutes.
inline constexpr double kMostTried = 20'000;

/// The part of `stage` for a small sample. If grooves cover all of it, it shows no plain face, and lamp and machine
/// less well than the whole.
Stage stage_of_sample(Stage stage);

/// Size of a photo's pixel on the board, mm, at the distance of its origin.
double pixel_mm(const LightView& view, const Bench& bench);

}  // namespace burin

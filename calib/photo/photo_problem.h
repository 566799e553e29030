// burin/calib/photo/photo_problem.h - all photos of a session as one least-squares problem: its data, set up in one way
// for all who use it. Frame: board, mm. The residuals are photo_equations.h's and paper_equation.h's; photo_weights.h
// weighs them, photo_fit.h minimizes.
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

/// Everything that moves: what all photos share, the paper's brightness, and a set for each lamp.
struct State {
  std::array<double, kSharedUnknowns> shared{};
  double log_paper[1] = {0};
  std::vector<std::array<double, kLampUnknowns>> lamps;

  /// Where the unknown whose first number is `first` lies; `light` matters for a lamp's only.
  double* block(int first, std::size_t light = 0) {
    return first < kSharedUnknowns ? shared.data() + first
           : first < kFitUnknowns  ? lamps[light].data() + (first - kSharedUnknowns)
                                   : log_paper;
  }
  const double* block(int first, std::size_t light = 0) const { return const_cast<State*>(this)->block(first, light); }
  /// Those of a photo under one lamp; cameras, bow and lens, which do not move with the rest, are 0.
  Unknowns of(std::size_t light) const {
    Unknowns x = Unknowns::Zero();
    for (int i = 0; i < kSharedUnknowns; ++i) x[i] = shared[i];
    for (int i = 0; i < kLampUnknowns; ++i) x[kSharedUnknowns + i] = lamps[light][i];
    return x;
  }
};

/// The state moved by a step of all unknowns, in the order of global_index().
State moved_state(const State& state, const Eigen::VectorXd& step);
/// The step that moved_state() would come from one to the other by.
Eigen::VectorXd step_between(const State& from, const State& to);

/// The photos at one resolution, with their weights.
struct Problem {
  ModelData model;
  std::vector<PhotoData> photos;
  std::vector<LightSample> paper;
  PaperCoat coat;  ///< of that paper: held
  std::vector<double> photo_model_error;
  /// What pixels scatter along their slopes by log alpha and log depth, from whatever cause: standard deviations.
  Eigen::Vector2d slope_error{0, 0};
  std::vector<bool> is_spot;
  /// Whether a lamp's axis and fall-off are held where they are: a large lamp's that paper did not tell. Its sigma is
  /// then what else they might be (RefineRun::find_large_lamps).
  std::vector<bool> spot_held;
  std::vector<LampSize> given_size;  ///< of lamps whose area a person told: it is held
  bool has_stray = false;            ///< whether a light that nobody named is among the unknowns (stray_light.h)
  std::array<bool, 2> both_ways{};   ///< whether grooves go both ways along x and y
  std::array<bool, 2> uneven{};      ///< whether the screws of x and y are sought to be uneven
  std::vector<bool> size_sought;     ///< whether a lamp's size is sought; else its area is held as the bench has it
  int merged_bin = 1;  ///< of the merged photos: how many of the camera's pixels, either way, are one of theirs
  /// The bench's surroundings that shine beside every photo's lamp: unknown::ambient is their scale. None: it is even
  /// light.
  std::optional<std::size_t> surroundings;
  std::optional<GeometryPrior> geometry;  ///< none: poses and bow are exact
};

/// The one set-up of every problem (refine, held-out photos, plans, the next photo): what board, sent scratches and
/// bench say, without a photo yet. `board` and `sent` must outlive it.
Problem make_problem(const Board& board, const Sent& sent, const Bench& bench);

/// Whether a lamp, or the bench, has this unknown: a bare one has no axis.
bool has_unknown(const Problem& problem, const UnknownRow& row, std::size_t light);

/// Whether a lamp's size is among the unknowns.
bool seeks_size(const Problem& problem, std::size_t light);

/// Which unknowns move while `stage` runs, in the order of global_index(); the paper's always does.
std::vector<bool> free_unknowns(const Problem& problem, const Stage& stage, std::size_t lights);

/// Bounds of one number of an unknown as the fit's numbers; false where there are none. Those of the blur's logarithm
/// are log_blur_range().
bool bounds_of(const Problem& problem, const UnknownRow& row, double& low, double& high);

/// Where the logarithm of the blur may lie. Corrections for binning follow it by its slope where they were taken, which
/// holds for a third more or less: beyond that it promises photos that no blur makes, and the blur runs away. It did on
/// sharp photos, whose slope is nearly none: until no pixel was further from a tag than the blur reached.
std::pair<double, double> log_blur_range(const Problem& problem);

/// Puts what lies beyond its bounds onto them: a step of Gauss and Newton knows none.
void keep_within_bounds(const Problem& problem, State& state);

/// How many of the session's merged pixels, either way, are binned into one at each step of a fit.
struct Bins {
  int coarse = 1, middle = 1, finest = 1;
};
/// `finest_pixel_mm`: pixels are at least this large on the board; `max_pixels`: and so large that all photos together
/// have no more than these.
Bins bins_for(const std::vector<LightView>& views, const Bench& bench, double finest_pixel_mm, std::size_t max_pixels);

/// Corrects all photos (which photos_at() made of `views`) for their binning, at `state`, by predictions of no more
/// than `max_pixels` of each: see photo_equations.h. By default as many as memory holds, some 100 bytes each.
void correct_binning(Problem& data, const std::vector<LightView>& views, const Board& board, const Bench& bench,
                     const State& state, std::size_t max_pixels = 4'000'000);

/// Takes what the board sends back of surroundings anew, at `state` (photo_equations.h).
void light_around(const State& state, Problem& data);

/// How many photos are worked on at the same time, each by all cores that are free: what a photo needs meanwhile is not
/// small, and where grooves are cut into many pieces it is a gigabyte and more.
int photos_at_once(const ModelData& model);

/// body(k) for the photos 0 .. count - 1, `at_once` of them at a time; for all photos of a problem.
void each_photo(std::size_t count, int at_once, const std::function<void(std::size_t)>& body);
void each_photo(const Problem& data, const std::function<void(std::size_t)>& body);

/// Cost of every `stride`-th photo.
double cost_of(const Problem& data, const State& state, std::size_t stride);
/// Each photo's.
std::vector<double> costs_of_photos(const Problem& data, const State& state);

/// The photos binned, their weights from noise alone. Pixels near tags and edges, within the blur's reach, are left
/// out.
std::vector<PhotoData> photos_at(const std::vector<LightView>& views, int bin, const Board& board, const Bench& bench,
                                 double blur_px);

/// Where grooves that are cut where they cross make more than about `most_pieces` of what photos show, only a sample of
/// the board is looked at from now on: pixels elsewhere do not count. Whether that is so. Said anew of photos that are
/// made anew.
bool look_at_sample(double most_pieces, const State& state, Problem& data);

/// Pieces that trials look at, of rules for crossings and of cross-sections: a hundred renderings of a few times as
/// many take minutes.
inline constexpr double kMostTried = 20'000;

/// What of `stage` a small sample is asked for. Where grooves cover all of it, it does not show the plain face, nor the
/// lamp and the machine as the whole does.
Stage stage_of_sample(Stage stage);

/// Size of a photo's pixel on the board, mm, at the distance of its origin.
double pixel_mm(const LightView& view, const Bench& bench);

}  // namespace burin

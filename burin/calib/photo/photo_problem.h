// burin/calib/photo/photo_problem.h - all photos of a session as one least-squares problem. What refine.h solves, stage
// by stage. Frame: board, mm. The residuals are photo_equations.h's and paper's (lamp.h).
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "burin/calib/geometry/geometry_prior.h"
#include "burin/calib/light/lamp.h"
#include "burin/calib/light/light_samples.h"
#include "burin/calib/photo/photo_equations.h"
#include "burin/render/progress.h"

namespace burin {

/// The parameter blocks of one photo's cost, in the order of `unknown`.
struct Block {
  int first, size;
};
constexpr std::array<Block, 15> kBlocks = {{{unknown::log_alpha, 1},
                                            {unknown::log_depth, 1},
                                            {unknown::log_base_alpha, 1},
                                            {unknown::depth_field, 2},
                                            {unknown::depth_field + 2, 3},
                                            {unknown::depth_field + 5, 1},
                                            {unknown::machine, 6},
                                            {unknown::ambient, 1},
                                            {unknown::vignette, 3},
                                            {unknown::log_blur, 1},
                                            {unknown::lamp_position, 3},
                                            {unknown::log_intensity, 1},
                                            {unknown::spot, 3},
                                            {unknown::pose, 6},
                                            {unknown::bow, 3}}};
constexpr int kFirstLampUnknown = unknown::lamp_position;
constexpr int kSharedUnknowns = kFirstLampUnknown;  // those before the lamp's
constexpr int kLampUnknowns = unknown::pose - unknown::lamp_position;

/// Everything that moves: shared unknowns, the paper's brightness, and a set for each lamp.
struct State {
  std::array<double, kSharedUnknowns> shared{};
  double log_paper[1] = {0};
  std::vector<std::array<double, kLampUnknowns>> lamps;

  double* block(int first, std::size_t light) {
    return first < kFirstLampUnknown ? shared.data() + first : lamps[light].data() + (first - kFirstLampUnknown);
  }
  Unknowns of(std::size_t light) const {
    Unknowns x = Unknowns::Zero();
    for (int i = 0; i < kSharedUnknowns; ++i) x[i] = shared[i];
    for (int i = 0; i < kLampUnknowns; ++i) x[kFirstLampUnknown + i] = lamps[light][i];
    return x;
  }
};

/// What a bench says of all of them. A lamp's aim is where its axis meets the board's plane.
State state_of(const Bench& bench, const ModelData& model);

/// The state moved by a step of all unknowns, in the order of global_index().
State moved_state(const State& state, const Eigen::VectorXd& step);

/// Groups of unknowns that a stage frees.
struct FreeField {
  bool linear = false, quadratic = false, wear = false;
};
struct Stage {
  FreeField depth_field;
  bool groove = true, base = true, machine = true, ambient = true, vignette = true, blur = false, lamp = true,
       intensity = true;
};

/// Whether a stage frees the block of unknowns that starts at `first`; the spot is free with the lamp, where it is one.
bool frees(const Stage& stage, int first);

/// Paper: its mean brightness a tag and photo, with the albedo that board.json gives up to one common factor.
struct PaperResidual {
  const LightSample* sample;
  double albedo, weight;

  template <typename T>
  bool operator()(const T* ambient, const T* vignette, const T* position, const T* log_intensity, const T* spot,
                  const T* log_paper, T* residual) const {
    using std::exp;
    LampModel<T> lamp;
    lamp.position_mm = Eigen::Matrix<T, 3, 1>(position[0], position[1], position[2]);
    lamp.log_intensity = log_intensity[0];
    lamp.aim_mm = Eigen::Matrix<T, 2, 1>(spot[0], spot[1]);
    lamp.exponent = spot[2];
    const T radiance = exp(log_paper[0]) * paper_radiance(lamp, ambient[0], albedo, *sample);
    residual[0] = weight * (vignette_at(vignette, sample->radius2) * radiance - sample->value);
    return true;
  }
};

inline constexpr double kPaperError = 0.005;       // relative: unevenness of paper beyond noise
inline constexpr double kPaperFactorSigma = 0.02;  // how well albedos in board.json are known, as a common factor
inline constexpr double kPaperLoss = 3;            // Cauchy scale, in expected errors

/// The photos at one resolution, with their weights.
struct Problem {
  ModelData model;
  std::vector<PhotoData> photos;
  std::vector<LightSample> paper;
  std::vector<double> photo_model_error;
  /// What pixels scatter along their slopes by log alpha and log depth, from whatever cause: standard deviations.
  Eigen::Vector2d slope_error{0, 0};
  std::vector<bool> is_spot;
  std::optional<GeometryPrior> geometry;  ///< none: poses and bow are exact
};

PaperResidual paper_residual(const Problem& problem, const LightSample& sample);

/// Where the logarithm of the blur may lie. Corrections for binning follow it by its slope where they were taken, which
/// holds for a third more or less: beyond that it promises photos that no blur makes, and the blur runs away. It did on
/// sharp photos, whose slope is nearly none: until no pixel was further from a tag than the blur reached.
std::pair<double, double> log_blur_range(const Problem& problem);

/// Minimises over what `stage` frees, until the cost falls by less than `tolerance` (relative). Returns the cost;
/// `state` moves.
double solve(const Problem& data, const Stage& stage, int max_iterations, double tolerance, State& state,
             const Progress& progress, const std::string& stage_name);

/// Weighs each photo by its noise and by what its residuals say the model misses: the relative error m for which the
/// median of |residual| / sqrt(noise^2 + (m prediction)^2) is that of a normal distribution. A photo that the model
/// cannot explain (moved, out of focus) so weighs little by itself.
void weigh_photos(Problem& data, const State& state);

/// The same with grooves that differ: how residuals' squares follow the squares of the prediction's slopes by log alpha
/// and log depth (`slope_error`) counts in a pixel's expected error: where half vectors lean towards the cut-off, a
/// groove a hundredth deeper than the others is many times the noise away from them. A residual counts up to 1.5
/// expected errors. What of it is the grooves' own (model.alpha_jitter, depth_jitter) is found by groove_scatter().
void weigh_photos_and_grooves(Problem& data, const State& state);

/// Corrects all photos (which photos_at() made of `views`) for their binning, at `state`: see photo_equations.h.
void correct_binning(Problem& data, const std::vector<LightView>& views, const Board& board, const Bench& bench,
                     const State& state);

/// body(k) for the photos 0 .. count - 1, as many at a time as there are cores and no more: what a photo needs while it
/// is worked on is not small.
void each_photo(std::size_t count, const std::function<void(std::size_t)>& body);

/// Cost of every `stride`-th photo.
double cost_of(const Problem& data, const State& state, std::size_t stride);

/// The photos binned, their weights from noise alone. Pixels near tags and edges, within the blur's reach, are left
/// out.
std::vector<PhotoData> photos_at(const std::vector<LightView>& views, int bin, const Board& board, const Bench& bench,
                                 double blur_px);

/// Size of a photo's pixel on the board, mm, at the distance of its origin.
double pixel_mm(const LightView& view, const Bench& bench);

double median_of(std::vector<double>& values);  ///< reorders; 0 for none

/// Indices of all unknowns of a problem in one vector: shared, paper, lamps.
inline int global_index(int index, std::size_t light) {
  return index < kFirstLampUnknown
             ? index
             : kSharedUnknowns + 1 + static_cast<int>(light) * kLampUnknowns + (index - kFirstLampUnknown);
}

}  // namespace burin

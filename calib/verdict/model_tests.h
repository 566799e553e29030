// burin/calib/verdict/model_tests.h - tests of the model: residuals and estimates by classes of pixels that an
// unmodeled effect would separate. Frame: board, mm. docs/calibration.md, 'Where the model is not enough'.
//
// Each of several quantities (kPixelQuantities) sorts pixels into six bins; two neighboring bins form a class. H_c and
// g_c are the normal equations of a class' pixels at the optimum x, with cameras, bow and lens fixed. A fit that gives
// the class full weight, and the others a tenth, would end, to first order, at
//
//   x_c = x - (P + H_c + H_others / 10)^-1 (g_P + g_c + g_others / 10)
//
// (P: priors and paper). Under a correct model the classes' estimates differ by chance alone. The expected difference
// follows from the scatter of scores over 20 mm squares of the board, within which neighbors may be correlated. The
// squares count as assigned to the classes at random. Halves of the photos cannot reveal such an effect, because both
// halves contain the common effects of all photos.
//
// No model is exact, and enough pixels refute every model. In an amateur's setup with a valid model, dust and
// fingerprints separate classes by 8 to 10 sigmas. Its estimates are nevertheless right to 0.1 %, and the classes'
// halves differ by 0.6 %. A misfit is therefore a difference beyond chance that is also large enough to matter.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "burin/calib/photo/photo_problem.h"
#include "burin/scene/misfit.h"

namespace burin {

inline constexpr int kPixelQuantities = 6, kQuantityBins = 6, kBinsInClass = 2;
inline constexpr int kQuantityClasses = kQuantityBins / kBinsInClass;

/// Boundaries between bins, by quantity in the order of the tests' names (pixel_quantity_names).
using BinEdges = std::array<std::array<double, kQuantityBins - 1>, kPixelQuantities>;

/// Names of the tests, as in Misfit::test.
const std::array<const char*, kPixelQuantities>& pixel_quantity_names();

/// Edges for equally filled bins over all photos' pixels, each weighted by its brightness over its expected error;
/// fixed edges for directions.
BinEdges bin_edges(const Problem& data, const State& state);

/// Contribution of one photo to each class and bin.
struct ClassSums {
  struct OfClass {
    Eigen::MatrixXd
        information;  ///< over all unknowns except cameras, bow and lens (kFitUnknowns), with the loss' curvature
    Eigen::VectorXd gradient;
    Eigen::MatrixXd tile_scores;  ///< one column per square of the board
  };
  struct OfBin {
    Eigen::VectorXd by_tile, norm_by_tile;  ///< sums of weighted residual x prediction, and of prediction squared
  };
  std::array<std::array<OfClass, kQuantityClasses>, kPixelQuantities> classes;
  std::array<std::array<OfBin, kQuantityBins>, kPixelQuantities> bins;
};

/// Sums of photo k, with `slopes` computed at `state`. They use every other pixel, as on a chessboard.
ClassSums class_sums(const Problem& data, std::size_t k, const State& state, const PhotoSlopes& slopes,
                     const BinEdges& edges);

/// Smallest misfit of alpha, depth or base_alpha: half of the difference between two classes, as a logarithm.
inline constexpr double kLeastShift = 0.01;

/// A detected misfit and the possible error of the estimates: half of the difference between the most different
/// classes, beyond chance, over all unknowns (global_index()).
struct ModelTest {
  Misfit misfit;
  Eigen::VectorXd shift;
};

/// Combines all photos. `free` marks the fitted unknowns.
std::vector<ModelTest> test_model(const Problem& data, const State& state, const std::vector<bool>& free,
                                  const std::vector<ClassSums>& photos);

/// Sets a misfit's percents of alpha, depth and base_alpha from a shift over all unknowns.
void set_percents(const Eigen::VectorXd& shift, Misfit& misfit);

}  // namespace burin

// burin/calib/verdict/model_tests.h - whether the model is enough: residuals and answers by classes of pixels that an
// effect nobody modeled would set apart. Frame: board, mm. docs/calibration.md, 'Where the model is not enough'.
//
// Pixels are put into six bins by each of some quantities (kPixelQuantities), two neighboring bins being a class. With
// H_c, g_c the normal equations of a class' pixels at the optimum x (cameras, bow and lens held), a fit that believes
// the class, and the others only a tenth, would end, to first order, at
//
//   x_c = x - (P + H_c + H_others / 10)^-1 (g_P + g_c + g_others / 10)
//
// (P: priors and paper). Under a right model the classes' answers differ by chance alone; how much that is follows from
// the scatter of scores over 20 mm squares of the board, in which neighbors may be alike: as if the squares, whole, had
// been dealt out to the classes at random. Halves of the photos cannot show it: what all photos share is in both.
//
// No model is exact, and with enough pixels every one is refuted: dust and fingerprints of an amateur's bench whose
// model holds set classes apart by 8 to 10 sigmas, though its answers are right to a tenth of a per cent and the
// classes' halves differ by 0.6 %. So a misfit is what differs by more than chance and by enough to matter.
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

/// Between bins, by quantity in the order of the tests' names (pixel_quantity_names).
using BinEdges = std::array<std::array<double, kQuantityBins - 1>, kPixelQuantities>;

/// Names of the tests, as in Misfit::test.
const std::array<const char*, kPixelQuantities>& pixel_quantity_names();

/// Edges such that all photos' pixels, each counting by its brightness over its expected error, fill bins alike;
/// fixed ones for directions.
BinEdges bin_edges(const Problem& data, const State& state);

/// What one photo adds to each class and bin.
struct ClassSums {
  struct OfClass {
    Eigen::MatrixXd
        information;  ///< over all unknowns but cameras, bow and lens (kFitUnknowns), with the loss' curvature
    Eigen::VectorXd gradient;
    Eigen::MatrixXd tile_scores;  ///< a column a square of the board
  };
  struct OfBin {
    Eigen::VectorXd by_tile, norm_by_tile;  ///< sums of weighted residual x prediction, and of prediction squared
  };
  std::array<std::array<OfClass, kQuantityClasses>, kPixelQuantities> classes;
  std::array<std::array<OfBin, kQuantityBins>, kPixelQuantities> bins;
};

/// Of photo k, whose `slopes` were taken at `state`. Every other pixel, as on a chessboard.
ClassSums class_sums(const Problem& data, std::size_t k, const State& state, const PhotoSlopes& slopes,
                     const BinEdges& edges);

/// Less than this of alpha, depth or base_alpha, between two classes, halved, is no misfit: logarithm.
inline constexpr double kLeastShift = 0.01;

/// A misfit that the tests found, and by how far the answer may be off for it: half of what lies between the classes
/// that differ most, beyond chance, over all unknowns (global_index()).
struct ModelTest {
  Misfit misfit;
  Eigen::VectorXd shift;
};

/// Puts all photos together. `free`: which unknowns were fitted.
std::vector<ModelTest> test_model(const Problem& data, const State& state, const std::vector<bool>& free,
                                  const std::vector<ClassSums>& photos);

/// A misfit's percents of alpha, depth and base_alpha, of a shift over all unknowns.
void set_percents(const Eigen::VectorXd& shift, Misfit& misfit);

}  // namespace burin

// burin/calib/photo/model_data.h - what all photos of a fit share, and the grooves in the metal that unknowns make of
// it. Frame: board, mm.
#pragma once

#include <Eigen/Core>
#include <array>

#include "burin/calib/photo/board_sample.h"
#include "burin/calib/photo/unknowns.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"
#include "burin/scene/carve.h"
#include "burin/scene/groove_field.h"

namespace burin {

/// Lanes across a groove: light that pixels get of it is good to a hundredth of what it sends there, and to less where
/// the camera blurs.
inline constexpr int kLanes = 16;

/// What all photos share.
struct ModelData {
  const Board* board = nullptr;
  const Sent* sent = nullptr;
  /// How roughness varies, as a bench says: it is not fitted (field_choice.h).
  std::array<double, GrooveField::kTerms> alpha_field{};
  Crossings crossings = Crossings::add;  ///< overlap: see burin/scene/carve.h
  CutInto cut{};                         ///< how grooves that are cut are laid (burin/scene/carve.h)
  BoardSample sample{};                  ///< what photos look at, and carved_at() carves
  GrooveProfile profile;                 ///< its kind; its numbers are unknowns
  Eigen::Vector2d center_mm{0, 0};       ///< of the carve area
  double f0 = 0.92;                      ///< mean of the channels
  double cauchy = 3;                     ///< scale of the robust loss, in expected errors
  /// How much roughness and depth differ from groove to groove: standard deviations of their logarithms
  /// (groove_scatter.h), and the standard errors of these numbers' squares.
  double alpha_jitter = 0, depth_jitter = 0;
  double alpha_jitter2_sigma = 0, depth_jitter2_sigma = 0;
};

/// expected_pieces() of what was sent over the carve area, as far as it is looked at.
double expected_pieces(const ModelData& model);

/// What share of the carve area grooves of one depth cover under these unknowns, all their areas added.
double covered_share(const ModelData& model, const Unknowns& x);

/// The terms of the field of depth.
std::array<double, GrooveField::kTerms> depth_field_of(const Unknowns& x);

/// The bench that the unknowns make, as far as carving asks.
Bench bench_at(const ModelData& model, const Unknowns& x);

/// The scratches as carved under these unknowns, cut where others rule if the model says so; in its sample's
/// surroundings, where it has one.
Carved carved_at(const ModelData& model, const Unknowns& x);

/// The same with the scratch that each is a piece of, and with a depth and a roughness for each.
Carved carved_pieces(const ModelData& model, const Unknowns& x);

}  // namespace burin

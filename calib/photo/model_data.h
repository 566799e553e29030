// burin/calib/photo/model_data.h - common data of all photos of a fit, and the carved grooves under its unknowns.
// Frame: board, mm.
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

/// Lanes across a groove. Each pixel's light is accurate to a hundredth of the groove's light there, and better under
/// the camera's blur.
inline constexpr int kLanes = 16;

/// Common data of all photos.
struct ModelData {
  const Board* board = nullptr;
  const Sent* sent = nullptr;
  /// Spatial variation of roughness from the bench: it is not fitted (field_choice.h).
  std::array<double, GrooveField::kTerms> alpha_field{};
  Crossings crossings = Crossings::add;  ///< overlap: see burin/scene/carve.h
  CutInto cut{};                         ///< layout of cut grooves (burin/scene/carve.h)
  BoardSample sample{};                  ///< part of the board in the photos, and of carved_at()
  GrooveProfile profile;                 ///< its kind; its numbers are unknowns
  Eigen::Vector2d center_mm{0, 0};       ///< of the carve area
  double f0 = 0.92;                      ///< mean of the channels
  double cauchy = 3;                     ///< scale of the robust loss, in expected errors
  /// Groove-to-groove variation of roughness and depth: standard deviations of their logarithms (groove_scatter.h), and
  /// the standard errors of their squares.
  double alpha_jitter = 0, depth_jitter = 0;
  double alpha_jitter2_sigma = 0, depth_jitter2_sigma = 0;
};

/// expected_pieces() of the sent scratches over the carve area, within the sample.
double expected_pieces(const ModelData& model);

/// Share of the carve area under grooves of one depth at these unknowns, all their areas added.
double covered_share(const ModelData& model, const Unknowns& x);

/// The terms of the field of depth.
std::array<double, GrooveField::kTerms> depth_field_of(const Unknowns& x);

/// The bench of these unknowns, as far as carving needs it.
Bench bench_at(const ModelData& model, const Unknowns& x);

/// The scratches as carved under these unknowns, cut at crossings if the model's rule cuts; within its sample's
/// surroundings, if it has a sample.
Carved carved_at(const ModelData& model, const Unknowns& x);

/// The carved pieces, each with its scratch's index, its own depth and its own roughness.
Carved carved_pieces(const ModelData& model, const Unknowns& x);

}  // namespace burin

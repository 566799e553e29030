#include "burin/calib/verdict/model_tests.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "burin/calib/geometry/information.h"
#include "burin/calib/photo/board_tiles.h"
#include "burin/calib/photo/cauchy_loss.h"
#include "burin/calib/photo/normal_system.h"
#include "burin/calib/photo/paper_equation.h"
#include "burin/scene/groove.h"
#include "burin/scene/surface.h"

namespace burin {
namespace {

enum Quantity { kAlong, kAcross, kAzimuth, kHighlight, kBrightness, kFrame };

// Squares of the board for sums of scores: kTileMm wide, and smaller on small boards, because few squares could not
// measure chance.
CellGrid tiles_of(const Board& board) {
  constexpr double kFewestAcross = 6;
  return board_tiles(board, std::min(kTileMm, board.size_mm.minCoeff() / kFewestAcross));
}

// Properties of pixels other than their light. Angles' tangents are of the half vector against the face.
struct PixelGeometry {
  double across = 0, azimuth_deg = 0, highlight = 0, frame = 0;
};

PixelGeometry geometry_at(const Problem& data, const PhotoData& photo, const Unknowns& x, std::size_t i) {
  const Eigen::Vector3d& p = photo.scene.grid->center_mm[i];
  const Eigen::Vector3d lamp = x.segment<3>(unknown::lamp_position);
  const Eigen::Vector3d h = ((lamp - p).normalized() + (photo.scene.camera_center_mm - p).normalized()).normalized();
  const Eigen::Vector3d n = face_normal(photo.camera.surface, p.x(), p.y());
  const Eigen::Vector3d flat = h - h.dot(n) * n;
  const double tangent = flat.norm() / std::max(1e-6, h.dot(n));
  const double cutoff = 2 * std::atan(groove_rim(data.model.board->tool_width_um, std::exp(x[unknown::log_depth])));
  PixelGeometry out;
  out.across = std::atan(tangent) / std::max(1e-6, cutoff);
  double turn = std::atan2(flat.y(), flat.x()) * 180 / std::numbers::pi;
  if (turn < 0) turn += 180;
  out.azimuth_deg = std::min(turn, 179.999);
  out.highlight = tangent / std::exp(x[unknown::log_base_alpha]);
  out.frame = photo.radius2[i];
  return out;
}

int bin_of(double value, const std::array<double, kQuantityBins - 1>& edges) {
  return static_cast<int>(std::upper_bound(edges.begin(), edges.end(), value) - edges.begin());
}

}  // namespace

const std::array<const char*, kPixelQuantities>& pixel_quantity_names() {
  static constexpr std::array<const char*, kPixelQuantities> kNames{"along",     "across",     "azimuth",
                                                                    "highlight", "brightness", "frame"};
  return kNames;
}

BinEdges bin_edges(const Problem& data, const State& state) {
  BinEdges out{};
  std::array<std::vector<std::pair<double, double>>, kPixelQuantities> values;  // with their weights
  for (const PhotoData& photo : data.photos) {
    const Unknowns x = state.of(photo.photo.light);
    const std::size_t stride = 1 + photo.weight.size() / 3000;
    for (std::size_t i = 0; i < photo.weight.size(); i += stride) {
      if (!(photo.weight[i] > 0)) continue;
      const PixelGeometry at = geometry_at(data, photo, x, i);
      const double value = photo.photo.value.data[i], counts = std::pow(photo.weight[i] * value, 2);
      values[kHighlight].emplace_back(at.highlight, counts);
      values[kBrightness].emplace_back(value, counts);
      values[kFrame].emplace_back(at.frame, counts);
    }
  }
  for (const int q : {kHighlight, kBrightness, kFrame}) {
    auto& v = values[q];
    std::sort(v.begin(), v.end());
    double all = 0, sum = 0;
    for (const auto& [value, counts] : v) all += counts;
    int edge = 0;
    for (const auto& [value, counts] : v) {
      sum += counts;
      while (edge < kQuantityBins - 1 && sum >= all * (edge + 1) / kQuantityBins) out[q][edge++] = value;
    }
  }
  // d log(light) / d log(alpha) is -1 in the middle of a glint and 2 far from it.
  out[kAlong] = {-0.7, -0.4, 0.1, 0.5, 1.0};
  // In units of the grooves' cut-off angle.
  out[kAcross] = {0.5, 0.75, 0.9, 1.0, 1.1};
  out[kAzimuth] = {30, 60, 90, 120, 150};
  return out;
}

ClassSums class_sums(const Problem& data, std::size_t k, const State& state, const PhotoSlopes& slopes,
                     const BinEdges& edges) {
  const PhotoData& photo = data.photos[k];
  const Unknowns x = state.of(photo.photo.light);
  const CellGrid tiles = tiles_of(*data.model.board);
  const auto tile_count = static_cast<Eigen::Index>(tiles.cells());
  // Indices of the unknowns with a column in this photo.
  std::vector<int> index;
  std::vector<const Image*> columns;
  const Image* by_alpha = nullptr;
  for (std::size_t c = 0; c < slopes.columns.size(); ++c) {
    if (slopes.index[c] >= kFitUnknowns) continue;
    index.push_back(slopes.index[c]);
    columns.push_back(&slopes.columns[c]);
    if (slopes.index[c] == unknown::log_alpha) by_alpha = &slopes.columns[c];
  }
  const std::size_t rendered = columns.size();
  const bool even = slopes.free[unknown::ambient] && photo.surroundings == nullptr;
  if (even) index.push_back(unknown::ambient);
  for (int v = 0; v < 3; ++v)
    if (slopes.free[unknown::vignette + v]) index.push_back(unknown::vignette + v);
  const bool glares = slopes.free[unknown::glare_share] && !photo.photo.scattered.data.empty();
  if (glares) index.push_back(unknown::glare_share);
  const auto n = static_cast<Eigen::Index>(index.size());

  ClassSums small;
  for (int q = 0; q < kPixelQuantities; ++q) {
    for (ClassSums::OfClass& c : small.classes[q])
      c = {Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n), Eigen::MatrixXd::Zero(n, tile_count)};
    for (ClassSums::OfBin& b : small.bins[q])
      b = {Eigen::VectorXd::Zero(tile_count), Eigen::VectorXd::Zero(tile_count)};
  }
  Eigen::VectorXd row(n);
  const int width = slopes.light.width;
  for (std::size_t i = 0; i < photo.weight.size(); ++i) {
    if (!(photo.weight[i] > 0) || (i % width + i / width) % 2 != 0) continue;
    const PixelSeen pixel = pixel_seen(photo, x, i, slopes.light);
    const double predicted = pixel.value;
    const double residual = photo.weight[i] * (predicted - photo.photo.value.data[i]);
    const Loss loss = cauchy_loss(residual * residual, data.model.cauchy);
    const double scale = photo.weight[i] * pixel.factor;
    for (std::size_t c = 0; c < rendered; ++c) row[static_cast<Eigen::Index>(c)] = scale * columns[c]->data[i];
    auto at = static_cast<Eigen::Index>(rendered);
    if (even) row[at++] = scale * data.model.f0;
    double power = photo.radius2[i];
    for (int v = 0; v < 3; ++v, power *= photo.radius2[i])
      if (slopes.free[unknown::vignette + v])
        row[at++] = (1 - x[unknown::glare_share]) * photo.weight[i] * power * slopes.light.data[i];
    if (glares) row[at++] = photo.weight[i] * pixel.by_glare;
    const PixelGeometry g = geometry_at(data, photo, x, i);
    const double light = slopes.light.data[i];
    const double elasticity = by_alpha != nullptr && light > 0 ? by_alpha->data[i] / light : 0;
    const std::array<double, kPixelQuantities> values{elasticity,  g.across,  g.azimuth_deg,
                                                      g.highlight, predicted, g.frame};
    const Eigen::Vector3d& place = photo.scene.grid->center_mm[i];
    const auto tile = static_cast<Eigen::Index>(tiles.cell(tiles.column(place.x()), tiles.row(place.y())));
    const double seen = photo.weight[i] * predicted;
    for (int q = 0; q < kPixelQuantities; ++q) {
      const int bin = bin_of(values[q], edges[q]);
      ClassSums::OfClass& c = small.classes[q][bin / kBinsInClass];
      c.information.selfadjointView<Eigen::Lower>().rankUpdate(row, loss.curvature);
      const double score = loss.weight * residual;
      c.gradient += score * row;
      c.tile_scores.col(tile) += score * row;
      small.bins[q][bin].by_tile[tile] -= score * seen;  // photo minus prediction
      small.bins[q][bin].norm_by_tile[tile] += loss.weight * seen * seen;
    }
  }

  ClassSums out;
  out.bins = std::move(small.bins);
  for (int q = 0; q < kPixelQuantities; ++q)
    for (int c = 0; c < kQuantityClasses; ++c) {
      const ClassSums::OfClass& from = small.classes[q][c];
      ClassSums::OfClass& to = out.classes[q][c];
      to = {Eigen::MatrixXd::Zero(kFitUnknowns, kFitUnknowns), Eigen::VectorXd::Zero(kFitUnknowns),
            Eigen::MatrixXd::Zero(kFitUnknowns, tile_count)};
      for (Eigen::Index a = 0; a < n; ++a) {
        to.gradient[index[a]] = from.gradient[a];
        to.tile_scores.row(index[a]) = from.tile_scores.row(a);
        for (Eigen::Index b = 0; b < n; ++b)
          to.information(index[a], index[b]) = from.information(std::max(a, b), std::min(a, b));
      }
    }
  return out;
}

namespace {

// One class of one quantity, over all photos and unknowns.
struct Whole {
  Eigen::MatrixXd information, tile_scores;
  Eigen::VectorXd gradient;
};

std::vector<Whole> whole_classes(const Problem& data, std::size_t lights, int quantity,
                                 const std::vector<ClassSums>& photos) {
  const Eigen::Index n = global_count(lights);
  const auto tiles = static_cast<Eigen::Index>(tiles_of(*data.model.board).cells());
  std::vector<Whole> out(kQuantityClasses,
                         {Eigen::MatrixXd::Zero(n, n), Eigen::MatrixXd::Zero(n, tiles), Eigen::VectorXd::Zero(n)});
  for (std::size_t k = 0; k < photos.size(); ++k)
    for (int c = 0; c < kQuantityClasses; ++c) {
      const ClassSums::OfClass& from = photos[k].classes[quantity][c];
      for (int a = 0; a < kFitUnknowns; ++a) {
        const int to = global_index(a, data.photos[k].photo.light);
        out[c].gradient[to] += from.gradient[a];
        out[c].tile_scores.row(to) += from.tile_scores.row(a);
        for (int b = 0; b < kFitUnknowns; ++b)
          out[c].information(to, global_index(b, data.photos[k].photo.light)) += from.information(a, b);
      }
    }
  return out;
}

// Priors and paper, which all classes share.
struct Held {
  Eigen::MatrixXd information;
  Eigen::VectorXd gradient;
};

Held held_by_all(const Problem& data, const State& state, const std::vector<bool>& free) {
  const Eigen::Index n = global_count(state.lamps.size());
  Held out{Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n)};
  // The sums use half of the photos' pixels; paper and priors have the same factor.
  constexpr double kShareOfPixels = 0.5;
  for (const LightSample& sample : data.paper) {
    const auto [r, row] = paper_equation(data, state, sample, free);
    const double weight = kShareOfPixels / (1 + r * r / (kPaperLoss * kPaperLoss));
    out.information += weight * row * row.transpose();
    out.gradient += weight * r * row;
  }
  for_each_unknown([&](const UnknownRow& row, int first) {
    if (!(row.prior_sigma[0] > 0)) return;
    const int begin = row.scope == Scope::paper ? kPaperIndex : first;
    for (int i = 0; i < row.size; ++i) {
      const double information = kShareOfPixels / std::pow(row.prior_sigma[i], 2);
      out.information(begin + i, begin + i) += information;
      out.gradient[begin + i] += information * state.block(first)[i];
    }
  });
  return out;
}

// Estimate of one class relative to the estimate of all, and the contribution of each square of the board.
struct Answer {
  bool told = false;
  Eigen::VectorXd step;
  Eigen::MatrixXd by_tile;
};

Answer answer_of(const std::vector<Whole>& classes, std::size_t c, const Held& held, const std::vector<bool>& free) {
  constexpr double kOthers = 0.1;
  Eigen::MatrixXd H = held.information,
                  scores = Eigen::MatrixXd::Zero(held.gradient.size(), classes[c].tile_scores.cols());
  Eigen::VectorXd g = held.gradient;
  for (std::size_t other = 0; other < classes.size(); ++other) {
    const double counts = other == c ? 1 : kOthers;
    H += counts * classes[other].information;
    g += counts * classes[other].gradient;
    scores += counts * classes[other].tile_scores;
  }
  const Eigen::MatrixXd inverse = safe_inverse(H, free);
  return {classes[c].information.trace() > 0, -inverse * g, -inverse * scores};
}

// Converts a t value with `degrees` degrees of freedom to sigmas of a normal distribution (Wallace, Annals of
// Mathematical Statistics 30, 1959).
double normal_sigmas(double t, double degrees) {
  return (8 * degrees + 1) / (8 * degrees + 3) * std::sqrt(degrees * std::log1p(t * t / degrees));
}

constexpr std::array<int, 3> kAsked{unknown::log_alpha, unknown::log_depth, unknown::log_base_alpha};

struct Contrast {
  std::array<double, kAsked.size()> sigmas{};  // of alpha, depth, base_alpha
  Eigen::VectorXd difference, chance;          // chance: one standard deviation
};

Contrast contrast_of(const Answer& a, const Answer& b) {
  Contrast out;
  out.difference = a.step - b.step;
  const Eigen::MatrixXd by_tile = a.by_tile - b.by_tile;
  std::vector<Eigen::Index> used;  // squares with pixels of the classes
  for (Eigen::Index t = 0; t < by_tile.cols(); ++t)
    if (by_tile.col(t).cwiseAbs().maxCoeff() > 0) used.push_back(t);
  const auto count = static_cast<double>(used.size());
  out.chance = Eigen::VectorXd::Zero(out.difference.size());
  if (used.size() < 4) return out;
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(out.difference.size());
  for (const Eigen::Index t : used) mean += by_tile.col(t) / count;
  for (const Eigen::Index t : used) out.chance += (by_tile.col(t) - mean).cwiseAbs2();
  out.chance = (out.chance * count / (count - 1)).cwiseSqrt();
  for (std::size_t k = 0; k < kAsked.size(); ++k)
    if (out.chance[kAsked[k]] > 0)
      out.sigmas[k] = normal_sigmas(out.difference[kAsked[k]] / out.chance[kAsked[k]], count - 1);
  return out;
}

// Possible error of the estimates: half of the difference between two classes, as for two halves of the photos, without
// the part due to chance.
Eigen::VectorXd half_beyond_chance(const Contrast& c) {
  constexpr double kMostLogarithm = 1.5;
  Eigen::VectorXd out = c.difference;
  for (Eigen::Index i = 0; i < out.size(); ++i)
    out[i] = 0.5 * std::copysign(std::sqrt(std::max(0.0, std::pow(out[i], 2) - std::pow(c.chance[i], 2))), out[i]);
  for (const int i : kAsked) out[i] = std::clamp(out[i], -kMostLogarithm, kMostLogarithm);
  return out;
}

// Photos minus model, bin by bin.
std::vector<Misfit::Class> residuals_by_bin(int quantity, const std::vector<ClassSums>& photos) {
  std::vector<Misfit::Class> out;
  for (int bin = 0; bin < kQuantityBins; ++bin) {
    Eigen::VectorXd by_tile = photos.front().bins[quantity][bin].by_tile * 0, norm = by_tile;
    for (const ClassSums& photo : photos) {
      by_tile += photo.bins[quantity][bin].by_tile;
      norm += photo.bins[quantity][bin].norm_by_tile;
    }
    const double all = norm.sum();
    Misfit::Class one{std::to_string(bin + 1), 0, 0};
    if (all > 0) {
      one.residual = by_tile.sum() / all;
      one.sigma = (by_tile - one.residual * norm).norm() / all;
    }
    out.push_back(one);
  }
  return out;
}

}  // namespace

std::vector<ModelTest> test_model(const Problem& data, const State& state, const std::vector<bool>& free,
                                  const std::vector<ClassSums>& photos) {
  // Six quantities, three contrasts, three numbers: chance exceeds four sigmas in one of three hundred setups.
  constexpr double kBeyondChance = 4;
  std::vector<ModelTest> out;
  if (photos.empty()) return out;
  const Held held = held_by_all(data, state, free);
  for (int q = 0; q < kPixelQuantities; ++q) {
    const std::vector<Whole> classes = whole_classes(data, state.lamps.size(), q, photos);
    std::vector<Answer> answers;
    for (std::size_t c = 0; c < classes.size(); ++c) answers.push_back(answer_of(classes, c, held, free));
    ModelTest test;
    double most = kLeastShift;
    for (std::size_t a = 0; a < answers.size(); ++a)
      for (std::size_t b = a + 1; b < answers.size(); ++b) {
        if (!answers[a].told || !answers[b].told) continue;
        const Contrast one = contrast_of(answers[a], answers[b]);
        const Eigen::VectorXd shift = half_beyond_chance(one);
        for (std::size_t k = 0; k < kAsked.size(); ++k) {
          if (!(one.sigmas[k] > kBeyondChance) || !(std::abs(shift[kAsked[k]]) > most)) continue;
          most = std::abs(shift[kAsked[k]]);
          test.shift = shift;
          test.misfit.sigmas = one.sigmas[k];
        }
      }
    if (test.shift.size() == 0) continue;
    test.misfit.test = pixel_quantity_names().at(static_cast<std::size_t>(q));
    test.misfit.classes = residuals_by_bin(q, photos);
    set_percents(test.shift, test.misfit);
    out.push_back(std::move(test));
  }
  return out;
}

void set_percents(const Eigen::VectorXd& shift, Misfit& misfit) {
  misfit.alpha_percent = 100 * shift[unknown::log_alpha];
  misfit.depth_percent = 100 * shift[unknown::log_depth];
  misfit.base_alpha_percent = 100 * shift[unknown::log_base_alpha];
}

}  // namespace burin

// Proves: tags weigh by their noise where pixels want the same geometry within chance, and by as much more as makes
// both agree where they do not, whatever the weight before; what other unknowns explain contradicts nobody.
// Oracle: the distance between both answers by whole covariances, the unknowns solved along.
#include "burin/calib/photo/geometry_agreement.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>

namespace burin {
namespace {

constexpr Eigen::Index kUnknowns = 3, kGeometry = 9, kAll = kUnknowns + kGeometry, kSquares = 200;

struct Measurement {
  Eigen::MatrixXd H;        // of the pixels, over unknowns and geometry
  Eigen::VectorXd wants;    // where they would have both
  Eigen::MatrixXd squares;  // scores
  GeometryPrior tags;
};

// Units of the geometry as different as radians, mm and focal lengths.
Measurement measured(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const auto noise = [&] { return normal(random); };
  Measurement out;
  Eigen::VectorXd unit(kAll);
  for (Eigen::Index i = 0; i < kAll; ++i) unit[i] = std::pow(10, static_cast<double>(i % 5) - 2);
  const Eigen::MatrixXd J = Eigen::MatrixXd::NullaryExpr(60, kAll, noise) * unit.asDiagonal();
  out.H = J.transpose() * J;
  const Eigen::MatrixXd K = Eigen::MatrixXd::NullaryExpr(30, kGeometry, noise) * unit.tail(kGeometry).asDiagonal();
  out.tags.information = K.transpose() * K;
  out.tags.moved = Eigen::VectorXd::Zero(kGeometry);
  // Both err by what they say.
  out.wants = out.H.llt().matrixU().solve(Eigen::VectorXd::NullaryExpr(kAll, noise));
  out.wants.tail(kGeometry) +=
      out.tags.information.llt().matrixU().solve(Eigen::VectorXd::NullaryExpr(kGeometry, noise));
  const Eigen::MatrixXd root = out.H.llt().matrixL();
  out.squares = root * Eigen::MatrixXd::NullaryExpr(kAll, kSquares, noise) / std::sqrt(double{kSquares});
  return out;
}

// As normal_system() has it, `off` from where the tags want to be.
NormalSystem system_of(const Measurement& m, const Eigen::VectorXd& off) {
  Eigen::VectorXd at = Eigen::VectorXd::Zero(kAll);
  at.tail(kGeometry) = off;
  const Eigen::VectorXd g = m.H * (at - m.wants);
  const Eigen::MatrixXd weighted = m.tags.weight * m.tags.information;
  NormalSystem out;
  out.free.assign(kUnknowns, true);
  out.A = m.H.bottomRightCorner(kGeometry, kGeometry) + weighted;
  out.B = m.H.topRightCorner(kUnknowns, kGeometry);
  out.gain = out.A.llt().solve(out.B.transpose()).transpose();
  out.geometry_off = off;
  out.geometry_g = g.tail(kGeometry) + weighted * off;
  out.H = m.H.topLeftCorner(kUnknowns, kUnknowns) - out.gain * out.B.transpose();
  out.g = g.head(kUnknowns) - out.gain * out.geometry_g;
  out.tiles = m.squares;
  out.tiles.topRows(kUnknowns) -= out.gain * m.squares.bottomRows(kGeometry);
  return out;
}

// The distance between both answers, the pixels' variances stretched.
double distance(const Measurement& m, double stretch) {
  const Eigen::MatrixXd pixels = m.H.inverse().bottomRightCorner(kGeometry, kGeometry),
                        tags = m.tags.information.inverse();
  const Eigen::VectorXd apart = m.wants.tail(kGeometry);
  return apart.dot((stretch * pixels + tags).ldlt().solve(apart));
}

TEST(GeometryAgreement, TagsWeighByTheirNoiseWhereBothAgree) {
  std::mt19937_64 random(7);
  for (int i = 0; i < 50; ++i) {
    const Measurement m = measured(random);
    EXPECT_EQ(tags_weight(system_of(m, Eigen::VectorXd::Zero(kGeometry)), m.tags), 1);
  }
}

TEST(GeometryAgreement, PixelsThatContradictThemAreStretchedUntilTheyDoNot) {
  std::mt19937_64 random(8);
  Measurement m = measured(random);
  m.wants *= 12;
  const double weight = tags_weight(system_of(m, Eigen::VectorXd::Zero(kGeometry)), m.tags);
  EXPECT_GT(weight, 10);
  EXPECT_GT(distance(m, 1), 4 * kGeometry);
  EXPECT_NEAR(distance(m, weight), kGeometry, 1e-6 * kGeometry);
  // From anywhere, and with the weight that it has.
  m.tags.weight = weight;
  EXPECT_NEAR(tags_weight(system_of(m, 0.3 * m.wants.tail(kGeometry)), m.tags), weight, 1e-6 * weight);
}

TEST(GeometryAgreement, WhatOtherUnknownsExplainContradictsNobody) {
  std::mt19937_64 random(9);
  Measurement m = measured(random);
  m.wants.head(kUnknowns) *= 1e4;
  EXPECT_EQ(tags_weight(system_of(m, Eigen::VectorXd::Zero(kGeometry)), m.tags), 1);
}

// Errors that are alike over a square of the board are no contradiction: their scores say that they scatter.
TEST(GeometryAgreement, SquaresThatScatterSayHowFarPixelsMayErr) {
  std::mt19937_64 random(10);
  Measurement m = measured(random);
  m.wants *= 4;
  EXPECT_GT(tags_weight(system_of(m, Eigen::VectorXd::Zero(kGeometry)), m.tags), 1);
  m.squares *= 4;
  EXPECT_EQ(tags_weight(system_of(m, Eigen::VectorXd::Zero(kGeometry)), m.tags), 1);
}

}  // namespace
}  // namespace burin

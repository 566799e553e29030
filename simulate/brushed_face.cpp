#include "burin/simulate/brushed_face.h"
#include "burin/base/scattered.h"

#include <cmath>
#include <numbers>

namespace burin {
namespace {

using Eigen::Vector3d;

// Random value of one cell's corner, -1 to 1.
double lattice(std::int64_t i, std::int64_t j, std::uint64_t seed) {
  const std::uint64_t v = static_cast<std::uint64_t>(i) * 0x9e3779b97f4a7c15ULL ^
                          (static_cast<std::uint64_t>(j) + 0x632be59bd9b4e019ULL) * 0xd1b54a32d192ed03ULL ^ seed;
  return static_cast<double>(scattered(v) >> 11) * 0x1.0p-52 - 1;
}

double value_noise(double u, double v, std::uint64_t seed) {
  const double fu = std::floor(u), fv = std::floor(v);
  const auto i = static_cast<std::int64_t>(fu), j = static_cast<std::int64_t>(fv);
  const auto ease = [](double t) { return t * t * (3 - 2 * t); };
  const double a = ease(u - fu), b = ease(v - fv);
  return (1 - b) * ((1 - a) * lattice(i, j, seed) + a * lattice(i + 1, j, seed)) +
         b * ((1 - a) * lattice(i, j + 1, seed) + a * lattice(i + 1, j + 1, seed));
}

}  // namespace

BrushedFace brushed_face(const BenchTruth& truth) {
  const FaceGrain& grain = truth.board.material.grain;
  const double angle = grain.along_deg() * std::numbers::pi / 180, root = std::sqrt(grain.ratio());
  return {std::cos(angle),
          std::sin(angle),
          truth.board.material.base_alpha / root,
          truth.board.material.base_alpha * root,
          truth.streaks,
          truth.seed ^ 0x5bd1e995ULL};
}

double brushed_light(const BrushedFace& face, const Vector3d& normal, const Vector3d& h, const Vector3d& wi,
                     const Vector3d& wo) {
  // Tangents: along the brushing within the face, and across.
  Vector3d along(face.along_x, face.along_y, 0);
  along = (along - normal * normal.dot(along)).normalized();
  const Vector3d across = normal.cross(along);
  const double hn = normal.dot(h), ci = normal.dot(wi), co = normal.dot(wo);
  if (!(hn > 0 && ci > 0 && co > 0)) return 0;
  const double p = along.dot(h) / hn / face.alpha_along, q = across.dot(h) / hn / face.alpha_across;  // slopes
  const double D =
      1 / (std::numbers::pi * face.alpha_along * face.alpha_across * std::pow(1 + p * p + q * q, 2) * std::pow(hn, 4));
  const auto G1 = [&](const Vector3d& v, double cosine) {
    const double a = face.alpha_along * along.dot(v) / cosine, b = face.alpha_across * across.dot(v) / cosine;
    return 2 / (1 + std::sqrt(1 + a * a + b * b));
  };
  return D * G1(wi, ci) * G1(wo, co);
}

Vector3d streaked_normal(const BrushedFace& face, const Vector3d& normal, double x, double y) {
  const double along = x * face.along_x + y * face.along_y, across = -x * face.along_y + y * face.along_x;
  const double slope =
      face.streaks.slope * value_noise(along / face.streaks.length_mm, across / face.streaks.width_mm, face.seed);
  return (normal - slope * Vector3d(-face.along_y, face.along_x, 0)).normalized();
}

}  // namespace burin

#include "burin/simulate/around_sampler.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace burin {

AroundSampler::AroundSampler(std::shared_ptr<const Panorama> panorama) : panorama_(std::move(panorama)) {
  const Image& picture = panorama_->radiance;
  double sum = 0;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      // Light from far below the face reaches no board, bowed or not.
      const bool counts = panorama_->direction(x + 0.5, y + 0.5).z() > -0.3;
      if (counts) sum += (picture.at(x, y, 0) + picture.at(x, y, 1) + picture.at(x, y, 2)) * panorama_->solid_angle(y);
      until_.push_back(sum);
    }
  for (double& share : until_) share /= sum;
}

double AroundSampler::density(std::size_t pixel) const {
  const double share = until_[pixel] - (pixel > 0 ? until_[pixel - 1] : 0);
  return share / panorama_->solid_angle(static_cast<int>(pixel / panorama_->radiance.width));
}

Eigen::Vector3d AroundSampler::draw(double a, double b, double c) const {
  const Image& picture = panorama_->radiance;
  const auto at = static_cast<std::size_t>(std::min<std::ptrdiff_t>(
      std::ssize(until_) - 1, std::upper_bound(until_.begin(), until_.end(), a) - until_.begin()));
  const std::size_t in_row = at % picture.width, above = at / picture.width;
  const double column = static_cast<double>(in_row) + b, row = static_cast<double>(above);
  // Uniform over the pixel's solid angle: in the cosine of the polar angle.
  const double top = std::cos(std::numbers::pi * row / picture.height),
               bottom = std::cos(std::numbers::pi * (row + 1) / picture.height);
  return panorama_->direction(column, std::acos(top + c * (bottom - top)) / std::numbers::pi * picture.height);
}

Eigen::Vector3d AroundSampler::reflected(const RoughFacet& facet, const Eigen::Vector3d& face,
                                         const Eigen::Vector3d& wo, const Eigen::Vector3d& f0,
                                         const double (&u)[4]) const {
  const double alpha = facet.alpha;
  const Eigen::Vector3d along = facet.normal.cross(facet.across);
  Eigen::Vector3d wi;
  if (u[0] < 0.5) {
    wi = draw(u[1], u[2], u[3]);
  } else {
    // Slopes with the density D (n.h), stretched across.
    const double slope = alpha * std::sqrt(u[1] / (1 - u[1])), turn = 2 * std::numbers::pi * u[2];
    const Eigen::Vector3d h =
        (facet.normal + slope * (facet.ratio * std::cos(turn) * facet.across + std::sin(turn) * along)).normalized();
    wi = 2 * wo.dot(h) * h - wo;
  }
  const double cos_i = face.dot(wi), cos_o = face.dot(wo);
  const Eigen::Vector3d h = (wi + wo).normalized();
  const double n_h = facet.normal.dot(h), cos_ho = wo.dot(h);
  if (!(cos_i > 0 && cos_o > 0 && n_h > 0 && cos_ho > 0)) return Eigen::Vector3d::Zero();
  // GGX and Smith, written independently of the renderer (docs/model.md 3.1 to 3.3, 3.7).
  const double m_h = facet.across.dot(h) / facet.ratio, l_h = along.dot(h), a2 = alpha * alpha;
  const double q = a2 * n_h * n_h + m_h * m_h + l_h * l_h, D = a2 / (std::numbers::pi * facet.ratio * q * q);
  const auto g1 = [a2](double c) { return 2 / (1 + std::sqrt(1 + a2 * (1 / (c * c) - 1))); };
  const Eigen::Vector3d F = f0 + (Eigen::Vector3d::Ones() - f0) * std::pow(1 - cos_ho, 5);
  const std::size_t pixel = panorama_->pixel(wi);
  const float* radiance = &panorama_->radiance.data[3 * pixel];
  const double drawn = 0.5 * density(pixel) + 0.5 * D * n_h / (4 * cos_ho);
  return Eigen::Vector3d(radiance[0], radiance[1], radiance[2]).cwiseProduct(F) *
         (D * g1(cos_i) * g1(cos_o) / (4 * cos_o) / drawn);
}

}  // namespace burin

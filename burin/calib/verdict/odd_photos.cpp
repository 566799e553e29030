#include "burin/calib/verdict/odd_photos.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "burin/calib/geometry/information.h"
#include "burin/calib/photo/normal_system.h"
#include "burin/calib/verdict/model_tests.h"
#include "burin/render/median.h"

namespace burin {
namespace {

// Clean benches' views differ by up to 1.8 times, an amateur's by 1.2; one that sees another lamp's mirror image stands
// out by four. Below the least, what is missed is hardly more than the camera's noise.
constexpr double kStandsOut = 3, kLeast = 4;

// Where the answer would be without one view, to first order.
Eigen::VectorXd step_without(std::size_t part, const Uncertainty& u) {
  Eigen::MatrixXd H = u.prior_information.asDiagonal();
  Eigen::VectorXd g = u.prior_gradient;
  for (std::size_t k = 0; k < u.part_information.size(); ++k) {
    if (k == part) continue;
    H += u.part_information[k];
    g += u.part_gradient[k];
  }
  return -safe_inverse(H, u.free) * g;
}

std::vector<Misfit::Class> residuals_by_photo(const std::vector<PhotoFit>& photos) {
  std::vector<Misfit::Class> out;
  for (const PhotoFit& photo : photos)
    out.push_back({photo.view, photo.residual_rms,
                   photo.residual_to_noise > 0 ? photo.residual_rms / photo.residual_to_noise : 0});
  return out;
}

}  // namespace

void add_odd_photos(const std::vector<PhotoFit>& photos, Uncertainty& uncertainty) {
  constexpr std::size_t kFewestViews = 4;
  const std::vector<std::size_t>& parts = uncertainty.part_photo;
  if (parts.size() < kFewestViews) return;
  std::vector<std::pair<Misfit, Eigen::VectorXd>> odd;
  for (std::size_t part = 0; part < parts.size(); ++part) {
    std::vector<double> others;
    for (std::size_t other = 0; other < parts.size(); ++other)
      if (other != part) others.push_back(photos[parts[other]].residual_to_noise);
    const double own = photos[parts[part]].residual_to_noise, usual = median_of(std::move(others));
    if (!(own > kLeast) || !(own > kStandsOut * usual)) continue;
    const Eigen::VectorXd shift = step_without(part, uncertainty);
    Misfit misfit;
    misfit.test = "photo " + photos[parts[part]].view;
    misfit.sigmas = own / usual;
    misfit.classes = residuals_by_photo(photos);
    set_percents(shift, misfit);
    odd.emplace_back(std::move(misfit), shift);
  }
  for (auto& [misfit, shift] : odd) {
    uncertainty.misfits.push_back(std::move(misfit));
    uncertainty.shifts.push_back(std::move(shift));
  }
}

}  // namespace burin

#include "burin/calib/verdict/odd_photos.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "burin/base/median.h"
#include "burin/calib/photo/unknowns.h"
#include "burin/calib/verdict/model_tests.h"

namespace burin {
namespace {

// Views of clean setups differ by a factor of up to 1.8, of an amateur's setup by 1.2. A view with another lamp's
// mirror image differs by a factor of four. Below kLeast, the model error hardly exceeds the camera's noise.
constexpr double kUsual = 1.8, kStandsOut = 3, kLeast = 4;
constexpr double kMostLogarithm = 1.5;  // a number from a single view: known only within a factor of four

// Residual of each part: its worst photo under any lamp; 0 if none of its pixels was used.
std::vector<double> residuals_by_part(const std::vector<PhotoFit>& photos, const std::vector<std::size_t>& parts) {
  std::vector<double> out;
  for (const std::size_t first : parts) {
    double most = 0;
    for (const PhotoFit& photo : photos)
      if (photo.view == photos[first].view && photo.pixels > 0) most = std::max(most, photo.residual_to_noise);
    out.push_back(most);
  }
  return out;
}

std::vector<Misfit::Class> residuals_by_photo(const std::vector<PhotoFit>& photos) {
  std::vector<Misfit::Class> out;
  out.reserve(photos.size());
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
  const std::vector<double> residuals = residuals_by_part(photos, parts);
  for (std::size_t part = 0; part < parts.size(); ++part) {
    std::vector<double> others;
    for (std::size_t other = 0; other < parts.size(); ++other)
      if (other != part && residuals[other] > 0) others.push_back(residuals[other]);
    if (others.size() + 1 < kFewestViews) continue;
    const double own = residuals[part], usual = median_of(std::move(others));
    if (!(own > kLeast) || !(own > kStandsOut * usual)) continue;
    Eigen::VectorXd shift = uncertainty.part_shift[part];
    for (const int i : {unknown::log_alpha, unknown::log_depth, unknown::log_base_alpha})
      shift[i] = std::clamp(shift[i], -kMostLogarithm, kMostLogarithm);
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

bool fits_as_usual(const std::vector<PhotoFit>& photos, const std::string& view) {
  std::vector<double> residuals;
  for (const PhotoFit& photo : photos)
    if (photo.pixels > 0) residuals.push_back(photo.residual_to_noise);
  if (residuals.empty()) return false;
  const double most = kUsual * median_of(std::move(residuals));
  return std::none_of(photos.begin(), photos.end(), [&](const PhotoFit& photo) {
    return photo.view == view && photo.pixels > 0 && photo.residual_to_noise > most;
  });
}

}  // namespace burin

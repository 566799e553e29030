#include "optimize/adam.h"

#include <algorithm>
#include <cmath>

#include "render/error.h"

namespace burin {

Adam::Adam(std::size_t parameter_count, const AdamOptions& options)
    : options_(options), mean_(parameter_count, 0.0), square_(parameter_count, 0.0), age_(parameter_count, 0) {}

void Adam::step(std::span<double> parameters, std::span<const double> gradient, double rate) {
  if (parameters.size() != size() || gradient.size() != size())
    fail("adam", "the arrays do not have the optimiser's size", "make a new Adam after changing the parameters");
  // Powers of the betas by age: few distinct values, computed once.
  const std::uint32_t oldest = age_.empty() ? 0 : *std::max_element(age_.begin(), age_.end()) + 1;
  std::vector<double> unbias_mean(oldest + 1, 1.0), unbias_square(oldest + 1, 1.0);
  double p1 = 1, p2 = 1;
  for (std::uint32_t t = 1; t <= oldest; ++t) {
    p1 *= options_.beta1;
    p2 *= options_.beta2;
    unbias_mean[t] = 1 / (1 - p1);
    unbias_square[t] = 1 / (1 - p2);
  }
  for (std::size_t i = 0; i < size(); ++i) {
    const double g = gradient[i];
    mean_[i] = options_.beta1 * mean_[i] + (1 - options_.beta1) * g;
    square_[i] = options_.beta2 * square_[i] + (1 - options_.beta2) * g * g;
    const std::uint32_t t = ++age_[i];
    parameters[i] -= rate * mean_[i] * unbias_mean[t] / (std::sqrt(square_[i] * unbias_square[t]) + options_.epsilon);
  }
}

void Adam::restart(std::size_t index) {
  mean_[index] = square_[index] = 0;
  age_[index] = 0;
}

void Adam::keep(std::span<const std::size_t> kept) {
  for (std::size_t i = 0; i < kept.size(); ++i) {
    mean_[i] = mean_[kept[i]];
    square_[i] = square_[kept[i]];
    age_[i] = age_[kept[i]];
  }
  mean_.resize(kept.size());
  square_.resize(kept.size());
  age_.resize(kept.size());
}

}  // namespace burin

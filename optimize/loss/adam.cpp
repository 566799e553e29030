#include "burin/optimize/loss/adam.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "burin/base/error.h"
#include "burin/base/machine_clones.h"

namespace burin {
namespace {

/// Parameters per task: enough to be worth a task, few enough to stay in the cache.
constexpr std::size_t kPart = 4096;

/// Number of ages whose corrections are computed at once.
constexpr std::size_t kAges = 256;

BURIN_MACHINE_CLONES void step_part(std::size_t n, const AdamOptions& options, double rate,
                                    const double* __restrict unbias_mean, const double* __restrict unbias_square,
                                    const double* __restrict gradient, double* __restrict mean,
                                    double* __restrict square, std::uint32_t* __restrict age,
                                    double* __restrict parameter) {
  const double beta1 = options.beta1, beta2 = options.beta2, epsilon = options.epsilon;
  for (std::size_t i = 0; i < n; ++i) {
    const double g = gradient[i];
    mean[i] = beta1 * mean[i] + (1 - beta1) * g;
    square[i] = beta2 * square[i] + (1 - beta2) * g * g;
    const std::uint32_t t = age[i]++;
    parameter[i] -= rate * mean[i] * unbias_mean[t] / (std::sqrt(square[i] * unbias_square[t]) + epsilon);
  }
}

}  // namespace

Adam::Adam(std::size_t parameter_count, const AdamOptions& options)
    : options_(options), mean_(parameter_count, 0.0), square_(parameter_count, 0.0), age_(parameter_count, 0) {}

void Adam::step(std::span<double> parameters, std::span<const double> gradient, double rate) {
  if (parameters.size() != size() || gradient.size() != size())
    fail("adam", "the arrays do not have the optimizer's size", "make a new Adam after changing the parameters");
  // No parameter is older than steps_.
  if (++steps_ > unbias_mean_.size()) {
    for (std::size_t t = unbias_mean_.size(), end = t + kAges; t < end; ++t) {
      unbias_mean_.push_back(1 / (1 - std::pow(options_.beta1, t + 1)));
      unbias_square_.push_back(1 / (1 - std::pow(options_.beta2, t + 1)));
    }
  }
  tbb::parallel_for(std::size_t{0}, (size() + kPart - 1) / kPart, [&](std::size_t part) {
    const std::size_t i = part * kPart;
    step_part(std::min(kPart, size() - i), options_, rate, unbias_mean_.data(), unbias_square_.data(), &gradient[i],
              &mean_[i], &square_[i], &age_[i], &parameters[i]);
  });
}

void Adam::restart(std::size_t index) {
  mean_[index] = square_[index] = 0;
  age_[index] = 0;
}

void Adam::keep(std::span<const std::size_t> kept) {
  const auto keep_in = [&](auto& values) {
    auto old = values;
    values.resize(kept.size());
    for (std::size_t i = 0; i < kept.size(); ++i) values[i] = old[kept[i]];
  };
  keep_in(mean_);
  keep_in(square_);
  keep_in(age_);
}

void Adam::exchange(std::size_t index, Adam& other) {
  if (steps_ != other.steps_) fail("adam", "histories of different lengths cannot be exchanged", "step both alike");
  std::swap(mean_[index], other.mean_[index]);
  std::swap(square_[index], other.square_[index]);
  std::swap(age_[index], other.age_[index]);
}

}  // namespace burin

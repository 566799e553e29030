// burin/optimize/loss/adam.h - Adam (Kingma & Ba, ICLR 2015, Algorithm 1) over flat arrays.
//
// One Adam holds the moments of one array of parameters. Every parameter counts its own steps. The bias correction of a
// re-inserted scratch therefore matches its own short history and not the array's.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace burin {

/// Constants of Adam; the defaults are the paper's, except epsilon.
struct AdamOptions {
  double beta1 = 0.9;      ///< decay of the mean gradient
  double beta2 = 0.999;    ///< decay of the mean square
  double epsilon = 1e-12;  ///< in the gradient's unit: gradients far below it hardly move a parameter
};

/// Adam over a vector of parameters, each with its own mean gradient, mean square and age.
class Adam {
 public:
  /// Starts without history.
  explicit Adam(std::size_t parameter_count, const AdamOptions& options = {});

  /// parameters -= rate * mean / (sqrt(mean square) + epsilon), each corrected for its age. A gradient of exactly zero
  /// does not move a parameter without history. Sizes must equal parameter_count. The same bits result for any number
  /// of threads.
  void step(std::span<double> parameters, std::span<const double> gradient, double rate);

  /// Forgets the history of one parameter.
  void restart(std::size_t index);

  /// Keeps the parameters at `kept`, in this order, after a removal or a permutation of parameters.
  void keep(std::span<const std::size_t> kept);

  /// Exchanges the histories of one parameter between this optimizer and another with as many steps.
  void exchange(std::size_t index, Adam& other);

  /// Number of values.
  std::size_t size() const { return mean_.size(); }

 private:
  AdamOptions options_;
  std::vector<double> mean_, square_;
  std::vector<std::uint32_t> age_;
  std::size_t steps_ = 0;
  std::vector<double> unbias_mean_, unbias_square_;  ///< by age before the step
};

}  // namespace burin

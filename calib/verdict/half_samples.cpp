#include "burin/calib/verdict/half_samples.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "burin/calib/geometry/information.h"

namespace burin {
namespace {

// Square root of chi-square's upper 0.1 % point divided by its degrees of freedom (Wilson and Hilferty, PNAS 17, 1931).
double chance_limit(double degrees) {
  constexpr double kNormal999 = 3.0902;
  const double k = 2.0 / (9.0 * degrees);
  return std::pow(1 - k + kNormal999 * std::sqrt(k), 1.5);
}

}  // namespace

HalfSamples half_samples(const EquationsInParts& e) {
  HalfSamples out;
  Eigen::MatrixXd H = e.prior;
  for (const Eigen::MatrixXd& part : e.information) H += part;
  out.inverse = inverse_information(H);
  if (e.pairs.size() < 2) return out;
  for (const auto& [first, second] : e.pairs)
    out.pair_information.emplace_back(e.information[first] + e.information[second]);

  std::vector<bool> paired(e.information.size(), false);
  for (const auto& [first, second] : e.pairs) paired[first] = paired[second] = true;
  // A parameter without information in one half (a lamp that it does not show) is unknown there, not fixed.
  Eigen::MatrixXd H_both = e.prior;
  H_both.diagonal() += 1e-10 * H.diagonal();
  Eigen::VectorXd g_both = e.prior_gradient;
  for (std::size_t k = 0; k < paired.size(); ++k)
    if (!paired[k]) {
      H_both += e.information[k];
      g_both += e.gradient[k];
    }
  // Sylvester's Hadamard matrix: entry (row, column) is -1 to the power of the number of common ones in binary. Column
  // 0 is all ones, so pair p uses column p + 1. There are more rows than pairs.
  const unsigned rows = std::bit_ceil(e.pairs.size() + 1);
  for (unsigned row = 0; row < rows; ++row) {
    Eigen::MatrixXd H_a = H_both, H_b = H_both;
    Eigen::VectorXd g_a = g_both, g_b = g_both;
    for (std::size_t p = 0; p < e.pairs.size(); ++p) {
      auto [a, b] = e.pairs[p];
      if (std::popcount(row & static_cast<unsigned>(p + 1)) % 2 != 0) std::swap(a, b);
      H_a += e.information[a];
      g_a += e.gradient[a];
      H_b += e.information[b];
      g_b += e.gradient[b];
    }
    HalfSamples::Split split;
    split.inverse_a = inverse_information(H_a);
    split.inverse_b = inverse_information(H_b);
    split.step_a = -(split.inverse_a * g_a);
    split.step_b = -(split.inverse_b * g_b);
    out.splits.push_back(std::move(split));
  }
  return out;
}

HalvesVerdict compare_halves(const HalfSamples& halves, const Eigen::VectorXd& a, double sigma) {
  HalvesVerdict out;
  const double whole = a.dot(halves.inverse * a);
  if (halves.splits.empty() || !(whole > 0) || !(sigma > 0)) return out;
  double sum = 0;
  for (const HalfSamples::Split& split : halves.splits) {
    const double variance_a = a.dot(split.inverse_a * a), variance_b = a.dot(split.inverse_b * a);
    const double expected = sigma * std::sqrt((variance_a + variance_b) / whole);
    sum += std::pow(a.dot(split.step_a - split.step_b) / expected, 2);
    out.half_to_whole = std::max(out.half_to_whole, std::sqrt(std::max(variance_a, variance_b) / whole));
  }
  const Eigen::VectorXd weights = halves.inverse * a;
  double share = 0, share2 = 0;
  for (const Eigen::MatrixXd& pair : halves.pair_information) {
    const double v = weights.dot(pair * weights);
    share += v;
    share2 += v * v;
  }
  out.degrees = share2 > 0 ? share * share / share2 : 1;
  out.ratio = std::sqrt(sum / static_cast<double>(halves.splits.size()));
  out.limit = chance_limit(out.degrees);
  return out;
}

std::vector<std::pair<std::size_t, std::size_t>> pair_neighbors(const std::vector<double>& key,
                                                                const std::vector<std::size_t>& group) {
  std::vector<std::size_t> order(key.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return group[a] != group[b] ? group[a] < group[b] : key[a] < key[b];
  });
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t i = 0; i + 1 < order.size();) {
    if (group[order[i]] != group[order[i + 1]]) {
      ++i;
      continue;
    }
    pairs.emplace_back(order[i], order[i + 1]);
    i += 2;
  }
  return pairs;
}

}  // namespace burin

#include "burin/optimize/wall/wall_shares.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <string>

#include "burin/base/files/decimals.h"

namespace burin {
namespace {

// The last digits of exp() and log() differ between systems; a wall must not.
double six_digits(double value) { return std::strtod(general(value, 6).c_str(), nullptr); }

struct Limits {
  double least = 0, most = 0;
};

Limits limits_of_trials(const std::vector<PreviewTrial>& trials) {
  Limits limits{trials.front().scratches, trials.front().scratches};
  for (const PreviewTrial& t : trials) {
    limits.least = std::min(limits.least, t.scratches);
    limits.most = std::max(limits.most, t.scratches);
  }
  return limits;
}

// Numbers at which one unit of cost more lowers each board's error by `price`.
std::vector<double> counts_at(double price, const std::vector<ErrorCurve>& curves, const std::vector<Limits>& limits,
                              const std::vector<double>& cost) {
  std::vector<double> counts;
  for (std::size_t b = 0; b < curves.size(); ++b)
    counts.push_back(std::clamp(std::sqrt(curves[b].a / (price * cost[b])), limits[b].least, limits[b].most));
  return counts;
}

std::vector<int> shares_at(const std::vector<BoardPreview>& boards, const std::vector<double>& cost, double total) {
  std::vector<ErrorCurve> curves;
  std::vector<Limits> limits;
  for (const BoardPreview& board : boards) {
    curves.push_back(error_curve(board.trials));
    limits.push_back(limits_of_trials(board.trials));
  }
  const auto spent = [&](double price) {
    const std::vector<double> counts = counts_at(price, curves, limits, cost);
    return std::inner_product(counts.begin(), counts.end(), cost.begin(), 0.0);
  };
  double low = -200, high = 200;  // natural logarithms of the price
  constexpr int kHalvings = 100;  // to the last bit
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = (low + high) / 2;
    (spent(std::exp(middle)) > total ? low : high) = middle;
  }
  std::vector<int> counts;
  for (const double n : counts_at(std::exp(high), curves, limits, cost))
    counts.push_back(static_cast<int>(std::floor(n + 1e-6)));
  return counts;
}

}  // namespace

std::vector<double> common_exposures(const std::vector<BoardPreview>& boards) {
  std::vector<double> out(boards.front().views.size());
  for (std::size_t k = 0; k < out.size(); ++k) {
    double weights = 0, sum = 0;
    for (const BoardPreview& board : boards) {
      const ViewPreview& v = board.views[k];
      if (!(v.stiffness > 0 && v.best_exposure > 0)) continue;
      weights += v.stiffness;
      sum += v.stiffness * std::log(v.best_exposure);
    }
    out[k] = weights > 0 ? six_digits(std::exp(sum / weights)) : 0;
  }
  return out;
}

ErrorCurve error_curve(const std::vector<PreviewTrial>& trials) {
  double x = 0, y = 0, xx = 0, xy = 0;
  const auto n = static_cast<double>(trials.size());
  for (const PreviewTrial& t : trials) {
    x += 1 / t.scratches / n;
    y += t.error / n;
  }
  for (const PreviewTrial& t : trials) {
    xx += std::pow(1 / t.scratches - x, 2);
    xy += (1 / t.scratches - x) * (t.error - y);
  }
  const double a = xx > 0 ? std::max(0.0, xy / xx) : 0;
  return {y - a * x, a};
}

std::vector<int> shared_scratches(const std::vector<BoardPreview>& boards, double total) {
  return shares_at(boards, std::vector<double>(boards.size(), 1.0), total);
}

std::vector<int> shared_hours(const std::vector<BoardPreview>& boards, double total_s) {
  std::vector<double> cost;
  for (const BoardPreview& board : boards) {
    const PreviewTrial& most = board.trials.back();
    cost.push_back(std::max(1e-6, most.carve_s / most.scratches));
  }
  return shares_at(boards, cost, total_s);
}

}  // namespace burin

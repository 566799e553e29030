#include "burin/capture/bracket_response.h"

#include <tbb/parallel_for.h>

#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/base/median.h"
#include "burin/capture/photo.h"

namespace burin {
namespace {

constexpr int kMostCurve = 2 + static_cast<int>(Response::kBumps);
constexpr double kExposureSigma = 0.01, kBalanceSigma = 0.02;  // sigmas of the priors of e and w
constexpr double kDarkest = 0.02, kBrightest = 0.96;           // range of compared stored values
constexpr double kOtherError = 0.005;                          // error of a logarithm
// JPEG, demosaicing and noise bias one level of brightness alike in all photos. More brackets do not average this error
// away: without it the curve bent until all longer exposures came out 1 % too long.
constexpr double kCommonError = 0.003;

// Blocks of one level of brightness in two exposures.
struct BlockComparison {
  std::size_t bracket = 0;
  int longer = 0, shorter = 0, channel = 0;  // photos: indices into session.photos
  double s_longer = 0, s_shorter = 0;        // stored, plain encoding
  double log_ratio = 0, sigma = 0;
  double alike = 1;  // number of comparisons of these levels, in all brackets and channels
};

// A block of 4 x 4 pixels in the middle of 8 x 8, by channel.
struct PixelBlock {
  std::array<double, 3> mean{}, variance{};  // mean of the 4 x 4; variance of the 8 x 8, relative
};

// None where pixels are clipped or scatter by more than `flat` of their mean.
std::optional<PixelBlock> flat_block(const LinearPhoto& photo, int x0, int y0, double flat) {
  const Image& image = photo.value;
  std::array<double, 3> sum{}, sum2{};
  PixelBlock out;
  for (int y = y0; y < y0 + 8; ++y)
    for (int x = x0; x < x0 + 8; ++x) {
      if (photo.clipped[static_cast<std::size_t>(y) * image.width + x]) return std::nullopt;
      const bool core = x >= x0 + 2 && x < x0 + 6 && y >= y0 + 2 && y < y0 + 6;
      for (int c = 0; c < image.channels; ++c) {
        const double v = image.at(x, y, c);
        sum[c] += v;
        sum2[c] += v * v;
        if (core) out.mean[c] += v / 16;
      }
    }
  for (int c = 0; c < image.channels; ++c) {
    const double m = sum[c] / 64;
    if (!(m > 0)) return std::nullopt;
    out.variance[c] = sum2[c] / (64 * m * m) - 1;
    if (out.variance[c] > flat * flat) return std::nullopt;
  }
  return out;
}

// Stored value of a linear one. Blocks are averaged in linear light, as well as it is known. Noise biases a mean of
// stored values, and in the darkest blocks it is a tenth and more.
double stored_of(double linear, const Photo& photo) {
  return bent(photo.response, photo.encoding == Encoding::srgb ? linear_to_srgb(static_cast<float>(linear)) : linear);
}

// Rounding error of the logarithm of a linear value. In smooth places it is common to all pixels of a level and to all
// photos, so more blocks do not reduce it. Levels with a large error are not compared.
double rounding_error(const StoredAs& stored, double linear) { return 0.29 * linear_step(stored, linear) / linear; }
constexpr double kCoarsest = 0.012;

// Compares the blocks of two exposures, level by level of brightness; each level is one comparison, for any number of
// blocks. The longer exposure alone selects a block, and the level's mean decides if the level is too dark. Otherwise
// the selection would favor blocks that noise made brighter in the shorter exposure.
void compare(const Session& session, std::size_t bracket, int longer, int shorter, const LinearPhoto& a,
             const LinearPhoto& b, std::vector<BlockComparison>& out) {
  constexpr double kFlat = 0.05, kFlatShort = 0.4;  // the latter rejects differences beyond noise
  // Sharpened or denoised noise shifts the stored mean against the light, by a part of its variance.
  constexpr double kOfVariance = 0.5;
  constexpr int kLevels = 48;
  constexpr double kFewestBlocks = 4;
  // Sums over the blocks of a level of brightness.
  struct Level {
    double count = 0, longer = 0, shorter = 0, variance = 0, ratio = 0, ratio2 = 0;
  };
  const int w = a.value.width, h = a.value.height;
  const int stride = std::max(8, static_cast<int>(std::sqrt(1.0 * w * h / 40000)));
  const Photo &photo_a = session.photos[longer], &photo_b = session.photos[shorter];
  const double log_ratio = std::log(exposure_factor(photo_a) / exposure_factor(photo_b));
  std::array<std::array<Level, kLevels>, 3> levels;
  for (int y = 0; y + 8 <= h; y += stride)
    for (int x = 0; x + 8 <= w; x += stride) {
      const std::optional<PixelBlock> in_a = flat_block(a, x, y, kFlat);
      if (!in_a) continue;
      const std::optional<PixelBlock> in_b = flat_block(b, x, y, kFlatShort);
      if (!in_b) continue;
      for (int c = 0; c < a.value.channels; ++c) {
        const double s = stored_of(in_a->mean[c], photo_a);
        if (s < kDarkest || s > kBrightest || !(in_b->mean[c] > 0)) continue;
        Level& level = levels[c][std::min(kLevels - 1, static_cast<int>(s * kLevels))];
        const double ratio = std::log(in_a->mean[c] / in_b->mean[c]);
        level.count += 1;
        level.longer += in_a->mean[c];
        level.shorter += in_b->mean[c];
        level.variance += in_a->variance[c] + in_b->variance[c];
        level.ratio += ratio;
        level.ratio2 += ratio * ratio;
      }
    }
  for (int c = 0; c < a.value.channels; ++c)
    for (const Level& level : levels[c]) {
      const double n = level.count;
      if (n < kFewestBlocks) continue;
      const double in_longer = level.longer / n, in_shorter = level.shorter / n, mean = level.ratio / n,
                   scatter2 = std::max(0.0, level.ratio2 / n - mean * mean), s = stored_of(in_longer, photo_a),
                   t = stored_of(in_shorter, photo_b), error_a = rounding_error(a.stored, in_longer),
                   error_b = rounding_error(b.stored, in_shorter);
      if (error_a > kCoarsest || error_b > kCoarsest || t < kDarkest || t > kBrightest) continue;
      out.push_back({bracket, longer, shorter, c, s, t, log_ratio,
                     std::hypot(std::hypot(kOtherError, kOfVariance * level.variance / n),
                                std::hypot(error_a, error_b) / 2, std::sqrt(scatter2 / n))});
    }
}

void count_alike(std::vector<BlockComparison>& comparisons) {
  constexpr double kApart = 1.0 / 16;  // spacing in stored values
  const auto levels = [](const BlockComparison& c) {
    return std::pair(std::lround(c.s_longer / kApart), std::lround(c.s_shorter / kApart));
  };
  std::map<std::pair<long, long>, double> count;
  for (const BlockComparison& c : comparisons) count[levels(c)] += 1;
  for (BlockComparison& c : comparisons) c.alike = count[levels(c)];
}

std::vector<BlockComparison> comparisons_of(const Session& session, const std::vector<Bracket>& brackets,
                                            const std::vector<std::size_t>& wanted) {
  std::vector<std::vector<BlockComparison>> each(wanted.size());
  tbb::parallel_for(std::size_t{0}, wanted.size(), [&](std::size_t i) {
    std::vector<int> order = brackets[wanted[i]].photos;
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
      return exposure_factor(session.photos[a]) > exposure_factor(session.photos[b]);
    });
    LinearPhoto last = read_photo(session.photos[order[0]]);
    for (std::size_t k = 1; k < order.size(); ++k) {
      LinearPhoto next = read_photo(session.photos[order[k]]);
      constexpr double kLeastRatio = 0.2;  // difference of logarithms: nearly equal exposures do not determine a curve
      const double log_ratio =
          std::log(exposure_factor(session.photos[order[k - 1]]) / exposure_factor(session.photos[order[k]]));
      if (log_ratio > kLeastRatio && last.value.data.size() == next.value.data.size() &&
          session.photos[order[k - 1]].encoding == session.photos[order[k]].encoding)
        compare(session, wanted[i], order[k - 1], order[k], last, next, each[i]);
      last = std::move(next);
    }
  });
  std::vector<BlockComparison> all;
  for (const auto& more : each) all.insert(all.end(), more.begin(), more.end());
  count_alike(all);
  return all;
}

// Logarithm of the linear value of a stored one, its slope by the stored value, and by the curve's parameters.
struct LogLight {
  double value = 0, by_stored = 0;
  std::array<double, kMostCurve> by_curve{};
};

double log_linear(double plain, Encoding encoding) {
  return std::log(encoding == Encoding::srgb ? srgb_to_linear(static_cast<float>(plain)) : plain);
}

LogLight log_light(const Response& response, double stored, Encoding encoding) {
  LogLight out;
  const double plain = unbent(response, stored);
  constexpr double kStep = 1e-3;
  out.value = log_linear(plain, encoding);
  const double by_plain =
      (log_linear(plain * (1 + kStep), encoding) - log_linear(plain * (1 - kStep), encoding)) / (2 * kStep * plain);
  const double by_logit = by_plain * plain * (1 - plain);
  double logit_by_stored = (1 + response.slope) / (stored * (1 - stored));
  out.by_curve[0] = by_logit;
  out.by_curve[1] = by_logit * std::log(stored / (1 - stored));
  for (std::size_t k = 0; k < Response::kBumps; ++k) {
    const double pi_k = static_cast<double>(k + 1) * std::numbers::pi;
    out.by_curve[2 + k] = by_logit * std::sin(pi_k * stored);
    logit_by_stored += response.bumps[k] * pi_k * std::cos(pi_k * stored);
  }
  out.by_stored = by_logit * logit_by_stored;
  return out;
}

// Parameters of a fit: the curve's, then e, w_R, w_B of each photo.
struct Fit {
  Response response;
  Eigen::VectorXd photos;  // 3 per photo
  Eigen::MatrixXd covariance;
  double cost = 0, scatter = 1, error = 0;  // robust cost; residuals' scatter in expected errors; error of a logarithm
  std::vector<double> residual;
};

Response response_of(const Eigen::VectorXd& curve) {
  Response r;
  r.offset = curve[0];
  r.slope = curve[1];
  for (std::size_t k = 0; k < Response::kBumps; ++k) r.bumps[k] = curve[2 + static_cast<Eigen::Index>(k)];
  return r;
}

// Normal equations of the curve's parameters and of three for each compared photo. A photo couples only to the curve
// and to its own bracket, so the cost grows linearly with the photos.
class PhotoEquations {
 public:
  explicit PhotoEquations(std::span<const BlockComparison> comparisons) {
    for (const BlockComparison& c : comparisons) place_[c.longer] = place_[c.shorter] = 0;
    Eigen::Index next = 0;
    for (auto& [photo, place] : place_) place = next++;
  }

  /// Position among the parameters of each compared photo, ascending.
  const std::map<int, Eigen::Index>& places() const { return place_; }
  Eigen::Index at(int photo) const { return kMostCurve + 3 * place_.at(photo); }
  Eigen::Index size() const { return kMostCurve + 3 * static_cast<Eigen::Index>(place_.size()); }

  void clear() { blocks_.clear(); }
  /// weight row row^T; `row` has the curve's slopes, then three of the longer exposure and three of the shorter.
  using Row = Eigen::Matrix<double, kMostCurve + 6, 1>;
  void add(int longer, int shorter, const Row& row, double weight) {
    const auto found = blocks_.try_emplace({longer, shorter}, Block::Zero()).first;
    found->second.noalias() += weight * row * row.transpose();
  }
  /// The matrix with `prior` on the diagonal.
  Eigen::SparseMatrix<double> matrix(const Eigen::VectorXd& prior) const {
    std::vector<Eigen::Triplet<double>> entries;
    for (Eigen::Index i = 0; i < size(); ++i) entries.emplace_back(i, i, prior[i]);
    for (const auto& [pair, block] : blocks_) {
      std::array<Eigen::Index, kMostCurve + 6> to{};
      std::iota(to.begin(), to.begin() + kMostCurve, Eigen::Index{0});
      for (int k = 0; k < 3; ++k) {
        to[kMostCurve + k] = at(pair.first) + k;
        to[kMostCurve + 3 + k] = at(pair.second) + k;
      }
      for (std::size_t i = 0; i < to.size(); ++i)
        for (std::size_t j = 0; j < to.size(); ++j)
          if (to[i] >= to[j])
            entries.emplace_back(to[i], to[j], block(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)));
    }
    Eigen::SparseMatrix<double> A(size(), size());
    A.setFromTriplets(entries.begin(), entries.end());
    return A;
  }

 private:
  using Block = Eigen::Matrix<double, kMostCurve + 6, kMostCurve + 6>;
  std::map<int, Eigen::Index> place_;
  std::map<std::pair<int, int>, Block> blocks_;
};

// Index of w_R or w_B among a photo's three parameters for a channel; -1 for G, which has e alone.
int balance_number(int channel) { return channel == 0 ? 1 : channel == 2 ? 2 : -1; }

// Priors of PhotoEquations for parameters without a comparison.
Eigen::VectorXd prior_weights(Eigen::Index size, int curve_numbers) {
  Eigen::VectorXd prior = Eigen::VectorXd::Ones(size);
  // Real bumps are small: a prior holds bumps that no pair of levels sees. The others get a tiny prior, so that the
  // system is regular without any comparison.
  for (int k = 0; k < curve_numbers; ++k) prior[k] = k < 2 ? 1e-6 : 1 / (0.3 * 0.3);
  for (Eigen::Index i = kMostCurve; i < size; ++i)
    prior[i] = 1 / std::pow((i - kMostCurve) % 3 == 0 ? kExposureSigma : kBalanceSigma, 2);
  return prior;
}

// Least squares with Cauchy's loss from `start`; `curve_numbers` parameters of the curve are free.
Fit fit_photos(std::span<const BlockComparison> comparisons, const Session& session, int curve_numbers,
               const Response& start, double scatter) {
  PhotoEquations equations(comparisons);
  const Eigen::Index size = equations.size();
  Eigen::VectorXd x = Eigen::VectorXd::Zero(size);
  x[0] = start.offset;
  x[1] = start.slope;
  for (std::size_t k = 0; k < Response::kBumps; ++k) x[2 + static_cast<Eigen::Index>(k)] = start.bumps[k];
  const Eigen::VectorXd prior = prior_weights(size, curve_numbers);
  Fit fit;
  constexpr int kRounds = 12;
  constexpr double kCauchy = 3;
  for (int round = 0; round <= kRounds; ++round) {
    const Response response = response_of(x);
    equations.clear();
    Eigen::VectorXd b = Eigen::VectorXd::Zero(size);
    fit.residual.clear();
    fit.cost = 0;
    std::vector<double> absolute, relative;
    for (const BlockComparison& c : comparisons) {
      const Encoding encoding = session.photos[c.longer].encoding;
      const LogLight p = log_light(response, c.s_longer, encoding), q = log_light(response, c.s_shorter, encoding);
      double r = p.value - q.value - c.log_ratio;
      PhotoEquations::Row row = PhotoEquations::Row::Zero();
      for (int k = 0; k < curve_numbers; ++k) row[k] = p.by_curve[k] - q.by_curve[k];
      const Eigen::Index of_longer = equations.at(c.longer), of_shorter = equations.at(c.shorter);
      const int own = balance_number(c.channel);
      for (const int k : {0, own}) {
        if (k < 0) continue;
        row[kMostCurve + k] = -1;
        row[kMostCurve + 3 + k] = 1;
        r += x[of_shorter + k] - x[of_longer + k];
      }
      const double sigma = std::hypot(scatter * c.sigma, kCommonError * std::sqrt(c.alike));
      absolute.push_back(std::abs(r));
      relative.push_back(std::abs(r) / (scatter * c.sigma));
      fit.residual.push_back(r);
      const double z2 = r * r / (sigma * sigma * kCauchy * kCauchy);
      fit.cost += 0.5 * kCauchy * kCauchy * std::log1p(z2);
      const double weight = 1 / (1 + z2) / (sigma * sigma);
      equations.add(c.longer, c.shorter, row, weight);
      b.head(kMostCurve) -= weight * r * row.head(kMostCurve);
      b.segment<3>(of_longer) -= weight * r * row.segment<3>(kMostCurve);
      b.segment<3>(of_shorter) -= weight * r * row.segment<3>(kMostCurve + 3);
    }
    for (Eigen::Index i = 0; i < size; ++i) {
      if (i >= curve_numbers && i < kMostCurve) continue;  // held fixed
      b[i] -= prior[i] * x[i];
      if (i >= kMostCurve) fit.cost += 0.5 * prior[i] * x[i] * x[i];
    }
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(equations.matrix(prior));
    if (round == kRounds) {
      fit.response = response;
      fit.photos = Eigen::VectorXd::Zero(3 * static_cast<Eigen::Index>(session.photos.size()));
      for (const auto& [photo, place] : equations.places())
        fit.photos.segment<3>(3 * static_cast<Eigen::Index>(photo)) = x.segment<3>(equations.at(photo));
      fit.scatter = scatter * median_of(relative) / 0.6745;
      fit.error = 1.4826 * median_of(absolute);
      fit.covariance = solver.solve(Eigen::MatrixXd::Identity(size, kMostCurve)).topRows(kMostCurve);
      break;
    }
    Eigen::VectorXd step = solver.solve(b);
    // Long steps of the curve are cut: its derivatives hold for a part of a logit.
    const double longest = step.head(kMostCurve).cwiseAbs().maxCoeff();
    if (longest > 0.3) step *= 0.3 / longest;
    x += step;
    if (step.cwiseAbs().maxCoeff() < 1e-7) round = kRounds - 1;
  }
  return fit;
}

// Standard deviation, over stored levels, of the curve's change to the logarithm of light, and its sigma.
std::pair<double, double> change_of(const Fit& fit, int curve_numbers, Encoding encoding) {
  constexpr int kLevels = 33;
  Eigen::VectorXd change(kLevels);
  Eigen::MatrixXd by_curve = Eigen::MatrixXd::Zero(kLevels, kMostCurve);
  for (int i = 0; i < kLevels; ++i) {
    const double s = 0.1 + 0.8 * i / (kLevels - 1);
    const LogLight light = log_light(fit.response, s, encoding);
    change[i] = light.value - log_linear(s, encoding);
    for (int k = 0; k < curve_numbers; ++k) by_curve(i, k) = light.by_curve[k];
  }
  change.array() -= change.mean();
  by_curve.rowwise() -= by_curve.colwise().mean().eval();
  const double deviation = std::sqrt(change.squaredNorm() / kLevels);
  if (!(deviation > 0)) return {0, 0};
  const Eigen::VectorXd direction = by_curve.transpose() * change / (kLevels * deviation);
  return {deviation, std::sqrt(std::max(0.0, direction.dot(fit.covariance * direction)))};
}

std::vector<BlockComparison> of_brackets(std::span<const BlockComparison> all,
                                         const std::vector<std::size_t>& brackets) {
  std::vector<BlockComparison> out;
  for (const BlockComparison& c : all)
    if (std::find(brackets.begin(), brackets.end(), c.bracket) != brackets.end()) out.push_back(c);
  return out;
}

// Hold-out cost of each bracket, under the curve of the other half of the brackets.
std::vector<double> foretold(std::span<const BlockComparison> all, const Session& session,
                             const std::vector<std::size_t>& brackets, int curve_numbers, double scatter) {
  std::vector<double> cost(brackets.size());
  for (std::size_t half = 0; half < 2; ++half) {
    std::vector<std::size_t> in, out;
    for (std::size_t i = 0; i < brackets.size(); ++i) (i % 2 == half ? in : out).push_back(brackets[i]);
    const Fit fit = fit_photos(of_brackets(all, in), session, curve_numbers, {}, scatter);
    for (std::size_t i = 0; i < brackets.size(); ++i)
      if (i % 2 != half) cost[i] = fit_photos(of_brackets(all, {brackets[i]}), session, 0, fit.response, scatter).cost;
  }
  return cost;
}

// True if `more` predicts the brackets better than `fewer`, by more than their scatter.
bool is_better(const std::vector<double>& fewer, const std::vector<double>& more) {
  const auto n = static_cast<double>(fewer.size());
  double sum = 0, sum2 = 0;
  for (std::size_t i = 0; i < fewer.size(); ++i) {
    const double gain = fewer[i] - more[i];
    sum += gain;
    sum2 += gain * gain;
  }
  const double mean = sum / n, error = std::sqrt(std::max(0.0, sum2 / n - mean * mean) / std::max(1.0, n - 1));
  // minimum gain of half the sum of squares, as the brackets' mean; in units of its error
  constexpr double kLeastGain = 6, kErrors = 2;
  return mean > kLeastGain && mean > kErrors * error;
}

// Number of curve parameters with evidence in the brackets.
int curve_numbers_asked(std::span<const BlockComparison> all, const Session& session,
                        const std::vector<std::size_t>& brackets, double scatter) {
  if (brackets.size() < 2) {
    const double none = fit_photos(all, session, 0, {}, scatter).cost,
                 two = fit_photos(all, session, 2, {}, scatter).cost;
    return none - two > 50 ? 2 : 0;
  }
  int asked = 0;
  std::vector<double> cost = foretold(all, session, brackets, 0, scatter);
  for (const int more : {2, 3, 4, 5}) {
    const std::vector<double> cost_of_more = foretold(all, session, brackets, more, scatter);
    if (!is_better(cost, cost_of_more)) continue;
    asked = more;
    cost = cost_of_more;
  }
  return asked;
}

// Current knowledge of the curve: the start of fits, and the number of free parameters.
struct Curve {
  Response start{};
  int most_numbers = kMostCurve;
};

// Leaves out brackets whose exposures disagree far beyond shutter errors, and names them.
void drop_contradictions(const Session& session, const std::vector<Bracket>& brackets, const Curve& curve,
                         std::vector<BlockComparison>& all, std::vector<std::size_t>& used, BracketResponse& out) {
  const Fit fit = fit_photos(all, session, std::min(2, curve.most_numbers), curve.start, 1);
  constexpr double kContradicts = 0.12;  // error of a logarithm: beyond any shutter, and beyond a curve common to all
  for (std::size_t i = 0; i < used.size();) {
    // Each pair of exposures is judged by itself: one of three may be right about the other.
    double middle = 0;
    for (const int longer : brackets[used[i]].photos) {
      std::vector<double> off;
      for (std::size_t k = 0; k < all.size(); ++k)
        // includes the part in the photos' own parameters
        if (all[k].bracket == used[i] && all[k].longer == longer)
          off.push_back(fit.residual[k] + fit.photos[3 * all[k].longer] - fit.photos[3 * all[k].shorter]);
      const double here = median_of(off);
      if (std::abs(here) > std::abs(middle)) middle = here;
    }
    if (std::abs(middle) < kContradicts) {
      ++i;
      continue;
    }
    out.findings.push_back(make_warning(
        FindingCode::exif,
        "the exposures of view " + brackets[used[i]].view + " contradict their EXIF by " +
            std::to_string(std::lround(100 * std::expm1(std::abs(middle)))) +
            " %, while other brackets agree: they tell "
            "nothing of the camera's curve",
        "take brackets in manual mode with a camera that stands still, lamp and room unchanged, or correct exposure_s, "
        "iso and f_number in session.json"));
    const std::size_t bad = used[i];
    std::erase_if(all, [&](const BlockComparison& c) { return c.bracket == bad; });
    used.erase(used.begin() + static_cast<std::ptrdiff_t>(i));
    // fit.residual no longer matches `all`: the next look finds further contradictions.
    drop_contradictions(session, brackets, curve, all, used, out);
    return;
  }
}

}  // namespace

BracketResponse bracket_response(const Session& session, bool fit_curve) {
  BracketResponse out;
  const std::vector<Bracket> brackets = brackets_of(session);
  std::vector<std::size_t> with_two;
  for (std::size_t b = 0; b < brackets.size(); ++b)
    if (brackets[b].photos.size() > 1) with_two.push_back(b);
  constexpr std::size_t kFewFirst = 4;
  std::vector<std::size_t> used;
  for (std::size_t i = 0; i < std::min(kFewFirst, with_two.size()); ++i)
    used.push_back(with_two[i * with_two.size() / std::min(kFewFirst, with_two.size())]);
  Session read = session;
  Curve curve;
  if (!fit_curve && !used.empty()) curve = {session.photos[brackets[used.front()].photos.front()].response, 0};
  constexpr int kLooks = 3;  // few brackets, then all, then all with the result
  for (int look = 0; look < kLooks && !used.empty(); ++look) {
    if (fit_curve)
      for (Photo& photo : read.photos) photo.response = out.response;
    out = {};
    std::vector<BlockComparison> all = comparisons_of(read, brackets, used);
    std::erase_if(used, [&](std::size_t b) {
      constexpr long kFewest = 6;
      return std::count_if(all.begin(), all.end(), [&](const BlockComparison& c) { return c.bracket == b; }) < kFewest;
    });
    if (used.empty()) break;
    drop_contradictions(session, brackets, curve, all, used, out);
    out.brackets = used.size();
    if (used.empty()) break;
    // The scatter of blocks comes from the fit with most parameters.
    const double scatter = std::max(0.2, fit_photos(all, session, curve.most_numbers, curve.start, 1).scatter);
    const int numbers = fit_curve ? curve_numbers_asked(all, session, used, scatter) : 0;
    const Fit none = fit_photos(all, session, 0, curve.start, scatter),
              fit = fit_photos(all, session, numbers, curve.start, scatter);
    out.error_before = none.error;
    out.error_after = fit.error;
    const Encoding encoding = session.photos[brackets[used.front()].photos.front()].encoding;
    std::tie(out.change, out.change_sigma) = change_of(fit, numbers, encoding);
    constexpr double kLeastChange = 0.005;  // JPEG and demosaicing leave smaller changes
    const bool bends = numbers > 0 && out.change > kLeastChange && out.change > 4 * out.change_sigma;
    if (bends && !is_monotonic(fit.response))
      out.findings.push_back(make_warning(
          FindingCode::response_curve,
          "the brackets' exposures only fit a response curve that is not monotonic, so no curve is taken from them",
          "the camera changes its pictures from photo to photo (HDR, local tone mapping): switch that off, or use raw "
          "files"));
    else if (bends)
      out.response = fit.response;
    const Fit& kept = bends && !out.response.is_none() ? fit : none;
    double sum2 = 0;
    for (const double v : kept.photos) sum2 += v * v;
    std::size_t photos = 0;
    for (const std::size_t b : used) photos += brackets[b].photos.size();
    constexpr double kLeastBalance = 0.006;  // JPEGs of a camera with a fixed balance reach 0.4 %
    const bool unbalanced = std::sqrt(sum2 / static_cast<double>(3 * photos)) > kLeastBalance;
    if (unbalanced)
      for (std::size_t i = 0; i < session.photos.size(); ++i) {
        const Eigen::Vector3d own = kept.photos.segment<3>(3 * static_cast<Eigen::Index>(i));
        out.balance.emplace_back(std::exp(own[0] + own[1]), std::exp(own[0]), std::exp(own[0] + own[2]));
      }
    if (out.response.is_none() && !unbalanced && out.findings.empty()) break;
    used = with_two;
  }
  return out;
}

}  // namespace burin

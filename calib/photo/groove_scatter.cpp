#include "burin/calib/photo/groove_scatter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <random>
#include <utility>
#include <vector>

#include "burin/scene/carve.h"

namespace burin {
namespace {

constexpr int kKinds = 2;  // log alpha, log depth
using Pair = std::array<std::vector<double>, kKinds>;

// The pieces with grooves exp(step z) times as rough or deep, one number z per groove.
Carved changed(const Carved& pieces, int kind, const std::vector<double>& z, double step) {
  Carved out = pieces;
  std::vector<double>& values = kind == 0 ? out.scratches.alpha : out.scratches.depth_um;
  for (std::size_t i = 0; i < values.size(); ++i) values[i] *= std::exp(step * z[pieces.source[i]]);
  return out;
}

// Sums over all ordered pairs of different halves: of each groove's products, (sum s)^2 - sum s^2.
class Products {
 public:
  explicit Products(std::size_t grooves) : sum_(grooves, 0), squares_(grooves, 0) {}
  void add(const std::vector<double>& half) {
    for (std::size_t g = 0; g < half.size(); ++g) {
      sum_[g] += half[g];
      squares_[g] += half[g] * half[g];
    }
  }
  double of(std::size_t g) const { return sum_[g] * sum_[g] - squares_[g]; }
  double total() const {
    double out = 0;
    for (std::size_t g = 0; g < sum_.size(); ++g) out += of(g);
    return out;
  }

 private:
  std::vector<double> sum_, squares_;
};

}  // namespace

GrooveScatter groove_scatter(const Problem& data, const State& state) {
  const Carved pieces = carved_pieces(data.model, state.of(0));
  const std::size_t grooves = data.model.sent->size();
  std::mt19937_64 random(1);
  std::array<std::vector<double>, kKinds> z;
  for (std::vector<double>& one : z)
    for (std::size_t g = 0; g < grooves; ++g) one.push_back((random() & 1U) != 0 ? 1 : -1);

  std::array<Products, kKinds> scores{Products(grooves), Products(grooves)};
  std::vector<Products> known(static_cast<std::size_t>(kKinds) * kKinds, Products(grooves));  // [of kind][by kind]
  constexpr double kStep = 0.01;
  // For each photo: scores, and the scores that the known differences would cause, by half.
  std::vector<std::vector<Pair>> of_photos(data.photos.size());
  each_photo(data, [&](std::size_t k) {
    const PhotoData& photo = data.photos[k];
    const Unknowns x = state.of(photo.photo.light);
    const Image value = predict(data.model, photo, x, pieces);
    std::array<Image, kKinds> slope;  // J z
    for (int kind = 0; kind < kKinds; ++kind) {
      slope[kind] = predict(data.model, photo, x, changed(pieces, kind, z[kind], kStep));
      const Image less = predict(data.model, photo, x, changed(pieces, kind, z[kind], -kStep));
      for (std::size_t i = 0; i < less.data.size(); ++i)
        slope[kind].data[i] = (slope[kind].data[i] - less.data[i]) / static_cast<float>(2 * kStep);
    }
    const double c2 = data.model.cauchy * data.model.cauchy;
    std::vector<Image> images(static_cast<std::size_t>(2) * (1 + kKinds), Image(value.width, value.height, 1));
    for (int y = 0; y < value.height; ++y)
      for (int px = 0; px < value.width; ++px) {
        const std::size_t i = static_cast<std::size_t>(y) * value.width + px;
        if (!(photo.weight[i] > 0)) continue;
        const double weight = photo.weight[i],
                     r = weight * (photo.photo.value.data[i] - static_cast<double>(value.data[i])), s = r * r / c2;
        Image* of_half = images.data() + static_cast<std::ptrdiff_t>((px + y) & 1) * (1 + kKinds);
        of_half[0].data[i] = static_cast<float>(weight * r / (1 + s));
        const double curvature = weight * weight * (1 - s) / ((1 + s) * (1 + s));  // of the robust loss
        for (int kind = 0; kind < kKinds; ++kind)
          of_half[1 + kind].data[i] = static_cast<float>(curvature * slope[kind].data[i]);
      }
    const std::vector<GrooveGradients> back = groove_gradients(photo, x, pieces, images);
    for (const GrooveGradients& gradients : back) {
      Pair of_groove{std::vector<double>(grooves, 0), std::vector<double>(grooves, 0)};
      for (std::size_t i = 0; i < pieces.source.size(); ++i) {
        of_groove[0][pieces.source[i]] += gradients.by_log_alpha[i];
        of_groove[1][pieces.source[i]] += gradients.by_log_depth[i];
      }
      of_photos[k].push_back(std::move(of_groove));
    }
  });
  for (const std::vector<Pair>& of_photo : of_photos)
    for (std::size_t at = 0; at < of_photo.size(); ++at) {
      const std::size_t what = at % (1 + kKinds);
      for (std::size_t kind = 0; kind < kKinds; ++kind)
        (what == 0 ? scores[kind] : known[kind * kKinds + (what - 1)]).add(of_photo[at][kind]);
    }

  Eigen::Matrix2d M;
  Eigen::Vector2d t;
  for (int p = 0; p < kKinds; ++p) {
    t[p] = scores[p].total();
    for (int q = 0; q < kKinds; ++q) M(p, q) = known[static_cast<std::size_t>(p) * kKinds + q].total();
  }
  GrooveScatter out;
  if (!(M(0, 0) > 0) || !(M(1, 1) > 0) || !(M.determinant() > 0)) return out;
  const Eigen::Matrix2d inverse = M.inverse();
  out.variance = inverse * t;
  if (out.variance.minCoeff() < 0) {  // one of them, or both, are not visible: the other alone explains
    const Eigen::Vector2d alone = t.cwiseQuotient(M.diagonal()).cwiseMax(0);
    out.variance = out.variance[0] < out.variance[1] ? Eigen::Vector2d(0, alone[1]) : Eigen::Vector2d(alone[0], 0);
  }
  // Each groove is a sample of its own.
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (std::size_t g = 0; g < grooves; ++g) {
    Eigen::Vector2d off;
    for (int p = 0; p < kKinds; ++p) {
      off[p] = scores[p].of(g);
      for (int q = 0; q < kKinds; ++q)
        off[p] -= out.variance[q] * known[static_cast<std::size_t>(p) * kKinds + q].of(g);
    }
    sum += (inverse * off).cwiseAbs2();
  }
  out.sigma = sum.cwiseSqrt();
  return out;
}

}  // namespace burin

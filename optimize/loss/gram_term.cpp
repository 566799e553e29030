#include "burin/optimize/loss/gram_term.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "burin/base/machine_clones.h"
#include "burin/optimize/loss/bands.h"

namespace burin {
namespace {

constexpr int kSide = kGramTilePx + 2;  // of a tile with the border of its patches

/// A tile's pixels minus their mean, from one pixel above and left of its first center. The mean does not affect
/// patches without mean, and its removal keeps more digits in float.
struct TilePixels {
  alignas(64) float value[kSide][kSide + 2];
  int width, height;  // of the tile, in centers
};

/// Moments of 3x3 patches; both indices are 3 (dy + 1) + dx + 1.
using Moments = std::array<float, 81>;

BURIN_INLINED void load(const float* corner, int stride, TilePixels& t) {
  float column[kSide] = {};
  for (int r = 0; r < t.height + 2; ++r)
    for (int x = 0; x < t.width + 2; ++x) column[x] += corner[static_cast<std::ptrdiff_t>(r) * stride + x];
  float sum = 0;
  for (int x = 0; x < t.width + 2; ++x) sum += column[x];
  const float mean = sum / static_cast<float>((t.width + 2) * (t.height + 2));
  for (int r = 0; r < t.height + 2; ++r)
    for (int x = 0; x < t.width + 2; ++x) t.value[r][x] = corner[static_cast<std::ptrdiff_t>(r) * stride + x] - mean;
}

BURIN_INLINED float folded(const float* columns) {
  float a[16], b[8], c[4];
  for (int x = 0; x < 16; ++x) a[x] = columns[x] + columns[x + 16];
  for (int x = 0; x < 8; ++x) b[x] = a[x] + a[x + 8];
  for (int x = 0; x < 4; ++x) c[x] = b[x] + b[x + 4];
  return (c[0] + c[2]) + (c[1] + c[3]);
}

/// M over n. The moment of two places of the patch is a sum of products of pixels at one offset. The sum covers a
/// window that moves with the first place. One sum per offset and column is computed; for the window's next rows the
/// entering products are added and the leaving ones subtracted. `kWidth` is the tile's width, or 0 if it is narrower
/// than kGramTilePx.
template <int kWidth>
BURIN_INLINED void moments_of(const TilePixels& t, Moments& moments) {
  static_assert(kGramTilePx == 32);
  const int w = kWidth > 0 ? kWidth : t.width, h = t.height;
  const float scale = 1 / static_cast<float>(w * h);
  for (int oy = 0; oy <= 2; ++oy) {
    for (int ox = oy > 0 ? -2 : 0; ox <= 2; ++ox) {
      for (int dx = std::max(0, -ox); dx <= std::min(2, 2 - ox); ++dx) {
        float sum[32] = {};
        for (int r = 0; r < h; ++r) {
          const float *a = &t.value[r][dx], *b = &t.value[r + oy][dx + ox];
          for (int x = 0; x < w; ++x) sum[x] += a[x] * b[x];
        }
        for (int dy = 0; dy + oy <= 2; ++dy) {
          if (dy > 0) {
            const float *a = &t.value[dy - 1][dx], *b = &t.value[dy - 1 + oy][dx + ox];
            const float *c = &t.value[dy - 1 + h][dx], *d = &t.value[dy - 1 + h + oy][dx + ox];
            for (int x = 0; x < w; ++x) sum[x] += c[x] * d[x] - a[x] * b[x];
          }
          const int i = 3 * dy + dx, j = 3 * (dy + oy) + dx + ox;
          moments[9 * i + j] = moments[9 * j + i] = scale * folded(sum);
        }
      }
    }
  }
}

/// P M P: subtracts the means of rows and columns.
BURIN_INLINED void project(Moments& m) {
  for (int pass = 0; pass < 2; ++pass) {
    const int along = pass == 0 ? 1 : 9, across = pass == 0 ? 9 : 1;
    for (int i = 0; i < 9; ++i) {
      float mean = 0;
      for (int k = 0; k < 9; ++k) mean += m[i * across + k * along];
      mean /= 9;
      for (int k = 0; k < 9; ++k) m[i * across + k * along] -= mean;
    }
  }
}

BURIN_MACHINE_CLONES void projected_moments(const float* corner, int stride, TilePixels& t, Moments& moments) {
  load(corner, stride, t);
  if (t.width == kGramTilePx)
    moments_of<kGramTilePx>(t, moments);
  else
    moments_of<0>(t, moments);
  project(moments);
}

/// Adds the sum over the tile's patches p of A p, each at the pixels of p, to `gradient` (its corner as load()'s).
/// Patches at the same place of their rows share their pixels: a 5x3 filter results for each column of a patch.
template <int kWidth>
BURIN_INLINED void scatter(const TilePixels& t, const Moments& A, int stride, float* gradient) {
  const int w = kWidth > 0 ? kWidth : t.width, h = t.height;
  float filter[3][5][3];  // index: the patch's column of the pixel; row and column of another pixel, from this row - 2
  int first_before = -1, end_before = -1;
  for (int r = 0; r < h + 2; ++r) {
    // Rows of the patch that can contain this row of pixels: the patch's center is within the tile.
    const int first = std::max(0, r - h + 1), end = std::min(2, r) + 1;
    if (first != first_before || end != end_before) {
      first_before = first;
      end_before = end;
      for (int dx = 0; dx < 3; ++dx)
        for (int oy = -2; oy <= 2; ++oy)
          for (int x = 0; x < 3; ++x) {
            float sum = 0;
            for (int dy = std::max(first, -oy); dy < std::min(end, 3 - oy); ++dy)
              sum += A[9 * (3 * dy + dx) + 3 * (dy + oy) + x];
            filter[dx][oy + 2][x] = sum;
          }
    }
    // Rows beyond the pixels have weight 0; any existing row can replace them.
    const float* row[5];
    for (int k = 0; k < 5; ++k) row[k] = t.value[std::clamp(r + k - 2, 0, h + 1)];
    for (int dx = 0; dx < 3; ++dx) {
      const auto& f = filter[dx];
      float* to = gradient + static_cast<std::ptrdiff_t>(r) * stride + dx;
      for (int x = 0; x < w; ++x) {
        float sum = 0;
        for (int k = 0; k < 5; ++k) sum += f[k][0] * row[k][x] + f[k][1] * row[k][x + 1] + f[k][2] * row[k][x + 2];
        to[x] += sum;
      }
    }
  }
}

BURIN_MACHINE_CLONES void add_patch_gradient(const TilePixels& t, const Moments& A, int stride, float* gradient) {
  if (t.width == kGramTilePx)
    scatter<kGramTilePx>(t, A, stride, gradient);
  else
    scatter<0>(t, A, stride, gradient);
}

/// Means of 2x2 pixels without an odd last row or column.
BURIN_MACHINE_CLONES void halve_row(const float* a, const float* b, int width, float* out) {
  for (int x = 0; x < width; ++x) out[x] = 0.25F * (a[2 * x] + a[2 * x + 1] + b[2 * x] + b[2 * x + 1]);
}

BURIN_MACHINE_CLONES void add_quarters_row(const float* d_half, int width, float* d_full) {
  for (int x = 0; x < width; ++x) {
    const float q = 0.25F * d_half[x];
    d_full[2 * x] += q;
    d_full[2 * x + 1] += q;
  }
}

void halve(const Image& in, Image& out) {
  for_bands(out.height, [&](int first, int end) {
    for (int y = first; y < end; ++y) {
      const float* a = &in.data[static_cast<std::size_t>(2) * y * in.width];
      halve_row(a, a + in.width, out.width, &out.data[static_cast<std::size_t>(y) * out.width]);
    }
  });
}

void add_halve_adjoint(const Image& d_half, Image& d_full) {
  for_bands(d_half.height, [&](int first, int end) {
    for (int y = first; y < end; ++y)
      for (const int below : {0, 1})
        add_quarters_row(&d_half.data[static_cast<std::size_t>(y) * d_half.width], d_half.width,
                         &d_full.data[(static_cast<std::size_t>(2) * y + below) * d_full.width]);
  });
}

std::size_t corner_of(const Image& image, int x0, int y0) {
  return static_cast<std::size_t>(y0 - 1) * image.width + x0 - 1;
}

}  // namespace

GramTerm::GramTerm(const Image& target) {
  int w = target.width, h = target.height;
  for (int s = 0; s < kGramScales && w >= 3 && h >= 3; ++s, w /= 2, h /= 2) {
    Scale& scale = scales_.emplace_back();
    if (s > 0) scale.picture = scale.gradient = Image(w, h, 1);
    for (int y = 0; y < h; y += kGramTilePx) {
      std::vector<Tile> row;
      for (int x = 0; x < w; x += kGramTilePx) {
        const Tile t{
            std::max(1, x), std::max(1, y), std::min(w - 1, x + kGramTilePx), std::min(h - 1, y + kGramTilePx), {}, 0};
        if (t.x1 > t.x0 && t.y1 > t.y0) row.push_back(t);
      }
      if (!row.empty()) scale.rows.push_back(std::move(row));
    }
  }
  shrink(target);
  for (std::size_t s = 0; s < scales_.size(); ++s) {
    const Image& image = s == 0 ? target : scales_[s].picture;
    for (std::vector<Tile>& row : scales_[s].rows)
      for (Tile& t : row) {
        TilePixels pixels;
        pixels.width = t.x1 - t.x0;
        pixels.height = t.y1 - t.y0;
        projected_moments(&image.data[corner_of(image, t.x0, t.y0)], image.width, pixels, t.target);
      }
  }
}

void GramTerm::shrink(const Image& picture) {
  for (std::size_t s = 1; s < scales_.size(); ++s) halve(s == 1 ? picture : scales_[s - 1].picture, scales_[s].picture);
}

double GramTerm::add(const Image& picture, double weight, Image& gradient) {
  shrink(picture);
  double sum = 0;
  double area = kGramUnit;  // kGramUnit 4^s
  for (std::size_t s = 0; s < scales_.size(); ++s, area *= 4) {
    Scale& scale = scales_[s];
    const Image& seen = s == 0 ? picture : scale.picture;
    Image& d_seen = s == 0 ? gradient : scale.gradient;
    if (s > 0) std::fill(d_seen.data.begin(), d_seen.data.end(), 0.0F);
    // Tiles overlap at their edges, so even and odd rows of tiles run in turn; one thread processes a row.
    for (const int parity : {0, 1}) {
      const int count = (static_cast<int>(scale.rows.size()) + 1 - parity) / 2;
      tbb::parallel_for(0, count, [&](int k) {
        for (Tile& t : scale.rows[2 * k + parity]) {
          TilePixels pixels;
          pixels.width = t.x1 - t.x0;
          pixels.height = t.y1 - t.y0;
          const std::size_t corner = corner_of(seen, t.x0, t.y0);
          Moments excess;
          projected_moments(&seen.data[corner], seen.width, pixels, excess);
          double square = 0;
          for (int i = 0; i < 81; ++i) {
            excess[i] -= t.target[i];
            square += static_cast<double>(excess[i]) * excess[i];
          }
          t.part = area * pixels.width * pixels.height * square;
          const auto slope = static_cast<float>(4 * area * weight);
          for (float& e : excess) e *= slope;
          add_patch_gradient(pixels, excess, d_seen.width, &d_seen.data[corner]);
        }
      });
    }
    for (const std::vector<Tile>& row : scale.rows)
      for (const Tile& t : row) sum += t.part;
  }
  for (std::size_t s = scales_.size(); s-- > 1;)
    add_halve_adjoint(scales_[s].gradient, s == 1 ? gradient : scales_[s - 1].gradient);
  return sum;
}

}  // namespace burin

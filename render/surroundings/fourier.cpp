#include "burin/render/surroundings/fourier.h"

#include <cmath>
#include <numbers>
#include <utility>

namespace burin {

FourierTurns fourier_turns(std::size_t n) {
  FourierTurns turns(n / 2);
  for (std::size_t k = 0; k < turns.size(); ++k) {
    const double angle = -2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n);
    turns[k] = {static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle))};
  }
  return turns;
}

void fourier(std::vector<std::complex<float>>& ring, const FourierTurns& turns, bool back) {
  const std::size_t n = ring.size();
  for (std::size_t i = 1, j = 0; i < n; ++i) {  // bit reversal
    std::size_t bit = n >> 1;
    for (; j & bit; bit >>= 1) j ^= bit;
    j ^= bit;
    if (i < j) std::swap(ring[i], ring[j]);
  }
  for (std::size_t length = 2; length <= n; length *= 2) {
    const std::size_t stride = n / length;
    for (std::size_t start = 0; start < n; start += length)
      for (std::size_t k = 0; k < length / 2; ++k) {
        const float cosine = turns[k * stride].real(),
                    sine = back ? -turns[k * stride].imag() : turns[k * stride].imag();
        const std::complex<float> a = ring[start + k], b = ring[start + k + length / 2];
        const std::complex<float> c(b.real() * cosine - b.imag() * sine, b.real() * sine + b.imag() * cosine);
        ring[start + k] = a + c;
        ring[start + k + length / 2] = a - c;
      }
  }
}

}  // namespace burin

#include "burin/render/surroundings/fourier.h"

#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

namespace burin {

void fourier(std::vector<std::complex<float>>& ring, bool back) {
  const std::size_t n = ring.size();
  for (std::size_t i = 1, j = 0; i < n; ++i) {  // bits in reverse
    std::size_t bit = n >> 1;
    for (; j & bit; bit >>= 1) j ^= bit;
    j ^= bit;
    if (i < j) std::swap(ring[i], ring[j]);
  }
  for (std::size_t length = 2; length <= n; length *= 2) {
    const double angle = (back ? 2 : -2) * std::numbers::pi / static_cast<double>(length);
    for (std::size_t k = 0; k < length / 2; ++k) {
      const std::complex<float> turn(static_cast<float>(std::cos(angle * static_cast<double>(k))),
                                     static_cast<float>(std::sin(angle * static_cast<double>(k))));
      for (std::size_t i = k; i < n; i += length) {
        const std::complex<float> a = ring[i], b = ring[i + length / 2];
        const std::complex<float> c(b.real() * turn.real() - b.imag() * turn.imag(),
                                    b.real() * turn.imag() + b.imag() * turn.real());
        ring[i] = a + c;
        ring[i + length / 2] = a - c;
      }
    }
  }
}

}  // namespace burin

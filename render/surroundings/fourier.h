// burin/render/surroundings/fourier.h - the discrete Fourier transform of a ring of values.
#pragma once

#include <complex>
#include <cstddef>
#include <vector>

namespace burin {

/// exp(-2 pi i k / n) for k = 0 .. n / 2 - 1, common to all transforms of n values.
using FourierTurns = std::vector<std::complex<float>>;
FourierTurns fourier_turns(std::size_t n);

/// In place, unnormalized: out[m] = sum over j of in[j] exp(-2 pi i j m / n). `back` conjugates the factors. n is a
/// power of two, `turns` those of n. (Cooley and Tukey, Math. Comp. 19, 1965.)
void fourier(std::vector<std::complex<float>>& ring, const FourierTurns& turns, bool back);

}  // namespace burin

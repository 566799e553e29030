// burin/render/surroundings/fourier.h - the discrete Fourier transform of a ring of values.
#pragma once

#include <complex>
#include <vector>

namespace burin {

/// In place, unnormalized: out[m] = sum over j of in[j] exp(-2 pi i j m / n); with `back` the conjugate of it. n is a
/// power of two. (Cooley and Tukey, Math. Comp. 19, 1965.)
void fourier(std::vector<std::complex<float>>& ring, bool back);

}  // namespace burin

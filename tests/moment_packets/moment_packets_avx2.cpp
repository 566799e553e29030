// Compiled for AVX2 and FMA (CMakeLists.txt beside it), and called only where the machine has them.
#include "tests/moment_packets/moment_packets_kernel.h"

namespace burin::footprint {

#if defined(__AVX2__) && defined(__FMA__)
PacketKernels avx2_kernels() { return detail::kernels_of<xsimd::fma3<xsimd::avx2>>(); }
#else
PacketKernels avx2_kernels() { return {}; }
#endif

}  // namespace burin::footprint

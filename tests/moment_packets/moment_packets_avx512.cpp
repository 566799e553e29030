// Compiled for AVX-512 F, CD, DQ, BW (CMakeLists.txt beside it), and called only where the machine has them.
#include "tests/moment_packets/moment_packets_kernel.h"

namespace burin::footprint {

#if defined(__AVX512F__) && defined(__AVX512DQ__) && defined(__AVX512BW__)
PacketKernels avx512_kernels() { return detail::kernels_of<xsimd::avx512bw>(); }
#else
PacketKernels avx512_kernels() { return {}; }
#endif

}  // namespace burin::footprint

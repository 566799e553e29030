#include "render/pair_batch_impl.h"

namespace burin::batch {

void evaluate_avx512(PairBatch& b, BatchMode mode) { Kernel<xsimd::batch<float, xsimd::avx512bw>>::dispatch(b, mode); }

int lanes_avx512() { return Kernel<xsimd::batch<float, xsimd::avx512bw>>::kLanes; }

}  // namespace burin::batch

#include "render/pair_batch_impl.h"

namespace burin::batch {

void evaluate_avx2(PairBatch& b, BatchMode mode) {
  Kernel<xsimd::batch<float, xsimd::fma3<xsimd::avx2>>>::dispatch(b, mode);
}

int lanes_avx2() { return Kernel<xsimd::batch<float, xsimd::fma3<xsimd::avx2>>>::kLanes; }

}  // namespace burin::batch

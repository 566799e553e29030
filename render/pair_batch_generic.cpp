#include "render/pair_batch_impl.h"

namespace burin::batch {

void evaluate_generic(PairBatch& b, BatchMode mode) { Kernel<xsimd::batch<float>>::dispatch(b, mode); }

int lanes_generic() { return Kernel<xsimd::batch<float>>::kLanes; }

}  // namespace burin::batch

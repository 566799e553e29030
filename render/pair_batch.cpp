#include "render/pair_batch.h"

#include "render/error.h"

namespace burin {

// One a file of its own instruction set; BURIN_X86_KERNELS where the build has the x86 ones.
namespace batch {
void evaluate_generic(PairBatch& b, BatchMode mode);
int lanes_generic();
#ifdef BURIN_X86_KERNELS
void evaluate_avx2(PairBatch& b, BatchMode mode);
int lanes_avx2();
void evaluate_avx512(PairBatch& b, BatchMode mode);
int lanes_avx512();
#endif
}  // namespace batch

namespace {

SimdWidth resolved(SimdWidth width) {
  if (width != SimdWidth::best) return width;
  if (has_kernel(SimdWidth::avx512)) return SimdWidth::avx512;
  if (has_kernel(SimdWidth::avx2)) return SimdWidth::avx2;
  return SimdWidth::generic;
}

}  // namespace

bool has_kernel(SimdWidth width) {
  switch (width) {
    case SimdWidth::best:
    case SimdWidth::generic:
      return true;
#ifdef BURIN_X86_KERNELS
    case SimdWidth::avx2:
      return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    case SimdWidth::avx512:
      return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512cd") &&
             __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw");
#endif
    default:
      return false;
  }
}

BatchKernel batch_kernel(SimdWidth width) {
  if (!has_kernel(width))
    fail("RenderOptions::simd", "this machine or this build has no such packets", "leave it at SimdWidth::best");
  switch (resolved(width)) {
#ifdef BURIN_X86_KERNELS
    case SimdWidth::avx2:
      return batch::evaluate_avx2;
    case SimdWidth::avx512:
      return batch::evaluate_avx512;
#endif
    default:
      return batch::evaluate_generic;
  }
}

int kernel_lanes(SimdWidth width) {
  switch (resolved(width)) {
#ifdef BURIN_X86_KERNELS
    case SimdWidth::avx2:
      return batch::lanes_avx2();
    case SimdWidth::avx512:
      return batch::lanes_avx512();
#endif
    default:
      return batch::lanes_generic();
  }
}

}  // namespace burin

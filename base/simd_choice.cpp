#include "burin/base/simd_choice.h"

namespace burin {
namespace {

// Throws Error for a width that does not run here.
SimdWidth that_runs(SimdWidth width) {
  if (width != SimdWidth::best) resolved_simd(width);
  return width;
}

}  // namespace

SimdChoice::SimdChoice(SimdWidth width) : before_(replace_best(that_runs(width))) {}

SimdChoice::~SimdChoice() { replace_best(before_); }

std::optional<SimdWidth> simd_named(std::string_view wanted) {
  for (const SimdWidth width : {SimdWidth::generic, SimdWidth::avx2, SimdWidth::avx512})
    if (wanted == name(width)) return width;
  return std::nullopt;
}

}  // namespace burin

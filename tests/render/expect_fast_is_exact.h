// What the fast path promises.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "tests/render/small_world.h"

namespace burin {

/// Image within 1e-6 of its peak and gradients within 1e-4, both RMS, for the packets of one width.
inline void expect_fast_is_exact(const World& w, int channels, SimdWidth simd, const std::string& what) {
  const FastErrors errors = fast_errors(w, channels, simd);
  EXPECT_TRUE(errors.same_pairs) << what;
  EXPECT_LT(errors.image, 1e-6) << what;
  EXPECT_LT(errors.value_only, 1e-6) << what;
  for (const auto& [name, error] : errors.gradients) EXPECT_LT(error, 1e-4) << what << ", " << name;
  EXPECT_LT(errors.base_alpha, 1e-4) << what;
  EXPECT_LT(errors.contributions, 1e-5) << what;
}

}  // namespace burin

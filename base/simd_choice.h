// burin/base/simd_choice.h - the same width of the float kernels on several machines. Widths differ in the last bits
// of a picture, and after a thousand iterations in every scratch of a design: the same design on two machines needs the
// same width on both.
#pragma once

#include <optional>
#include <string_view>

#include "burin/base/simd_width.h"

namespace burin {

/// While it lives, `best` is this width everywhere in the process; of several, the one made last. Throws Error for a
/// width that does not run here.
class SimdChoice {
 public:
  explicit SimdChoice(SimdWidth width);
  ~SimdChoice();
  SimdChoice(const SimdChoice&) = delete;
  SimdChoice& operator=(const SimdChoice&) = delete;

 private:
  SimdWidth before_;
};

/// The width of a name that name() gives on this kind of processor; none for other words.
std::optional<SimdWidth> simd_named(std::string_view name);

}  // namespace burin

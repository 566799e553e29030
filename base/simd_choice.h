// burin/base/simd_choice.h - one SIMD width of the float kernels on several machines. Widths differ in the last bits of
// a picture, and after a thousand iterations in every scratch of a design. Two machines make identical designs only
// with the same width.
#pragma once

#include <optional>
#include <string_view>

#include "burin/base/simd_width.h"

namespace burin {

/// During its lifetime, `best` is this width everywhere in the process; the latest object counts. Throws Error for a
/// width that does not run here.
class SimdChoice {
 public:
  /// Uses this width until destruction.
  explicit SimdChoice(SimdWidth width);
  ~SimdChoice();
  SimdChoice(const SimdChoice&) = delete;
  SimdChoice& operator=(const SimdChoice&) = delete;

 private:
  SimdWidth before_;
};

/// The width with a name() on this kind of processor; nothing for other words.
std::optional<SimdWidth> simd_named(std::string_view name);

}  // namespace burin

#include "tools/automatic_exposure.h"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <vector>

namespace burin {

std::optional<double> automatic_exposure(const Image& radiance) {
  std::vector<float> lit;
  std::copy_if(radiance.data.begin(), radiance.data.end(), std::back_inserter(lit), [](float v) { return v > 0; });
  if (lit.empty()) return std::nullopt;
  const auto at = lit.begin() + static_cast<std::ptrdiff_t>(0.995 * static_cast<double>(lit.size() - 1));
  std::nth_element(lit.begin(), at, lit.end());
  return 1 / static_cast<double>(*at);
}

}  // namespace burin

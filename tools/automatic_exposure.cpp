#include "tools/automatic_exposure.h"

#include <algorithm>
#include <iterator>
#include <vector>

#include "burin/base/median.h"

namespace burin {

std::optional<double> automatic_exposure(const Image& radiance) {
  std::vector<float> lit;
  std::copy_if(radiance.data.begin(), radiance.data.end(), std::back_inserter(lit), [](float v) { return v > 0; });
  if (lit.empty()) return std::nullopt;
  return 1 / static_cast<double>(quantile_in_place(lit, 0.995));
}

}  // namespace burin

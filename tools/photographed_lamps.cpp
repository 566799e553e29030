#include "tools/photographed_lamps.h"

#include <algorithm>

namespace burin {

std::vector<std::string> photographed_lamps(const DesignView& view, const Bench& bench) {
  std::vector<std::string> out;
  for (const std::string& id : light_names(view.light))
    if (find_light(bench, id, "the design").is_near()) out.push_back(id);
  if (out.empty()) out.push_back(view.light);
  return out;
}

std::vector<std::string> photographed_lamps(const DesignSpec& design, const Bench& bench) {
  std::vector<std::string> out;
  for (const DesignView& view : design.views)
    for (const std::string& id : photographed_lamps(view, bench))
      if (std::find(out.begin(), out.end(), id) == out.end()) out.push_back(id);
  return out;
}

std::vector<std::string> lamps_of(const Bench& bench) {
  std::vector<std::string> out;
  for (const Light& light : bench.lights)
    if (light.is_near()) out.push_back(light.id);
  return out;
}

}  // namespace burin

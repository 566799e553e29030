#include "tools/report/section.h"
namespace burin {
std::optional<Section> design_section(const std::filesystem::path&) { return std::nullopt; }
}  // namespace burin

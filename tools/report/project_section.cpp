#include "tools/report/section.h"
namespace burin {
std::optional<Section> project_section(const std::filesystem::path&, const Progress&) { return std::nullopt; }
}  // namespace burin

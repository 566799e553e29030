#include "tools/project.h"

#include <fmt/format.h>

#include <algorithm>

#include "burin/render/files/input_file.h"
#include "burin/render/files/json_file.h"
#include "burin/render/limits.h"

namespace burin {
std::filesystem::path Project::round(int number) const { return folder / fmt::format("round-{:02}", number); }

std::filesystem::path Project::bench_before(int number) const {
  return (number == 1 ? folder : round(number - 1)) / "bench.json";
}

std::optional<int> Project::pixels(int number) const {
  const std::filesystem::path file = round(number) / "design" / "design-report.json";
  if (!std::filesystem::exists(file)) return std::nullopt;
  // Broken ones are told of by those who need more of them.
  const Json report = Json::parse(read_bytes(file, limit::kJsonBytes, "a JSON file"), nullptr, false);
  if (!report.is_object() || !report.contains("pixels")) return std::nullopt;
  const Json& pixels = report["pixels"];
  if (!pixels.is_array() || pixels.size() != 2 || !pixels[0].is_number_integer() || !pixels[1].is_number_integer())
    return std::nullopt;
  const int side = std::max(pixels[0].get<int>(), pixels[1].get<int>());
  return side > 0 ? std::optional(side) : std::nullopt;
}

int Project::rounds() const {
  int count = 0;
  while (std::filesystem::is_directory(round(count + 1))) ++count;
  return count;
}

int Project::measured() const {
  int count = 0;
  while (std::filesystem::exists(round(count + 1) / "bench.json")) ++count;
  return count;
}

}  // namespace burin

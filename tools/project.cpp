#include "tools/project.h"

#include <fmt/core.h>

namespace burin {
std::filesystem::path Project::round(int number) const { return folder / fmt::format("round-{:02}", number); }

std::filesystem::path Project::bench_before(int number) const {
  return (number == 1 ? folder : round(number - 1)) / "bench.json";
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

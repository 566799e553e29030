#include "tools/project.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <string_view>
#include <system_error>

#include "burin/base/files/input_file.h"
#include "burin/base/files/json_file.h"
#include "burin/base/limits.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

// "round-07" is 7; 0: no round's name.
int number_of_round(const fs::path& name) {
  constexpr std::string_view kRound = "round-";
  const std::string text = name.string();
  int number = 0;
  if (!text.starts_with(kRound)) return 0;
  const char* const end = text.data() + text.size();
  const auto read = std::from_chars(text.data() + kRound.size(), end, number);
  return read.ec == std::errc() && read.ptr == end && Project{{}}.round(number) == name ? number : 0;
}

bool holds_project(const fs::path& folder) {
  std::error_code ignored;
  for (const char* file : {"board.json", "design.json", "bench.json"})
    if (!fs::is_regular_file(folder / file, ignored)) return false;
  return number_of_round(folder.filename()) == 0;  // a round holds the same files
}

// Returns the nearest project above a path, and the number of its round that contains the path.
std::optional<PlaceInProject> project_above(fs::path at) {
  if (!at.has_filename()) at = at.parent_path();  // "round-01/"
  for (fs::path below;; below = at, at = at.parent_path()) {
    if (holds_project(at)) return PlaceInProject{{at}, number_of_round(below.filename())};
    if (at == at.parent_path()) return std::nullopt;
  }
}

}  // namespace

std::optional<PlaceInProject> project_of(const fs::path& path) {
  if (path.empty()) return std::nullopt;
  std::error_code error;
  std::optional<PlaceInProject> found = project_above(fs::absolute(path).lexically_normal());
  if (!found) {
    const fs::path leads_to = fs::weakly_canonical(path, error);
    if (!error) found = project_above(fs::absolute(leads_to));
  }
  if (found && path.is_relative())
    found->project.folder = found->project.folder.lexically_proximate(fs::current_path());
  return found;
}

bool is_in_round(const fs::path& path) {
  const std::optional<PlaceInProject> at = project_of(path);
  return at && at->round > 0;
}

std::filesystem::path Project::round(int number) const { return folder / fmt::format("round-{:02}", number); }

std::filesystem::path Project::bench_before(int number) const {
  return (number == 1 ? folder : round(number - 1)) / "bench.json";
}

std::filesystem::path Project::heights(int number) const {
  const std::filesystem::path file = round(number) / "heights.json";
  return std::filesystem::exists(file) ? file : std::filesystem::path();
}

std::optional<int> Project::pixels(int number) const {
  const std::filesystem::path file = round(number) / "design" / "design-report.json";
  if (!std::filesystem::exists(file)) return std::nullopt;
  // Readers of more fields report a broken file.
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

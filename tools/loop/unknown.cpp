#include "tools/loop/unknown.h"

#include <fmt/core.h>

#include "burin/render/bench.h"
#include "burin/render/parameter_name.h"

namespace burin {
namespace {

bool design_rests_on(const std::string& parameter) {
  return parameter == parameter::kDepth || parameter == parameter::kAlpha || parameter == parameter::kMachine ||
         (parameter.starts_with("light.") && parameter.ends_with(".position_mm"));
}

}  // namespace

std::vector<UnknownParameter> unknown_after(const Project& project, int round) {
  std::vector<UnknownParameter> unknown;
  for (const auto& [name, verdict] : read_bench(project.round(round) / "bench.json").verdict)
    if (design_rests_on(name) && !verdict.known()) unknown.push_back({name, verdict});
  return unknown;
}

std::string in_words(const std::vector<UnknownParameter>& unknown) {
  std::string words;
  for (const UnknownParameter& u : unknown) {
    words += fmt::format("  {} is not determined: {}\n", u.name, sentence(u.verdict));
    if (u.verdict.next_photo)
      words += fmt::format("    next photo: {}\n", sentence(*u.verdict.next_photo, u.verdict.unit));
  }
  return words;
}

}  // namespace burin

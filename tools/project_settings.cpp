#include "tools/project_settings.h"

#include <CLI/Error.hpp>

#include "tools/commands.h"
#include "tools/loop/options.h"

namespace burin {

namespace fs = std::filesystem;

std::optional<ProjectSettings> settings_around(const fs::path& given) {
  std::optional<PlaceInProject> at;
  if (!given.empty()) at = project_of(given);
  if (!at) at = project_of(".");
  if (!at) return std::nullopt;
  const Project& project = at->project;
  const LoopOptions options = read_loop_options(project.folder);
  ProjectSettings out{*at, options.machine.empty() ? "" : machine_argument(options, project.folder), {}, {}, {}, false};
  out.board = project.folder / "board.json";
  out.bench = project.bench_before(at->round > 0 ? at->round : project.measured() + 1);
  if (at->round > 0) out.heights = project.heights(at->round);
  out.follow_bow = options.toolpath.contains("follow-bow");
  return out;
}

fs::path project_folder(const fs::path& given, const std::string& argument) {
  const std::optional<PlaceInProject> at = project_of(given.empty() ? fs::path(".") : given);
  if (given.empty() && !at) throw CLI::RequiredError(argument);
  const bool other = at && !given.empty() && (at->round == 0 || !fs::is_directory(given));
  return !at || other ? given : at->project.folder;
}

void TakenSettings::add(const std::string& option, const std::string& value) {
  words_ += (words_.empty() ? "" : ", ") + option.substr(option.find_first_not_of('-')) +
            (value.empty() ? "" : " " + shell_word(value));
}

void TakenSettings::take(const std::string& option, const std::string& value, std::string& into) {
  if (is_said(option) || value.empty() || value == into) return;
  into = value;
  add(option, value);
}

void TakenSettings::take(const std::string& option, const fs::path& value, fs::path& into) {
  if (is_said(option) || value.empty() || value == into) return;
  into = value;
  add(option, value.lexically_normal().string());  // "board.json" of the project "."
}

void TakenSettings::take(const std::string& option, bool value, bool& into) {
  if (is_said(option) || !value || into) return;
  into = true;
  add(option, "");
}

void TakenSettings::say(const ProjectSettings& settings) const {
  if (words_.empty()) return;
  const fs::path& folder = settings.at.project.folder;
  const bool dots = folder.string().starts_with('.');  // "." and ".." name nothing
  note("from the project " + (dots ? fs::weakly_canonical(folder) : folder).string() + ": " + words_);
}

}  // namespace burin

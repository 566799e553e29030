#include "tools/project_settings.h"

#include <CLI/Error.hpp>
#include <type_traits>

#include "burin/base/files/decimals.h"
#include "burin/base/files/table.h"
#include "tools/commands.h"
#include "tools/loop/options.h"

namespace burin {

namespace fs = std::filesystem;

namespace {

std::optional<PlaceInProject> project_around(const fs::path& given) {
  const std::optional<PlaceInProject> at = given.empty() ? std::nullopt : project_of(given);
  return at ? at : project_of(".");
}

}  // namespace

std::optional<ProjectSettings> settings_around(const fs::path& given) {
  const std::optional<PlaceInProject> at = project_around(given);
  if (!at) return std::nullopt;
  const Project& project = at->project;
  const LoopOptions options = read_loop_options(project.folder);
  ProjectSettings out;
  out.at = *at;
  if (!options.machine.empty()) out.machine = machine_argument(options, project.folder);
  out.board = project.folder / "board.json";
  out.bench = project.bench_before(at->round > 0 ? at->round : project.measured() + 1);
  if (at->round > 0) out.heights = project.heights(at->round);
  out.follow_bow = options.toolpath.contains("follow-bow");
  if (const auto said = options.capture.find("f-number"); said != options.capture.end())
    out.f_number = number_in(said->second.front()).value_or(0);
  return out;
}

MachineProfile machine_in_project(const std::string& machine, const fs::path& given) {
  const std::optional<PlaceInProject> at = project_around(given);
  if (!at) return machine_profile(machine);
  const LoopOptions options = read_loop_options(at->project.folder);
  const std::string own = machine_argument(options, at->project.folder);
  std::error_code ignored;
  const bool is_own = machine == own || fs::equivalent(machine, own, ignored);
  return is_own ? machine_of(options, at->project.folder) : machine_profile(machine);
}

fs::path project_folder(const fs::path& given, const std::string& argument) {
  const std::optional<PlaceInProject> at = project_of(given.empty() ? fs::path(".") : given);
  if (given.empty() && !at) throw CLI::RequiredError(argument);
  const bool other = at && !given.empty() && (at->round == 0 || !fs::is_directory(given));
  return !at || other ? given : at->project.folder;
}

void take_from_project(const CLI::App& command, const ProjectSettings& settings, const SettingsToTake& into) {
  std::string words;
  const auto take = [&](const char* name, const auto& value, auto* to, const std::string& value_words) {
    using Value = std::remove_cvref_t<decltype(value)>;
    if (to == nullptr || value == Value() || value == *to || command.count(std::string("--") + name) > 0) return;
    *to = value;
    words += std::string(words.empty() ? "" : ", ") + name + (value_words.empty() ? "" : " " + shell_word(value_words));
  };
  const auto take_file = [&](const char* name, const fs::path& file, fs::path* to) {
    take(name, file, to, file.lexically_normal().string());  // "board.json" of the project "."
  };
  take("machine", settings.machine, into.machine, settings.machine);
  take_file("scratches", settings.scratches, into.scratches);
  take_file("board", settings.board, into.board);
  take_file("bench", settings.bench, into.bench);
  const bool by_heights = into.heights != nullptr && !into.heights->empty();
  if (!by_heights) take("follow-bow", settings.follow_bow, into.follow_bow, "");
  if (into.follow_bow == nullptr || !*into.follow_bow) take_file("heights", settings.heights, into.heights);
  take("lamp", settings.light, into.light, settings.light);
  take("f-number", settings.f_number, into.f_number, general(settings.f_number, 3));
  if (words.empty()) return;
  const fs::path& folder = settings.at.project.folder;
  const bool dots = folder.string().starts_with('.');  // "." and ".." are no names
  note(FindingCode::settings,
       "from the project " + (dots ? fs::weakly_canonical(folder) : folder).string() + ": " + words);
}

}  // namespace burin

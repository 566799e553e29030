// burin status - describes a loop project: its rounds and stages, their inputs, and the next step.
#include <algorithm>
#include <filesystem>
#include <memory>

#include "burin/base/error.h"
#include "burin/base/files/json_file.h"
#include "tools/commands.h"
#include "tools/loop/say.h"
#include "tools/loop/state.h"
#include "tools/progress_bar.h"
#include "tools/project_settings.h"
#include "tools/work_lock.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

Json files_json(const FileHashes& files) {
  Json json = Json::object();
  for (const auto& [name, hash] : files) json[name] = hash;
  return json;
}

Json change_json(const StageChange& change) {
  static const char* const kKinds[] = {"input", "output", "option"};
  static const char* const kHows[] = {"changed", "gone", "added", "unused"};
  Json json{{"kind", kKinds[static_cast<int>(change.kind)]},
            {"how", kHows[static_cast<int>(change.how)]},
            {"name", change.name}};
  if (change.kind == StageChange::Kind::option) {
    json["was"] = change.was;
    json["now"] = change.now;
  }
  return json;
}

Json stage_json(const LoopProject& loop, const StageState& state) {
  static const char* const kConditions[] = {"not begun", "not recorded", "stopped", "interrupted", "done"};
  Json json;
  json["stage"] = name_of(loop.project, state.at);
  json["condition"] = kConditions[static_cast<int>(state.condition)];
  json["up_to_date"] = state.up_to_date();
  json["asks"] = needs_answer(state);
  json["words"] = in_words(state);
  json["changes"] = Json::array();
  for (const StageChange& change : state.changes) json["changes"].push_back(change_json(change));
  if (!state.record) return json;
  json["status"] = in_words(state.record->status);
  json["burin"] = state.record->burin;
  json["inputs"] = files_json(state.record->inputs);
  json["outputs"] = files_json(state.record->outputs);
  json["options"] = files_json(state.record->options);
  json["accepted_unknown"] = state.record->accepted_unknown;
  return json;
}

// Returns the inputs of one stage in words for one line.
std::string rests_on(const StageState& state) {
  if (!state.record || !state.record->holds()) return "";
  constexpr std::size_t kNamed = 6;
  std::string words;
  std::size_t count = 0;
  for (const auto& [name, hash] : state.record->inputs)
    if (count++ < kNamed) words += (words.empty() ? "" : ", ") + name;
  if (count > kNamed) words += fmt::format(" and {} more", count - kNamed);
  for (const auto& [name, text] : state.record->options) words += fmt::format(", {} {}", name, text);
  return words;
}

// A screen has room for the newest round.
std::string basis_in_words(const LoopProject& loop, const std::vector<StageState>& states) {
  int newest = 0;
  std::string lines;
  for (const StageState& state : states) newest = std::max(newest, state.at.round);
  for (const StageState& state : states)
    if (const std::string words = rests_on(state); !words.empty() && (state.at.round == newest || state.at.round == 0))
      lines += fmt::format("  {}: {}\n", name_of(loop.project, state.at), words);
  if (lines.empty()) return "";
  return fmt::format("Inputs of each{}{}:\n{}", newest > 1 ? " of the newest round" : "",
                     newest > 1 ? " (--json: of all rounds)" : "", lines);
}

Json status_json(const LoopProject& loop, const std::vector<StageState>& states, const std::string& at_work,
                 const std::string& next) {
  Json json{{"project", loop.project.folder.string()}};
  json["options"] = in_words(loop.options);
  json["at_work"] = at_work;
  json["stages"] = Json::array();
  for (const StageState& state : states) json["stages"].push_back(stage_json(loop, state));
  json["next"] = next;
  return json;
}

Report run(const fs::path& given) {
  const fs::path folder = project_folder(given, "PROJECT_DIR");
  if (!fs::exists(folder / "design.json"))
    fail((folder / "design.json").string(), "a loop project needs this file", "name a project folder");
  const LoopProject loop{{folder}, read_loop_options(folder)};
  ProgressBar bar;
  bar.progress()("looking whether files are as they were", 0);
  ContentHashes hashes;
  const std::vector<StageState> states = states_of(loop, hashes);
  const std::string at_work = who_works_in(folder), next = next_of(loop, states);
  bar.clear();
  Report report;
  report.data = status_json(loop, states, at_work, next);
  report.line("{}: {}\n{}{}", folder.string(), in_words(loop.options), table_of(loop, states, false, !at_work.empty()),
              basis_in_words(loop, states));
  if (!at_work.empty()) report.line("A loop is at work here: {}\n", at_work);
  report.line("Next: {}\n", next);
  return report;
}

}  // namespace

void add_status_command(CLI::App& burin) {
  auto folder = std::make_shared<fs::path>();
  CLI::App* command =
      burin.add_subcommand("status", "Show a project's rounds and stages, their inputs and the next step");
  command->add_option("PROJECT_DIR", *folder, "Show this project [default: the working directory's project]");
  command->footer(
      example("burin status samples/small-bench\n"
              "  burin status samples/small-bench --json      # the same for programs, with all hashes"));
  command->callback([folder] { print(run(*folder)); });
}

}  // namespace burin

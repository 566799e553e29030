#include "tools/loop/state.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "burin/base/error.h"
#include "tools/version.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

using Kind = StageChange::Kind;
using How = StageChange::How;
using Condition = StageState::Condition;

// Compares recorded files with present ones; accepted changes count as recorded.
void compare_files(const Project& project, const FileHashes& was, const FileHashes& kept, const FileHashes& now,
                   Kind kind, std::vector<StageChange>& changes) {
  for (const auto& [name, hash] : now) {
    const auto before = was.find(name);
    if (before != was.end() && before->second == hash) continue;
    if (const auto settled = kept.find(name); settled != kept.end() && settled->second == hash) continue;
    if (before == was.end() && hash.empty()) continue;  // missing then and now
    const How how = hash.empty()                                    ? How::gone
                    : before == was.end() || before->second.empty() ? How::added
                                                                    : How::changed;
    changes.push_back({kind, how, name, "", ""});
  }
  for (const auto& [name, hash] : was) {
    if (now.contains(name) || hash.empty()) continue;
    if (const auto settled = kept.find(name); settled != kept.end() && settled->second.empty()) continue;
    changes.push_back({kind, fs::exists(project.folder / name) ? How::unused : How::gone, name, "", ""});
  }
}

void compare_options(const MadeRecord& record, const OptionTexts& now, std::vector<StageChange>& changes) {
  std::set<std::string> names;
  for (const auto& [name, text] : record.options) names.insert(name);
  for (const auto& [name, text] : now) names.insert(name);
  const auto text_in = [](const OptionTexts& texts, const std::string& name) {
    const auto found = texts.find(name);
    return found == texts.end() ? std::string() : found->second;
  };
  for (const std::string& name : names) {
    const std::string was = text_in(record.options, name), is = text_in(now, name);
    if (was == is) continue;
    if (const auto settled = record.kept.options.find(name);
        settled != record.kept.options.end() && settled->second == is)
      continue;
    changes.push_back({Kind::option, How::changed, name, was.empty() ? "not said" : was, is.empty() ? "not said" : is});
  }
}

// Returns the present inputs or, if they are unknown, the recorded ones.
StageBasis basis_now(const LoopProject& loop, const StageOfRound& at, const MadeRecord& record) {
  try {
    return basis_of(loop, at);
  } catch (const Error&) {
    StageBasis basis{{}, record.options};
    for (const auto& [name, hash] : record.inputs) basis.files.insert(loop.project.folder / name);
    return basis;
  }
}

std::string list_of(const std::vector<std::string>& names) {
  constexpr std::size_t kNamed = 3;
  std::string out;
  for (std::size_t i = 0; i < std::min(names.size(), kNamed); ++i) out += (i == 0 ? "" : ", ") + names[i];
  if (names.size() > kNamed) out += fmt::format(" and {} more", names.size() - kNamed);
  return out;
}

bool is_in_the_metal(StageKind stage) { return stage == StageKind::design || stage == StageKind::toolpath; }

// Returns true if an earlier carving stage of the round is to be made or was ended early. The inputs of this one are
// then unknown.
bool waits_for_another(const StageState& state, const std::vector<StageState>& states) {
  return is_carving(state.at.stage) && std::any_of(states.begin(), states.end(), [&](const StageState& other) {
           return other.at.round == state.at.round && is_carving(other.at.stage) && other.at.stage < state.at.stage &&
                  is_made_by_itself(other);
         });
}

}  // namespace

bool is_carving(StageKind stage) { return is_in_the_metal(stage) || stage == StageKind::board; }

bool follows(const StageState& state) {
  const char* from = state.at.stage == StageKind::toolpath ? "/scratches.csv"
                     : state.at.stage == StageKind::board  ? "/sent.csv"
                                                           : nullptr;
  if (!from) return false;
  return std::any_of(state.changes.begin(), state.changes.end(), [&](const StageChange& change) {
    return change.kind == Kind::input && change.how != How::gone && change.name.ends_with(from);
  });
}

std::vector<StageState> without_followers(const std::vector<StageState>& asking) {
  const auto stale = [](const StageState& state) {
    return is_carving(state.at.stage) && state.condition == Condition::done && !state.changed(Kind::output);
  };
  std::vector<StageState> first;
  for (const StageState& state : asking) {
    // A stage that lacks only files of the stage before is repeated with it.
    const bool misses = std::all_of(state.changes.begin(), state.changes.end(), [](const StageChange& change) {
      return change.kind == Kind::input && change.how == How::gone;
    });
    const bool behind =
        stale(state) && std::any_of(first.begin(), first.end(), [&](const StageState& other) {
          return other.at.round == state.at.round && is_carving(other.at.stage) && (stale(other) || misses);
        });
    if (!behind) first.push_back(state);
  }
  return first;
}

bool StageState::changed(StageChange::Kind kind) const {
  return std::any_of(changes.begin(), changes.end(), [&](const StageChange& change) { return change.kind == kind; });
}

FileHashes hashes_of(const Project& project, const std::set<fs::path>& files, ContentHashes& hashes) {
  FileHashes out;
  for (const fs::path& file : files) out[path_in_project(project.folder, file)] = hashes.of(file);
  return out;
}

FileHashes hashes_of(const Project& project, const std::vector<fs::path>& files, ContentHashes& hashes) {
  return hashes_of(project, std::set<fs::path>(files.begin(), files.end()), hashes);
}

void record_check(const LoopProject& loop, int number, bool good) {
  const StageOfRound at{number, StageKind::check};
  std::optional<MadeRecord> record = read_record(record_file(loop.project, at));
  if (!record) return;
  ContentHashes hashes;
  const StageBasis basis = basis_of(loop, at);
  record->status = good ? MadeRecord::Status::done : MadeRecord::Status::begun;
  record->burin = version();
  record->options = basis.options;
  record->inputs = hashes_of(loop.project, basis.files, hashes);
  record->outputs = hashes_of(loop.project, outputs_of(loop, at), hashes);
  record->kept = {};
  write_record(*record, record_file(loop.project, at));
}

StageState state_of(const LoopProject& loop, const StageOfRound& at, ContentHashes& hashes) {
  StageState state;
  state.at = at;
  state.photographed = at.round > 0 && is_photographed(loop.project, at.round);
  state.record = read_record(record_file(loop.project, at));
  if (!state.record) {
    // No command makes the user's photos.
    const bool photos = at.stage == StageKind::photos;
    state.condition = !has_result(loop, at) ? Condition::not_begun : photos ? Condition::done : Condition::not_recorded;
    return state;
  }
  const MadeRecord& record = *state.record;
  if (!record.holds()) {
    state.condition = record.status == MadeRecord::Status::interrupted ? Condition::interrupted : Condition::stopped;
    if (state.condition == Condition::stopped) return state;
  } else {
    state.condition = Condition::done;
  }
  const StageBasis basis = basis_now(loop, at, record);
  compare_files(loop.project, record.inputs, record.kept.inputs, hashes_of(loop.project, basis.files, hashes),
                Kind::input, state.changes);
  compare_options(record, basis.options, state.changes);
  FileHashes left;
  for (const auto& [name, hash] : record.outputs) left[name] = hashes.of(loop.project.folder / name);
  compare_files(loop.project, record.outputs, record.kept.outputs, left, Kind::output, state.changes);
  return state;
}

std::vector<StageState> states_of(const LoopProject& loop, ContentHashes& hashes) {
  std::vector<StageState> states;
  const int rounds = loop.project.rounds();
  for (int round = 1; round <= rounds; ++round)
    for (const StageKind stage : kRoundStages) states.push_back(state_of(loop, {round, stage}, hashes));
  states.push_back(state_of(loop, {0, StageKind::report}, hashes));
  return states;
}

bool needs_answer(const StageState& state) {
  // Pages for reading: an earlier one is moved.
  if (state.at.stage == StageKind::report || state.at.stage == StageKind::check) return false;
  if (state.condition == Condition::not_recorded) return true;
  if (state.condition != Condition::done || state.changes.empty()) return false;
  if (state.at.stage == StageKind::photos) return false;  // photos remain valid
  if (state.changed(Kind::output)) return true;
  if (is_in_the_metal(state.at.stage) && state.photographed) return false;  // as it was carved
  return is_carving(state.at.stage) && !follows(state);
}

bool needs_answer_now(const StageState& state, const std::vector<StageState>& states) {
  if (!needs_answer(state) || waits_for_another(state, states)) return false;
  if (state.condition != Condition::done || state.changed(Kind::output)) return true;
  return std::none_of(states.begin(), states.end(), [&](const StageState& other) {
    const bool measures = other.at.stage == StageKind::capture || other.at.stage == StageKind::calibrate ||
                          other.at.stage == StageKind::refine;
    return other.at.round + 1 == state.at.round && measures && is_made_by_itself(other);
  });
}

bool is_made_by_itself(const StageState& state) {
  if (needs_answer(state)) return false;
  if (state.at.stage == StageKind::check && state.photographed) return false;  // too late for a warning
  if (state.condition != Condition::done) return true;
  if (state.changes.empty() || state.at.stage == StageKind::photos) return false;
  return !(is_in_the_metal(state.at.stage) && state.photographed);
}

std::string in_words(const std::vector<StageChange>& changes) {
  std::string out;
  const auto add = [&](const std::string& words) { out += (out.empty() ? "" : "; ") + words; };
  struct Group {
    Kind kind;
    How how;
    const char *one, *several;
  };
  constexpr std::array<Group, 7> kGroups{{{Kind::input, How::changed, "changed", "changed"},
                                          {Kind::input, How::added, "is new", "are new"},
                                          {Kind::input, How::gone, "is gone", "are gone"},
                                          {Kind::input, How::unused, "is not used any more", "are not used any more"},
                                          {Kind::output, How::changed, "was changed by hand", "were changed by hand"},
                                          {Kind::output, How::added, "is new", "are new"},
                                          {Kind::output, How::gone, "is gone", "are gone"}}};
  for (const Group& group : kGroups) {
    std::vector<std::string> names;
    std::vector<std::string> pages;  // `burin check carve` and `burin report` write them too
    for (const StageChange& change : changes)
      if (change.kind == group.kind && change.how == group.how)
        (change.kind == Kind::output && change.how == How::changed && change.name.ends_with(".html") ? pages : names)
            .push_back(change.name);
    if (!names.empty()) add(list_of(names) + " " + (names.size() == 1 ? group.one : group.several));
    if (!pages.empty())
      add(list_of(pages) + (pages.size() == 1 ? " was" : " were") + " written again outside of the loop");
  }
  for (const StageChange& change : changes)
    if (change.kind == Kind::option) add(fmt::format("{} was {} and is {}", change.name, change.was, change.now));
  return out;
}

std::string in_words(const StageState& state) {
  switch (state.condition) {
    case Condition::not_begun:
      return "not begun";
    case Condition::not_recorded:
      return "exists, but no record has its inputs";
    case Condition::stopped:
      return "begun, and not ended";
    case Condition::interrupted:
      return "ended early, with what it had by then";
    case Condition::done:
      break;
  }
  const bool accepted = state.record && state.record->status != MadeRecord::Status::done;
  std::string done = accepted ? state.record->status == MadeRecord::Status::adopted ? "done, from what is not known"
                                                                                    : "done, ended early and kept"
                              : "done";
  if (state.changes.empty()) return done;
  const std::string since = in_words(state.changes);
  if (state.at.stage == StageKind::photos) return "taken; since then: " + since;
  if (is_in_the_metal(state.at.stage) && state.photographed && !state.changed(Kind::output))
    return "as it was carved; since then: " + since;
  return "out of date: " + since;
}

}  // namespace burin

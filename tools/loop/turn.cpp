#include "tools/loop/turn.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <optional>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "tools/commands.h"
#include "tools/loop/aside.h"
#include "tools/loop/carved_board.h"
#include "tools/loop/round_design.h"
#include "tools/loop/round_lamps.h"
#include "tools/loop/say.h"
#include "tools/loop/unknown.h"
#include "tools/stop_signal.h"
#include "tools/version.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

using Condition = StageState::Condition;

struct Turn {
  const LoopProject& loop;
  const LoopAnswers& answers;
  std::set<StageOfRound> again;
  ContentHashes hashes;
  bool some_done = false, said = false;
};

// Parses an --force. Throws Error for an unknown stage, and for a carved one.
StageOfRound stage_of(const LoopProject& loop, const std::string& words) {
  const Project& project = loop.project;
  const std::size_t slash = words.find('/');
  const std::string stage = slash == std::string::npos ? words : words.substr(slash + 1);
  const auto known = std::find_if(std::begin(kRoundStages), std::end(kRoundStages),
                                  [&](StageKind kind) { return stage == name_of(kind); });
  StageOfRound at;
  if (known != std::end(kRoundStages)) {
    at.stage = *known;
    at.round = 0;
    for (int round = 1; round <= project.rounds(); ++round)
      if (slash != std::string::npos
              ? words == name_of(project, {round, *known})
              : fs::exists(record_file(project, {round, *known})) || has_result(loop, {round, *known}))
        at.round = round;
  }
  if (known == std::end(kRoundStages) || (at.round == 0 && at.stage != StageKind::report))
    fail("--force " + words, "there is no such stage in " + project.folder.string(),
         fmt::format("`burin status {}` lists them, such as design or round-01/refine",
                     shell_word(project.folder.string())));
  if (at.stage == StageKind::photos)
    fail("--force " + words, "photos are never replaced", "add photos to that folder, or take some out of it");
  const bool metal = at.stage == StageKind::design || at.stage == StageKind::toolpath;
  if (metal && at.round > 0 && is_photographed(project, at.round))
    fail("--force " + words,
         fmt::format("the board of {} is carved and photographed", project.round(at.round).filename().string()),
         fmt::format("`{}` designs the next one; copy the project's own files to another folder to start over",
                     loop_line(project)));
  return at;
}

// Returns true for a stage behind a repeated one of the same round.
bool follows_one_made_anew(const Turn& turn, const StageOfRound& at) {
  return std::any_of(turn.again.begin(), turn.again.end(), [&](const StageOfRound& again) {
    return again.round == at.round && is_carving(again.stage) && is_carving(at.stage) && again.stage <= at.stage;
  });
}

bool is_open(const Turn& turn, const StageState& state) {
  return needs_answer(state) && !turn.again.contains(state.at) &&
         !(follows_one_made_anew(turn, state.at) && state.condition == Condition::done &&
           !state.changed(StageChange::Kind::output));
}

bool can_be_kept(const Turn& turn, const StageState& state) {
  if (state.condition == Condition::interrupted) return true;
  return is_open(turn, state) && has_result(turn.loop, state.at);
}

// Ends the loop with a question for the user.
[[noreturn]] void ask_person(const Turn& turn, const LoopQuestion& question) {
  fail_as(ErrorCode::question, turn.loop.project.folder.string(), question.what, question.remedy);
}

// Records the present state as accepted.
void keep(Turn& turn, const StageState& state) {
  const LoopProject& loop = turn.loop;
  if (state.condition == Condition::interrupted) finish_design(loop, state.at.round);
  const StageBasis basis = basis_of(loop, state.at);
  const FileHashes inputs = hashes_of(loop.project, basis.files, turn.hashes),
                   outputs = hashes_of(loop.project, outputs_of(loop, state.at), turn.hashes);
  MadeRecord record = state.record.value_or(MadeRecord{});
  if (!state.record) {
    record.stage = name_of(state.at.stage);
    record.status = MadeRecord::Status::adopted;
    record.burin = "unknown";
    record.options = basis.options;
    record.inputs = inputs;
    record.outputs = outputs;
  } else {
    if (state.condition == Condition::interrupted) {
      record.status = MadeRecord::Status::accepted;
      record.outputs = outputs;
    }
    for (const StageChange& change : state.changes) {
      const auto hash_in = [&](const FileHashes& files) {
        const auto found = files.find(change.name);
        return found == files.end() ? std::string() : found->second;
      };
      if (change.kind == StageChange::Kind::option) {
        const auto found = basis.options.find(change.name);
        record.kept.options[change.name] = found == basis.options.end() ? "" : found->second;
      } else if (change.kind == StageChange::Kind::input) {
        record.kept.inputs[change.name] = hash_in(inputs);
      } else {
        record.kept.outputs[change.name] = hash_in(outputs);
      }
    }
  }
  write_record(record, record_file(loop.project, state.at));
  const std::string name = name_of(loop.project, state.at);
  print_event("kept", {{"stage", name}},
              fmt::format("Kept: {} ({})\n", name, state.changes.empty() ? in_words(state) : in_words(state.changes)));
}

// Collects the user's decisions before any work. Throws Error for missing ones.
void settle(Turn& turn) {
  const std::vector<StageState> states = states_of(turn.loop, turn.hashes);
  const bool begun = std::any_of(states.begin(), states.end(),
                                 [](const StageState& state) { return state.condition != Condition::not_begun; });
  if (begun) print_event("state", {}, table_of(turn.loop, states, true));
  std::vector<StageState> open, kept;
  for (const StageState& state : states) {
    const bool asks = is_open(turn, state) && needs_answer_now(state, states);
    if (turn.answers.keep && !turn.again.contains(state.at) && can_be_kept(turn, state) &&
        (asks || state.condition == Condition::interrupted))
      kept.push_back(state);
    else if (asks)
      open.push_back(state);
  }
  const auto carving = [](const StageState& state) { return is_carving(state.at.stage); };
  // Unavoidable errors come before any question.
  if (!open.empty() || std::any_of(kept.begin(), kept.end(), carving)) require_one_truth_to_carve(turn.loop.project);
  if (!open.empty()) {
    ask_person(turn, question_of(turn.loop, without_followers(open)));
  }
  for (const StageState& asked : kept) {
    const StageState state = state_of(turn.loop, asked.at, turn.hashes);
    const bool follows_now = follows(state) && !follows(asked);  // an accepted stage before it changed the question
    if (can_be_kept(turn, state) && !follows_now) keep(turn, state);
  }
}

// Refuses photos without a tool path, since their board is unknown.
void refuse_early_photos(const Turn& turn, const StageState& state) {
  if (!state.photographed || !(state.at.stage == StageKind::design || state.at.stage == StageKind::toolpath)) return;
  fail((turn.loop.project.round(state.at.round) / "photos").string(),
       fmt::format("holds photos (or they were measured), but {} is not done: the commands of that board are unknown",
                   name_of(turn.loop.project, state.at)),
       "move the photos out of there until that board is carved, and session.json with them");
}

// Refuses the next design while the measured round leaves its parameters undetermined.
void refuse_unknown(Turn& turn, int round) {
  const LoopProject& loop = turn.loop;
  const ToldByRound told = told_by_round(loop, round, turn.answers.accept_unknown);
  if (!told.open.empty()) {
    Json names = Json::array();
    for (const UnknownParameter& u : told.open) names.push_back(u.name);
    print_event("undetermined", {{"parameters", names}}, "\n" + in_words(told.open));
    const LoopQuestion question = question_of(loop, round, told.open);
    fail_as(ErrorCode::question, loop.project.round(round).string(), question.what, question.remedy);
  }
  for (const Finding& weak : told.weak) tell(weak);
  std::vector<std::string> names;
  for (const UnknownParameter& u : told.accepted) {
    names.push_back(u.name);
    const bool refuted = rests_on(u.verdict, Cause::Kind::believed_refuted);
    tell(make_warning(FindingCode::parameter_undetermined, in_short({u}) + "; the next design uses the value that " +
                                                               (u.verdict.known() ? "the photos determine"
                                                                : refuted         ? "explains the photos best"
                                                                                  : "was believed") +
                                                               ", as accepted"));
  }
  const fs::path file = record_file(loop.project, {round, StageKind::refine});
  std::optional<MadeRecord> record = read_record(file);
  if (!record || names.empty() || record->accepted_unknown == names) return;
  record->accepted_unknown = names;
  write_record(*record, file);
}

// Checks all reasons to refuse a stage before its former result moves.
void refuse_before_it_begins(Turn& turn, const StageState& state) {
  const Project& project = turn.loop.project;
  const auto [round, stage] = state.at;
  refuse_early_photos(turn, state);
  if (stage == StageKind::board && state.photographed) require_told_as_carved(project, round);
  if (stage == StageKind::design && round > 1) refuse_unknown(turn, round - 1);
  if (stage == StageKind::design) require_designable(project, round);
  if (stage == StageKind::toolpath) require_one_truth(project, round);
}

// Refuses inputs that changed during the work, because the record would be wrong.
void refuse_edited_meanwhile(Turn& turn, const StageOfRound& at, const FileHashes& inputs) {
  const FileHashes now = hashes_of(turn.loop.project, basis_of(turn.loop, at).files, turn.hashes);
  for (const auto& [name, hash] : now)
    if (const auto before = inputs.find(name); before == inputs.end() || before->second != hash)
      fail((turn.loop.project.folder / name).string(),
           fmt::format("changed while {} was being made", name_of(turn.loop.project, at)),
           fmt::format("say `{}` again", loop_line(turn.loop.project)));
}

void say_begin(Turn& turn, const StageState& state) {
  const std::string name = state.at.round == 0 ? "report of the whole loop"
                                               : turn.loop.project.round(state.at.round).filename().string() + ": " +
                                                     name_of(state.at.stage);
  std::string text = turn.some_done && !turn.said ? fmt::format("Going on with: {}\n", name) : "";
  turn.said = true;
  text += fmt::format("\n== {}{}\n", name,
                      state.at.stage == StageKind::photos ? " (carve and photograph, simulated from truth.json)" : "");
  if (!state.changes.empty()) text += fmt::format("since it was made: {}\n", in_words(state.changes));
  print_event("stage", {{"stage", name_of(turn.loop.project, state.at)}}, text);
}

void make(Turn& turn, const StageState& state) {
  const LoopProject& loop = turn.loop;
  refuse_before_it_begins(turn, state);
  say_begin(turn, state);
  const StageBasis basis = basis_of(loop, state.at);
  MadeRecord record;
  record.stage = name_of(state.at.stage);
  record.burin = version();
  record.options = basis.options;
  record.inputs = hashes_of(loop.project, basis.files, turn.hashes);
  const fs::path aside = begin_stage(loop, state.at, record, turn.hashes);
  if (!aside.empty())
    print_event("moved", {{"folder", aside.string()}}, fmt::format("the former files are now in {}\n", aside.string()));
  if (!turn.again.contains(state.at)) {
    const fs::path from = restore_former(loop, state.at, record, turn.hashes);
    if (!from.empty()) {
      print_event("taken back", {{"folder", from.string()}},
                  fmt::format("the same was made of the same before: it is taken back from {}\n", from.string()));
      return;
    }
  }
  const bool whole = make_stage(loop, state.at);
  refuse_edited_meanwhile(turn, state.at, record.inputs);
  record.status = whole ? MadeRecord::Status::done : MadeRecord::Status::interrupted;
  if (!whole && turn.answers.keep) {
    finish_design(loop, state.at.round);
    record.status = MadeRecord::Status::accepted;
  }
  record.outputs = hashes_of(loop.project, outputs_of(loop, state.at), turn.hashes);
  write_record(record, record_file(loop.project, state.at));
  if (record.status == MadeRecord::Status::interrupted)
    fail_as(ErrorCode::question, loop.project.folder.string(),
            fmt::format("{} was ended early and is not done", name_of(loop.project, state.at)),
            fmt::format("`{}` takes it as good as it got, `{}` designs anew{}",
                        loop_line(loop.project, "--allow-stale"), loop_line(loop.project), time_limit_in_words(loop)));
}

// Handles one stage after all before it: no action, work, or a question. Returns false if the user has to act.
bool turn_stage(Turn& turn, const StageOfRound& at) {
  stop_if_asked();
  const StageState state = state_of(turn.loop, at, turn.hashes);
  const bool again = turn.again.contains(at);
  if (at.stage == StageKind::photos && state.condition != Condition::done) {
    if (state.photographed && photos_of(turn.loop.project, at.round).empty())
      fail((turn.loop.project.round(at.round) / "photos").string(), "holds no photo any more", "put them back");
    const bool workshop =
        fs::exists(turn.loop.project.folder / "truth.json") && at.round <= turn.answers.simulated_rounds;
    if (photos_of(turn.loop.project, at.round).empty()) {
      if (!workshop) return false;
    } else {
      return true;  // a simulation, interrupted after its work
    }
  }
  if (!again && is_open(turn, state)) ask_person(turn, question_of(turn.loop, state));
  if (again || is_made_by_itself(state) || (needs_answer(state) && follows_one_made_anew(turn, at)))
    make(turn, state);
  else
    turn.some_done = true;
  return true;
}

// Prints the user's tasks after the last stage.
Report report_end(const LoopProject& loop, int round, bool another) {
  const Project& project = loop.project;
  const bool simulated = fs::exists(project.folder / "truth.json");
  const std::optional<NextBoard> next = another ? std::nullopt : last_board(project);
  Report report;
  report.line("\n");
  report.data["project"] = project.folder.string();
  report.data["round"] = round;
  report.data["another_board_pays"] = !next;
  const std::string turned =
      round == 1 ? "" : "The loop has turned " + counted(static_cast<std::size_t>(round - 1), "time") + "; ";
  if (next) {
    report.line("Done: {}.\n{}to carve another board all the same: {}\n", hang_in_words(*next), turned,
                loop_line(project, "--another"));
    return report;
  }
  if (!simulated) {
    make_photo_folders(project, round);
    report.line("{}", your_turn(loop, round));
  }
  report.next.push_back({"burin", "loop", project.folder.string()});
  if (simulated) report.next.back().insert(report.next.back().end(), {"--rounds", std::to_string(round)});
  report.line("{}{}he next board to carve is {}; {}: {}\n", turned, turned.empty() ? "T" : "t",
              fact("gcode", (project.round(round) / "board.gcode").string()),
              simulated ? "to simulate that too, next" : "with its photos in their folder, next",
              command_text(report.next.back()));
  return report;
}

}  // namespace

Report dry_run(const LoopProject& loop, const LoopAnswers& answers) {
  Turn turn{loop, answers, {}, {}, false, false};
  for (const std::string& words : answers.again) turn.again.insert(stage_of(loop, words));
  Report report;
  report.line("{}: {}\n", fact("project", loop.project.folder.string()), fact("options", in_words(loop.options)));
  const std::vector<StageState> states = states_of(loop, turn.hashes);
  bool is_made_before = false;  // then all stages behind are made, too
  for (const StageState& state : states) {
    const std::string name = name_of(loop.project, state.at);
    const auto say = [&](const char* action, const std::string& why) {
      Facts stage = report.add("stages");
      stage.line("  {:<9} {}{}\n", fact("action", action), fact("stage", name), why.empty() ? "" : ": " + why);
      if (!why.empty()) stage.set("why", why);
    };
    const bool again = turn.again.contains(state.at);
    const bool simulated = fs::exists(loop.project.folder / "truth.json") && state.at.round <= answers.simulated_rounds;
    if (state.at.stage == StageKind::photos && photos_of(loop.project, state.at.round).empty() && !simulated) {
      say("wait for", "photos into " + (loop.project.round(state.at.round) / "photos").string());
      return report;
    }
    if (!again && is_open(turn, state) && !answers.keep && !is_made_before) {
      const LoopQuestion question = question_of(loop, state);
      say("ask about", question.what + "; " + question.remedy);
      return report;
    }
    is_made_before = is_made_before || again || is_made_by_itself(state);
    say(is_made_before ? "make" : is_open(turn, state) ? "keep" : "have", "");
  }
  return report;
}

void turn_loop(const LoopProject& loop, const LoopAnswers& answers) {
  const Project& project = loop.project;
  Turn turn{loop, answers, {}, {}, false, false};
  for (const std::string& words : answers.again) turn.again.insert(stage_of(loop, words));
  remove_half_written(project);
  print_event("began", {{"project", project.folder.string()}, {"options", in_words(loop.options)}},
              fmt::format("{}: {}\n", project.folder.string(), in_words(loop.options)));
  settle(turn);
  int round = 1;
  for (bool photographed = true; photographed; ++round)
    for (const StageKind stage : kRoundStages)
      if (photographed) photographed = turn_stage(turn, {round, stage});
  --round;
  // The last round is designed and not carved: for the measured bench, if there are photos.
  turn_stage(turn, {0, StageKind::report});
  print(report_end(loop, round, answers.another));
}

}  // namespace burin

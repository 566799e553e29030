#include "tools/loop/say.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <sstream>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/calib/plan.h"
#include "burin/capture/lamp_folders.h"
#include "burin/optimize/design_file.h"
#include "burin/scene/bench_of_board.h"
#include "burin/scene/board.h"
#include "tools/commands.h"
#include "tools/loop/carved_board.h"
#include "tools/loop/printed_sheet.h"
#include "tools/loop/round_design.h"
#include "tools/loop/round_lamps.h"
#include "tools/match_views.h"
#include "tools/photographed_lamps.h"
#include "tools/report/carve_check.h"
#include "tools/version.h"
#include "tools/where_to_stand.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

using Condition = StageState::Condition;

// Returns the G-code in carving order: one file, or its parts.
std::string gcode_of(const LoopProject& loop, int round) {
  std::string first;
  int count = 0;
  for (const fs::path& file : outputs_of(loop, {round, StageKind::toolpath})) {
    if (file.extension() != ".gcode" || file.stem().string().ends_with("-frame")) continue;
    if (count++ == 0) first = file.string();
  }
  if (first.empty()) return (loop.project.round(round) / "board.gcode").string();
  return count == 1 ? first : fmt::format("{} and the {} further board*.gcode", first, count - 1);
}

// Possible answers to a stage's question.
struct PossibleAnswers {
  bool again = false, keep = false;
};

// Returns the values of board.json that differ from the carved board, if they made its stage outdated.
std::vector<ToldOtherwise> carved_otherwise(const LoopProject& loop, const StageState& state) {
  if (state.at.stage != StageKind::board || !state.photographed) return {};
  try {
    return told_otherwise(loop.project, state.at.round);
  } catch (const Error&) {  // a board.json during editing: its next reader reports the error
    return {};
  }
}

PossibleAnswers answers_to(const LoopProject& loop, const StageState& state) {
  const bool metal =
      state.photographed && (state.at.stage == StageKind::design || state.at.stage == StageKind::toolpath);
  return {!metal && carved_otherwise(loop, state).empty(), has_result(loop, state.at)};
}

// Returns the reason against a design of that round's board; empty if there is none.
std::string why_not_designed(const LoopProject& loop, int round) {
  try {
    if (round > 1)
      if (const ToldByRound told = told_by_round(loop, round - 1); !told.open.empty()) {
        const auto named = std::find_if(told.open.begin(), told.open.end(),
                                        [](const UnknownParameter& u) { return u.verdict.next_photo.has_value(); });
        const LoopQuestion question = question_of(
            loop, round - 1, told.open,
            named == told.open.end() ? "" : "(" + sentence(*named->verdict.next_photo, named->verdict.unit) + ")");
        return question.what + "; " + question.remedy;
      }
    require_designable(loop.project, round);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

// Returns the next step of a stage that needs no question.
std::string next_of_stage(const LoopProject& loop, const StageState& state) {
  if (state.at.stage == StageKind::design)
    if (std::string why_not = why_not_designed(loop, state.at.round); !why_not.empty()) return why_not;
  std::string next = fmt::format("{}: `{}`", name_of(loop.project, state.at), loop_line(loop.project));
  if (state.condition == Condition::interrupted)
    return fmt::format("{}{} (or `{}`, which takes it as good as it got)", next, time_limit_in_words(loop),
                       loop_line(loop.project, "--allow-stale"));
  if (state.at.stage == StageKind::check && state.condition == Condition::stopped && has_result(loop, state.at))
    return fmt::format("correct the errors in {}; then `{}`",
                       (folder_of(loop.project, state.at) / "carve-check.html").string(), loop_line(loop.project));
  return next;
}

// Returns true if all stages of a round are done and need no message.
bool is_whole(const std::vector<StageState>& states, int round) {
  return std::all_of(states.begin(), states.end(), [&](const StageState& state) {
    return state.at.round != round ||
           (state.up_to_date() &&
            (!state.record || (state.record->accepted_unknown.empty() && state.record->burin == version())));
  });
}

// Before the first board, lists hard to recognize pictures of the design. Empty: none.
std::string not_yet(const LoopProject& loop, int round) {
  const std::vector<std::string> views = unreadable_views(loop.project.round(round) / "design");
  if (round > 1 || views.empty()) return "";
  std::string names;
  for (const std::string& view : views) names += (names.empty() ? "" : ", ") + view;
  return fmt::format("do not carve it yet: few would recognize {} (see {}); give the board fewer pictures or more room",
                     names, (loop.project.round(round) / "carve-check.html").string());
}

}  // namespace

std::string loop_line(const Project& project, const std::string& more) {
  return "burin loop " + shell_word(project.folder.string()) + (more.empty() ? "" : " " + more);
}

std::string table_of(const LoopProject& loop, const std::vector<StageState>& states, bool brief, bool at_work) {
  std::string table;
  int round = -1;
  for (const StageState& state : states) {
    if (state.condition == Condition::not_begun) continue;
    if (brief && state.at.round > 0 && is_whole(states, state.at.round)) {
      if (state.at.round != round)
        table += fmt::format("{}: all is done\n", loop.project.round(state.at.round).filename().string());
      round = state.at.round;
      continue;
    }
    if (state.at.round != round) {
      round = state.at.round;
      table += round == 0 ? "whole loop" : loop.project.round(round).filename().string();
      table += '\n';
    }
    std::string words = at_work && state.condition == Condition::stopped ? "is being made now" : in_words(state);
    if (state.at.stage == StageKind::photos) {
      const std::string photos = counted(photos_of(loop.project, round).size(), "photo");
      words = state.changes.empty() ? photos : photos + ", " + words;
    }
    if (state.record && state.record->holds() && state.record->burin != version())
      words += fmt::format(" (made by Burin {}; this is {})", state.record->burin, version());
    if (state.record && !state.record->accepted_unknown.empty()) {
      words += "; accepted without being determined:";
      for (const std::string& name : state.record->accepted_unknown) words += " " + name;
    }
    table += fmt::format("  {:<10} {}\n", name_of(state.at.stage), words);
  }
  return table;
}

LoopQuestion question_of(const LoopProject& loop, const StageState& state) {
  const Project& project = loop.project;
  const std::string stage = name_of(state.at.stage), place = name_of(project, state.at);
  const bool metal =
      state.photographed && (state.at.stage == StageKind::design || state.at.stage == StageKind::toolpath);
  LoopQuestion question;
  if (state.condition == Condition::not_recorded)
    question.what = fmt::format("{} exists, but no record has its inputs", place);
  else if (state.changed(StageChange::Kind::output) && !has_result(loop, state.at))
    question.what = fmt::format("{}, which {} made", in_words(state.changes), place);
  else
    question.what = fmt::format("{} since {} was made", in_words(state.changes), place);
  const std::vector<ToldOtherwise> told = carved_otherwise(loop, state);
  if (!told.empty()) question.what += ": " + in_words(told);
  const std::string keep = fmt::format("`{}` goes on with it as it is", loop_line(project, "--allow-stale"));
  const std::string again =
      fmt::format("`{}` makes it again (the former goes to {})", loop_line(project, "--force " + place),
                  (folder_of(project, state.at) / "former").string());
  if (!told.empty())
    question.remedy = told_again(project, told) + (has_result(loop, state.at) ? "; or " + keep : "");
  else if (!has_result(loop, state.at))
    question.remedy = metal ? "put it back: that board is carved and photographed" : again;
  else if (metal)
    question.remedy = keep + "; it is not made again, since that board is carved and photographed";
  else
    question.remedy = again + ", " + keep;
  return question;
}

LoopQuestion question_of(const LoopProject& loop, const std::vector<StageState>& states) {
  if (states.empty()) fail(loop.project.folder.string(), "raises no question", "ask none");
  if (states.size() == 1) return question_of(loop, states.front());
  LoopQuestion all;
  std::string again, neither, missing_again, told;
  bool can_keep_all = true, can_make_all = true;
  for (const StageState& state : states) {
    const LoopQuestion one = question_of(loop, state);
    const auto [can_make, can_keep] = answers_to(loop, state);
    all.what += (all.what.empty() ? "" : "; ") + one.what;
    if (const std::vector<ToldOtherwise> numbers = carved_otherwise(loop, state); !numbers.empty())
      told = told_again(loop.project, numbers);
    const std::string option = "--force " + name_of(loop.project, state.at);
    if (can_make) again += (again.empty() ? "" : " ") + option;
    if (can_make && !can_keep) missing_again += (missing_again.empty() ? "" : " ") + option;
    if (!can_make && !can_keep) neither += (neither.empty() ? "" : "; ") + one.remedy;
    can_make_all = can_make_all && can_make;
    can_keep_all = can_keep_all && can_keep;
  }
  if (!neither.empty()) {
    all.remedy = neither;
    return all;
  }
  if (can_make_all)
    all.remedy = fmt::format("`{}` makes all of it again (the former goes to the rounds' former/)",
                             loop_line(loop.project, again));
  else if (!again.empty())
    all.remedy = fmt::format("`{}` makes again all that it can, and continues with the rest as it is",
                             loop_line(loop.project, again + " --allow-stale"));
  if (can_keep_all)
    all.remedy += fmt::format("{}`{}` goes on with all as it is", all.remedy.empty() ? "" : ", ",
                              loop_line(loop.project, "--allow-stale"));
  else if (can_make_all && missing_again != again)
    all.remedy += fmt::format(", `{}` makes only the missing parts again",
                              loop_line(loop.project, missing_again + " --allow-stale"));
  if (!told.empty()) all.remedy = told + "; or " + all.remedy;
  return all;
}

LoopQuestion question_of(const LoopProject& loop, int round, const std::vector<UnknownParameter>& open,
                         const std::string& photo) {
  std::string options;
  for (const UnknownParameter& u : open)
    options += (options.empty() ? "" : " ") + ("--allow-undetermined " + shell_word(u.name));
  LoopQuestion question;
  question.what = in_short(open) + ", and another board would be designed on a guess";
  const bool one =
      std::any_of(open.begin(), open.end(), [](const UnknownParameter& u) { return u.verdict.next_photo.has_value(); });
  question.remedy =
      fmt::format("take {}, put {} into {}, and say `{}` again; or go on without: `{}`",
                  one ? "the photo " + photo
                      : fmt::format("the photos that `burin plan {}` names", shell_word(loop.project.folder.string())),
                  one ? "it" : "them", photo_folders_in_words(loop.project, round), loop_line(loop.project),
                  loop_line(loop.project, options));
  return question;
}

std::string time_limit_in_words(const LoopProject& loop) {
  const auto limit = loop.options.design.find("time");
  if (limit == loop.options.design.end() || limit->second.empty()) return "";
  return fmt::format(", again for {} at most (`time` in {}, which `{}` changes)", limit->second.front(),
                     (loop.project.folder / "loop.toml").string(), loop_line(loop.project, "--time 2h"));
}

std::string next_of(const LoopProject& loop, const std::vector<StageState>& states) {
  const Project& project = loop.project;
  std::vector<StageState> asking;
  for (const StageState& state : states)
    if (needs_answer_now(state, states)) asking.push_back(state);
  if (!asking.empty()) {
    try {
      require_one_truth_to_carve(project);
    } catch (const Error& error) {
      return error.what();
    }
    const LoopQuestion question = question_of(loop, without_followers(asking));
    return question.what + "; " + question.remedy;
  }
  int waiting = 1;
  for (const StageState& state : states) {
    if (state.at.round == 0 || state.up_to_date() || !is_made_by_itself(state)) continue;
    if (state.at.stage == StageKind::photos) {
      waiting = state.at.round;
      break;
    }
    return next_of_stage(loop, state);
  }
  while (is_photographed(project, waiting)) ++waiting;
  if (states.size() <= 1 || !fs::is_directory(project.round(waiting))) {
    if (std::string why_not = why_not_designed(loop, waiting); !why_not.empty()) return why_not;
    return fmt::format("{}: `{}`", states.size() <= 1 ? "the first design" : "the design of the next board",
                       loop_line(project));
  }
  if (const std::optional<NextBoard> last = last_board(project))
    return fmt::format("{}; `{}` says how to carve it all the same", hang_in_words(*last),
                       loop_line(project, "--another"));
  std::string wait = not_yet(loop, waiting);
  if (!wait.empty()) wait += "; or ";
  const std::string changed = changed_since_sheet(project);
  return fmt::format("{}carve {}, put photos of it into {}{}; then `{}`", wait, gcode_of(loop, waiting),
                     photo_folders_in_words(project, waiting),
                     changed.empty() ? ""
                                     : fmt::format(" (print `burin sheet {}` again: {} changed since)",
                                                   shell_word(project.folder.string()), changed),
                     loop_line(project));
}

std::optional<NextBoard> last_board(const Project& project) {
  const std::optional<RoundsQuality> rounds = read_rounds(project.folder / "rounds.json");
  if (!rounds || static_cast<int>(rounds->size()) != next_to_carve(project)) return std::nullopt;  // outdated
  const std::optional<NextBoard> next = next_board(*rounds);
  return next && is_last(*next) ? next : std::nullopt;
}

std::string your_turn(const LoopProject& loop, int round) {
  const Project& project = loop.project;
  const DesignSpec spec = read_design(project.round(round) / "design.json");
  const Board board = read_board(spec.board);
  const Bench bench = read_bench_of(board, spec.board, spec.bench);
  std::istringstream places(
      where_to_stand(spec, bench, board,
                     shown_tolerances(spec, bench, board, project.round(round) / "design" / "design-report.json")));
  std::string where;
  for (std::string line; std::getline(places, line);) where += "       " + line + "\n";
  const std::string here = shell_word(project.folder.string()), changed = changed_since_sheet(project);
  const std::vector<std::string> lamps = photographed_lamps(spec, bench);
  const std::string one_lamp_at_once =
      lamps.size() < 2 ? ""
                       : "     Photos do not tell which lamp was on: photograph each place under one lamp after the "
                         "other, each alone,\n"
                         "     without touching the camera.\n";
  std::string wait = not_yet(loop, round);
  if (!wait.empty()) wait = "D" + wait.substr(1) + ".\n";
  return wait +
         fmt::format(
             "Your turn:\n"
             "  1. Read {}, run board-frame.gcode in the air, and carve {}.\n"
             "  2. Stick the tags on it (burin print {} makes them and shows where), and photograph it from these "
             "places\n"
             "     and from {} further ones that tell the rest of the bench. All of them in order, with drawings:\n"
             "     burin sheet {}{}\n{}{}"
             "  3. Put the photos into {}\n"
             "     (burin watch {} judges each as it comes); then: {}\n\n",
             (project.round(round) / "carve-check.html").string(), gcode_of(loop, round), here, PlanOptions{}.shots,
             here, changed.empty() ? "" : fmt::format(" (print it again: {} changed since)", changed), where,
             one_lamp_at_once, photo_folders_in_words(project, round), here, loop_line(project));
}

}  // namespace burin

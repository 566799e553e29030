#include "tools/loop/say.h"

#include <fmt/core.h>

#include <sstream>

#include "burin/capture/lamp_folders.h"
#include "burin/optimize/design_file.h"
#include "burin/render/bench_of_board.h"
#include "burin/render/board.h"
#include "tools/commands.h"
#include "tools/loop/round_lamps.h"
#include "tools/match_views.h"
#include "tools/photographed_lamps.h"
#include "tools/where_to_stand.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

using Condition = StageState::Condition;

// The G-code in carving order: one file, or its parts.
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

}  // namespace

std::string loop_line(const Project& project, const std::string& more) {
  return "burin loop " + shell_word(project.folder.string()) + (more.empty() ? "" : " " + more);
}

std::string table_of(const LoopProject& loop, const std::vector<StageState>& states) {
  std::string table;
  int round = -1;
  for (const StageState& state : states) {
    if (state.condition == Condition::not_begun) continue;
    if (state.at.round != round) {
      round = state.at.round;
      table += round == 0 ? "whole loop\n" : loop.project.round(round).filename().string() + "\n";
    }
    std::string words = in_words(state);
    if (state.at.stage == StageKind::photos)
      words =
          fmt::format("{} photo{}{}", photos_of(loop.project, round).size(),
                      photos_of(loop.project, round).size() == 1 ? "" : "s", state.changes.empty() ? "" : ", " + words);
    if (state.record && state.record->holds() && state.record->burin != BURIN_VERSION)
      words += fmt::format(" (made by Burin {}; this is {})", state.record->burin, BURIN_VERSION);
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
    question.what = fmt::format("{} is there, but no record tells what it was made from", place);
  else if (state.changed(StageChange::Kind::output) && !has_result(loop, state.at))
    question.what = fmt::format("{}, which {} made", in_words(state.changes), place);
  else
    question.what = fmt::format("{} since {} was made", in_words(state.changes), place);
  const std::string keep = fmt::format("`{}` goes on with it as it is", loop_line(project, "--keep"));
  const std::string again =
      fmt::format("`{}` makes it anew (what it replaces goes to {})", loop_line(project, "--again " + place),
                  (folder_of(project, state.at) / "former").string());
  if (!has_result(loop, state.at))
    question.remedy = metal ? "put it back: that board is carved and photographed" : again;
  else if (metal)
    question.remedy = keep + "; it is not made anew, since that board is carved and photographed";
  else
    question.remedy = again + ", " + keep;
  return question;
}

std::string next_of(const LoopProject& loop, const std::vector<StageState>& states) {
  for (const StageState& state : states)
    if (needs_answer_now(state, states)) {
      const LoopQuestion question = question_of(loop, state);
      return question.what + "; " + question.remedy;
    }
  const Project& project = loop.project;
  int waiting = 1;
  for (const StageState& state : states) {
    if (state.at.round == 0 || state.up_to_date() || !is_made_by_itself(state)) continue;
    if (state.at.stage == StageKind::photos) {
      waiting = state.at.round;
      break;
    }
    const std::string next = fmt::format("{}: `{}`", name_of(project, state.at), loop_line(project));
    if (state.condition != Condition::interrupted) return next;
    return fmt::format("{} (or `{}`, which takes it as good as it got)", next, loop_line(project, "--keep"));
  }
  if (states.size() <= 1) return fmt::format("the first design: `{}`", loop_line(project));
  while (is_photographed(project, waiting)) ++waiting;
  if (!fs::is_directory(project.round(waiting)))
    return fmt::format("the design of the next board: `{}`", loop_line(project));
  return fmt::format("carve {}, put photos of it into {}; then `{}`", gcode_of(loop, waiting),
                     photo_folders_in_words(project, waiting), loop_line(project));
}

std::string your_turn(const LoopProject& loop, int round) {
  const Project& project = loop.project;
  const DesignSpec spec = read_design(project.round(round) / "design.json");
  const Board board = read_board(spec.board);
  const Bench bench = read_bench_of(board, spec.board, spec.bench);
  std::istringstream places(
      where_to_stand(spec, bench, board,
                     match_tolerances(spec, bench, board, project.round(round) / "design" / "design-report.json")));
  std::string where;
  for (std::string line; std::getline(places, line);) where += "       " + line + "\n";
  const std::string here = shell_word(project.folder.string());
  const std::vector<std::string> lamps = photographed_lamps(spec, bench);
  const std::string one_lamp_at_once =
      lamps.size() < 2 ? ""
                       : "     Photos do not tell which lamp was on: photograph each place under one lamp after the "
                         "other, each alone,\n"
                         "     without touching the camera.\n";
  return fmt::format(
      "Your turn:\n"
      "  1. Read {}, run board-frame.gcode in the air, and carve {}.\n"
      "  2. Stick the tags on it (burin print {} makes them and shows where), and photograph it\n"
      "     (burin sheet {} draws the places):\n{}"
      "     and from three places near the mirror direction, where the plain face shines, and from five or more\n"
      "     further ones, with the camera tilted and the board in other parts of the frame. Keep focus and zoom as\n"
      "     they are. Some views must hardly glint: only half vectors on both sides of the grooves' cut-off angle "
      "tell\n"
      "     how deep they are. The best such places, in words and mm: burin plan {}\n{}"
      "  3. Put the photos into {}\n"
      "     (burin watch {} judges each as it comes); then: {}\n\n",
      (project.round(round) / "carve-check.html").string(), gcode_of(loop, round), here, here, where, here,
      one_lamp_at_once, photo_folders_in_words(project, round), here, loop_line(project));
}

}  // namespace burin

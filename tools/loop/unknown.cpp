#include "tools/loop/unknown.h"

#include <fmt/format.h>

#include <algorithm>

#include "burin/scene/parameter_name.h"
#include "tools/loop/record.h"
#include "tools/round_names.h"

namespace burin {
namespace {

// A weakly determined value of these is insufficient for the next design.
bool must_be_determined(const std::string& name, const std::set<std::string>& lamps) {
  return name == parameter::kDepth || std::any_of(lamps.begin(), lamps.end(), [&](const std::string& lamp) {
           return name == parameter::light_position(lamp);
         });
}

bool must_be_known(const std::string& name) { return name == parameter::kAlpha || name == parameter::kMachine; }

std::string how_far_known(const Verdict& verdict) {
  return verdict.known() ? "determined only weakly" : "not determined";
}

// Returns the lamps of the next design, by their names in the round's measured bench.
std::set<std::string> lamps_used(const Project& project, int round) {
  std::set<std::string> lamps;
  for (const Match& match : match_round(project, round).lamps)
    if (!match.measured.empty()) lamps.insert(match.measured);
  return lamps;
}

}  // namespace

std::vector<UnknownParameter> unknown_in(const Bench& measured, const std::set<std::string>& lamps) {
  std::vector<UnknownParameter> unknown;
  for (const auto& [name, verdict] : measured.verdict)
    if ((must_be_determined(name, lamps) && !verdict.determined()) || (must_be_known(name) && !verdict.known()))
      unknown.push_back({name, verdict});
  return unknown;
}

std::vector<Finding> weakly_known_in(const Bench& measured, const std::filesystem::path& file) {
  std::vector<Finding> weak;
  for (const auto& [name, verdict] : measured.verdict)
    if (must_be_known(name) && verdict.degree == Degree::weakly)
      weak.push_back({FindingCode::parameter_undetermined, Finding::Severity::warning, file,
                      fmt::format("{} is {}, and the next design rests on it: {}", name, how_far_known(verdict),
                                  sentence(verdict)),
                      ""});
  return weak;
}

ToldByRound told_by_round(const LoopProject& loop, int round, const std::vector<std::string>& accepted) {
  const std::filesystem::path file = loop.project.round(round) / "bench.json";
  const std::optional<MadeRecord> record = read_record(record_file(loop.project, {round, StageKind::refine}));
  const Bench measured = read_bench(file);
  ToldByRound told;
  for (const UnknownParameter& u : unknown_in(measured, lamps_used(loop.project, round))) {
    const auto names_it = [&](const std::vector<std::string>& names) {
      return std::find(names.begin(), names.end(), u.name) != names.end();
    };
    const bool goes_on =
        names_it(accepted) || names_it(loop.options.accept_unknown) || (record && names_it(record->accepted_unknown));
    (goes_on ? told.accepted : told.open).push_back(u);
  }
  told.weak = weakly_known_in(measured, file);
  return told;
}

std::string in_words(const std::vector<UnknownParameter>& unknown) {
  std::string words;
  for (const UnknownParameter& u : unknown) {
    words += fmt::format("  {} is {}: {}\n", u.name, how_far_known(u.verdict), sentence(u.verdict));
    if (u.verdict.next_photo)
      words += fmt::format("    next photo: {}\n", sentence(*u.verdict.next_photo, u.verdict.unit));
  }
  return words;
}

std::string in_short(const std::vector<UnknownParameter>& unknown) {
  std::string words;
  for (const bool known : {false, true}) {
    std::string names, how;
    int count = 0;
    for (const UnknownParameter& u : unknown) {
      if (u.verdict.known() != known) continue;
      names += (names.empty() ? "" : ", ") + u.name;
      how = how_far_known(u.verdict);
      ++count;
    }
    if (count > 0) words += fmt::format("{}{} {} {}", words.empty() ? "" : "; ", names, count == 1 ? "is" : "are", how);
  }
  return words;
}

}  // namespace burin

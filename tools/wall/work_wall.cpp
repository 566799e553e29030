#include "tools/wall/work_wall.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <set>
#include <thread>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/base/files/descriptor.h"
#include "burin/base/files/file_error.h"
#include "burin/base/input_error.h"
#include "burin/base/simd_width.h"
#include "burin/optimize/wall/wall_shares.h"
#include "tools/commands.h"
#include "tools/loop/round_design.h"
#include "tools/loop/say.h"
#include "tools/loop/turn.h"
#include "tools/stop_signal.h"
#include "tools/version.h"
#include "tools/wall/claim.h"
#include "tools/wall/lay_wall.h"
#include "tools/wall/wall_preview.h"
#include "tools/work_lock.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSettle = "settle";  // the claim for the couplings

// The first worker writes its program's version and SIMD width; others must have the same. Both decide on the last bits
// of a design.
void require_one_program(const fs::path& claims) {
  make_output_folder(claims);
  const fs::path file = claims / "program.json";
  const std::string own_version = version(), simd = name(resolved_simd(SimdWidth::best));
  const Json mine{{"format", "burin/wall-program"}, {"version", 1}, {"burin", own_version}, {"simd", simd}};
  const Descriptor made(::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0666));
  if (made) {
    if (const int error = write_all(made.number(), mine.dump() + "\n"); error != 0) {
      ::unlink(file.c_str());
      fail_with(file, "cannot be written", error);
    }
    ::fsync(made.number());
    return;
  }
  if (errno != EEXIST) fail_with(file, "cannot be made, and without it workers could differ", errno);
  constexpr int kTries = 50;
  for (int i = 0; fs::file_size(file) == 0 && i < kTries; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  const Json json = read_json(file, "burin/wall-program", 1);
  JsonObject theirs(json, file.string());
  const std::string other_version = theirs.text("burin"), other_simd = theirs.text("simd");
  if (other_version == own_version && other_simd == simd) return;
  fail_as(
      ErrorCode::refused, file.string(),
      fmt::format("the wall's workers run burin {} with --simd {}, and this is burin {} with {}; their boards would "
                  "differ in the last bits",
                  other_version, other_simd, own_version, simd),
      other_version == own_version
          ? "start it as: burin --simd " + other_simd + " wall work"
          : "use the same version, or end all workers and remove this file to go on with this one");
}

// Next stage of one board.
struct BoardNeed {
  enum class Kind { nothing, preview, couplings, loop, answer } kind = Kind::nothing;
  std::string words;  // of the state
};

BoardNeed need_of_loop(const fs::path& folder, ContentHashes& hashes) {
  const LoopProject loop{{folder}, read_loop_options(folder)};
  for (const StageState& state : states_of(loop, hashes)) {
    if (needs_answer(state)) return {BoardNeed::Kind::answer, question_of(loop, state).what};
    const bool waits = state.at.stage == StageKind::photos && state.condition != StageState::Condition::done &&
                       photos_of(loop.project, state.at.round).empty();
    const bool simulated = fs::exists(folder / "truth.json") && state.at.round <= 1;
    if (waits && !simulated) {
      const StageState whole = state_of(loop, {0, StageKind::report}, hashes);
      if (!is_made_by_itself(whole))
        return {BoardNeed::Kind::nothing,
                "ready to carve: " + (folder / fmt::format("round-{:02}", state.at.round)).string()};
      return {BoardNeed::Kind::loop, name_of(whole.at.stage)};
    }
    if (is_made_by_itself(state)) return {BoardNeed::Kind::loop, name_of(loop.project, state.at)};
  }
  return {};
}

BoardNeed need_of(const Wall& wall, const LaidWall& laid, const std::optional<SettledWall>& settled, std::size_t index,
                  ContentHashes& hashes) {
  const std::string& name = wall.boards[index].name;
  if (laid.is_blank(name)) return {BoardNeed::Kind::nothing, "blank: it stays dark in all views"};
  if (settled) return need_of_loop(wall.folder / name, hashes);
  if (!read_preview(wall.folder, name, laid.key)) return {BoardNeed::Kind::preview, "preview"};
  return {BoardNeed::Kind::couplings, "waits for the previews of other boards"};
}

void turn_board(const Wall& wall, std::size_t index, const SettledWall& settled) {
  const Project project{wall.folder / wall.boards[index].name};
  const WorkLock lock(project.folder, "burin wall work");
  settle_design(wall, index, settled);
  require_own_files(project);
  for (int round = 1; round <= project.rounds(); ++round) make_output_folder(project.round(round));
  const LoopProject loop{project, read_loop_options(project.folder)};
  turn_loop(loop, {});
}

SettledWall solve_couplings(const Wall& wall, const LaidWall& laid) {
  std::vector<BoardPreview> previews;
  std::vector<std::string> names;
  for (const WallBoard& b : wall.boards) {
    if (laid.is_blank(b.name)) continue;
    auto preview = read_preview(wall.folder, b.name, laid.key);
    if (!preview || preview->views.size() != wall.views.size())
      fail((wall.folder / b.name).string(), "has no preview yet", "run: burin wall work " + wall.folder.string());
    previews.push_back(std::move(*preview));
    names.push_back(b.name);
  }
  SettledWall settled;
  settled.key = laid.key;
  settled.exposures = common_exposures(previews);
  const std::vector<int> counts = wall.machine_hours > 0 ? shared_hours(previews, 3600 * wall.machine_hours)
                                                         : shared_scratches(previews, wall.scratches);
  for (std::size_t b = 0; b < names.size(); ++b) settled.scratches[names[b]] = counts[b];
  return settled;
}

// wall.json and the layout as read at the start must still be those on disk.
void refuse_changed_wall(const fs::path& folder, const LaidWall& first) {
  if (read_laid(folder).key != first.key)
    fail((folder / "wall.json").string(), "was changed and laid out anew while this worker ran",
         "start this worker again: nothing is lost");
}

bool is_working(const LatestClaim& claim) {
  return claim.number > 0 && (!claim.text || claim.text->state == ClaimState::working);
}

struct WallWork {
  fs::path folder;
  Wall wall;
  LaidWall laid;
  WallWorkOptions options;
  ContentHashes hashes;
  Heartbeats heartbeats;
  std::set<std::string> finished;  // boards without work for this process
  std::size_t made = 0, failed = 0, asking = 0;
};

enum class Took { something, nothing, waits };

// Claims, works and ends. Returns false if another worker was faster.
template <typename Do>
bool do_claimed(WallWork& w, const std::string& board, const std::string& stage, int number, const Do& work) {
  const auto claim = Claim::make(w.folder / "claims", board, stage, number);
  if (!claim) return false;
  print_event("claim", {{"board", board}, {"stage", stage}}, fmt::format("\n==== {}: {}\n", board, stage));
  try {
    work();
    claim->end(ClaimState::done);
    ++w.made;
  } catch (const Error& error) {
    if (StopOnSignal::asked()) {  // a design that ended early; it is made anew
      claim->end(ClaimState::stopped);
      throw Stopped{};
    }
    claim->end(ClaimState::failed, error.what());
    tell(make_warning(FindingCode::wall_board, fmt::format("{}: {}", board, error.what())));
    ++w.failed;
    w.finished.insert(board);
  }
  if (stage == "board") w.finished.insert(board);
  return true;
}

Took take_next(WallWork& w) {
  refuse_changed_wall(w.folder, w.laid);
  const auto claims = read_claims(w.folder / "claims");
  const auto latest = [&](const std::string& board) {
    const auto found = claims.find(board);
    return found == claims.end() ? LatestClaim{} : found->second;
  };
  const auto settled = read_settled(w.folder, w.laid.key);
  bool others = false, some_wait = false;
  for (std::size_t b = 0; b < w.wall.boards.size(); ++b) {
    const std::string& board = w.wall.boards[b].name;
    if (w.finished.contains(board)) continue;
    const LatestClaim claim = latest(board);
    if (is_working(claim) && !w.heartbeats.is_dead(board, claim, w.options.stale)) {
      others = true;
      continue;
    }
    const BoardNeed need = need_of(w.wall, w.laid, settled, b, w.hashes);
    const bool has_failed = claim.text && claim.text->state == ClaimState::failed;
    if (need.kind == BoardNeed::Kind::couplings) some_wait = true;
    if (need.kind == BoardNeed::Kind::nothing) w.finished.insert(board);
    if (need.kind == BoardNeed::Kind::answer) {
      ++w.asking;
      w.finished.insert(board);
      tell(make_warning(FindingCode::wall_board, fmt::format("board {} waits for an answer: {}", board, need.words),
                        "give it with: burin loop " + shell_word((w.folder / board).string())));
    }
    if (need.kind != BoardNeed::Kind::preview && need.kind != BoardNeed::Kind::loop) continue;
    if (has_failed && !w.options.retry) {
      w.finished.insert(board);
      ++w.failed;
      tell(make_warning(FindingCode::wall_board, fmt::format("board {} failed before: {}", board, claim.text->words),
                        "repair it and use --retry"));
      continue;
    }
    const bool preview = need.kind == BoardNeed::Kind::preview;
    const bool took = do_claimed(w, board, preview ? "preview" : "board", claim.number + 1, [&] {
      if (preview)
        make_preview(w.wall, w.laid, b);
      else
        turn_board(w.wall, b, *settled);
    });
    if (took) return Took::something;
    others = true;
  }
  if (others) return Took::waits;
  if (!some_wait || settled || w.failed > 0) return Took::nothing;
  const LatestClaim claim = latest(kSettle);
  if (is_working(claim) && !w.heartbeats.is_dead(kSettle, claim, w.options.stale)) return Took::waits;
  return do_claimed(w, kSettle, kSettle, claim.number + 1,
                    [&] { write_settled(w.wall, w.laid, solve_couplings(w.wall, w.laid)); })
             ? Took::something
             : Took::waits;
}

}  // namespace

Report work_on_wall(const fs::path& folder, const WallWorkOptions& options) {
  WallWork w{folder, read_wall(folder), read_laid(folder), options, {}, {}, {}, 0, 0, 0};
  require_one_program(folder / "claims");
  constexpr std::chrono::seconds kToEnd(30);  // Slurm waits about as long before it kills
  const StopOnSignal stop(kToEnd);
  for (bool said = false;;) {
    stop_if_asked();
    const Took took = take_next(w);
    if (took == Took::nothing) break;
    if (took == Took::something) {
      said = false;
      continue;
    }
    if (!said) print_event("waits", {}, "waiting for boards that other workers have\n");
    said = true;
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
  }
  Report report;
  report.line("{} stages made; {} boards failed, {} wait for an answer. Who does what: burin wall status {}\n",
              fact("stages", w.made), fact("failed", w.failed), fact("asking", w.asking), shell_word(folder.string()));
  report.next.push_back({"burin", "wall", "status", folder.string()});
  if (w.failed + w.asking > 0)
    report.failure = InputError(ErrorCode::question, folder.string(),
                                fmt::format("{} of its boards could not be finished", w.failed + w.asking),
                                "see the warnings above");
  return report;
}

Report settle_wall(const fs::path& folder) {
  const Wall wall = read_wall(folder);
  const LaidWall laid = read_laid(folder);
  const SettledWall settled = solve_couplings(wall, laid);
  write_settled(wall, laid, settled);
  Report report;
  for (std::size_t k = 0; k < wall.views.size(); ++k) {
    Facts view = report.add("views");
    view.line("view {}: exposure {:.6g} on all boards\n", fact("view", wall.views[k].name),
              fact("exposure", settled.exposures[k]));
  }
  for (std::size_t b = 0; b < wall.boards.size(); ++b) {
    const std::string& name = wall.boards[b].name;
    if (laid.is_blank(name)) continue;
    Facts board = report.add("boards");
    board.line("board {}: {} scratches (its area's share: {})\n", fact("board", name),
               fact("scratches", settled.scratches.at(name)), preview_scratches(wall, b));
  }
  report.next.push_back({"burin", "wall", "work", folder.string()});
  report.line("Wrote {}; next: {}\n", (folder / "settled.json").string(), command_text(report.next.front()));
  return report;
}

Report wall_status(const fs::path& folder) {
  const Wall wall = read_wall(folder);
  const LaidWall laid = read_laid(folder);
  const auto settled = read_settled(folder, laid.key);
  const auto claims = read_claims(folder / "claims");
  ContentHashes hashes;
  Report report;
  std::map<std::string, std::size_t> sums;
  report.line("{}: {}, {}\n", folder.string(), counted(wall.boards.size(), "board"),
              counted(wall.views.size(), "view"));
  const auto add = [&](const std::string& board, const std::string& state, const std::string& words) {
    ++sums[state];
    Facts facts = report.add("boards");
    facts.line("  {:<12} {:<10} {}\n", fact("board", board), fact("state", state), fact("words", words));
  };
  for (std::size_t b = 0; b < wall.boards.size(); ++b) {
    const std::string& name = wall.boards[b].name;
    const auto found = claims.find(name);
    const ClaimText* claim = found != claims.end() && found->second.text ? &*found->second.text : nullptr;
    const bool working = claim && claim->state == ClaimState::working;
    const std::string who =
        working ? fmt::format("{} by process {} on {} since {} ({} threads, heartbeat {})", claim->stage,
                              claim->process, claim->host, claim->began, claim->threads, claim->pulse)
                : "";
    if (working && !has_ended_here(*claim)) {
      add(name, "working", who);
      continue;
    }
    BoardNeed need;
    try {
      need = need_of(wall, laid, settled, b, hashes);
    } catch (const Error& error) {
      add(name, "broken", error.what());
      continue;
    }
    const bool open = need.kind == BoardNeed::Kind::preview || need.kind == BoardNeed::Kind::loop;
    if (open && working)
      add(name, "abandoned", who + ", which has ended; a worker takes it over");
    else if (open && claim && claim->state == ClaimState::failed)
      add(name, "failed", claim->words);
    else if (need.kind == BoardNeed::Kind::answer)
      add(name, "asks", need.words);
    else if (need.kind == BoardNeed::Kind::nothing)
      add(name, laid.is_blank(name) ? "blank" : "ready", need.words);
    else
      add(name, open ? "free" : "waits", need.words);
  }
  std::string line;
  for (const auto& [state, count] : sums) line += fmt::format("{}{} {}", line.empty() ? "" : ", ", count, state);
  report.all().set("settled", settled.has_value());
  report.next.push_back({"burin", "wall", "work", folder.string()});
  report.line("{}; exposures {}. Next: {}\n", line, settled ? "settled" : "not settled yet",
              command_text(report.next.front()));
  return report;
}

}  // namespace burin

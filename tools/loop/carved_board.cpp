#include "tools/loop/carved_board.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

// Returns the board.json of a round's carved board. After an interrupted repetition, it is the latest moved one. Empty:
// none.
fs::path carved_board_file(const fs::path& round) {
  if (fs::exists(round / "board.json")) return round / "board.json";
  fs::path last;
  if (fs::is_directory(round / "former"))
    for (const auto& entry : fs::directory_iterator(round / "former"))
      if (entry.path().filename().string().ends_with("-board") && fs::exists(entry.path() / "board.json"))
        last = std::max(last, entry.path() / "board.json");
  return last;
}

void compare_told(const char* field, double now, const std::optional<double>& then, const fs::path& told,
                  std::vector<ToldOtherwise>& out) {
  constexpr double kSame = 1e-9;  // as in burin/scene/bench_of_board.h
  if (!then || std::abs(now - *then) <= kSame * std::max(std::abs(now), std::abs(*then))) return;
  if (std::none_of(out.begin(), out.end(), [&](const ToldOtherwise& other) { return other.field == field; }))
    out.push_back({field, now, *then, told});
}

}  // namespace

std::vector<ToldOtherwise> told_otherwise(const Project& project, int round) {
  const fs::path folder = project.round(round), carved = carved_board_file(folder), measured = folder / "bench.json";
  const Board now = read_board(project.folder / "board.json");
  std::vector<ToldOtherwise> out;
  const auto compare = [&](const std::optional<double>& width_um, const std::optional<double>& depth_um,
                           const std::optional<double>& alpha, const fs::path& told) {
    compare_told("tool.width_um", now.tool_width_um, width_um, told, out);
    compare_told("material.depth_um", now.material.depth_um, depth_um, told, out);
    compare_told("material.alpha", now.material.alpha, alpha, told, out);
  };
  if (!carved.empty()) {
    const Board then = read_board(carved);
    compare(then.tool_width_um, then.material.depth_um, then.material.alpha, carved);
  }
  if (!fs::exists(measured)) return out;
  try {
    const Bench bench = read_bench(measured);
    compare(bench.told.tool_width_um, bench.told.depth_um, bench.told.alpha, measured);
  } catch (const Error&) {  // the next reader of the file reports its error
  }
  return out;
}

std::string in_words(const std::vector<ToldOtherwise>& numbers) {
  std::string words;
  for (const ToldOtherwise& n : numbers)
    words +=
        fmt::format("{}{} is {}, but {}, of a board that is carved and photographed, has {}", words.empty() ? "" : "; ",
                    n.field, significant(n.now, 6), n.told.string(), significant(n.then, 6));
  return words;
}

std::string told_again(const Project& project, const std::vector<ToldOtherwise>& numbers) {
  std::string words;
  for (const ToldOtherwise& n : numbers)
    words += fmt::format("{}{} {}", words.empty() ? "" : ", ", n.field, significant(n.then, 6));
  return fmt::format("write {} into {} again", words, (project.folder / "board.json").string());
}

void require_told_as_carved(const Project& project, int round) {
  const std::vector<ToldOtherwise> numbers = told_otherwise(project, round);
  if (numbers.empty()) return;
  fail((project.folder / "board.json").string(), in_words(numbers),
       told_again(project, numbers) + ": its photos do not determine the machine's depth for another number");
}

}  // namespace burin

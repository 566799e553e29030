#include "tools/loop/round_depth.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "burin/base/files/decimals.h"
#include "burin/optimize/machine_profile.h"
#include "burin/optimize/toolpath/sheet.h"
#include "burin/scene/bench_of_board.h"
#include "burin/scene/board.h"

namespace burin {

namespace fs = std::filesystem;

std::optional<RoundDepth> depth_of_round(const Project& project, const LoopOptions& options, int number) {
  if (number < 2) return std::nullopt;
  const fs::path board_file = project.folder / "board.json";
  const Board board = read_board(board_file);
  const Bench bench = read_bench_of(board, board_file, project.bench_before(number));
  if (!depth_is_measured(bench)) return std::nullopt;
  RoundDepth out;
  out.told_um = out.wanted_um = board.material.depth_um;
  out.made_um = bench.material.depth_um;
  out.sigma_um = *bench.material_sigma.depth_um;
  constexpr double kSigmas = 2, kAlike = 0.03;
  if (std::abs(out.made_um - out.told_um) <= std::max(kSigmas * out.sigma_um, kAlike * out.told_um))
    return std::nullopt;
  const double gain = out.made_um / out.told_um;
  double least_um = 0, most_um = 1e9;  // range of the machine's commanded depths
  const MachineProfile machine = machine_profile(machine_argument(options, project.folder));
  if (machine.depth_by != DepthBy::fixed_z && !machine.depth_table.rows.empty()) {
    least_um = machine.depth_table.rows.front().depth_um;
    most_um = machine.depth_table.rows.back().depth_um;
  }
  // Rounded to 0.01 um, within the machine's range.
  constexpr double kRounding = 100;
  out.depth_um = std::round(kRounding * out.wanted_um) / kRounding;
  if (out.depth_um > most_um * gain) out.depth_um = std::floor(kRounding * most_um * gain) / kRounding;
  if (out.depth_um < least_um * gain) out.depth_um = std::ceil(kRounding * least_um * gain) / kRounding;
  out.command_um = out.depth_um / gain;
  return out;
}

std::string in_words(const RoundDepth& depth) {
  const double part = depth.sigma_um / depth.made_um;
  return fmt::format(
      "the machine makes {} +- {} um of {} um that it is told: this board is designed {} um deep{}, and told {} um "
      "for it (one sigma of what becomes of it: {} um)",
      fixed(depth.made_um, 1), significant(depth.sigma_um), significant(depth.told_um, 4),
      significant(depth.depth_um, 4),
      depth.as_wanted() ? ""
                        : fmt::format(", not {} um, because the machine's depth table ends there", depth.wanted_um),
      fixed(depth.command_um, 1), significant(part * depth.depth_um));
}

}  // namespace burin

// burin/optimize/toolpath/toolpath_plan.h - scratches to a planned path: compensated, on the machine's steps, checked
// by all rules, and ordered; and the remainder of an interrupted file. burin/optimize/toolpath.h defines the commanded
// scratches.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "burin/base/progress.h"
#include "burin/optimize/machine_profile.h"
#include "burin/optimize/toolpath/carving_limits.h"
#include "burin/optimize/toolpath/height_map.h"
#include "burin/optimize/toolpath/planned_path.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"
#include "burin/scene/scratches.h"

namespace burin {

/// An interrupted file of G-code, and the line (from 1) at which the machine stopped. Scratches before that line are
/// done; the scratch of the line, and later ones, are not.
struct Interruption {
  std::filesystem::path file;
  std::size_t line = 0;
};

/// Options of plan_toolpath().
struct ToolpathOptions {
  /// Carve in the file's order, or in the shortest. Unset: in the file's if the order affects the bench
  /// (order_matters), since the board was designed for it.
  std::optional<bool> keep_order{};
  bool follow_bow = false;  ///< depths follow the bench's measured bow: the same sheet, in the position of the photos
  /// G-code: also a file with a path around the scratches at safe height, for a check of their fit
  bool frame = false;
  double part_s = 0;  ///< split G-code into files of at most about this length; 0: as few files as max_lines allows
  std::optional<Interruption> after{};  ///< carve only the remainder of this file, in its order
  std::optional<HeightMap> heights{};   ///< of the face on the machine: depths follow it
  std::vector<double> feed_mm_min{};    ///< of each given scratch (a test piece's); empty: the machine's for all
};

/// The rules of a tool path. `measured` may be null.
CarvingLimits toolpath_limits(const Board& board, const Bench* measured, const MachineProfile& machine);

/// Orders and compensates scratches not carved yet. `measured` may be null. Depths count from the followed face, else
/// from z = 0. Throws Error, with the row, for a scratch outside of the rules of the board and the machine
/// (burin/optimize/toolpath/carving_limits.h), judged on the machine's steps. Compensated ends beyond the machine's
/// reach are an Error too. Also throws if nothing is to be carved, if a scratch leaves the height map, and for a depth
/// beyond the machine's table.
Toolpath plan_toolpath(const Scratches& scratches, const Board& board, const Bench* measured,
                       const MachineProfile& machine, const ToolpathOptions& options = {},
                       const Progress& progress = {});

/// The remainder of an interrupted tool path: its scratches from that of `line` on, in its order. `planned` must hold
/// all scratches of the file (it may hold more: other parts); `text` is the file's content. By replay, the carved
/// scratches before the line and the remainder are together the file's scratches, once each. Throws Error if the file
/// was cut off, if it carves unplanned scratches (another board, bench or machine), if the line is not in the file, and
/// if nothing or everything is left.
Toolpath left_after(const Toolpath& planned, const MachineProfile& machine, std::string_view text, std::size_t line,
                    const std::string& name);

}  // namespace burin

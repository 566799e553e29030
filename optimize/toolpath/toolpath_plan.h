// burin/optimize/toolpath/toolpath_plan.h - scratches into a planned path: compensated, on the machine's steps, judged
// by all rules, ordered; and what an interrupted file left of one. burin/optimize/toolpath.h says what is sent.
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

/// A file of G-code in which the machine stopped, and the line (from 1) that it was at: what is carved before it is
/// done; the scratch that it was at, and what follows, is not.
struct Interruption {
  std::filesystem::path file;
  std::size_t line = 0;
};

struct ToolpathOptions {
  /// Carve in the file's order, or in the shortest. Unsaid: in the file's where the bench says that it shows
  /// (order_matters), for the board was designed for it.
  std::optional<bool> keep_order{};
  bool follow_bow = false;  ///< depths follow the bench's measured bow: the same sheet, lying as it was photographed
  bool frame = false;       ///< G-code: also a file that moves round the scratches at safe height, to see that they fit
  double part_s = 0;        ///< split G-code into files of at most about this long; 0: as few files as max_lines allows
  std::optional<Interruption> after{};  ///< carve only what this file left, in its order
  std::optional<HeightMap> heights{};   ///< of the face as it lies on the machine: depths follow it
  std::vector<double> feed_mm_min{};    ///< of each scratch given (a test piece's); empty: the machine's for all
};

/// The rules that a tool path obeys. `measured` may be null.
CarvingLimits toolpath_limits(const Board& board, const Bench* measured, const MachineProfile& machine);

/// Orders and compensates what is not carved yet. `measured` may be null. Throws Error when there is nothing to carve,
/// for a scratch that breaks the rules of the board and the machine (burin/optimize/toolpath/carving_limits.h; judged
/// as the machine will carve it, on its steps), and for one whose compensated ends the machine cannot reach; each is
/// named by its row. Depths count from the face that is to be followed, else from z = 0; a scratch that leaves the
/// height map, and a depth beyond the machine's table, are Errors too.
Toolpath plan_toolpath(const Scratches& scratches, const Board& board, const Bench* measured,
                       const MachineProfile& machine, const ToolpathOptions& options = {},
                       const Progress& progress = {});

/// What an interrupted file left of a tool path: its scratches from the one on that its `line` belongs to, in its
/// order. `planned` must hold all scratches of the file (it may hold more: other parts), `text` is the file's content.
/// By replay: what was carved before the line and what is left are together the file's scratches, once each. Throws
/// Error if the file was cut off, if it carves anything that is not planned (another board, bench or machine), if the
/// line is not in the file, and if nothing or everything is left.
Toolpath left_after(const Toolpath& planned, const MachineProfile& machine, std::string_view text, std::size_t line,
                    const std::string& name);

}  // namespace burin

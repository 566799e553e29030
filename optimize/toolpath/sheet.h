// burin/optimize/toolpath/sheet.h - whether a machine reaches its depths on a sheet that is not quite even.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "burin/base/finding.h"
#include "burin/optimize/machine_profile.h"
#include "burin/optimize/toolpath/face.h"
#include "burin/optimize/toolpath/planned_path.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"

namespace burin {

/// What is known of how far the face's highest place lies above its lowest, over the carve area.
struct Unevenness {
  double mm = 0;
  std::string source;  ///< in words: "board.json's flatness_um", "the bow that photos measured"
};

/// A person's number or the measured bow, whichever is more; nothing where nobody knows. `measured` may be null.
std::optional<Unevenness> known_unevenness(const Board& board, const Bench* measured);

/// Whether photos told how deep this bench's grooves are: if not, the machine is told what it was told before.
bool depth_is_measured(const Bench& bench);

/// The face that depths are to follow: the probed one, or the bow that photos measured; even where neither is asked
/// for. Throws Error for a bow that nobody measured.
Face face_to_follow(const Board& board, const Bench& bench, const std::optional<HeightMap>& heights, bool follow_bow);

/// Depths that the path wants, mm.
struct DepthRange {
  double least_mm = 0, most_mm = 0;
};
DepthRange depth_range(const Toolpath& path);

/// By how much the depth differs over an uneven face that is not followed, mm: all of it for a fixed Z, what the table
/// makes of it for a spring or a drag bit, nothing for a servo.
double depth_error_mm(const MachineProfile& machine, double depth_mm, double unevenness_mm);

/// What a person should know of this path's depths on this sheet. An error: a depth that will differ by more than half
/// of itself. Warnings: by more than a tenth, and where nobody knows how even the face is, or what the machine's table
/// really is.
std::vector<Finding> sheet_findings(const Toolpath& path, const Board& board, const Bench* measured,
                                    const MachineProfile& machine);

}  // namespace burin

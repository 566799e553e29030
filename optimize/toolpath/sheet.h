// burin/optimize/toolpath/sheet.h - accuracy of a machine's depths on an uneven sheet.
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

/// Known height difference between the face's highest and lowest place over the carve area.
struct Unevenness {
  double mm = 0;
  std::string source;  ///< in words: "board.json's flatness_um", "the bow that photos measured"
};

/// A person's number or the measured bow, whichever is larger; nothing if neither is known. `measured` may be null.
std::optional<Unevenness> known_unevenness(const Board& board, const Bench* measured);

/// True if photos measured this bench's groove depth; otherwise the commanded depths stay as before.
bool depth_is_measured(const Bench& bench);

/// The face that depths follow: the probed one, the measured bow, or an even face if neither is requested. Throws Error
/// for a bow without a measurement.
Face face_to_follow(const Board& board, const Bench& bench, const std::optional<HeightMap>& heights, bool follow_bow);

/// Depths of the path, mm.
struct DepthRange {
  double least_mm = 0, most_mm = 0;
};
DepthRange depth_range(const Toolpath& path);

/// Depth difference over an uneven face without compensation, mm: all of it for a fixed Z, the table's response for a
/// spring or a drag bit, nothing for a servo.
double depth_error_mm(const MachineProfile& machine, double depth_mm, double unevenness_mm);

/// Findings about this path's depths on this sheet. An error: a depth that differs by more than half of itself.
/// Warnings: a difference of more than a tenth, an unknown evenness of the face, and an unmeasured table of the
/// machine.
std::vector<Finding> sheet_findings(const Toolpath& path, const Board& board, const Bench* measured,
                                    const MachineProfile& machine);

}  // namespace burin

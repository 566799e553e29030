// burin/scene/files/machine_json.h - what a machine does to what it is told, as bench.json ("machine") and a design's
// report keep it.
#pragma once

#include <Eigen/Core>

#include "burin/base/files/json_file.h"
#include "burin/scene/machine_errors.h"

namespace burin {

/// {"affine": [[..], [..]]} and what there is of {"backlash_mm": [x, y], "screw_mm": [x, y], "screw_period_mm": [x, y],
/// "screw_phase_deg": [x, y]} with their sigmas.
Json machine_json(const Eigen::Matrix<double, 2, 3>& affine, const MachineErrors& errors);

/// The key "affine", or `otherwise` where there is none. Throws Error for a map that flattens the board.
Eigen::Matrix<double, 2, 3> read_machine_affine(JsonObject& json, const Eigen::Matrix<double, 2, 3>& otherwise);

/// Backlash and screws. Throws Error for numbers that no machine has.
MachineErrors read_machine_errors(JsonObject& json);

}  // namespace burin

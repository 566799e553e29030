// burin/scene/files/machine_json.h - affine machine calibration and machine errors in bench.json ("machine") and in a
// design's report.
#pragma once

#include <Eigen/Core>

#include "burin/base/files/json_file.h"
#include "burin/scene/machine_errors.h"

namespace burin {

/// {"affine": [[..], [..]]} and the present ones of {"backlash_mm": [x, y], "screw_mm": [x, y], "screw_period_mm": [x,
/// y], "screw_phase_deg": [x, y]} with their sigmas.
Json machine_json(const Eigen::Matrix<double, 2, 3>& affine, const MachineErrors& errors);

/// Reads the key "affine"; returns `otherwise` if it is missing. Throws Error for a singular map.
Eigen::Matrix<double, 2, 3> read_machine_affine(JsonObject& json, const Eigen::Matrix<double, 2, 3>& otherwise);

/// Reads backlash and screws. Throws Error for numbers that no machine has.
MachineErrors read_machine_errors(JsonObject& json);

}  // namespace burin

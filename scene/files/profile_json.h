// burin/scene/files/profile_json.h - the cross-section and the face's grain in board.json, bench.json and truth.json.
// docs/file-formats.md. Include it in .cpp files only: it pulls in nlohmann-json.
#pragma once

#include "burin/base/files/json_file.h"
#include "burin/scene/material.h"

namespace burin {

/// Reads {"kind": "rounded-v", "flank_deg": 24, "tip_radius_um": 80, "burr_height_um": [1.2, 0.7], "burr_width_um": 10,
/// "alpha_across": 1.4}. Missing keys take the paper's values. Keys of sigmas are accepted and ignored. Throws Error
/// for a cross-section that no tool can carve.
GrooveProfile read_profile(JsonObject json);
Json profile_json(const GrooveProfile& profile);

/// Reads {"along_deg": 4, "alpha_along": 0.1, "alpha_across": 0.24} into grain and base_alpha (their geometric mean).
/// read_grain_into() leaves other keys, such as those of streaks, to the caller, who calls finish().
void read_grain(JsonObject json, Material& material);
void read_grain_into(JsonObject& json, Material& material);
Json grain_json(const Material& material);

}  // namespace burin

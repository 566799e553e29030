// burin/scene/files/profile_json.h - the cross-section and the face's grain as board.json, bench.json and truth.json
// give them. docs/file-formats.md. Include it in .cpp files only: it pulls in nlohmann-json.
#pragma once

#include "burin/base/files/json_file.h"
#include "burin/scene/material.h"

namespace burin {

/// {"kind": "rounded-v", "flank_deg": 24, "tip_radius_um": 80, "burr_height_um": [1.2, 0.7], "burr_width_um": 10,
/// "alpha_across": 1.4}; what is left out is the paper's. Keys of sigmas are known and not read. Throws Error for what
/// cannot be carved.
GrooveProfile read_profile(JsonObject json);
Json profile_json(const GrooveProfile& profile);

/// {"along_deg": 4, "alpha_along": 0.1, "alpha_across": 0.24} into grain and base_alpha (their geometric mean). With
/// `truth`, keys of streaks are left to the caller, who calls finish().
void read_grain(JsonObject json, Material& material);
void read_grain_into(JsonObject& json, Material& material);
Json grain_json(const Material& material);

}  // namespace burin

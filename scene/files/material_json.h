// burin/scene/files/material_json.h - the fields of `material` that board.json and bench.json share.
// docs/file-formats.md. Include it in .cpp files only: it pulls in nlohmann-json.
#pragma once

#include "burin/base/files/json_file.h"
#include "burin/scene/material.h"

namespace burin {

/// Reads alpha, depth_um, base_alpha and f0; missing keys take Material's defaults. Throws Error for a roughness
/// outside (0, 1], a depth that is not positive, or a reflectance outside [0, 1]. The caller calls finish().
Material read_material(JsonObject& json);

/// The keys of read_material() that are present.
SaidMaterial said_material(const JsonObject& json);

}  // namespace burin

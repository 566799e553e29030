// burin/scene/files/material_json.h - the common fields of `material` in board.json and bench.json.
// docs/file-formats.md. Include it in .cpp files only: it pulls in nlohmann-json.
#pragma once

#include "burin/base/files/json_file.h"
#include "burin/scene/material.h"

namespace burin {

/// Reads alpha, depth_um, base_alpha and f0; missing keys take Material's defaults. Throws Error for a roughness
/// outside (0, 1], a non-positive depth, or a reflectance outside [0, 1]. The caller calls finish().
Material read_material(JsonObject& json);

/// The present keys of read_material().
SaidMaterial said_material(const JsonObject& json);

}  // namespace burin

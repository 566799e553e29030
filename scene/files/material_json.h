// burin/scene/files/material_json.h - the fields of `material` that board.json and bench.json share.
// docs/file-formats.md. Include it in .cpp files only: it pulls in nlohmann-json.
#pragma once

#include "burin/base/files/json_file.h"
#include "burin/scene/material.h"

namespace burin {

/// alpha, depth_um, base_alpha and f0 with Material's defaults where they are left out. Throws Error for a roughness
/// outside (0, 1], a depth that is not positive, or a reflectance outside [0, 1]. The caller calls finish().
Material read_material(JsonObject& json);

/// Which of them are there.
SaidMaterial said_material(const JsonObject& json);

}  // namespace burin

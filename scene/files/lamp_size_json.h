// burin/scene/files/lamp_size_json.h - a lamp's area in bench.json and truth.json: "disk_mm", or "panel_mm" and
// "turn_deg". docs/file-formats.md. Include it in .cpp files only: it pulls in nlohmann-json.
#pragma once

#include "burin/base/files/json_file.h"
#include "burin/scene/light.h"

namespace burin {

/// Reads the area of a lamp at `position_mm`. Throws Error for both a disk and a panel, and for a non-positive size. A
/// size as large as the distance from the board's corner is an error too: a few points cannot represent such a lamp.
LampSize read_lamp_size(JsonObject& light, const Eigen::Vector3d& position_mm);

/// Writes nothing for a point lamp.
void put_lamp_size(const LampSize& size, Json& light);

}  // namespace burin

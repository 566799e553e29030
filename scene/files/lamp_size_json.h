// burin/scene/files/lamp_size_json.h - a lamp's area in bench.json and truth.json: "disk_mm", or "panel_mm" and
// "turn_deg". docs/file-formats.md. Include it in .cpp files only: it pulls in nlohmann-json.
#pragma once

#include "burin/base/files/json_file.h"
#include "burin/scene/light.h"

namespace burin {

/// Of a lamp at `position_mm`. Throws Error for both a disk and a panel, a size that is not positive, and one as large
/// as its distance from the board's corner: no few points stand for such a lamp.
LampSize read_lamp_size(JsonObject& light, const Eigen::Vector3d& position_mm);

/// Nothing for a point lamp.
void put_lamp_size(const LampSize& size, Json& light);

}  // namespace burin

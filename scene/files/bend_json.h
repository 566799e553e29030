// burin/scene/files/bend_json.h - a bend in board.json and bench.json. docs/file-formats.md.
#pragma once

#include <optional>

#include "burin/base/files/json_file.h"
#include "burin/scene/bend.h"

namespace burin {

/// Reads `{"radius_mm": 150, "axis_deg": 90}`. Throws Error for an impossible bend of a sheet of this size (if known).
Bend read_bend(JsonObject json, const std::optional<Eigen::Vector2d>& size_mm);

/// Reads the same keys as uncertainties, which are never negative.
Bend read_bend_sigma(JsonObject json);

Json bend_json(const Bend& bend);

}  // namespace burin

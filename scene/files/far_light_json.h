// burin/scene/files/far_light_json.h - the sun and surroundings in bench.json and truth.json. docs/file-formats.md.
// Include it in .cpp files only: it pulls in nlohmann-json.
#pragma once

#include "burin/base/files/json_file.h"
#include "burin/scene/light.h"

namespace burin {

/// Three numbers of light, R G B. Throws Error if one is negative.
Eigen::Vector3d light_color(JsonObject& json, const std::string& key, const Eigen::Vector3d& fallback);

/// True if an entry of "lights" is a distant light: it has a "sun" or a "surroundings".
bool says_far_light(JsonObject& light);

/// Reads all but the id into `light`, with its picture (relative to `file`). Throws Error for both kinds at once, a
/// lamp's position in addition to them, directions below the face, sizes out of range, surroundings without a frame,
/// and for pictures as make_panorama() does.
void read_far_light(JsonObject& json, const std::filesystem::path& file, Light& light);

/// Writes the keys of read_far_light().
void put_far_light(const Light& light, const std::filesystem::path& file, Json& json);

}  // namespace burin

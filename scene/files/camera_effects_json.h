// burin/scene/files/camera_effects_json.h - response, sharpening, glare and white balance of a camera in bench.json
// (`sensor`) and session.json. docs/file-formats.md. Missing keys mean no effect.
#pragma once

#include "burin/base/files/json_file.h"
#include "burin/scene/sensor.h"

namespace burin {

/// {offset, slope, bumps}, or {contrast, pivot} of an S-curve. Throws Error for a non-monotonic curve.
Response read_response(JsonObject json);
Json response_json(const Response& response);

/// {amount, sigma_px}.
Sharpening read_sharpening(JsonObject json);
Json sharpening_json(const Sharpening& sharpening);

/// `glare` {share, core_px, reach_px, share_sigma}, `response`, `sharpening`, `green_sites` and `balance` of
/// bench.json's sensor.
void read_camera_effects(JsonObject& sensor_json, Sensor& sensor);
void put_camera_effects(const Sensor& sensor, Json& sensor_json);

}  // namespace burin

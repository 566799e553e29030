// tests/capture/small_truth.h - a small bench with known truth, as JSON that tests change before they use it.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "burin/base/files/json_file.h"
#include "tests/temporary_folder.h"

namespace burin {

/// A 100 mm board with four tags seen from 400 mm, straight down, 320 x 240 pixels of 0.5 mm, one lamp, one photo.
inline Json small_truth() {
  return Json::parse(R"({
    "format": "burin/rig-truth", "version": 1, "name": "small", "seed": 7, "samples": 64, "samples_plain": 64,
    "board": { "size_mm": [100, 80], "carve_mm": [[30, 20], [70, 60]],
               "tags": { "family": "tag36h11", "z_mm": 0, "white_albedo": 0.8, "black_albedo": 0.04, "quiet_mm": 1,
                         "list": [ { "id": 3, "center_mm": [15, 15], "size_mm": 16 },
                                   { "id": 4, "center_mm": [85, 15], "size_mm": 16 },
                                   { "id": 5, "center_mm": [85, 65], "size_mm": 16 },
                                   { "id": 6, "center_mm": [15, 65], "size_mm": 16 } ] },
               "tool": { "width_um": 400 } },
    "material": { "alpha": 0.08, "depth_um": 14, "base_alpha": 0.2, "f0": [0.9, 0.9, 0.9] },
    "scratches": { "random": { "count": 60, "length_mm": [5, 9], "seed": 1 } },
    "camera": { "lensmodel": "LENSMODEL_PINHOLE", "imagersize": [320, 240], "intrinsics": [800, 800, 159.5, 119.5] },
    "sensor": { "channels": 1, "bits": 12, "encoding": "linear", "gain": 20000, "full_well_e": 20000,
                "read_noise_e": 5 },
    "lights": [ { "id": "lamp", "position_mm": [250, 40, 500], "intensity": [100000, 100000, 100000] } ],
    "views": [ { "view": "v00", "T_camera_board": [[1, 0, 0, -50], [0, -1, 0, 40], [0, 0, -1, 400], [0, 0, 0, 1]],
                 "photos": [ { "file": "photos/v00.png", "exposure_s": 0.01, "f_number": 8,
                               "datetime": "2024:05:01 12:00:00" } ] } ],
    "background": { "albedo": [0.05, 0.05, 0.05], "z_mm": -5 },
    "exif": { "make": "Altair", "model": "M12", "focal_mm": 35 }
  })");
}

/// Writes a truth beside the test's other files.
inline std::filesystem::path write_truth(const TemporaryFolder& folder, const Json& truth,
                                         const std::string& name = "truth.json") {
  return folder.write(name, truth.dump(1));
}

}  // namespace burin

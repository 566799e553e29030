// tools/hold_out_file.h - hold-out.json next to bench.json: prediction errors on held-out photos.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "burin/base/files/json_file.h"
#include "burin/calib/hold_out.h"

namespace burin {

/// Results of `burin calibrate --hold-out` and `burin refine --hold-out`. Either part may be missing.
struct HoldOutFile {
  std::optional<HeldOutCorners> corners;
  std::vector<HeldOutPhoto> pixels;  ///< view, light, residual_rms, residual_to_noise and outliers only
};

/// Returns an empty object if `folder` has no such file. Throws Error for a broken one.
HoldOutFile read_hold_out(const std::filesystem::path& folder);

/// Writes `folder`/hold-out.json.
void write_hold_out(const HoldOutFile& held, const std::filesystem::path& folder);

/// The content of hold-out.json.
Json to_json(const HoldOutFile& held);

/// Tables that the commands print: one line per photo and one for all photos, next to the fit.
std::string corners_in_words(const HeldOutCorners& corners);
std::string pixels_in_words(const std::vector<HeldOutPhoto>& photos);

}  // namespace burin

// tools/hold_out_file.h - hold-out.json beside bench.json: how well photos that were not used were predicted.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "burin/calib/hold_out.h"

namespace burin {

/// What `burin calibrate --hold-out` and `burin refine --hold-out` leave; either part may be missing.
struct HoldOutFile {
  std::optional<HeldOutCorners> corners;
  std::vector<HeldOutPhoto> pixels;  ///< view, light, residual_rms, residual_to_noise and outliers only
};

/// Empty if there is no such file in `folder`. Throws Error on a broken one.
HoldOutFile read_hold_out(const std::filesystem::path& folder);

/// Writes `folder`/hold-out.json.
void write_hold_out(const HoldOutFile& held, const std::filesystem::path& folder);

/// The tables that the commands print: a line a photo, and all together, next to the fit.
std::string corners_in_words(const HeldOutCorners& corners);
std::string pixels_in_words(const std::vector<HeldOutPhoto>& photos);

}  // namespace burin

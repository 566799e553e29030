// burin/scene/physical_bounds.h - physical bounds of numbers, in one table. Readers of files and the check before
// carving (burin/optimize/toolpath/release_check.h) use it.
//
// A number out of bounds is a slip (um for mm, one zero too many) or a damaged file. The bounds are far beyond the
// needs of boards, so they refuse no intended value. docs/file-formats.md.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>

namespace burin {

class JsonObject;

namespace bound {

constexpr double kDepth_um = 1000;       ///< of a groove: glinting grooves have some hundredths of a mm
constexpr double kShallowest_um = 0.05;  ///< of a groove: a tenth of light's wavelength, and less than machines step
constexpr double kToolWidth_um = 4000;   ///< wt, four times a tip's radius
constexpr double kPreload_mm = 10;       ///< travel of a spring or a drag bit below first contact
constexpr double kMapShare = 0.05;       ///< error of a machine's scale, and of its axes' squareness
constexpr double kMapShift_mm = 10;      ///< offset of a machine's zero
constexpr double kBacklash_mm = 1;       ///< of a screw in use for carving
constexpr double kScrew_mm = 1;          ///< amplitude of a screw's uneven pitch
constexpr double kScrewPeriod_mm = 100;  ///< travel per turn
constexpr double kBow_mm = 100;          ///< of any sheet
constexpr double kBowShare = 0.03;       ///< of a sheet's shorter side, for a bow that a tool follows
constexpr double kTilt = 0.02;           ///< mm per mm: a steeper sheet is not clamped
constexpr double kStanding_mm = 100;     ///< height of a clamp, and of the tags' paper, above the face
constexpr double kHighest_mm = 150;      ///< highest travel of a small machine's tool above the face
constexpr double kSafeZ_mm = 100;        ///< travel above the face
constexpr double kPlace_mm = 200'000;    ///< coordinate of a scratch's end: boards are at most half as long

}  // namespace bound

/// Returns `value` if it is from `least` to `most`. Throws Error with the field and the range otherwise.
double require_within(const JsonObject& json, const std::string& key, double value, double least, double most,
                      std::string_view unit);

/// Reads a depth from bound::kShallowest_um to bound::kDepth_um. Without a fallback the key is required.
double read_depth_um(JsonObject& json, const std::string& key, std::optional<double> fallback = {});

/// Reads a tool's wt above 0 and at most bound::kToolWidth_um.
double read_tool_width_um(JsonObject& json, const std::string& key, std::optional<double> fallback = {});

/// Reads a bow; each of its three numbers is at most bound::kBow_mm.
Eigen::Vector3d read_bow_mm(JsonObject& json, const std::string& key);

/// Throws Error with `where` for a bow that no sheet of this size has and that a tool would follow.
void fail_unless_bow_fits(const Eigen::Vector3d& bow_mm, const Eigen::Vector2d& size_mm, const std::string& where);

}  // namespace burin

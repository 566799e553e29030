// burin/scene/physical_bounds.h - the most that nature lets a number be: one table, for those who read files and for
// the check of what is given to a machine (burin/optimize/toolpath/release_check.h).
//
// A number beyond is a slip (um for mm, one zero too many) or a damaged file. They lie far beyond what boards need, so
// that nothing that is meant is refused. docs/file-formats.md.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>

namespace burin {

class JsonObject;

namespace bound {

constexpr double kDepth_um = 1000;       ///< of a groove: grooves that glint are some hundredths of a mm deep
constexpr double kShallowest_um = 0.05;  ///< of a groove: a tenth of light's wavelength, and less than machines step
constexpr double kToolWidth_um = 4000;   ///< wt, four times a tip's radius
constexpr double kPreload_mm = 10;       ///< by which a spring or a drag bit is pressed
constexpr double kMapShare = 0.05;       ///< by which a machine's scale, and its axes' squareness, are off
constexpr double kMapShift_mm = 10;      ///< by which it lies beside its zero
constexpr double kBacklash_mm = 1;       ///< of a screw that anyone carves with
constexpr double kScrew_mm = 1;          ///< amplitude of a screw's uneven pitch
constexpr double kScrewPeriod_mm = 100;  ///< way of a turn
constexpr double kBow_mm = 100;          ///< of any sheet
constexpr double kBowShare = 0.03;       ///< of a sheet's shorter side, for a bow that a tool follows
constexpr double kTilt = 0.02;           ///< mm a mm: a sheet that lies steeper is not clamped
constexpr double kStanding_mm = 100;     ///< height of a clamp, and of the tags' paper, above the face
constexpr double kHighest_mm = 150;      ///< above the face that a small machine's tool goes at all
constexpr double kSafeZ_mm = 100;        ///< travel above the face
constexpr double kPlace_mm = 200'000;    ///< of a scratch's end: no board is longer than half of it

}  // namespace bound

/// `value`, if it lies from `least` to `most`. Throws Error naming the field and the range otherwise.
double require_within(const JsonObject& json, const std::string& key, double value, double least, double most,
                      std::string_view unit);

/// A depth from bound::kShallowest_um to bound::kDepth_um; it must be there if there is no fallback.
double read_depth_um(JsonObject& json, const std::string& key, std::optional<double> fallback = {});

/// A tool's wt above 0 and at most bound::kToolWidth_um.
double read_tool_width_um(JsonObject& json, const std::string& key, std::optional<double> fallback = {});

/// A bow, each of its three numbers at most bound::kBow_mm.
Eigen::Vector3d read_bow_mm(JsonObject& json, const std::string& key);

/// Throws Error naming `where` for a bow that no sheet of this size has and that a tool would follow.
void fail_unless_bow_fits(const Eigen::Vector3d& bow_mm, const Eigen::Vector2d& size_mm, const std::string& where);

}  // namespace burin

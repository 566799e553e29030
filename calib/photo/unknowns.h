// burin/calib/photo/unknowns.h - the one table of the unknowns in a fit of photos. Frame: board, mm. docs/model.md 9.
//
// A row defines an unknown: its name, its number of values, its owner, its group in stages, its place in a photo's
// value, its bounds and its prior. Indices, parameter blocks, stages, bounds and priors follow from the rows. An
// unknown further needs its link to a bench (bench_unknowns.cpp: read and write) and its derivative: in photo_slopes()
// if it changes the rendering, otherwise in photo_equations().
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <initializer_list>
#include <string_view>

#include "burin/calib/geometry/geometry_prior.h"
#include "burin/calib/light/lamp_model.h"

namespace burin {

/// Owner of an unknown.
enum class Scope {
  shared,    ///< all photos
  lamp,      ///< each lamp has its own
  geometry,  ///< cameras, bow and lens: moved by joint_step() alone, with geometry_prior.h as their prior
  paper      ///< all samples of paper; photos of metal do not depend on it
};

/// Unknowns freed or held together by a stage.
enum class Group {
  groove,
  depth,
  base,
  depth_linear,
  depth_quadratic,
  depth_wear,
  machine,
  backlash,
  screw,
  screw_period,
  grain,
  flank,
  burrs,
  across,
  ambient,
  vignette,
  blur,
  glare,
  stray,
  stray_size,
  lamp,
  intensity,
  lamp_size,
  lamp_sides,
  geometry,
  paper,
  count
};

/// Role of an unknown in a photo's value = vignetting x blur(light of the lamp + ambient light).
enum class Enters {
  light,    ///< by the rendering: a column of photo_slopes()
  ambient,  ///< as light added everywhere
  factor,   ///< as a factor on the sensor's light
  glare,    ///< as the part of it replaced by light from all over the photo
  paper     ///< not at all: the brightness of paper
};

/// Bounds of one number of an unknown, or of several in a row.
struct Bounds {
  /// Meaning of `low` and `high`: the numbers themselves, logarithms' arguments, these in units of the tool's width, or
  /// lengths in units of the board's diagonal.
  enum class Kind { none, plain, of_log, of_log_per_tool_width, per_board_diagonal };
  Kind kind = Kind::none;
  double low = 0, high = 0;
  int at = 0;  ///< index of the first number
  int count = 1;
};

struct UnknownRow {
  std::string_view name;
  int size = 1;
  Scope scope = Scope::shared;
  Group group = Group::groove;
  Enters enters = Enters::light;
  Bounds bounds{};
  std::array<double, 3> prior_sigma{};  ///< of each number, about 0; 0: no prior
  bool of_spot = false;                 ///< exists only for spotlights
  bool of_size = false;                 ///< exists only for lamps whose size is sought; else it is held
  bool of_stray = false;                ///< exists only with an unmodeled light
  int both_ways = -1;                   ///< exists only if grooves go both ways along this axis (0: x, 1: y)
  int uneven = -1;                      ///< exists only if this axis has a detected lead-screw error
};

/// Upper bound of the board's diagonal over the distance of an unmodeled light. With the bound of its size, it
/// satisfies bench.json's limit: a lamp less wide than its distance from the board's corner.
inline constexpr double kMostStrayNearness = 0.7;

inline constexpr double kSteepestFlank_deg = 75;  // of a V

inline constexpr double kPaperFactorSigma = 0.02;  // relative sigma of board.json's albedos, as a common factor

inline constexpr auto kUnknownRows = std::to_array<UnknownRow>({
    // The grooves: logarithms of roughness and depth; of the plain face's roughness.
    {"log_alpha", 1, Scope::shared, Group::groove, Enters::light, {Bounds::Kind::of_log, 0.004, 0.8}},
    {"log_depth", 1, Scope::shared, Group::depth, Enters::light, {Bounds::Kind::of_log_per_tool_width, 1e-3, 0.7}},
    {"log_base_alpha", 1, Scope::shared, Group::base, Enters::light, {Bounds::Kind::of_log, kSmoothestFace, 1.0}},
    // GrooveField's terms: gx gy; qxx qxy qyy; wear.
    {"depth_linear", 2, Scope::shared, Group::depth_linear},
    {"depth_quadratic", 3, Scope::shared, Group::depth_quadratic},
    {"depth_wear", 1, Scope::shared, Group::depth_wear},
    // a00 a01 a10 a11 tx ty (machine_map.h).
    {"machine", 6, Scope::shared, Group::machine},
    // Backlash of x and y, mm. If all grooves go the same way along an axis, its backlash is only an offset.
    {"backlash_x", 1, Scope::shared, Group::backlash, Enters::light, {}, {}, false, false, false, 0},
    {"backlash_y", 1, Scope::shared, Group::backlash, Enters::light, {}, {}, false, false, false, 1},
    // The sine's and the cosine's parts of x, then of y, mm; then the logarithms of both periods.
    {"screw_x", 2, Scope::shared, Group::screw, Enters::light, {}, {}, false, false, false, -1, 0},
    {"screw_y", 2, Scope::shared, Group::screw, Enters::light, {}, {}, false, false, false, -1, 1},
    {"log_screw_period_x", 1, Scope::shared, Group::screw_period, Enters::light, {}, {}, false, false, false, -1, 0},
    {"log_screw_period_y", 1, Scope::shared, Group::screw_period, Enters::light, {}, {}, false, false, false, -1, 1},
    // FaceGrain's c and s.
    {"grain", 2, Scope::shared, Group::grain},
    // The profile's: flanks' slope (degrees); burrs left and right, and their width (um); logarithm of `across`.
    {"flank", 1, Scope::shared, Group::flank, Enters::light, {Bounds::Kind::plain, 5, kSteepestFlank_deg}},
    {"burr_left", 1, Scope::shared, Group::burrs, Enters::light, {Bounds::Kind::plain, 0, 50}},
    {"burr_right", 1, Scope::shared, Group::burrs, Enters::light, {Bounds::Kind::plain, 0, 50}},
    {"burr_width", 1, Scope::shared, Group::burrs, Enters::light, {Bounds::Kind::of_log, 1, 200}},
    {"log_across", 1, Scope::shared, Group::across, Enters::light, {Bounds::Kind::of_log, 0.2, 5}},
    // Radiance, mean of the channels.
    {"ambient", 1, Scope::shared, Group::ambient, Enters::ambient, {Bounds::Kind::plain, 0, 1e9}},
    // v1 v2 v3.
    {"vignette", 3, Scope::shared, Group::vignette, Enters::factor, {}, kVignettePriorSigma},
    // Logarithm of the Gaussian's sigma in pixels of the merged photos; see also log_blur_range().
    {"log_blur", 1, Scope::shared, Group::blur, Enters::light, {Bounds::Kind::of_log, 0.05, 6.0}},
    // Share of light scattered by the lens; core and reach are the bench's (glare_fit.h).
    {"glare_share", 1, Scope::shared, Group::glare, Enters::glare, {Bounds::Kind::plain, 0, 0.3}},
    // An unmodeled light (stray_light.h): its direction, nearness, irradiance of the middle, and its size.
    {"stray_slope",
     2,
     Scope::shared,
     Group::stray,
     Enters::light,
     {Bounds::Kind::plain, -6, 6, 0, 2},
     {},
     false,
     false,
     true},
    {"stray_nearness",
     1,
     Scope::shared,
     Group::stray,
     Enters::light,
     {Bounds::Kind::plain, 0.01, kMostStrayNearness},
     {},
     false,
     false,
     true},
    {"stray_light",
     1,
     Scope::shared,
     Group::stray,
     Enters::light,
     {Bounds::Kind::plain, 1e-9, 1e12},
     {},
     false,
     false,
     true},
    {"stray_spread2",
     1,
     Scope::shared,
     Group::stray_size,
     Enters::light,
     {Bounds::Kind::plain, 0, 0.1},
     {},
     false,
     false,
     true},
    {"lamp_position", 3, Scope::lamp, Group::lamp, Enters::light, {Bounds::Kind::per_board_diagonal, 0.02, 1e4, 2}},
    {"log_intensity", 1, Scope::lamp, Group::intensity, Enters::light, {Bounds::Kind::of_log, 1e-20, 1e20}},
    // A spotlight's: intersection of its axis with the board's plane (mm), and its exponent; 0 (held): a bare lamp.
    {"aim", 2, Scope::lamp, Group::lamp, Enters::light, {Bounds::Kind::per_board_diagonal, -3, 4, 0, 2}, {}, true},
    {"falloff", 1, Scope::lamp, Group::lamp, Enters::light, {Bounds::Kind::plain, 1e-3, 200}, {}, true},
    // LampArea's numbers in squares of size_unit_mm(); photos are nearly linear in them from 0 on.
    {"size2", 1, Scope::lamp, Group::lamp_size, Enters::light, {Bounds::Kind::plain, 0, 400}, {}, false, true},
    {"sides2", 2, Scope::lamp, Group::lamp_sides, Enters::light, {}, {}, false, true},
    // Rotation vector on the left of T_camera_board; then translation, mm.
    {"pose", 6, Scope::geometry, Group::geometry},
    {"bow", 3, Scope::geometry, Group::geometry},
    // In moved_lens()'s order (geometry_prior.h); lenses of more parameters are held.
    {"lens", kMostLensParameters, Scope::geometry, Group::geometry},
    // Logarithm of the common factor of all paper's brightness over board.json's.
    {"log_paper", 1, Scope::paper, Group::paper, Enters::paper, {}, {kPaperFactorSigma}},
});

/// End of the unknowns of scopes up to `scope`, in the order of the table.
constexpr int end_of(Scope scope) {
  int end = 0;
  for (const UnknownRow& row : kUnknownRows)
    if (row.scope <= scope) end += row.size;
  return end;
}

/// Index of an unknown's first number.
constexpr int first_of(std::string_view name) {
  int first = 0;
  for (const UnknownRow& row : kUnknownRows) {
    if (row.name == name) return first;
    first += row.size;
  }
  return -1;
}

/// Unit of a lamp's size, mm: a tenth of the board's diagonal.
inline double size_unit_mm(const Board& board) { return 0.1 * board.size_mm.norm(); }

/// Indices of the unknowns of a photo under one lamp, as one vector.
namespace unknown {
inline constexpr int log_alpha = first_of("log_alpha");
inline constexpr int log_depth = first_of("log_depth");
inline constexpr int log_base_alpha = first_of("log_base_alpha");
inline constexpr int depth_field = first_of("depth_linear");  // all terms of a GrooveField, in its order
inline constexpr int depth_wear = first_of("depth_wear");
inline constexpr int machine = first_of("machine");
inline constexpr int backlash = first_of("backlash_x");
inline constexpr int screw = first_of("screw_x");
inline constexpr int screw_period = first_of("log_screw_period_x");
inline constexpr int grain = first_of("grain");
inline constexpr int flank = first_of("flank");
inline constexpr int burrs = first_of("burr_left");  // and the right one
inline constexpr int burr_width = first_of("burr_width");
inline constexpr int log_across = first_of("log_across");
inline constexpr int ambient = first_of("ambient");
inline constexpr int vignette = first_of("vignette");
inline constexpr int log_blur = first_of("log_blur");
inline constexpr int glare_share = first_of("glare_share");
inline constexpr int stray = first_of("stray_slope");  // all of its numbers
inline constexpr int stray_nearness = first_of("stray_nearness");
inline constexpr int stray_light = first_of("stray_light");
inline constexpr int stray_spread2 = first_of("stray_spread2");
inline constexpr int lamp_position = first_of("lamp_position");
inline constexpr int log_intensity = first_of("log_intensity");
inline constexpr int spot = first_of("aim");  // and the exponent behind it
inline constexpr int size2 = first_of("size2");
inline constexpr int sides2 = first_of("sides2");
inline constexpr int pose = first_of("pose");
inline constexpr int bow = first_of("bow");
inline constexpr int lens = first_of("lens");
inline constexpr int count = end_of(Scope::geometry);  // of a photo
inline constexpr int log_paper = first_of("log_paper");
}  // namespace unknown

using Unknowns = Eigen::Matrix<double, unknown::count, 1>;
using FreeUnknowns = std::array<bool, unknown::count>;

constexpr int kSharedUnknowns = end_of(Scope::shared);                // before the lamp's
constexpr int kLampUnknowns = end_of(Scope::lamp) - kSharedUnknowns;  // of each lamp
constexpr int kFitUnknowns = end_of(Scope::lamp);                     // moved by a fit of one photo

/// All unknowns of a problem but the geometry's, in one vector: shared, paper, and a set for each lamp.
constexpr int kPaperIndex = kSharedUnknowns;
constexpr int global_index(int index, std::size_t light) {
  return index < kSharedUnknowns
             ? index
             : kPaperIndex + 1 + static_cast<int>(light) * kLampUnknowns + (index - kSharedUnknowns);
}
constexpr Eigen::Index global_count(std::size_t lights) {
  return kPaperIndex + 1 + static_cast<Eigen::Index>(lights) * kLampUnknowns;
}

/// Free terms of the field of depth, of glare and of the lamps' sizes. All are tested together: one may look like
/// another.
struct FreeField {
  bool linear = false, quadratic = false, wear = false, glare = false, size = false;
};

/// Groups of free unknowns during a fit. By default all are, except the field of depth, the blur, the glare, lamps'
/// sizes, an unmodeled light, and effects of only some benches (effect_choice.h).
class Stage {
 public:
  Stage() {
    free_.fill(true);
    hold({Group::depth_linear, Group::depth_quadratic, Group::depth_wear, Group::blur, Group::glare, Group::lamp_size,
          Group::lamp_sides, Group::stray, Group::stray_size, Group::backlash, Group::screw, Group::screw_period,
          Group::grain, Group::flank, Group::burrs, Group::across});
  }
  bool frees(Group group) const { return free_[static_cast<std::size_t>(group)]; }
  Stage& free(Group group, bool free = true) {
    free_[static_cast<std::size_t>(group)] = free;
    return *this;
  }
  Stage& hold(std::initializer_list<Group> groups) {
    for (const Group group : groups) free(group, false);
    return *this;
  }
  Stage& free(const FreeField& field) {
    return free(Group::depth_linear, field.linear)
        .free(Group::depth_quadratic, field.quadratic)
        .free(Group::depth_wear, field.wear)
        .free(Group::glare, field.glare)
        .free(Group::lamp_size, field.size);
  }

 private:
  std::array<bool, static_cast<std::size_t>(Group::count)> free_{};
};

/// Calls body(row, first) for each row of the table in its order, with the index of its first number.
template <typename Body>
void for_each_unknown(const Body& body) {
  int first = 0;
  for (const UnknownRow& row : kUnknownRows) {
    body(row, first);
    first += row.size;
  }
}

}  // namespace burin

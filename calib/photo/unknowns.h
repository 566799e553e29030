// burin/calib/photo/unknowns.h - the one table of what a fit of photos may move. Frame: board, mm. docs/model.md 9.
//
// A row says all that code must know of an unknown: its name, how many numbers it is, whom it belongs to, with what a
// stage frees it, how it enters a photo's value, its bounds and its prior. Indices, parameter blocks, stages, bounds
// and priors follow from the rows. What else an unknown needs is its link to a bench (bench_unknowns.cpp: how it is
// read and written) and its derivative (photo_slopes() where it changes what is rendered, photo_equations() where it
// does not).
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <initializer_list>
#include <string_view>

#include "burin/calib/geometry/geometry_prior.h"
#include "burin/calib/light/lamp_model.h"

namespace burin {

/// Whom an unknown belongs to.
enum class Scope {
  shared,    ///< all photos
  lamp,      ///< each lamp has its own
  geometry,  ///< cameras, bow and lens: moved by joint_step() alone, with geometry_prior.h as their prior
  paper      ///< all samples of paper; photos of metal do not depend on it
};

/// What a stage frees or holds together.
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

/// How an unknown enters a photo's value = vignetting x blur(light of the lamp + ambient light).
enum class Enters {
  light,    ///< by what is rendered: a column of photo_slopes()
  ambient,  ///< as light that is added everywhere
  factor,   ///< as a factor of what the sensor sees
  glare,    ///< as the part of it that is replaced by light from all over the photo
  paper     ///< not at all: the brightness of paper
};

/// Bounds of one number of an unknown, or of several in a row.
struct Bounds {
  /// What `low` and `high` are: the numbers themselves, logarithms' arguments, the same in units of the tool's width,
  /// or lengths in units of the board's diagonal.
  enum class Kind { none, plain, of_log, of_log_per_tool_width, per_board_diagonal };
  Kind kind = Kind::none;
  double low = 0, high = 0;
  int at = 0;  ///< which number, the first
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
  bool of_spot = false;                 ///< exists for spots only
  bool of_size = false;                 ///< exists for lamps whose size is sought only; else it is held
  bool of_stray = false;                ///< exists where there is a light that nobody named only
  int both_ways = -1;                   ///< exists where grooves go both ways along that axis (0: x, 1: y) only
  int uneven = -1;                      ///< exists where that axis' screw was found to be uneven only
};

/// The board's diagonal over the distance of a light that nobody named. With the most that its size may be, this keeps
/// what bench.json may hold: a lamp less wide than it is far from the board's corner.
inline constexpr double kMostStrayNearness = 0.7;

inline constexpr double kSteepestFlank_deg = 75;  // of a V

inline constexpr double kPaperFactorSigma = 0.02;  // how well albedos in board.json are known, as a common factor

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
    // Of x and y, mm.
    // Where all grooves go the same way along an axis, its backlash is but an offset.
    {"backlash_x", 1, Scope::shared, Group::backlash, Enters::light, {}, {}, false, false, false, 0},
    {"backlash_y", 1, Scope::shared, Group::backlash, Enters::light, {}, {}, false, false, false, 1},
    // The sine's and the cosine's parts of x, then of y, mm; then the logarithms of both periods.
    {"screw_x", 2, Scope::shared, Group::screw, Enters::light, {}, {}, false, false, false, -1, 0},
    {"screw_y", 2, Scope::shared, Group::screw, Enters::light, {}, {}, false, false, false, -1, 1},
    {"log_screw_period_x", 1, Scope::shared, Group::screw_period, Enters::light, {}, {}, false, false, false, -1, 0},
    {"log_screw_period_y", 1, Scope::shared, Group::screw_period, Enters::light, {}, {}, false, false, false, -1, 1},
    // FaceGrain's c and s.
    {"grain", 2, Scope::shared, Group::grain},
    // The profile's: flanks' slope (degrees); burrs left and right, and their width (um); logarithm of across.
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
    // Share of the light that the lens scatters; core and reach are the bench's (glare_fit.h).
    {"glare_share", 1, Scope::shared, Group::glare, Enters::glare, {Bounds::Kind::plain, 0, 0.3}},
    // A light that nobody named (stray_light.h): its direction, nearness, light on the middle, and its size.
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
    // A spot's: where on the plane of the board its axis points (mm), and its exponent; 0 (held): a bare lamp.
    {"aim", 2, Scope::lamp, Group::lamp, Enters::light, {Bounds::Kind::per_board_diagonal, -3, 4, 0, 2}, {}, true},
    {"falloff", 1, Scope::lamp, Group::lamp, Enters::light, {Bounds::Kind::plain, 1e-3, 200}, {}, true},
    // LampArea's numbers in squares of size_unit_mm(); photos follow them nearly linearly from 0 on.
    {"size2", 1, Scope::lamp, Group::lamp_size, Enters::light, {Bounds::Kind::plain, 0, 400}, {}, false, true},
    {"sides2", 2, Scope::lamp, Group::lamp_sides, Enters::light, {}, {}, false, true},
    // Rotation vector on the left of T_camera_board; then translation, mm.
    {"pose", 6, Scope::geometry, Group::geometry},
    {"bow", 3, Scope::geometry, Group::geometry},
    // As moved_lens() (geometry_prior.h) takes them; lenses of more parameters are held.
    {"lens", kMostLensParameters, Scope::geometry, Group::geometry},
    // Logarithm of the factor by which all paper is brighter than board.json has it.
    {"log_paper", 1, Scope::paper, Group::paper, Enters::paper, {}, {kPaperFactorSigma}},
});

/// Where the unknowns of scopes up to and with `scope` end in the order of the table.
constexpr int end_of(Scope scope) {
  int end = 0;
  for (const UnknownRow& row : kUnknownRows)
    if (row.scope <= scope) end += row.size;
  return end;
}

/// Where an unknown's first number lies.
constexpr int first_of(std::string_view name) {
  int first = 0;
  for (const UnknownRow& row : kUnknownRows) {
    if (row.name == name) return first;
    first += row.size;
  }
  return -1;
}

/// What the size of a lamp is in units of, mm: a tenth of the board's diagonal.
inline double size_unit_mm(const Board& board) { return 0.1 * board.size_mm.norm(); }

/// The unknowns of a photo under one lamp, as one vector: where each lies.
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

constexpr int kSharedUnknowns = end_of(Scope::shared);                // those before the lamp's
constexpr int kLampUnknowns = end_of(Scope::lamp) - kSharedUnknowns;  // of each lamp
constexpr int kFitUnknowns = end_of(Scope::lamp);                     // what a fit of one photo moves

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

/// Which terms of the field of depth are free; and the glare and the lamps' sizes, which are asked for together with
/// them: either may look like the other.
struct FreeField {
  bool linear = false, quadratic = false, wear = false, glare = false, size = false;
};

/// The groups of unknowns that are free while one fit runs. At first all but the field of depth, the blur, the glare,
/// lamps' sizes, a light that nobody named, and what only some benches have (effect_choice.h).
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

/// body(row, first): for each row of the table in its order, with where its numbers lie.
template <typename Body>
void for_each_unknown(const Body& body) {
  int first = 0;
  for (const UnknownRow& row : kUnknownRows) {
    body(row, first);
    first += row.size;
  }
}

}  // namespace burin

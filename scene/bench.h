// burin/scene/bench.h - a bench, believed or measured: lens, poses, lamps, material, bow, machine, with uncertainties.
// Frame: board, mm. docs/file-formats.md, `bench.json`.
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "burin/base/finding.h"
#include "burin/scene/board.h"
#include "burin/scene/crossings.h"
#include "burin/scene/groove_field.h"
#include "burin/scene/lens.h"
#include "burin/scene/light.h"
#include "burin/scene/machine_errors.h"
#include "burin/scene/material.h"
#include "burin/scene/misfit.h"
#include "burin/scene/sensor.h"
#include "burin/scene/verdict.h"

namespace burin {

/// One place of the camera. The camera's center in board coordinates is T_camera_board.inverse().translation().
struct View {
  std::string name;
  Eigen::Isometry3d T_camera_board = Eigen::Isometry3d::Identity();
  std::optional<Eigen::Vector3d> center_sigma_mm;  ///< of the center, board axes
  std::optional<double> reprojection_rms_px;       ///< per axis
  std::optional<int> tags;                         ///< tags used
  /// Where lenses were found to differ from photo to photo: this one's, and its standard deviations.
  std::optional<OwnLens> own_lens, own_lens_sigma;
  /// Set as long as a file says only where the eye is and the board was not looked at: T_camera_board then has the
  /// center alone (burin/scene/bench_of_board.h, aim_views).
  std::optional<double> roll_to_middle_deg;
};

/// Standard deviations of Material's numbers; empty for those that were not measured.
struct MaterialSigma {
  std::optional<double> alpha, depth_um, base_alpha;
  std::optional<Eigen::Vector2d> grain;                                                 ///< of FaceGrain's c and s
  std::optional<double> flank_deg, burr_left_um, burr_right_um, burr_width_um, across;  ///< of the profile
};

/// What board.json said of the board that a bench was measured on: what its machine was told, and with which tool.
/// Empty where that is not known.
struct ToldMaterial {
  std::optional<double> alpha, depth_um, tool_width_um;
};

/// How much a number differs from groove to groove: the standard deviation of its logarithm.
struct Scatter {
  double value = 0;
  std::optional<double> sigma;
};

using Affine2 = Eigen::Matrix<double, 2, 3>;  ///< [A | b], mm

/// A coat on the tags' paper that shines, as satin and glossy papers have: a GGX lobe beside what paper scatters
/// (model.md 5.14). f0 0: none.
struct PaperCoat {
  double f0 = 0, alpha = 0.3;
};

/// How much lenses differ from photo to photo (OwnLens), as standard deviations: of each axis of the shift, and of the
/// logarithm of the focal length.
struct LensScatter {
  double shift_px = 0, focal = 0;
};

/// A bench, believed or measured: everything but the board and the scratches that decides what a photo shows.
struct Bench {
  Lens lens;
  std::filesystem::path camera;             ///< where the lens is kept; empty if bench.json says it in words
  std::optional<LensScatter> lens_scatter;  ///< of the photos that it was measured from; nothing: one lens for all
  std::vector<View> views;
  std::vector<Light> lights;
  /// A lamp or window that shone into the photos beside each of their lamps, and that nobody named: find_lit() has it.
  std::optional<Light> stray;
  Material material;
  MaterialSigma material_sigma;
  SaidMaterial said;                     ///< by the file that this was read from
  ToldMaterial told;                     ///< where the bench was measured on a carved board
  GrooveField depth_field, alpha_field;  ///< what multiplies material.depth_um and alpha, scratch by scratch
  Crossings crossings = Crossings::add;  ///< what is left where grooves cross
  /// How much roughness and depth differ from groove to groove beside their fields: standard deviations of the
  /// logarithms.
  Scatter alpha_scatter, depth_scatter;
  Sensor sensor;
  Eigen::Vector3d ambient{0, 0, 0};  ///< radiance of uniform surroundings, R G B (in units of gain = 1)
  std::optional<Eigen::Vector3d> ambient_sigma;
  Eigen::Vector3d bow_mm{0, 0, 0};  ///< face height z = b0 X^2 + b1 X Y + b2 Y^2; X, Y from -1 to 1 over the board
  std::optional<Eigen::Vector3d> bow_sigma_mm;
  /// How a bent sheet was measured to be bent; nothing: as board.json says. Its bow changes the bend (surface.h).
  std::optional<Bend> bend;
  std::optional<Bend> bend_sigma;
  PaperCoat paper;
  std::vector<Tag> tags;  ///< measured positions; empty where board.json's are believed
  Affine2 machine_affine = (Affine2() << 1, 0, 0, 0, 1, 0).finished();  ///< board coordinates, from sent to carved, mm
  std::optional<Affine2> machine_affine_sigma;
  MachineErrors machine_errors;            ///< what its map leaves: backlash, uneven screws
  std::vector<Misfit> misfits;             ///< where the photos it was measured from contradict the model
  std::map<std::string, Verdict> verdict;  ///< by parameter name (burin/scene/parameter_name.h)
  std::vector<Finding> findings;           ///< what a file of an older version lacks; not written
};

/// Reads `bench.json` (version 2, or 1) and the `.cameramodel` it names, if it names one. Throws Error on anything
/// missing, unknown or out of range.
Bench read_bench(const std::filesystem::path& file);

/// Writes `bench.json` and, if `bench.camera` is empty or lies beside it, the `.cameramodel`; atomically.
/// half_width_um is derived from material.depth_um and `tool_width_um`.
void write_bench(const Bench& bench, double tool_width_um, const std::filesystem::path& file);

/// What the bench says of a parameter; nullptr where it says nothing.
const Verdict* find_verdict(const Bench& bench, const std::string& parameter);

/// The lens that a view's photos were taken with.
Lens lens_of(const Bench& bench, const View& view);

/// The view of that name. Throws Error listing the names there are, and for a view that is not aimed yet. `where` is
/// named in the message.
const View& find_view(const Bench& bench, std::string_view name, std::string_view where);

/// The light of that name; for names joined by kBesides ("sun + room") those lights at once, the first with the others
/// as its `also`. Throws Error listing the names there are.
Light find_light(const Bench& bench, std::string_view id, std::string_view where);
/// The same with all that shines where it does: beside near lamps alone bench.stray, too.
Light find_lit(const Bench& bench, std::string_view id, std::string_view where);
inline constexpr std::string_view kBesides = " + ";

/// The names of lights that shine at once as one name, and the other way.
std::string joined_lights(const std::vector<std::string>& ids);
std::vector<std::string> light_names(std::string_view joined);

}  // namespace burin

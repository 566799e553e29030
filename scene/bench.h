// burin/scene/bench.h - a setup, nominal or measured: lens, poses, lamps, material, bow and machine, with
// uncertainties.
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

/// One viewpoint. T_camera_board.inverse().translation() is the camera's center in board coordinates.
struct View {
  std::string name;
  Eigen::Isometry3d T_camera_board = Eigen::Isometry3d::Identity();
  std::optional<Eigen::Vector3d> center_sigma_mm;  ///< of the center, board axes
  std::optional<double> reprojection_rms_px;       ///< per axis
  std::optional<int> tags;                         ///< tags used
  /// Lens deviation of this view and its standard deviations, if calibration found different lenses between photos.
  std::optional<OwnLens> own_lens, own_lens_sigma;
  /// Set if the file gives only the eye and aim_views() (burin/scene/bench_of_board.h) has not run yet. T_camera_board
  /// then holds only the center.
  std::optional<double> roll_to_middle_deg;
};

/// Standard deviations of Material's numbers; empty for unmeasured ones.
struct MaterialSigma {
  std::optional<double> alpha, depth_um, base_alpha;
  std::optional<Eigen::Vector2d> grain;                                                 ///< of FaceGrain's c and s
  std::optional<double> flank_deg, burr_left_um, burr_right_um, burr_width_um, across;  ///< of the profile
};

/// Prior of the board that a setup was measured on, from board.json: commanded roughness and depth, and the tool's
/// width. Empty if unknown.
struct ToldMaterial {
  std::optional<double> alpha, depth_um, tool_width_um;
};

/// Groove-to-groove variation of a number: the standard deviation of its logarithm.
struct Scatter {
  double value = 0;
  std::optional<double> sigma;
};

using Affine2 = Eigen::Matrix<double, 2, 3>;  ///< [A | b], mm

/// Glossy coating of the tags' paper: a GGX lobe in addition to diffuse reflection (model.md 5.14). f0 0: no coating.
struct PaperCoat {
  double f0 = 0, alpha = 0.3;
};

/// Variation of lenses between photos (OwnLens): standard deviations of each axis of the shift and of the logarithm of
/// the focal length.
struct LensScatter {
  double shift_px = 0, focal = 0;
};

/// A setup, nominal or measured: all inputs of a photo except the board and the scratches.
struct Bench {
  Lens lens;
  std::filesystem::path camera;             ///< file of the lens; empty if bench.json contains the lens itself
  std::optional<LensScatter> lens_scatter;  ///< over the photos of the calibration; nothing: one lens for all
  std::vector<View> views;
  std::vector<Light> lights;
  /// Unmodeled light: a lamp or window that shone into all photos in addition to the named lamps. find_lit() adds it.
  std::optional<Light> stray;
  Material material;
  MaterialSigma material_sigma;
  SaidMaterial said;                     ///< fields present in the source file
  ToldMaterial told;                     ///< set if the setup was measured on a carved board
  GrooveField depth_field, alpha_field;  ///< factors on material.depth_um and alpha, per scratch
  Crossings crossings = Crossings::add;  ///< crossing rule: the remaining surface at crossings
  /// Groove-to-groove variation of roughness and depth in addition to their fields: standard deviations of logarithms.
  Scatter alpha_scatter, depth_scatter;
  Sensor sensor;
  Eigen::Vector3d ambient{0, 0, 0};  ///< radiance of uniform surroundings, R G B (in units of gain = 1)
  std::optional<Eigen::Vector3d> ambient_sigma;
  Eigen::Vector3d bow_mm{0, 0, 0};  ///< face height z = b0 X^2 + b1 X Y + b2 Y^2; X, Y from -1 to 1 over the board
  std::optional<Eigen::Vector3d> bow_sigma_mm;
  /// Measured bend of a bent sheet; nothing: board.json's. The bow changes this bend (surface.h).
  std::optional<Bend> bend;
  std::optional<Bend> bend_sigma;
  PaperCoat paper;
  std::vector<Tag> tags;  ///< measured positions; empty: board.json's hold
  /// Affine machine calibration in board coordinates, from commanded to carved, mm
  Affine2 machine_affine = (Affine2() << 1, 0, 0, 0, 1, 0).finished();
  std::optional<Affine2> machine_affine_sigma;
  MachineErrors machine_errors;            ///< residual errors of the affine map: backlash, uneven screws
  std::vector<Misfit> misfits;             ///< contradictions between the model and the photos of the calibration
  std::map<std::string, Verdict> verdict;  ///< by parameter name (burin/scene/parameter_name.h)
  std::vector<Finding> findings;           ///< missing fields of a file of an older version; not written
};

/// Reads `bench.json` (version 2 or 1) and the `.cameramodel`, if the file names one. Throws Error for anything
/// missing, unknown or out of range.
Bench read_bench(const std::filesystem::path& file);

/// Writes `bench.json` atomically, and the `.cameramodel` if `bench.camera` is empty or in the same folder. The
/// function derives half_width_um from material.depth_um and `tool_width_um`.
void write_bench(const Bench& bench, double tool_width_um, const std::filesystem::path& file);

/// The verdict on a parameter; nullptr if there is none.
const Verdict* find_verdict(const Bench& bench, const std::string& parameter);

/// The lens of a view's photos.
Lens lens_of(const Bench& bench, const View& view);

/// The view of that name. `where` appears in the message. Throws Error for an unknown name, with a list of all names,
/// and for an unaimed view.
const View& find_view(const Bench& bench, std::string_view name, std::string_view where);

/// The light of that name. Names joined by kBesides ("sun + room") give several lights at once: the first one with the
/// others as its `also`. Throws Error for an unknown name, with a list of all names.
Light find_light(const Bench& bench, std::string_view id, std::string_view where);
/// find_light() plus bench.stray if all named lights are near lamps.
Light find_lit(const Bench& bench, std::string_view id, std::string_view where);
inline constexpr std::string_view kBesides = " + ";

/// Joins the names of simultaneous lights into one name, and splits it.
std::string joined_lights(const std::vector<std::string>& ids);
std::vector<std::string> light_names(std::string_view joined);

}  // namespace burin

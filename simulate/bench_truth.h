// burin/simulate/bench_truth.h - a bench with known ground truth for the simulated camera. Format "burin/rig-truth".
//
// The ground truth goes beyond board.json and bench.json: the carved grooves, the sensor's effects, and other objects
// on the board. Frame: board, mm. Additional fields:
//
//   name, seed                 every random draw follows from the seed
//   samples, samples_plain     points per pixel with and without scratches
//   overlap                    "sum": crossing grooves add up; "last": the last carved groove rules at a point
//                              (docs/model.md 7.6); "deepest": the lower surface does, burrs are above the face
//   tolerance, sampling        of other programs with the same file; not used here
//   h_at                       "sample": wi, wo and h at every point; "center": at the footprint's center
//                              (docs/model.md 5.1)
//   board                      as board.json, with the tags' true places; tags.quiet_mm: white paper beyond the
//                              tag's own border; tags.gloss_alpha, gloss_f0: its gloss; bow_mm, or bend
//   believed                   {material, bend, tag_overrides}: values of board.json instead of the ground truth
//   scratches                  "FILE.csv", or {"random": {count, length_mm: [from, to], seed}}: the designed scratches
//   material                   depth_gradient [gx, gy]: depth_um (1 + gx (u - 1/2) + gy (v - 1/2)); alpha_jitter,
//                              depth_jitter: standard deviation of the logarithm per scratch; wear: depth falls from
//                              1 + wear/2 times at the first scratch to 1 - wear/2 at the last;
//                              profile (as in board.json), brushed {along_deg, alpha_along, alpha_across, streak_slope,
//                              streak_mm [long, wide]}
//   views[]                    as in bench.json, with photos; own_lens {shift_px [x, y], focal_ratio}: a stabilizer
//                              moved the principal point, and focus or a digital zoom changed both focal lengths
//   machine                    affine, and as in bench.json: backlash_mm, screw_mm, screw_period_mm, screw_phase_deg
//   sensor                     {channels, encoding, bits, jpeg_quality, gain, full_well_e, read_noise_e}; bits of
//                              linear files occupy the high end of 16;
//                              camera effects of a phone: camera_truth.h, with glare as a separate field
//   lights[]                   as in bench.json, disk_mm or panel_mm and turn_deg included: an area light is
//                              sampled at lamp_samples of its points (default 96); a sun, surroundings. A photo's
//                              "light" may name several, as "sun + sky"
//   stray_lights[]             lamps lit in every photo and named in no other file
//   psf_sigma_px, vignette, ambient, background {albedo, noise, z_mm}, dust, shapes, exif, session
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "burin/capture/session.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"
#include "burin/scene/carve.h"
#include "burin/scene/lens.h"
#include "burin/scene/surface.h"
#include "burin/simulate/camera_truth.h"

namespace burin {

/// Random scratches in the carve area.
struct RandomScratches {
  int count = 0;
  double shortest_mm = 6, longest_mm = 10;
  std::uint64_t seed = 0;
};

/// Quantization and noise of a simulated sensor.
struct SensorTruth {
  int channels = 1;  ///< 1: the mean of R, G and B
  Encoding encoding = Encoding::linear;
  int bits = 16;
  int jpeg_quality = 95;
  double full_well_e = 18000;  ///< electrons at the white level at ISO 100
  double read_noise_e = 9;
  CameraTruth camera;
};

/// The background under the board.
struct Cloth {
  Eigen::Vector3d albedo{0.03, 0.03, 0.03};
  double noise = 0;  ///< relative
  double z_mm = -2;
};

/// An object on the face: a sticker, or a fingerprint that veils the metal.
struct ShapeOnBoard {
  bool ellipse = false;  ///< false: a rectangle
  Eigen::Vector2d center_mm{0, 0}, half_mm{0, 0};
  double rotation_deg = 0, z_mm = 0;
  Eigen::Vector3d albedo{0, 0, 0};
  double gloss_alpha = 0, gloss_f0 = 0;  ///< a coat of varnish; none if gloss_f0 is 0
  double smudge = 1;                     ///< veiled share of the metal; 1 hides it
};

/// Specks and fibers scattered over the board.
struct Dust {
  int specks = 0, fibers = 0;
  double smallest_mm = 0.1, largest_mm = 0.5;
  Eigen::Vector3d albedo{0.3, 0.3, 0.3};
  std::uint64_t seed = 0;
};

/// Streaks of a brushed face: value noise that tilts it across the brushing.
struct Streaks {
  double slope = 0;                     ///< from -slope to slope
  double length_mm = 40, width_mm = 1;  ///< of the noise's cells, along and across
};

/// A photo that a ground truth requests.
struct TruthPhoto {
  std::filesystem::path file;  ///< relative to the output folder
  Photo photo;                 ///< view, light, exposure; `file` is empty
  std::string datetime;        ///< "2024:03:09 14:03:30", or empty
};

/// A pose of the simulated camera, and its photos.
struct TruthView {
  std::string name;
  Eigen::Isometry3d T_camera_board = Eigen::Isometry3d::Identity();
  std::optional<Lens> lens;  ///< if it differs from the common one
  std::vector<TruthPhoto> photos;
};

/// Ground truth of a simulated bench (`truth.json`).
struct BenchTruth {
  std::filesystem::path file;
  std::string name;
  std::uint64_t seed = 0;
  int samples = 1024, samples_plain = 64;
  // The board and the machine's errors.
  Board board;     ///< true board
  Board believed;  ///< prior for board.json
  Surface surface;
  Eigen::Vector2d depth_gradient{0, 0};
  Affine2 machine_affine = (Affine2() << 1, 0, 0, 0, 1, 0).finished();
  MachineErrors machine_errors;  ///< backlash and uneven screws
  double alpha_jitter = 0, depth_jitter = 0, wear = 0;
  Streaks streaks;
  double quiet_mm = 0;
  double tag_gloss_alpha = 0, tag_gloss_f0 = 0;  ///< satin paper: a coat of GGX over it; none if f0 is 0
  std::filesystem::path scratches;               ///< empty: random
  RandomScratches random;
  // The camera and its light.
  Lens lens;
  Sensor optics;  ///< gain, vignette, blur
  SensorTruth sensor;
  std::vector<Light> lights, stray_lights;
  int lamp_samples = 96;
  std::vector<TruthView> views;
  Eigen::Vector3d ambient{0, 0, 0};
  std::string make, model;
  std::optional<double> focal_mm, focal_35mm;
  // Other objects.
  Cloth cloth;
  Dust dust;
  std::vector<ShapeOnBoard> shapes;
  bool last_rules = false, h_at_center = false;
  bool deepest_rules = false;
  bool writes_session = true;
};

/// Throws Error on anything missing, unknown or out of range.
BenchTruth read_bench_truth(const std::filesystem::path& file);

/// The commanded scratches of a ground truth: its file, or random scratches (ends inside the carve area).
Sent sent_scratches(const BenchTruth& truth);

/// The carved grooves: carve() with the true map, fields and wear, and each groove's own deviation. All grooves are
/// whole, with width, depth and alpha of their own.
Carved carved_by(const BenchTruth& truth, const Sent& sent);

}  // namespace burin

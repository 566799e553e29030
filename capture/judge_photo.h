// burin/capture/judge_photo.h - one photo judged the moment it was taken, while the camera still stands there: tags,
// exposure of paper and glints, sharpness, where the camera stood. Facts first; photo_faults() makes the sentences.
//
// Quick: tags are searched in a copy of at most three megapixels, and in the photo itself only where that leaves reason
// to; edges are measured at full size. What photos say together is preflight's (burin/capture/preflight.h).
// Values: linear, 1 is the white level, of the brightest channel. Pixels are those of the sensor.
#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "burin/base/finding.h"
#include "burin/capture/exif.h"
#include "burin/capture/photo_look.h"
#include "burin/capture/tags/board_pose.h"
#include "burin/scene/board.h"
#include "burin/scene/lens.h"

namespace burin {

/// Where the focal length behind a pose comes from.
enum class LensFrom {
  nowhere,  ///< no pose
  bench,    ///< the bench's lens, made to fit the photo's size
  exif,     ///< the 35 mm equivalent that the photo tells
  photo     ///< the tags themselves, seen at an angle
};

/// What one photo shows.
struct PhotoFacts {
  std::filesystem::path file;
  int width = 0, height = 0;
  Exif exif;
  std::optional<double> exposure_factor;  ///< exposure_s iso / 100 / f_number^2; ISO 100 and f/8 if EXIF has none
  std::vector<TagLook> tags;              ///< the board's, sorted by id
  std::vector<int> missing_tags;          ///< ids of the board's that are not seen
  std::vector<int> stray_tags;            ///< ids that are seen where the board does not have them
  double tag_side_px = 0;                 ///< median
  double bright = 0;                      ///< what 0.5 % of the pixels exceed
  double paper = 0;                       ///< median over the tags' white paper; 0 without tags
  double paper_clipped = 0;               ///< share of that paper
  /// Within the carve area (the tags' paper left out): the share of clipped pixels, and what 0.1 % exceed. None where
  /// nothing tells where it lies in the photo.
  std::optional<double> glints_clipped, glints_bright;
  /// Gaussian width of the tags' edges, the pixel's own square included: the median over all sides, the worst tag's,
  /// and how many times wider they are in one direction of the photo than in the other. None where no edge could be
  /// measured.
  std::optional<double> blur_px, worst_blur_px;
  double one_way_blur = 1;
  int worst_blur_tag = -1;
  std::optional<BoardPose> pose;
  LensFrom lens_from = LensFrom::nowhere;
  double focal_px = 0;
  std::array<Eigen::Vector2d, 4> carve_px;  ///< corners of the carve area in the photo; of use where `carve_seen`
  bool carve_seen = false;
  bool place_of_before = false;  ///< no tag is seen, so it was taken for the place of the photo before

  /// Where the camera stood, board frame.
  std::optional<Eigen::Vector3d> eye_mm() const;
};

/// Judges a photo of `board`. `believed`: the lens of the bench, if there is one; a photo whose EXIF tells a focal
/// length that is more than a seventh off is judged by its own. `before`: the photo taken before this one; where this
/// one is too dark to show a tag and was taken within a minute of it, at a shorter exposure, it is taken to show the
/// same. `f_number`: of a photo whose EXIF has none; 0: not known. Throws Error for a file that is missing, broken, cut
/// short, or of an unknown kind, and for a family of tags that AprilTag does not know.
PhotoFacts judge_photo(const std::filesystem::path& file, const Board& board, const Lens* believed = nullptr,
                       const PhotoFacts* before = nullptr, double f_number = 0);

/// White paper is best at this share of the white level: room for what is brighter, and little noise.
inline constexpr double kPaperAt = 0.6;
/// So much of the carve area may be clipped before its glints count as clipped.
inline constexpr double kGlintsClipped = 0.001;
/// So much of the tags' paper may be.
inline constexpr double kPaperLost = 0.05;

/// Whether tags can be measured in it: enough of them, sharp, their paper bright and not clipped.
bool shows_tags_well(const PhotoFacts& facts, const Board& board);

/// Whether it holds the glints: none is clipped, and it is known to show the carve area.
bool holds_glints(const PhotoFacts& facts);

/// Whether it is too blurred for use, beside the sharpest of `others`.
bool is_blurred(const PhotoFacts& facts, std::span<const PhotoFacts* const> others);

/// What is wrong with a photo, by itself and beside the `others` of its session: errors for one that cannot be used,
/// warnings for what spoils it. How bright it is is no fault: a bracket has dark photos.
std::vector<Finding> photo_faults(const PhotoFacts& facts, const Board& board,
                                  std::span<const PhotoFacts* const> others);

}  // namespace burin

// burin/capture/judge_photo.h - checks of one photo right after it was taken, while the camera is still in place: tags,
// exposure of paper and glints, sharpness, camera position. judge_photo() returns facts; photo_faults() makes
// sentences.
//
// For speed, tags are searched in a copy of at most three megapixels. The photo itself is searched only if the copy
// leaves doubt. Edges are measured at full size. burin/capture/preflight.h checks all photos of a session together.
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

/// Source of the focal length behind a pose.
enum class LensFrom {
  nowhere,  ///< no pose
  bench,    ///< the bench's lens, scaled to the photo's size
  exif,     ///< the 35 mm equivalent in EXIF
  photo     ///< the tags themselves, seen at an angle
};

/// Measurements of one photo.
struct PhotoFacts {
  std::filesystem::path file;
  int width = 0, height = 0;
  Exif exif;
  std::optional<double> exposure_factor;  ///< exposure_s iso / 100 / f_number^2; ISO 100 and f/8 if EXIF has none
  std::vector<TagLook> tags;              ///< tags of the board, sorted by id
  std::vector<int> missing_tags;          ///< unseen ids of the board
  std::vector<int> stray_tags;            ///< seen ids at places where the board has no such tag
  double tag_side_px = 0;                 ///< median
  double bright = 0;                      ///< 99.5 % quantile of the pixels
  double paper = 0;                       ///< median over the tags' white paper; 0 without tags
  double paper_clipped = 0;               ///< clipped share of the paper
  /// Share of clipped pixels within the carve area, and the 99.9 % quantile; the tags' paper does not count. None if
  /// the place of the carve area in the photo is unknown.
  std::optional<double> glints_clipped, glints_bright;
  /// Gaussian width of the tags' edges, the pixel's own square included: the median over all sides, and the worst
  /// tag's. None if no edge could be measured. `one_way_blur` is the ratio of the widths in two directions of the
  /// photo.
  std::optional<double> blur_px, worst_blur_px;
  double one_way_blur = 1;
  int worst_blur_tag = -1;
  std::optional<BoardPose> pose;
  LensFrom lens_from = LensFrom::nowhere;
  double focal_px = 0;
  std::array<Eigen::Vector2d, 4> carve_px;  ///< corners of the carve area in the photo; valid if `carve_seen`
  bool carve_seen = false;
  bool place_of_before = false;  ///< no tag is seen, so the place of the previous photo is assumed

  /// Camera center, board frame.
  std::optional<Eigen::Vector3d> eye_mm() const;
};

/// Judges a photo of `board`. `believed` is the bench's lens, if there is one. A photo whose EXIF focal length differs
/// by more than a seventh is judged by its own. `before` is the previous photo. If this one is too dark to show a tag,
/// and was taken within a minute at a shorter exposure, it counts as the same place. `f_number` applies to a photo
/// without one in EXIF; 0: not known. Throws Error for a missing, broken or truncated file, for an unknown kind, and
/// for a tag family unknown to AprilTag.
PhotoFacts judge_photo(const std::filesystem::path& file, const Board& board, const Lens* believed = nullptr,
                       const PhotoFacts* before = nullptr, double f_number = 0);

/// Best level of white paper, as a share of the white level: headroom for brighter parts, and little noise.
inline constexpr double kPaperAt = 0.6;
/// Share of the carve area that may be clipped before its glints count as clipped.
inline constexpr double kGlintsClipped = 0.001;
/// Share of the tags' paper that may be clipped.
inline constexpr double kPaperLost = 0.05;

/// True if tags can be measured: enough of them, sharp, their paper bright and not clipped.
bool shows_tags_well(const PhotoFacts& facts, const Board& board);

/// True if the photo holds the glints: none is clipped, and it is known to show the carve area.
bool holds_glints(const PhotoFacts& facts);

/// True if the photo is too blurred for use, compared with the sharpest of `others`.
bool is_blurred(const PhotoFacts& facts, std::span<const PhotoFacts* const> others);

/// Faults of a photo, by itself and against the `others` of its session. Errors mark unusable photos; warnings mark
/// faults that degrade it. Darkness is no fault: a bracket has dark photos.
std::vector<Finding> photo_faults(const PhotoFacts& facts, const Board& board,
                                  std::span<const PhotoFacts* const> others);

}  // namespace burin

// burin/scene/coupon.h - a coupon: a small patch of test scratches that measures a machine. Format "burin/coupon".
// Frame: the coupon's own board (origin at its lower-left corner, x right, y up), mm. docs/calibration.md, "The
// coupon".
//
// A coupon contains fans: scratches in all directions around a center, like spokes, all with the same command. Fans
// with the same command share a cell; cells with several fans measure repeatability. The folder of coupon.json also
// contains board.json (tags, tool, prior) and scratches.csv, with rows in carving order.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace burin {

/// One way to carve: the machine's command and the prior of its result.
struct CouponCell {
  double command = 0;   ///< Z below the face or below contact, mm; a servo's S
  double depth_um = 0;  ///< prior
  double feed_mm_min = 0;
  double reached_mm_min = 0;  ///< mean over a scratch, with the machine's acceleration
  double spacing_mm = 0;      ///< between neighboring scratches, halfway along them
};

/// Scratches around a center, carved one after the other.
struct CouponFan {
  std::size_t cell = 0;
  Eigen::Vector2d center_mm{0, 0};
  double radius_mm = 0;       ///< distance of the scratches' outer ends from the center
  bool outward = true;        ///< true: the tool moves away from the center
  std::size_t first_row = 0;  ///< of scratches.csv
  std::size_t rows = 0;
};

/// A recommended camera position for one photo.
struct CouponShot {
  double lean_deg = 0;  ///< of the half vector from the board's normal, at the coupon's middle
  Eigen::Vector3d eye_mm{0, 0, 0};
};

/// A coupon as it was carved, and the photos to take of it.
struct Coupon {
  int number = 1;  ///< 1 to kMostCoupons; the tags' ids follow from it
  std::string date;
  std::string machine;   ///< its profile's name
  std::string depth_by;  ///< as in the profile: "fixed-z", "spring", "drag", "servo"
  double usual_feed_mm_min = 0;
  Eigen::Vector2d at_mm{0, 0};  ///< lower-left corner in machine coordinates
  std::vector<CouponCell> cells;
  std::vector<CouponFan> fans;       ///< in carving order
  Eigen::Vector3d lamp_mm{0, 0, 0};  ///< recommended position of the lamp
  std::vector<CouponShot> shots;
};

inline constexpr int kMostCoupons = 120;
inline constexpr int kCouponTags = 12;

/// The id of a coupon's first tag; a coupon has kCouponTags consecutive ids. No two coupons share an id, and boards
/// rarely have as many tags as the ids below the first coupon's.
constexpr int first_coupon_tag(int number) { return 600 + kCouponTags * (number - 1); }

/// Reads coupon.json. Throws Error for anything missing, unknown or out of range.
Coupon read_coupon(const std::filesystem::path& file);

/// Writes it, atomically.
void write_coupon(const Coupon& coupon, const std::filesystem::path& file);

}  // namespace burin

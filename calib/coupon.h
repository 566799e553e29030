// burin/calib/coupon.h - three photos of a coupon (burin/scene/coupon.h) into what its machine carves: depth and
// roughness of each cell, how well they repeat, wear, and whether the direction of travel matters. Frame: the coupon's
// board, mm. docs/calibration.md, "The coupon".
//
//   Coupon c = read_coupon("coupon.json");
//   Calibration k = calibrate(session, board);                       // cameras and lamp, from the tags
//   CouponReading r = read_coupon_photos(merged, c, board, told, k.bench);
//
// First `refine` fits what all grooves share. Then each fan is fitted by itself (photo/coupon_fit.h), with lamp, face,
// light and the machine's map moving along, twice, so that what all share is not bent by grooves that differ. Fans of
// one cell are then one number with a sigma (verdict/coupon_statistics.h).
#pragma once

#include <span>
#include <vector>

#include "burin/base/progress.h"
#include "burin/calib/verdict/coupon_statistics.h"
#include "burin/calib/verdict/refinement.h"
#include "burin/capture/photo.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"
#include "burin/scene/coupon.h"
#include "burin/scene/scratches.h"
#include "burin/scene/verdict.h"

namespace burin {

/// Why a number of a cell is not determined.
enum class CouponCause {
  none,          ///< it is
  unseen,        ///< no photo shows its fans, or shows anything of them
  overexposed,   ///< in most photos
  inside_reach,  ///< of a depth: all photos lean less than its walls, where light does not depend on it
  beyond_reach,  ///< of a depth: all photos lean more
  large_sigma    ///< they do tell, but not well
};

/// A number of a cell.
struct CouponNumber {
  double value = 0, sigma = 0;
  Degree degree = Degree::not_determined;
  CouponCause cause = CouponCause::none;
};

/// What the photos say of a cell, halfway through the carving.
struct CellReading {
  CouponNumber depth_um, alpha;
  std::size_t fans = 0;
  double steepest_rad = 0;                       ///< of its walls
  double least_lean_rad = 0, most_lean_rad = 0;  ///< of the half vectors at its fans, in all photos
};

/// What they say of one fan: logarithms and their sigmas.
struct FanReading {
  double log_depth = 0, log_depth_sigma = 0, log_alpha = 0, log_alpha_sigma = 0;
};

/// How the depth depends on the direction of travel.
struct TravelReading {
  double share = 0;        ///< by how much it is deeper going towards `towards_deg` than going back
  double sigma = 0;        ///< of the share
  double towards_deg = 0;  ///< counter-clockwise from x
  double towards_sigma_deg = 0;
  bool known = false;  ///< whether the photos could tell
  bool seen = false;   ///< beyond chance, at 1 %
};

struct CouponReading {
  std::vector<CellReading> cells;  ///< as the coupon's
  std::vector<FanReading> fans;    ///< as the coupon's
  CellStatistics depth, alpha;     ///< of the logarithms; trends and what repeats
  TravelReading travel;
  Bench bench;  ///< the cameras, lamp, face and map that explain the photos
  std::vector<PhotoFit> photos;
  std::vector<Finding> findings;
};

struct CouponReadOptions {
  double finest_pixel_mm = 0.2;  ///< photos are binned to pixels of at least this size on the coupon
};

/// `told`: scratches.csv. `calibrated`: from calibrate(), with lamps. Throws Error for photos that show no coupon, and
/// for scratches that are not the coupon's.
CouponReading read_coupon_photos(std::span<const MergedView> photos, const Coupon& coupon, const Board& board,
                                 const Scratches& told, const Bench& calibrated, const CouponReadOptions& options = {},
                                 const Progress& progress = {});

}  // namespace burin

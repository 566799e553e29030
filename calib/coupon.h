// burin/calib/coupon.h - reads three photos of a coupon (burin/scene/coupon.h): depth and roughness of each cell, their
// repeatability, wear, and the effect of the direction of travel. Frame: the coupon's board, mm. docs/calibration.md,
// "The coupon".
//
//   Coupon c = read_coupon("coupon.json");
//   Calibration k = calibrate(session, board);                       // cameras and lamp, from the tags
//   CouponReading r = read_coupon_photos(merged, c, board, told, k.bench);
//
// First `refine` fits the shared parameters of all grooves. Then each fan is fitted by itself (photo/coupon_fit.h),
// while lamp, face, light and the affine machine calibration move along. A second pass keeps differing grooves from
// biasing the shared parameters. Fans of one cell then become one number with a sigma (verdict/coupon_statistics.h).
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

/// Reason for an undetermined number of a cell.
enum class CouponCause {
  none,          ///< it is determined
  unseen,        ///< no photo shows its fans, or shows any light of them
  overexposed,   ///< in most photos
  inside_reach,  ///< of a depth: all photos lean less than its walls; there light does not depend on depth
  beyond_reach,  ///< of a depth: all photos lean more
  large_sigma    ///< the photos constrain it, but poorly
};

/// A number of a cell.
struct CouponNumber {
  double value = 0, sigma = 0;
  Degree degree = Degree::not_determined;
  CouponCause cause = CouponCause::none;
};

/// Estimates of a cell, halfway through the carving.
struct CellReading {
  CouponNumber depth_um, alpha;
  std::size_t fans = 0;
  double steepest_rad = 0;                       ///< of its walls
  double least_lean_rad = 0, most_lean_rad = 0;  ///< of the half vectors at its fans, in all photos
};

/// Estimates of one fan: logarithms and their sigmas.
struct FanReading {
  double log_depth = 0, log_depth_sigma = 0, log_alpha = 0, log_alpha_sigma = 0;
};

/// Dependence of the depth on the direction of travel.
struct TravelReading {
  double share = 0;        ///< relative excess of depth towards `towards_deg` over the way back
  double sigma = 0;        ///< of the share
  double towards_deg = 0;  ///< counter-clockwise from x
  double towards_sigma_deg = 0;
  bool known = false;  ///< the photos can show it
  bool seen = false;   ///< beyond chance, at 1 %
};

/// Depths and roughnesses that a coupon's photos determine.
struct CouponReading {
  std::vector<CellReading> cells;  ///< in the coupon's order
  std::vector<FanReading> fans;    ///< in the coupon's order
  CellStatistics depth, alpha;     ///< of the logarithms; trends and repeatability
  TravelReading travel;
  Bench bench;  ///< cameras, lamp, face and affine machine calibration of the fit
  std::vector<PhotoFit> photos;
  std::vector<Finding> findings;
};

/// Options of read_coupon_photos().
struct CouponReadOptions {
  double finest_pixel_mm = 0.2;  ///< photos are binned to pixels of at least this size on the coupon
};

/// `told` is scratches.csv; `calibrated` comes from calibrate(), with lamps. Throws Error for photos without a coupon,
/// and for scratches of another coupon.
CouponReading read_coupon_photos(std::span<const MergedView> photos, const Coupon& coupon, const Board& board,
                                 const Scratches& told, const Bench& calibrated, const CouponReadOptions& options = {},
                                 const Progress& progress = {});

}  // namespace burin

// burin/optimize/toolpath/coupon.h - layout of a coupon (burin/scene/coupon.h): its fans, their places and order, and
// the viewpoints for its photos. Frame: the coupon's own board, mm.
//
// The coupon has 60 mm and twelve tags along the edges. Between them is a square of fans: one per command and speed,
// some with another spacing, and repeats. Places and order are random (the coupon's number is the seed), so an uneven
// sheet or a worn tool does not look like an effect of a command. One cell in the middle of the ladder is carved first
// and last, and cells at the usual speed both early and late. Half of each cell's fans are carved away from their
// centers, half towards them.
#pragma once

#include <string>
#include <vector>

#include "burin/base/finding.h"
#include "burin/optimize/machine_profile.h"
#include "burin/scene/board.h"
#include "burin/scene/coupon.h"
#include "burin/scene/scratches.h"

namespace burin {

/// Parameters of the trials. The machine decides empty ones.
struct CouponOptions {
  int number = 1;
  std::string date;                  ///< digits, hyphens and spaces: it is carved
  std::vector<double> commands;      ///< as CouponCell has them, softest first
  std::vector<double> depths_um;     ///< instead of commands: by the machine's table
  std::vector<double> feeds_mm_min;  ///< the machine's usual one is always among them
  std::vector<double> spacings_mm;   ///< the first is that of all fans; the middle command also tries the others
  double tool_width_um = 400;        ///< wt
  Material material;                 ///< prior; its depth matters for a machine of fixed Z only
  Eigen::Vector2d at_mm{0, 0};       ///< machine coordinates of the coupon's lower-left corner
};

/// A coupon, and the machine's input for it.
struct CouponPlan {
  Coupon coupon;
  Board board;                      ///< with its tags; scratches are not named
  Scratches scratches;              ///< in carving order, with prior depths
  std::vector<double> feed_mm_min;  ///< of each scratch
  MachineProfile machine;           ///< the given one, its table extended to all commands
  std::vector<Finding> findings;
};

/// Throws Error for lists that make no sense on this machine (preloads at a fixed Z, falling ones, speeds below 0).
/// Also throws for more fans than a coupon holds, and for limits of the machine under which no fan can be carved.
CouponPlan make_coupon(const MachineProfile& machine, const CouponOptions& options);

/// Checks a coupon's place. Throws Error if it leaves the board's face or covers a tag's paper or a keep-out. The
/// findings name its overlap with the carve area, where designs must avoid it.
std::vector<Finding> check_place(const Board& board, const Eigen::Vector2d& at_mm);

/// The board shifted by the coupon's place, in the machine's frame. `on` is the board on whose face it is carved, with
/// that board's obstacles; null on scrap.
Board coupon_on_machine(const CouponPlan& plan, const Board* on = nullptr);

}  // namespace burin

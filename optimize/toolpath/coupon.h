// burin/optimize/toolpath/coupon.h - lays out a coupon (burin/scene/coupon.h): which fans, where, in what order, and
// from where to photograph them. Frame: the coupon's own board, mm.
//
// 60 mm with twelve tags along the edges and, between them, a square of fans: one for each command and speed, some at
// another spacing, and repeats. Places and order are drawn by chance (the coupon's number is the seed), so that neither
// a sheet that is not even nor a tool that wears looks like a command's doing; one cell in the middle of the ladder is
// carved first and last, and those at the usual speed both early and late. Half of each cell's fans are carved away
// from their centers, half towards them.
#pragma once

#include <string>
#include <vector>

#include "burin/base/finding.h"
#include "burin/optimize/machine_profile.h"
#include "burin/scene/board.h"
#include "burin/scene/coupon.h"
#include "burin/scene/scratches.h"

namespace burin {

/// What is to be tried. What is left empty is chosen by the machine.
struct CouponOptions {
  int number = 1;
  std::string date;                  ///< digits, hyphens and spaces: it is carved
  std::vector<double> commands;      ///< as CouponCell has them, softest first
  std::vector<double> depths_um;     ///< instead of commands: by the machine's table
  std::vector<double> feeds_mm_min;  ///< the machine's usual one is always among them
  std::vector<double> spacings_mm;   ///< the first is that of all fans, the others are tried at the middle command
  double tool_width_um = 400;        ///< wt
  Material material;                 ///< believed; its depth matters for a machine of fixed Z only
  Eigen::Vector2d at_mm{0, 0};       ///< where the coupon's lower-left corner lies for the machine
};

/// A coupon, and what the machine needs to carve it.
struct CouponPlan {
  Coupon coupon;
  Board board;                      ///< with its tags; scratches are not named
  Scratches scratches;              ///< in carving order, with the depths that are believed
  std::vector<double> feed_mm_min;  ///< of each scratch
  MachineProfile machine;           ///< the one given, its table reaching over all commands
  std::vector<Finding> findings;
};

/// Throws Error for lists that make no sense on this machine (preloads at a fixed Z, falling ones, speeds below 0), for
/// more fans than a coupon holds, and for limits of the machine under which no fan can be carved.
CouponPlan make_coupon(const MachineProfile& machine, const CouponOptions& options);

/// Whether a coupon may lie there: throws Error where it leaves the board's face or covers a tag's paper or a keep-out;
/// tells where it lies in the carve area, where designs must be kept off it.
std::vector<Finding> check_place(const Board& board, const Eigen::Vector2d& at_mm);

/// The board with everything shifted by the coupon's place: as the machine sees it. `on`: the board on whose face it is
/// carved, with what stands there; null on scrap.
Board coupon_on_machine(const CouponPlan& plan, const Board* on = nullptr);

}  // namespace burin

// burin/simulate/things_on_board.h - what hides or veils the metal in a simulated photo: tags, stickers,
// fingerprints, dust. Frame: board, mm. Everything is flat, z_mm above the face.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

#include "burin/simulate/bench_truth.h"

namespace burin {

/// The look of one point of a thing.
struct Coat {
  Eigen::Vector3d albedo{0, 0, 0};       ///< Lambertian
  double gloss_alpha = 0, gloss_f0 = 0;  ///< varnish on top; none where gloss_f0 is 0
  double share = 1;                      ///< of the metal that is hidden
};

/// Things, and where to look for them. Dust lies on shapes, shapes on tags; of two of a kind the later one is on top.
class ThingsOnBoard {
 public:
  /// Draws tags from AprilTag's own families: the tag's cells, white paper `quiet_mm` beyond its border.
  /// Throws Error for a family that AprilTag does not have, and for an id that the family does not have.
  explicit ThingsOnBoard(const BenchTruth& truth);
  ~ThingsOnBoard();
  ThingsOnBoard(const ThingsOnBoard&) = delete;
  ThingsOnBoard& operator=(const ThingsOnBoard&) = delete;

  /// Things that could be seen within a small part of the face, top first, into `found`.
  void near(const Eigen::Vector2d& min_mm, const Eigen::Vector2d& max_mm, std::vector<int>& found) const;

  /// How high the thing lies.
  double z_mm(int thing) const;

  /// The thing's look at a point; false where it does not reach.
  bool at(int thing, double x_mm, double y_mm, Coat& coat) const;

 private:
  struct Thing;
  struct Bins;
  std::vector<Thing> things_;
  std::unique_ptr<Bins> bins_;
};

}  // namespace burin

// burin/simulate/things_on_board.h - objects that hide or veil the metal in a simulated photo: tags, stickers,
// fingerprints, dust. Frame: board, mm. All are flat, z_mm above the face.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

#include "burin/simulate/bench_truth.h"

namespace burin {

/// Appearance of one point of an object.
struct Coat {
  Eigen::Vector3d albedo{0, 0, 0};       ///< Lambertian
  double gloss_alpha = 0, gloss_f0 = 0;  ///< varnish on top; none if gloss_f0 is 0
  double share = 1;                      ///< hidden share of the metal
};

/// The objects, and a search by place. Dust covers shapes, and shapes cover tags; of two of a kind the later one is on
/// top.
class ThingsOnBoard {
 public:
  /// Draws tags from AprilTag's own families: the tag's cells, white paper `quiet_mm` beyond its border. Throws Error
  /// for a family unknown to AprilTag, and for an id that the family does not have.
  explicit ThingsOnBoard(const BenchTruth& truth);
  ~ThingsOnBoard();
  ThingsOnBoard(const ThingsOnBoard&) = delete;
  ThingsOnBoard& operator=(const ThingsOnBoard&) = delete;

  /// Finds objects that could be visible within a small part of the face, top first, into `found`.
  void near(const Eigen::Vector2d& min_mm, const Eigen::Vector2d& max_mm, std::vector<int>& found) const;

  /// Height of the object above the face.
  double z_mm(int thing) const;

  /// The object's appearance at a point; false outside of it.
  bool at(int thing, double x_mm, double y_mm, Coat& coat) const;

 private:
  struct Thing;
  struct Bins;
  std::vector<Thing> things_;
  std::unique_ptr<Bins> bins_;
};

}  // namespace burin

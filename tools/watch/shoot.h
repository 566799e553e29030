// tools/watch/shoot.h - the photos of a board as they come in, beside those that are wanted of it: which is which, what
// is missing, what to take now. Facts; tools/watch/say_shoot.h has the sentences.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "burin/capture/judge_photo.h"
#include "tools/match_views.h"
#include "tools/watch/wanted_shots.h"

namespace burin {

/// One photo, and where it belongs.
struct JudgedPhoto {
  PhotoFacts facts;
  std::string light;                   ///< the lamp that was on; empty: not known, so any
  std::vector<Finding> faults;         ///< photo_faults() when it came
  std::optional<std::size_t> shot;     ///< of the wanted ones, the one that it is
  std::optional<std::size_t> nearest;  ///< of the wanted ones, the nearest; none without a pose
  Offset offset;                       ///< from the place of `nearest` to where it was taken
  bool wrong_way_up = false;           ///< `nearest` wants the camera on its side, or this one is and should not
  std::optional<double> stops;         ///< of exposure, above the one that has the tags' paper at 60 % of white
};

/// How far one wanted shot is.
enum class ShotState {
  open,   ///< no photo of it
  begun,  ///< photos, but none with the tags well exposed, or none with the glints held
  again,  ///< only photos with faults
  done
};

/// A board being photographed.
struct Shoot {
  Board board;
  std::optional<Lens> lens;  ///< of the bench
  double f_number = 0;       ///< of photos whose EXIF has none; 0: not known
  std::vector<WantedShot> wanted;
  std::string light;  ///< the lamp that is on in the next photos; empty: not known, then shots come in their order
  std::size_t least_places = 0;        ///< from which photos are wanted in all; a plan knows better
  std::optional<std::size_t> sent_to;  ///< the shot that was last gone to, before the last photo came
  std::vector<JudgedPhoto> photos;     ///< in the order in which they came
};

/// Whether a photo is from a place of its own, of use where no plan names the further ones: not a wanted shot missed.
bool is_further_place(const JudgedPhoto& photo, const Shoot& shoot);

/// Takes a photo in, judged by judge_photo(); one of the same file that was there before is replaced.
const JudgedPhoto& add_photo(PhotoFacts facts, Shoot& shoot);

/// Forgets the photo of a file; false if there was none.
bool remove_photo(const std::filesystem::path& file, Shoot& shoot);

ShotState state_of(const Shoot& shoot, std::size_t shot);

/// At how many places photos without errors were taken.
std::size_t places_of(const Shoot& shoot);

/// What to do now.
struct NextStep {
  enum class Kind {
    retake,   ///< the last photo once more, without its faults
    expose,   ///< from the same place, with `factor`
    move,     ///< go to `shot`
    further,  ///< go to any further place: all wanted shots are done, but they are too few
    finished  ///< all wanted shots are done
  };
  Kind kind = Kind::finished;
  std::optional<std::size_t> shot;
  /// exposure_s iso / 100 / f_number^2 to take it at: 0 where nothing tells.
  double factor = 0;
  bool for_glints = false;  ///< `factor` is for them, else for the tags' paper
};
NextStep next_step(const Shoot& shoot);

/// Whether the bracket of the last photo still lacks an exposure, and which: `expose`, or else `finished`. Only
/// photos from index `from` on count.
NextStep next_exposure(const Shoot& shoot, std::size_t from = 0);

}  // namespace burin

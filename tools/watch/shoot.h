// tools/watch/shoot.h - incoming photos of a board and the wanted ones: their assignment, the missing shots and the
// next step. This file has the facts; tools/watch/say_shoot.h has the sentences.
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

/// One photo and its assignment.
struct JudgedPhoto {
  PhotoFacts facts;
  std::string light;                   ///< the lamp that was on; empty: unknown, so any
  std::vector<Finding> faults;         ///< photo_faults() at its arrival
  std::optional<std::size_t> shot;     ///< index of its wanted shot
  std::optional<std::size_t> nearest;  ///< index of the nearest wanted shot; none without a pose
  Offset offset;                       ///< from the place of `nearest` to the camera
  bool wrong_way_up = false;    ///< true if the camera's rotation (upright or on its side) differs from `nearest`
  std::optional<double> stops;  ///< exposure in stops above the one with the tags' paper at 60 % of white
};

/// Progress of one wanted shot.
enum class ShotState {
  open,   ///< no photo of it
  begun,  ///< photos, but none with well exposed tags, or none with unclipped glints
  again,  ///< only photos with faults
  done
};

/// A board and its photos so far.
struct Shoot {
  Board board;
  std::optional<Lens> lens;  ///< of the bench
  double f_number = 0;       ///< of photos without EXIF; 0: unknown
  std::vector<WantedShot> wanted;
  std::string light;                   ///< the lamp of the next photos; empty: unknown, then shots follow their order
  std::size_t least_places = 0;        ///< number of wanted places in all, if no plan gives it
  std::optional<std::size_t> sent_to;  ///< the shot of the latest `move` before the latest photo
  std::vector<JudgedPhoto> photos;     ///< in the order of arrival
};

/// Returns true for a photo from a new place that is useful without a plan, and no near miss of a wanted shot.
bool is_further_place(const JudgedPhoto& photo, const Shoot& shoot);

/// Adds a photo with the result of judge_photo(); replaces an earlier photo of the same file.
const JudgedPhoto& add_photo(PhotoFacts facts, Shoot& shoot);

/// Removes the photo of a file; returns false if there is none.
bool remove_photo(const std::filesystem::path& file, Shoot& shoot);

ShotState state_of(const Shoot& shoot, std::size_t shot);

/// Number of places of photos without errors.
std::size_t places_of(const Shoot& shoot);

/// The next step of the photographer.
struct NextStep {
  enum class Kind {
    retake,   ///< repeat the latest photo without its faults
    expose,   ///< from the same place, with `factor`
    move,     ///< go to `shot`
    further,  ///< go to any further place: all wanted shots are done, but they are too few
    finished  ///< all wanted shots are done
  };
  Kind kind = Kind::finished;
  std::optional<std::size_t> shot;
  /// Exposure as exposure_s iso / 100 / f_number^2; 0: unknown.
  double factor = 0;
  bool for_glints = false;  ///< `factor` is for the glints, otherwise for the tags' paper
};
NextStep next_step(const Shoot& shoot);

/// Returns `expose` with the missing exposure of the latest photo's bracket, or `finished`. Only photos from index
/// `from` on count.
NextStep next_exposure(const Shoot& shoot, std::size_t from = 0);

}  // namespace burin

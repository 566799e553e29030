// burin/scene/verdict.h - what is known of one parameter of a bench, as facts: where the number comes from, how well
// the photos determine it, why, and which photo would help. Programs ask the fields; people read sentence(), which is
// made from them here and nowhere else. docs/file-formats.md, `bench.json`.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace burin {

/// Where a number comes from: it is believed (nobody looked, or the photos do not tell it), a person gave it to be
/// held, or photos.
enum class Source { assumed, given, measured };

/// What is determined only weakly is a measurement with a sigma too large to build on.
enum class Degree { determined, weakly, not_determined };

enum class Unit { none, percent, mm, px, degrees };

/// One thing that a verdict rests on, with its numbers.
struct Cause {
  enum class Kind {
    // What the sigma is a share of, or where it holds.
    of_focal_length,     ///< focal length, its sigma, that of the center, corners' RMS per axis: px; text: lens model
    of_camera_distance,  ///< text: the view, where it is the worst of all
    of_tag_place,        ///< sigma that was believed, mm
    of_bow,              ///< from the tags
    of_carve_area,       ///< the worst over it; mm without what the tags' places add
    of_paper_light,      ///< a share of the lamp's own light on paper
    of_picture_corner,   ///< a share of a pixel's value, 0.7 of the way to the picture's corner
    of_blur,             ///< px
    of_lamp_distance,    ///< the sigma as a share of it, %
    // What else speaks for or against it.
    halves_of_photos,     ///< ratio, limit, degrees, half_to_whole (burin/calib/verdict/half_samples.h)
    halves_of_tags,       ///< the same for halves of one photo's tags
    poses_by_halves,      ///< views whose halves of tags contradict each other; all views
    cutoff_seen,          ///< half vectors that lean a little less, and a little more, than the steepest wall
    cutoff_not_seen,      ///< the same, where one of them is too small
    believed_refuted,     ///< the depth that was believed and the photos speak against, um
    field_chosen,         ///< linear, quadratic, wear: 1 where depth varies so
    bare_lamp,            ///< a spot explains paper and face no better
    shines_as_a_plane,    ///< assumed: the exponent, and what was tried as much as it may be off by
    no_photo_under_lamp,  ///< no photo was taken under this lamp
    no_paper,             ///< no paper or plain face tells where the lamp is
    paper_and_face,       ///< from these alone, without scratches
    model_misses,         ///< classes of pixels contradict each other: sigmas apart, of how many tests; text: which
    above_noise,          ///< how many times the sigma is what the camera's noise alone would allow
    told                  ///< text: the sentence of a file of version 1, which had no facts
  };
  Kind kind = Kind::told;
  std::array<double, 4> numbers{};  ///< as said above; the rest 0
  std::string text{};
};

/// The photo that would help most.
struct NextPhoto {
  enum class Kind { at_place, same_view_with_more_tags, any_for_the_lens };
  Kind kind = Kind::at_place;
  std::string place{};                ///< at_place: where camera and lamp stand, in words
  std::optional<double> sigma{};      ///< what the sigma would come to, in the verdict's unit
  std::optional<int> half_vectors{};  ///< that would then lie on either side of the cut-off
};

/// What is known of one parameter.
struct Verdict {
  Source source = Source::measured;
  Degree degree = Degree::not_determined;
  std::optional<double> sigma{};  ///< one standard deviation, the worst of several numbers; in `unit`
  Unit unit = Unit::none;
  std::vector<Cause> causes{};
  std::optional<NextPhoto> next_photo{};  ///< for what is not determined

  bool determined() const { return degree == Degree::determined; }
  /// Determined at least weakly: the number is a measurement, or was given.
  bool known() const { return degree != Degree::not_determined; }
};

/// A number that was given and is held.
Verdict given_verdict();

/// Whether the verdict rests on a cause of this kind.
bool rests_on(const Verdict& verdict, Cause::Kind kind);

/// Why, for people: "one sigma is 0.4 %; halves of the photos agree (...)". No full stop.
std::string sentence(const Verdict& verdict);
std::string sentence(const NextPhoto& next, Unit unit);

/// "determined", "weakly", "not determined"; "assumed", "given", "measured"; "%", "mm", "" for none.
const char* in_words(Degree degree);
const char* in_words(Source source);
const char* in_words(Unit unit);

}  // namespace burin

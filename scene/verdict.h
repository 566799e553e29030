// burin/scene/verdict.h - identifiability report of one parameter of a setup, as facts: source, determination by the
// photos, reasons, and the most helpful next photo. Programs read the fields. Only sentence() makes text for people
// from them. docs/file-formats.md, `bench.json`.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace burin {

/// Source of a number: a prior (not measured, or not identifiable from the photos), a person's fixed value, or photos.
enum class Source { assumed, given, measured };

/// A weakly determined number is a measurement with a sigma that is too large to build on.
enum class Degree { determined, weakly, not_determined };

enum class Unit { none, percent, mm, px, degrees };

/// One reason for a verdict, with its numbers.
struct Cause {
  /// Kind of a cause.
  enum class Kind {
    // Reference or place of the sigma.
    of_focal_length,     ///< focal length, its sigma, the center's sigma, corners' RMS per axis: px; text: lens model
    of_camera_distance,  ///< text: the worst of all views
    of_tag_place,        ///< sigma of the prior, mm
    of_bow,              ///< from the tags
    of_carve_area,       ///< the worst over it; mm, without the contribution of the tags' places
    of_paper_light,      ///< fraction of the lamp's own light on paper
    of_picture_corner,   ///< fraction of a pixel's value, 0.7 of the way to the picture's corner
    of_blur,             ///< px
    of_lamp_distance,    ///< the sigma as a fraction of it, %
    // Further evidence for or against the number.
    halves_of_photos,     ///< ratio, limit, degrees, half_to_whole (burin/calib/verdict/half_samples.h)
    halves_of_tags,       ///< the same for halves of one photo's tags
    poses_by_halves,      ///< views with contradicting halves of tags; all views
    cutoff_seen,          ///< half vectors that lean slightly less, and slightly more, than the steepest wall
    cutoff_not_seen,      ///< as for cutoff_seen, if one of them is too small
    believed_refuted,     ///< prior of the depth, contradicted by the photos, um
    field_chosen,         ///< linear, quadratic, wear: 1 if depth varies in this way
    bare_lamp,            ///< a spotlight fits paper and face no better
    shines_as_a_plane,    ///< assumed: the exponent, and its assumed error
    no_photo_under_lamp,  ///< no photo was taken under this lamp
    no_paper,             ///< no paper or plain face can show the lamp's place
    paper_and_face,       ///< from these alone, without scratches
    model_misses,         ///< classes of pixels contradict each other: sigmas apart, number of tests; text: the class
    above_noise,          ///< ratio of the sigma to the sigma from the camera's noise alone
    told                  ///< text: the sentence of a file of version 1, which had no facts
  };
  Kind kind = Kind::told;
  std::array<double, 4> numbers{};  ///< as listed above; the rest 0
  std::string text{};
};

/// The most helpful next photo.
struct NextPhoto {
  /// Kind of a further photo.
  enum class Kind { at_place, same_view_with_more_tags, any_for_the_lens };
  Kind kind = Kind::at_place;
  std::string place{};                ///< at_place: positions of camera and lamp, in words
  std::optional<double> sigma{};      ///< predicted sigma with this photo, in the verdict's unit
  std::optional<int> half_vectors{};  ///< predicted number on each side of the cut-off
};

/// Identifiability report of one parameter.
struct Verdict {
  Source source = Source::measured;
  Degree degree = Degree::not_determined;
  std::optional<double> sigma{};  ///< one standard deviation, the worst of several numbers; in `unit`
  Unit unit = Unit::none;
  std::vector<Cause> causes{};
  std::optional<NextPhoto> next_photo{};  ///< for a number that is not determined

  /// True if the photos determine the parameter.
  bool determined() const { return degree == Degree::determined; }
  /// True for an at least weakly determined or given number.
  bool known() const { return degree != Degree::not_determined; }
};

/// The verdict on a number that a person gave and that stays fixed.
Verdict given_verdict();

/// True if the verdict has a cause of this kind.
bool rests_on(const Verdict& verdict, Cause::Kind kind);

/// The reason, for people: "one sigma is 0.4 %; halves of the photos agree (...)". No full stop.
std::string sentence(const Verdict& verdict);
std::string sentence(const NextPhoto& next, Unit unit);

/// "determined", "weakly", "not determined"; "assumed", "given", "measured"; "%", "mm", "" for none.
const char* in_words(Degree degree);
const char* in_words(Source source);
const char* in_words(Unit unit);

}  // namespace burin

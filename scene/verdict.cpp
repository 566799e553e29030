#include "burin/scene/verdict.h"

#include <algorithm>
#include <string_view>

#include "burin/base/files/decimals.h"

namespace burin {
namespace {

std::string with_unit(double value, Unit unit) {
  return significant(value) + (unit == Unit::none ? "" : std::string(" ") + in_words(unit));
}

std::string halves_in_words(const std::array<double, 4>& n, std::string_view of_what) {
  const auto [ratio, limit, degrees, half_to_whole] = n;
  if (!(degrees > 0)) return "too few " + std::string(of_what) + " to compare halves of them";
  std::string out = "halves of the " + std::string(of_what);
  if (ratio > limit)
    out += " contradict each other: they differ " + significant(ratio) +
           " times as much as the covariance allows (up to " + significant(limit) +
           " is chance), so the sigma was made that much larger";
  else
    out += " agree (their difference is " + significant(ratio) + " of what is to be expected; up to " +
           significant(limit) + " is chance)";
  constexpr double kFewCarry = 4;
  if (half_to_whole > kFewCarry) out += "; it rests on few of the " + std::string(of_what);
  return out;
}

std::string cutoff_in_words(double inside, double outside, bool seen) {
  std::string counts = significant(inside, 17) + " half vectors lean a little less and " + significant(outside, 17) +
                       " a little more than the grooves' steepest wall";
  if (seen) return counts;
  return counts + ", so no photo shows where the glints end; photograph the board from " +
         (inside >= outside ? "further to the side" : "nearer to the lamp's mirror image");
}

std::string field_in_words(bool linear, bool quadratic, bool wear) {
  std::string name = quadratic ? "quadratic over the board" : linear ? "linear over the board" : "constant";
  if (wear)
    name += (linear || quadratic) ? ", with wear along the carving order" : " but for wear along the carving order";
  return name + ", chosen by predicting each view from the others, accidents of single grooves counted";
}

// The reference of the sigma, to follow the sigma directly; empty for other causes.
std::string of_what(const Cause& cause) {
  const auto& n = cause.numbers;
  switch (cause.kind) {
    case Cause::Kind::of_focal_length:
      return " of the focal length or as much for the center (" + cause.text + ", focal length " +
             significant(n[0], 6) + " +- " + significant(n[1]) + " px, center +- " + significant(n[2]) +
             " px; corners " + significant(n[3], 3) + " px RMS per axis)";
    case Cause::Kind::of_camera_distance:
      return " of the camera's distance" + (cause.text.empty() ? "" : ", in view " + cause.text + ", the worst");
    case Cause::Kind::of_tag_place:
      return " for a tag's place against the others' (believed before: " + significant(n[0]) + " mm)";
    case Cause::Kind::of_bow:
      return ", from the tags";
    case Cause::Kind::of_carve_area:
      return " at most over the carve area, the tags' places included (" + significant(n[0]) + " mm without)";
    case Cause::Kind::of_paper_light:
      return " of the lamp's own light on paper";
    case Cause::Kind::of_picture_corner:
      return " of a pixel's value at 0.7 of the way to the picture's corner";
    case Cause::Kind::of_blur:
      return " of " + significant(n[0]) + " px";
    case Cause::Kind::of_lamp_distance:
      return ", " + significant(n[0]) + " % of its distance";
    default:
      return "";
  }
}

// Advice for a sigma over the carve area to which the tags' places contribute most; otherwise empty.
std::string tags_in_words(const Verdict& verdict) {
  constexpr double kPhotosPart = 2.0 / 3;  // a decrease by a third would be worth a photo
  for (const Cause& cause : verdict.causes)
    if (cause.kind == Cause::Kind::of_carve_area && verdict.sigma && cause.numbers[0] < kPhotosPart * *verdict.sigma &&
        !verdict.determined())
      return "the tags' places make most of it, and no photo determines these: measure with a ruler where two tags or "
             "more "
             "lie from the board's edges, write their center_mm and a smaller tags.sigma_mm into board.json. Without "
             "it "
             "all pictures lie aside by as much, which hardly shows";
  return "";
}

std::string in_words(const Cause& cause) {
  const auto& n = cause.numbers;
  switch (cause.kind) {
    case Cause::Kind::halves_of_photos:
      return halves_in_words(n, "photos");
    case Cause::Kind::halves_of_tags:
      return halves_in_words(n, "tags");
    case Cause::Kind::poses_by_halves:
      return n[0] == 0 ? "in every view, poses from halves of its tags agree"
                       : "in " + significant(n[0], 17) + " of " + significant(n[1], 17) +
                             " views, poses from halves of the tags contradict each other, and their sigmas were made "
                             "larger";
    case Cause::Kind::cutoff_seen:
    case Cause::Kind::cutoff_not_seen:
      return cutoff_in_words(n[0], n[1], cause.kind == Cause::Kind::cutoff_seen);
    case Cause::Kind::believed_refuted:
      return "the photos contradict the prior of " + significant(n[0], 3) + " um, and this value explains them best";
    case Cause::Kind::field_chosen:
      return field_in_words(n[0] != 0, n[1] != 0, n[2] != 0);
    case Cause::Kind::bare_lamp:
      return "a bare lamp: taking it for a spot explains paper and face no better";
    case Cause::Kind::shines_as_a_plane:
      return "assumed to shine to the side as a plane does, since paper and face do not determine it: a fall-off "
             "exponent "
             "of " +
             significant(n[0], 2) + "; what " + significant(n[1], 2) + " more would move is in the sigmas";
    case Cause::Kind::no_photo_under_lamp:
      return "no photo shows the board under this lamp";
    case Cause::Kind::no_paper:
      return "no paper or plain face determines the lamp's place";
    case Cause::Kind::paper_and_face:
      return "from paper and plain face alone; refine adds the scratches' glints";
    case Cause::Kind::model_misses:
      return "the model misses something (" + cause.text + "), and the sigma counts how far that moves the answer";
    case Cause::Kind::above_noise:
      return significant(n[0]) + " times what the camera's noise alone would allow";
    case Cause::Kind::told:
      return cause.text;
    default:
      return "";
  }
}

}  // namespace

const char* in_words(Degree degree) {
  return degree == Degree::determined ? "determined" : degree == Degree::weakly ? "weakly" : "not determined";
}

const char* in_words(Source source) {
  return source == Source::assumed ? "assumed" : source == Source::given ? "given" : "measured";
}

const char* in_words(Unit unit) {
  constexpr std::array<const char*, 5> kWords{"", "%", "mm", "px", "degrees"};
  return kWords.at(static_cast<std::size_t>(unit));
}

Verdict given_verdict() { return {Source::given, Degree::determined}; }

bool rests_on(const Verdict& verdict, Cause::Kind kind) {
  return std::any_of(verdict.causes.begin(), verdict.causes.end(), [&](const Cause& c) { return c.kind == kind; });
}

std::string sentence(const Verdict& verdict) {
  std::string out;
  const auto add = [&](const std::string& part) {
    if (!part.empty()) out += (out.empty() ? "" : "; ") + part;
  };
  // The sentence of an old file is complete already.
  if (rests_on(verdict, Cause::Kind::told)) {
    for (const Cause& cause : verdict.causes) add(in_words(cause));
    return out;
  }
  if (verdict.source == Source::given) add("given, and held fixed");
  if (verdict.source == Source::assumed)
    add(verdict.sigma || !verdict.causes.empty() ? "left as it was believed" : "assumed; no photo was used");
  if (verdict.sigma) {
    add("one sigma is " + with_unit(*verdict.sigma, verdict.unit));
    for (const Cause& cause : verdict.causes) out += of_what(cause);
    if (verdict.degree == Degree::weakly) out += "; the photos do not determine it better than that";
    if (verdict.degree == Degree::not_determined) out += ", so the photos do not determine it";
  }
  for (const Cause& cause : verdict.causes) add(in_words(cause));
  add(tags_in_words(verdict));
  return out;
}

std::string sentence(const NextPhoto& next, Unit unit) {
  std::string out;
  switch (next.kind) {
    case NextPhoto::Kind::at_place:
      out = next.place;
      break;
    case NextPhoto::Kind::same_view_with_more_tags:
      out = "the same view again with more of the board's tags in it, sharp";
      break;
    case NextPhoto::Kind::any_for_the_lens:
      out = "any that helps the lens, which this pose depends on";
      break;
  }
  if (next.half_vectors)
    out += "; " + std::to_string(*next.half_vectors) + " half vectors would then lie on either side of the cut-off";
  else if (next.sigma)
    out += "; its sigma would come to about " + with_unit(*next.sigma, unit);
  return out;
}

}  // namespace burin

#include "burin/scene/files/verdict_json.h"

#include <array>
#include <cstddef>
#include <utility>

namespace burin {
namespace {

template <typename Enum>
struct Name {
  Enum value;
  const char* name;
};

constexpr std::array<Name<Source>, 3> kSources{
    {{Source::assumed, "assumed"}, {Source::given, "given"}, {Source::measured, "measured"}}};
constexpr std::array<Name<Degree>, 3> kDegrees{
    {{Degree::determined, "determined"}, {Degree::weakly, "weakly"}, {Degree::not_determined, "not_determined"}}};
constexpr std::array<Name<Unit>, 5> kUnits{
    {{Unit::none, ""}, {Unit::percent, "%"}, {Unit::mm, "mm"}, {Unit::px, "px"}, {Unit::degrees, "degrees"}}};
constexpr std::array<Name<NextPhoto::Kind>, 3> kNextPhotos{
    {{NextPhoto::Kind::at_place, "at_place"},
     {NextPhoto::Kind::same_view_with_more_tags, "same_view_with_more_tags"},
     {NextPhoto::Kind::any_for_the_lens, "any_for_the_lens"}}};

// Written form of each cause: its name, its numbers' keys, and the key of its text.
struct CauseForm {
  Cause::Kind value;
  const char* name;
  std::array<const char*, 4> numbers{};
  const char* text = nullptr;
};
using K = Cause::Kind;
constexpr std::array<CauseForm, 24> kCauses{{
    {K::of_focal_length,
     "of_focal_length",
     {"focal_px", "focal_sigma_px", "center_sigma_px", "corners_rms_px"},
     "lens_model"},
    {K::of_camera_distance, "of_camera_distance", {}, "worst_view"},
    {K::of_tag_place, "of_tag_place", {"believed_mm"}},
    {K::of_bow, "of_bow"},
    {K::of_carve_area, "of_carve_area", {"without_tags_mm"}},
    {K::of_paper_light, "of_paper_light"},
    {K::of_picture_corner, "of_picture_corner"},
    {K::of_blur, "of_blur", {"psf_sigma_px"}},
    {K::of_lamp_distance, "of_lamp_distance", {"percent"}},
    {K::halves_of_photos, "halves_of_photos", {"ratio", "limit", "degrees_of_freedom", "half_to_whole"}},
    {K::halves_of_tags, "halves_of_tags", {"ratio", "limit", "degrees_of_freedom", "half_to_whole"}},
    {K::poses_by_halves, "poses_by_halves", {"contradicting", "views"}},
    {K::cutoff_seen, "cutoff_seen", {"inside", "outside"}},
    {K::cutoff_not_seen, "cutoff_not_seen", {"inside", "outside"}},
    {K::believed_refuted, "believed_refuted", {"believed_um"}},
    {K::field_chosen, "field_chosen", {"linear", "quadratic", "wear"}},
    {K::bare_lamp, "bare_lamp"},
    {K::shines_as_a_plane, "shines_as_a_plane", {"exponent", "uncertainty"}},
    {K::no_photo_under_lamp, "no_photo_under_lamp"},
    {K::no_paper, "no_paper"},
    {K::paper_and_face, "paper_and_face"},
    {K::model_misses, "model_misses", {"sigmas", "tests"}, "where"},
    {K::above_noise, "above_noise", {"times"}},
    {K::told, "told", {}, "words"},
}};

template <typename Table, typename Enum>
const auto& form_of(const Table& table, Enum value) {
  for (const auto& form : table)
    if (form.value == value) return form;
  return table.front();  // every value has a form (Verdict.EveryCauseHasAForm)
}

template <typename Table>
auto form_named(const Table& table, const JsonObject& json, const std::string& key, const std::string& name) {
  std::string known;
  for (const auto& form : table) {
    if (name == form.name) return form;
    known += (known.empty() ? "\"" : ", \"") + std::string(form.name) + "\"";
  }
  json.fail_field(key, "is \"" + name + "\"", "write one of: " + known);
}

Json cause_json(const Cause& cause) {
  const CauseForm& form = form_of(kCauses, cause.kind);
  Json json{{"cause", form.name}};
  for (std::size_t i = 0; i < form.numbers.size() && form.numbers[i] != nullptr; ++i)
    json[form.numbers[i]] = cause.numbers[i];
  if (form.text != nullptr && !cause.text.empty()) json[form.text] = cause.text;
  return json;
}

Cause read_cause(JsonObject json) {
  const CauseForm form = form_named(kCauses, json, "cause", json.text("cause"));
  Cause cause;
  cause.kind = form.value;
  for (std::size_t i = 0; i < form.numbers.size() && form.numbers[i] != nullptr; ++i)
    cause.numbers[i] = json.number(form.numbers[i]);
  if (form.text != nullptr) cause.text = json.text(form.text, "");
  json.finish();
  return cause;
}

std::optional<double> read_sigma(JsonObject& json) {
  if (!json.has("sigma")) return std::nullopt;
  const double sigma = json.number("sigma");
  if (sigma < 0) json.fail_field("sigma", "is " + Json(sigma).dump(), "a standard deviation is 0 or greater");
  return sigma;
}

}  // namespace

Json verdict_json(const Verdict& verdict) {
  Json json{{"source", form_of(kSources, verdict.source).name}, {"degree", form_of(kDegrees, verdict.degree).name}};
  if (verdict.sigma) json["sigma"] = *verdict.sigma;
  if (verdict.unit != Unit::none) json["unit"] = form_of(kUnits, verdict.unit).name;
  if (!verdict.causes.empty()) {
    Json& causes = json["causes"] = Json::array();
    for (const Cause& cause : verdict.causes) causes.push_back(cause_json(cause));
  }
  json["reason"] = sentence(verdict);
  if (verdict.next_photo) {
    const NextPhoto& next = *verdict.next_photo;
    Json& item = json["next_photo"] = {{"kind", form_of(kNextPhotos, next.kind).name}};
    if (!next.place.empty()) item["place"] = next.place;
    if (next.sigma) item["sigma"] = *next.sigma;
    if (next.half_vectors) item["half_vectors"] = *next.half_vectors;
    item["words"] = sentence(next, verdict.unit);
  }
  return json;
}

Verdict read_verdict(JsonObject json) {
  Verdict verdict;
  verdict.source = form_named(kSources, json, "source", json.text("source")).value;
  verdict.degree = form_named(kDegrees, json, "degree", json.text("degree")).value;
  verdict.sigma = read_sigma(json);
  verdict.unit = form_named(kUnits, json, "unit", json.text("unit", "")).value;
  if (json.has("causes"))
    for (JsonObject& cause : json.objects("causes")) verdict.causes.push_back(read_cause(cause));
  json.text("reason", "");  // for people; readers ignore it
  if (json.has("next_photo")) {
    JsonObject item = json.object("next_photo");
    NextPhoto next;
    next.kind = form_named(kNextPhotos, item, "kind", item.text("kind")).value;
    next.place = item.text("place", "");
    next.sigma = read_sigma(item);
    if (item.has("half_vectors")) next.half_vectors = item.integer("half_vectors");
    item.text("words", "");
    item.finish();
    verdict.next_photo = next;
  }
  json.finish();
  return verdict;
}

Verdict read_verdict_of_version_1(JsonObject json) {
  Verdict verdict;
  const bool determined = json.boolean("determined"), weakly = json.boolean("weakly", false);
  verdict.degree = determined ? Degree::determined : weakly ? Degree::weakly : Degree::not_determined;
  verdict.sigma = read_sigma(json);
  verdict.unit = form_named(kUnits, json, "unit", json.text("unit", "")).value;
  const std::string reason = json.text("reason", "");
  // Version 1 had no field for it: this sentence is the only sign of a number from a person.
  if (reason == "given, and held fixed")
    verdict.source = Source::given;
  else if (!reason.empty())
    verdict.causes.push_back({Cause::Kind::told, {}, reason});
  if (const std::string next = json.text("next_photo", ""); !next.empty())
    verdict.next_photo = NextPhoto{NextPhoto::Kind::at_place, next, {}, {}};
  json.finish();
  return verdict;
}

}  // namespace burin

#include "tools/watch/say_shoot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "burin/base/files/decimals.h"
#include "burin/base/files/json_file.h"

namespace burin {
namespace {

// Rounds to steps that people can set by hand: 5 mm from 30 mm on.
std::string mm_words(double mm) {
  const double a = std::abs(mm);
  return fmt::format("{:.0f} mm", a >= 30 ? 5 * std::round(a / 5) : std::round(a));
}

// "40 mm to the left, 15 mm higher": board axes, as seen from the lower edge of a board on a table. Leaves out parts
// below `least_mm`; empty if none remains.
std::string way_words(const Eigen::Vector3d& way_mm, double least_mm) {
  std::string out;
  const auto add = [&](double mm, const char* plus, const char* minus) {
    if (std::abs(mm) >= least_mm) out += (out.empty() ? "" : ", ") + mm_words(mm) + (mm > 0 ? plus : minus);
  };
  add(way_mm.x(), " to the right", " to the left");
  add(way_mm.y(), " towards the upper edge", " towards the lower edge");
  add(way_mm.z(), " higher", " lower");
  return out;
}

double least_step_mm(const WantedShot& shot, const Board& board) {
  const Eigen::Vector3d middle(board.size_mm.x() / 2, board.size_mm.y() / 2, 0);
  return std::max(1.0, 0.005 * (shot.eye_mm - middle).norm());
}

std::string called(const WantedShot& shot) {
  return fmt::format("{} \"{}\"", shot.designed ? "view" : "shot", shot.name);
}

// Returns the assigned shot and the distance from it.
std::string which_words(const JudgedPhoto& photo, const Shoot& shoot) {
  if (photo.facts.place_of_before && photo.shot)
    return called(shoot.wanted[*photo.shot]) + " (too dark to see tags: taken for the place of the photo before)";
  if (!photo.facts.pose) return shoot.wanted.empty() || photo.facts.tags.empty() ? "" : "place unknown";
  if (!photo.nearest) return "";
  const WantedShot& shot = shoot.wanted[*photo.nearest];
  const Offset& o = photo.offset;
  const std::string off = way_words(*photo.facts.eye_mm() - shot.eye_mm, least_step_mm(shot, shoot.board));
  if (photo.shot) return called(shot) + (off.empty() ? ", in its place" : ", off by " + off);
  if (photo.wrong_way_up && o.reaches <= 1)
    return "from the place of " + called(shot) + ", which wants the camera turned by 90 degrees";
  if (is_further_place(photo, shoot)) return "a further place";
  return "none of the planned ones; nearest is " + called(shot) +
         (o.degrees > 40 ? fmt::format(", {:.0f} degrees away", o.degrees)
          : off.empty()  ? ""
                         : ", this is off by " + off);
}

std::string share_words(double share) {
  const double percent = 100 * share;
  return fmt::format("{:.{}f} %", percent, percent > 0 && percent < 0.995 ? 2 : percent < 9.95 ? 1 : 0);
}

std::string shows_words(const JudgedPhoto& photo, const Shoot& shoot) {
  const PhotoFacts& f = photo.facts;
  std::string out = fmt::format("{} of {}", f.tags.size(), counted(shoot.board.tags.list.size(), "tag"));
  if (f.blur_px) out += fmt::format(", edges {:.1f} px", *f.blur_px);
  if (!f.tags.empty()) {
    out += fmt::format("; paper at {} of white", share_words(f.paper));
    if (f.paper_clipped > kPaperLost) out += fmt::format(", {} of it clipped", share_words(f.paper_clipped));
  }
  if (f.glints_clipped)
    out += *f.glints_clipped > kGlintsClipped
               ? fmt::format("; glints clipped in {} of the carve area", share_words(*f.glints_clipped))
               : fmt::format("; glints held (up to {} of white)", share_words(*f.glints_bright));
  if (photo.stops && f.tags.empty()) out += fmt::format("; {:+.1f} stops", *photo.stops);
  return out;
}

// Returns the exposure as an exposure time, at that photo's aperture and ISO.
std::string exposure_words(double factor, const PhotoFacts& like) {
  if (!(factor > 0)) return "";
  const double f_number = like.exif.f_number.value_or(kAssumedAperture), iso = like.exif.iso.value_or(100);
  const std::string time = shutter_words(factor * f_number * f_number / (iso / 100));
  return like.exif.f_number ? fmt::format("{} (f/{:.3g}, ISO {:.0f})", time, f_number, iso)
                            : fmt::format("{} (ISO {:.0f})", time, iso);
}

std::string move_words(const NextStep& next, const Shoot& shoot) {
  const WantedShot& shot = shoot.wanted[*next.shot];
  const JudgedPhoto* last = shoot.photos.empty() ? nullptr : &shoot.photos.back();
  const bool said = last != nullptr && shoot.sent_to == next.shot;  // the place was given with the message before
  std::string out = called(shot) + (said && last->facts.pose ? "" : ": " + shot.place);
  if (last == nullptr || (last->shot && shoot.wanted[*last->shot].light != shot.light))
    out += fmt::format("; lamp \"{}\" {}", shot.light, shot.lamp_place);
  if (last != nullptr)
    if (const auto eye = last->facts.eye_mm()) {
      const std::string words = way_words(shot.eye_mm - *eye, least_step_mm(shot, shoot.board));
      if (!words.empty()) out += "; from here " + words;
    }
  std::string exposure;
  if (last != nullptr) exposure = exposure_words(next.factor, last->facts);
  if (exposure.empty() && shot.exposure_s) exposure = shutter_words(*shot.exposure_s) + " (f/8, ISO 100)";
  return out + (exposure.empty() ? "; the tags' paper at 60 % of white" : "; at " + exposure);
}

}  // namespace

std::string shutter_words(double exposure_s) {
  constexpr double kDial[] = {1 / 8000., 1 / 6400., 1 / 5000., 1 / 4000., 1 / 3200., 1 / 2500., 1 / 2000., 1 / 1600.,
                              1 / 1250., 1 / 1000., 1 / 800.,  1 / 640.,  1 / 500.,  1 / 400.,  1 / 320.,  1 / 250.,
                              1 / 200.,  1 / 160.,  1 / 125.,  1 / 100.,  1 / 80.,   1 / 60.,   1 / 50.,   1 / 40.,
                              1 / 30.,   1 / 25.,   1 / 20.,   1 / 15.,   1 / 13.,   1 / 10.,   1 / 8.,    1 / 6.,
                              1 / 5.,    1 / 4.,    0.3,       0.4,       0.5,       0.6,       0.8,       1,
                              1.3,       1.6,       2,         2.5,       3.2,       4,         5,         6,
                              8,         10,        13,        15,        20,        25,        30};
  const double nearest = *std::min_element(std::begin(kDial), std::end(kDial), [&](double a, double b) {
    return std::abs(std::log(a / exposure_s)) < std::abs(std::log(b / exposure_s));
  });
  const double shown =
      std::abs(std::log2(nearest / exposure_s)) < 0.25 ? nearest : exposure_s;  // beyond the dial's ends
  return shown < 0.28 ? fmt::format("1/{:.0f} s", 1 / shown) : fmt::format("{:.2g} s", shown);
}

std::string next_words(const Shoot& shoot) {
  const NextStep next = next_step(shoot);
  const PhotoFacts* last = shoot.photos.empty() ? nullptr : &shoot.photos.back().facts;
  switch (next.kind) {
    case NextStep::Kind::retake: {
      const std::string exposure = exposure_words(next.factor, *last);
      return "take this one again" + (exposure.empty() ? "" : ", at " + exposure);
    }
    case NextStep::Kind::expose: {
      if (!(next.factor > 0)) return "the same place, the tags' paper at 60 % of white";
      const double stops = std::log2(next.factor / *last->exposure_factor);
      return fmt::format("the same place at {}, {:.0f} stop{} {}, {}", exposure_words(next.factor, *last),
                         std::max(1.0, std::abs(stops)), std::abs(stops) < 1.5 ? "" : "s",
                         stops < 0 ? "darker" : "brighter", next.for_glints ? "for the glints" : "for the tags");
    }
    case NextStep::Kind::move:
      return move_words(next, shoot);
    case NextStep::Kind::further:
      return fmt::format("another place, tilted or near the mirror direction: {} of at least {} are there",
                         places_of(shoot), shoot.least_places);
    case NextStep::Kind::finished:
      break;
  }
  return "nothing more: all that is needed is there";
}

std::string last_photo_words(const Shoot& shoot) {
  const JudgedPhoto& photo = shoot.photos.back();
  const std::string which = which_words(photo, shoot);
  std::string out = fmt::format("{}{}: {}{}\n", photo.facts.file.filename().string(),
                                photo.light.empty() ? "" : fmt::format(" (lamp \"{}\")", photo.light),
                                which.empty() ? "" : which + ": ", shows_words(photo, shoot));
  for (const Finding& fault : photo.faults)
    out += fmt::format("    {}: {}{}\n", in_words(fault.severity), fault.what,
                       fault.remedy.empty() ? "" : "; " + fault.remedy);
  return out + fmt::format("    now: {}  [{}]\n", next_words(shoot), state_words(shoot));
}

std::string state_words(const Shoot& shoot) {
  if (shoot.wanted.empty())
    return counted(shoot.photos.size(), "photo") + " from " + counted(places_of(shoot), "place");
  int done = 0, begun = 0, again = 0;
  for (std::size_t i = 0; i < shoot.wanted.size(); ++i) {
    const ShotState state = state_of(shoot, i);
    done += state == ShotState::done;
    begun += state == ShotState::begun;
    again += state == ShotState::again;
  }
  std::string out = fmt::format("{} of {}", done, counted(shoot.wanted.size(), "shot"));
  if (begun > 0) out += fmt::format(", {} begun", begun);
  if (again > 0) out += fmt::format(", {} to take again", again);
  return out;
}

std::string missing_words(const Shoot& shoot) {
  std::string out;
  for (std::size_t i = 0; i < shoot.wanted.size(); ++i) {
    const ShotState state = state_of(shoot, i);
    if (state == ShotState::done) continue;
    const WantedShot& shot = shoot.wanted[i];
    out += fmt::format("  {} {}: {}, lamp \"{}\"\n",
                       state == ShotState::open    ? "missing    "
                       : state == ShotState::begun ? "begun      "
                                                   : "again      ",
                       called(shot), shot.place, shot.light);
  }
  return out;
}

Json last_photo_json(const Shoot& shoot, double seconds, double processor_seconds) {
  const JudgedPhoto& photo = shoot.photos.back();
  const PhotoFacts& f = photo.facts;
  Json json;
  json["photo"] = f.file.string();
  json["seconds"] = seconds;
  json["processor_seconds"] = processor_seconds;
  json["pixels"] = {f.width, f.height};
  if (f.exif.exposure_s) json["exposure_s"] = *f.exif.exposure_s;
  if (f.exif.f_number) json["f_number"] = *f.exif.f_number;
  if (f.exif.iso) json["iso"] = *f.exif.iso;
  json["tags"] = Json::array();
  for (const TagLook& tag : f.tags) json["tags"].push_back(tag.id);
  if (!photo.light.empty()) json["light"] = photo.light;
  json["missing_tags"] = f.missing_tags;
  json["stray_tags"] = f.stray_tags;
  json["paper"] = f.paper;
  json["paper_clipped"] = f.paper_clipped;
  if (f.glints_clipped) json["glints_clipped"] = *f.glints_clipped;
  if (f.blur_px) json["blur_px"] = *f.blur_px;
  if (photo.stops) json["stops"] = *photo.stops;
  if (const auto eye = f.eye_mm()) json["eye_mm"] = to_json(*eye);
  if (photo.shot) json["shot"] = shoot.wanted[*photo.shot].name;
  if (photo.nearest && !f.place_of_before) {
    json["nearest"] = shoot.wanted[*photo.nearest].name;
    json["off_mm"] = to_json(Eigen::Vector3d(*f.eye_mm() - shoot.wanted[*photo.nearest].eye_mm));
  }
  json["faults"] = Json::array();
  for (const Finding& fault : photo.faults)
    json["faults"].push_back({{"severity", in_words(fault.severity)},
                              {"code", name_of(fault.code)},
                              {"what", fault.what},
                              {"remedy", fault.remedy}});
  json["now"] = next_words(shoot);
  json["state"] = state_words(shoot);
  return json;
}

}  // namespace burin

#include "burin/capture/folder_session.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <optional>
#include <utility>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/base/files/input_file.h"
#include "burin/base/files/json_file.h"
#include "burin/base/limits.h"
#include "burin/base/median.h"
#include "burin/capture/photo_memory.h"
#include "burin/capture/preflight.h"
#include "burin/capture/same_shot.h"
#include "burin/scene/board.h"

namespace burin {
namespace {

namespace fs = std::filesystem;
using enum Finding::Severity;

constexpr double kLongestGap_s = 60;  // within a view
constexpr double kBurst_s = 3;        // photos this close belong together unless their pictures contradict
constexpr double kSameDetails = 0.6;  // one pose gives 0.94 and more, two poses less than 0.05
constexpr double kSamePlace_px = 0.5;
constexpr double kTouched_px = 10;  // a touched tripod; larger shifts are intended

// A photo with the exposure of its EXIF, and with `f_number` if EXIF has none. Nothing, with a finding, if EXIF lacks
// too much.
std::optional<Photo> photo_of(const IncomingPhoto& incoming, double f_number, std::vector<Finding>& findings) {
  if (!incoming.unreadable.empty()) {
    findings.push_back(
        {FindingCode::photo_unusable, error, {}, incoming.unreadable, ""});  // names file and remedy already
    return std::nullopt;
  }
  const Exif& exif = incoming.exif;
  const double aperture = exif.f_number.value_or(f_number);
  std::string missing = exif.exposure_s ? "" : "exposure time";
  if (!(aperture > 0)) missing += missing.empty() ? "aperture" : " and aperture";
  if (!missing.empty()) {
    findings.push_back(
        {FindingCode::exif, warning, incoming.file, "is left out: its EXIF holds no " + missing,
         std::string(exif.exposure_s ? "give the aperture with --f-number 8 (of burin capture, watch and loop), "
                                     : "") +
             "copy the photo from the camera itself (chats and editors strip EXIF), set what is missing with "
             "exiftool -ExposureTime=1/60 -FNumber=8, or write session.json by hand"});
    return std::nullopt;
  }
  Photo photo;
  photo.file = incoming.file;
  photo.exposure_s = *exif.exposure_s;
  photo.f_number = aperture;
  if (exif.iso)
    photo.iso = *exif.iso;
  else
    findings.push_back({FindingCode::exif, warning, incoming.file, "its EXIF holds no ISO; 100 was assumed",
                        "correct iso in session.json"});
  const AssumedEncoding encoding = encoding_of(exif);
  photo.encoding = encoding.encoding;
  const bool other_colors = exif.uncalibrated && exif.channels >= 3;  // irrelevant for gray, which has no primaries
  if (encoding.assumed && encoding.encoding == Encoding::linear && other_colors) {
    findings.push_back({FindingCode::encoding, error, incoming.file,
                        "has no known tone curve: its EXIF has a color space other than sRGB, and no profile",
                        "export it with its color profile embedded, or as sRGB; if its values are linear, take the "
                        "statement out: exiftool -ColorSpace= FILE"});
    return std::nullopt;
  }
  if (other_colors && encoding.encoding == Encoding::srgb)
    findings.push_back({FindingCode::encoding, warning, incoming.file,
                        "has a color space other than sRGB by its EXIF, and no profile; sRGB's curve was assumed",
                        "set the camera to sRGB, or export with the profile embedded"});
  if (exif.gain_map)
    findings.push_back({FindingCode::encoding, note, incoming.file,
                        "carries a gain map for HDR displays; its base picture is used", ""});
  if (encoding.assumed && !other_colors)
    findings.push_back({FindingCode::encoding, note, incoming.file,
                        encoding.encoding == Encoding::linear
                            ? "does not name its encoding; linear was assumed, as it has 16 bits"
                            : "does not name its encoding; sRGB was assumed, as it has 8 bits",
                        "correct encoding in session.json if that is wrong"});
  return photo;
}

using ExifPhoto = std::pair<Photo, Exif>;

// The aperture of files without one: the person's; if no file has one, an assumed one, with a finding.
double missing_aperture(const std::vector<IncomingPhoto>& incoming, double said, std::vector<Finding>& findings) {
  const auto lacks = [](const IncomingPhoto& photo) { return photo.exif.exposure_s && !photo.exif.f_number; };
  const auto count = std::count_if(incoming.begin(), incoming.end(), lacks);
  if (count == 0) return said;
  const bool some_have = std::any_of(incoming.begin(), incoming.end(), [](const auto& p) { return !!p.exif.f_number; });
  if (said > 0) {
    findings.push_back({FindingCode::exif,
                        note,
                        {},
                        counted(static_cast<std::size_t>(count), "photo") + " without an aperture in EXIF: f/" +
                            general(said, 3) + " is used, from --f-number",
                        ""});
    return said;
  }
  if (some_have) return 0;
  findings.push_back({FindingCode::exif,
                      warning,
                      {},
                      "no photo holds an aperture in its EXIF (a lens that the camera does not know); f/" +
                          general(kAssumedAperture, 3) + " is used for all",
                      "that does no harm if the aperture ring stayed as it was; if it did not, leave out the photos at "
                      "other apertures"});
  return kAssumedAperture;
}

// The camera's digital zoom: EXIF's ratio, and its 35 mm equivalent over the focal length.
struct DigitalZoom {
  double ratio = 1, equivalent = 0;
};

DigitalZoom digital_zoom_of(const Exif& exif) {
  return {exif.digital_zoom.value_or(1), exif.focal_35mm && exif.focal_mm ? *exif.focal_35mm / *exif.focal_mm : 0};
}

// Leaves out photos with digital zoom, crop or flash, unlike most, by their EXIF.
void leave_out_by_exif(std::vector<ExifPhoto>& photos, std::vector<Finding>& findings) {
  if (photos.size() < 3) return;
  constexpr double kSameZoom = 0.045;  // rounding of a 35 mm equivalent of 13 mm
  std::vector<double> ratios, equivalents;
  std::size_t fired = 0;
  for (const auto& [photo, exif] : photos) {
    const DigitalZoom zoom = digital_zoom_of(exif);
    ratios.push_back(zoom.ratio);
    if (zoom.equivalent > 0) equivalents.push_back(zoom.equivalent);
    fired += exif.flash.value_or(false);
  }
  const double ratio = median_of(ratios), equivalent = median_of(equivalents);
  const bool mostly_fired = 2 * fired > photos.size();
  std::erase_if(photos, [&](const ExifPhoto& one) {
    const auto& [photo, exif] = one;
    const DigitalZoom zoom = digital_zoom_of(exif);
    const bool by_equivalent = zoom.equivalent > 0 && std::abs(zoom.equivalent / equivalent - 1) > kSameZoom;
    if (std::abs(zoom.ratio / ratio - 1) > kSameZoom || by_equivalent) {
      const double times = by_equivalent ? zoom.equivalent / equivalent : zoom.ratio / ratio;
      findings.push_back({FindingCode::camera_changed, warning, photo.file,
                          "is left out: by its EXIF the camera zoomed digitally or cropped, " + general(times, 3) +
                              " times the other photos",
                          "set the zoom to 1x for all photos, switch crop modes off, and take it again"});
      return true;
    }
    if (fired > 0 && exif.flash.value_or(false) != mostly_fired) {
      findings.push_back({FindingCode::lamp_differs, warning, photo.file,
                          mostly_fired
                              ? "is left out: by its EXIF the flash did not fire, as it did for other photos"
                              : "is left out: by its EXIF the flash fired, and lit the board in addition to the lamp",
                          "switch the flash off for all photos, and take it again"});
      return true;
    }
    return false;
  });
  if (fired > 0 && mostly_fired)
    findings.push_back({FindingCode::camera_settings,
                        warning,
                        {},
                        "the flash fired in " + counted(fired, "photo") + ", by EXIF",
                        "a flash on the camera moves with it: burin calibrate sees that and takes it for a lamp of its "
                        "own at each view; photos determine a lamp that does not move better"});
}

// Distance between the common tags of two photos; nothing if they share too few.
std::optional<double> tags_moved_px(const PhotoLook& a, const PhotoLook& b) {
  constexpr std::size_t kFewTags = 2;  // a single tag may be misread
  std::vector<double> moved;
  std::size_t tags = 0;
  for (const TagLook& tag : a.tags) {
    const auto same = std::find_if(b.tags.begin(), b.tags.end(), [&](const TagLook& t) { return t.id == tag.id; });
    if (same == b.tags.end()) continue;
    ++tags;
    for (std::size_t c = 0; c < 4; ++c) moved.push_back((tag.corner_px[c] - same->corner_px[c]).norm());
  }
  if (tags < kFewTags) return std::nullopt;
  return median_of(std::move(moved));
}

// True if the pictures show that a photo was taken right after those of `view`, under its lamp, from the same place.
bool joins_by_picture(const std::vector<ExifPhoto>& photos, const std::vector<std::optional<PhotoLook>>& looks,
                      const std::vector<std::size_t>& view, std::size_t i, bool timed, std::vector<Finding>& findings) {
  const auto& [photo, exif] = photos[i];
  // The member with the nearest exposure is the best evidence.
  const double factor = exposure_factor(photo);
  const auto distance = [&](std::size_t k) { return std::abs(std::log(exposure_factor(photos[k].first) / factor)); };
  const std::size_t k =
      *std::min_element(view.begin(), view.end(), [&](auto a, auto b) { return distance(a) < distance(b); });
  const double gap_s =
      timed ? *exif.time_s - *photos[view.back()].second.time_s - photos[view.back()].first.exposure_s : 0;
  if (gap_s > kLongestGap_s) return false;
  const auto same = compare(*looks[k], exposure_factor(photos[k].first), *looks[i], factor);
  if (!same) return timed && gap_s <= kBurst_s;
  if (same->correlation < kSameDetails) return false;
  if (same->shift_px <= kSamePlace_px) return true;
  findings.push_back({FindingCode::camera_moved, warning, photo.file,
                      "shows the same as " + photos[k].first.file.filename().string() + ", but " +
                          fixed(same->shift_px, 1) + " px aside: it became a view of its own",
                      "use a tripod and a remote release for brackets"});
  return false;
}

// The view of each photo, counted from 0 (also 0 without a look). Photos under one lamp are grouped first. Neighboring
// groups then join if their tags stayed in place while the lamp changed.
std::vector<std::size_t> views_of(const std::vector<ExifPhoto>& photos,
                                  const std::vector<std::optional<PhotoLook>>& looks, bool timed,
                                  std::vector<Finding>& findings) {
  std::vector<std::vector<std::size_t>> views;  // members
  const auto moved_px = [&](const std::vector<std::size_t>& a, const std::vector<std::size_t>& b) {
    std::optional<double> least;
    for (const std::size_t i : a)
      for (const std::size_t k : b)
        if (const auto px = tags_moved_px(*looks[i], *looks[k]); px && (!least || *px < *least)) least = px;
    return least;
  };
  for (std::size_t i = 0; i < photos.size(); ++i) {
    if (!looks[i]) continue;
    bool joins = false;
    if (!views.empty()) {
      std::vector<std::size_t> of_lamp;
      for (const std::size_t k : views.back())
        if (photos[k].first.light == photos[i].first.light) of_lamp.push_back(k);
      joins = of_lamp.empty() ? moved_px({i}, views.back()).value_or(INFINITY) <= kSamePlace_px
                              : joins_by_picture(photos, looks, of_lamp, i, timed, findings);
    }
    if (!joins) views.emplace_back();
    views.back().push_back(i);
  }
  // A bracket under a new lamp may begin with its dark photos, which show no tags.
  std::vector<std::size_t> out(photos.size(), 0);
  std::size_t count = 0;
  for (std::size_t v = 0; v < views.size(); ++v) {
    bool joins = false;
    if (v > 0) {
      const std::string &before = photos[views[v - 1].back()].first.light, &now = photos[views[v].front()].first.light;
      const auto px = before == now ? std::nullopt : moved_px(views[v - 1], views[v]);
      joins = px && *px <= kSamePlace_px;
      if (px && !joins && *px <= kTouched_px)
        findings.push_back(
            {FindingCode::camera_moved, warning, photos[views[v].front()].first.file,
             "lies " + fixed(*px, 1) + " px aside of the photos under the lamp before: it became a view of its own",
             "use a tripod, and change lamps without touching the camera"});
    }
    if (v > 0 && !joins) ++count;
    for (const std::size_t i : views[v]) out[i] = count;
  }
  return out;
}

// Makes one finding of many photos' equal ones. Errors stay separate: each photo needs its own remedy.
void merge_notes(std::vector<Finding>& findings) {
  std::vector<Finding> merged;
  std::vector<int> count;
  for (Finding& finding : findings) {
    const auto same = std::find_if(merged.begin(), merged.end(), [&](const Finding& f) {
      return finding.severity != error && f.severity == finding.severity && f.what == finding.what;
    });
    if (same == merged.end()) {
      merged.push_back(std::move(finding));
      count.push_back(1);
    } else {
      ++count[static_cast<std::size_t>(same - merged.begin())];
    }
  }
  for (std::size_t i = 0; i < merged.size(); ++i)
    if (count[i] > 1) merged[i].what += " (and " + counted(static_cast<std::size_t>(count[i] - 1), "more file") + ")";
  findings = std::move(merged);
}

}  // namespace

FolderSession session_from(const PhotoSource& source, const TagSet& tags, const Progress& progress,
                           const std::string& light, double f_number) {
  FolderSession result;
  std::vector<IncomingPhoto> all;
  while (auto incoming = source()) all.push_back(std::move(*incoming));
  const double aperture = missing_aperture(all, f_number, result.findings);
  std::vector<ExifPhoto> photos;
  for (const IncomingPhoto& incoming : all)
    if (auto photo = photo_of(incoming, aperture, result.findings)) {
      photo->light = incoming.light.empty() ? light : incoming.light;
      photos.emplace_back(*photo, incoming.exif);
    }
  leave_out_by_exif(photos, result.findings);
  require_at_most(photos.size(), limit::kPhotos, "the photos", "files",
                  "take some of them into a folder of their own: a few dozen from many directions are enough");
  if (photos.empty())  // no photo is left: the findings of the photos are the reason
    for (Finding& finding : result.findings)
      if (finding.severity == warning) finding.severity = error;
  // Uses the clock only if every photo has a time: a partial clock would split brackets.
  const bool timed =
      std::all_of(photos.begin(), photos.end(), [](const auto& p) { return p.second.time_s.has_value(); });
  if (timed)
    std::stable_sort(photos.begin(), photos.end(),
                     [](const auto& a, const auto& b) { return *a.second.time_s < *b.second.time_s; });
  else
    result.findings.push_back(
        {FindingCode::exif, note, {}, "some photos have no time in EXIF; they are in the order of their names", ""});

  // A few at a time: this thread reports progress, and memory holds few large photos.
  std::vector<std::optional<PhotoLook>> looks(photos.size());
  std::vector<std::string> broken(photos.size());
  constexpr std::size_t kMostAtOnce = 4;
  for (std::size_t begin = 0, end = 0; begin < photos.size(); begin = end) {
    if (progress) progress("reading photos", static_cast<double>(begin) / static_cast<double>(photos.size()));
    end = std::min(begin + kMostAtOnce, photos.size());
    double largest = 0;
    for (std::size_t i = begin; i < end; ++i)
      largest = std::max(largest, 1.0 * photos[i].second.width * photos[i].second.height);
    end = begin + static_cast<std::size_t>(groups_at_once(largest, static_cast<int>(end - begin)));
    tbb::parallel_for(begin, end, [&](std::size_t i) {
      try {
        looks[i] = look_at(photos[i].first, &tags);
      } catch (const Error& unreadable) {
        broken[i] = unreadable.what();
      }
    });
  }

  const std::vector<bool> twin = twins_of(photos, looks, result.findings);
  const auto keep_others = [&twin](auto& list) {
    std::size_t i = 0;
    std::erase_if(list, [&](const auto&) { return twin[i++]; });
  };
  keep_others(photos);
  keep_others(looks);
  keep_others(broken);
  const std::vector<std::size_t> views = views_of(photos, looks, timed, result.findings);
  for (std::size_t i = 0; i < photos.size(); ++i) {
    auto& [photo, exif] = photos[i];
    if (!looks[i]) {
      result.findings.push_back({FindingCode::photo_unusable, error, {}, broken[i], ""});
      continue;
    }
    char name[24];
    std::snprintf(name, sizeof name, "v%02zu", views[i]);
    photo.view = name;
    result.session.photos.push_back(photo);
    result.exif.push_back(exif);
  }
  for (std::optional<PhotoLook>& look : looks)
    if (look) result.looks.push_back(std::move(*look));
  return result;
}

CaptureResult capture_folder(const fs::path& photos_dir, const fs::path& board_json, const fs::path& out_dir,
                             const Progress& progress, const PhotoLamps& lamps, double f_number) {
  const Board board = read_board(board_json);  // a session needs a readable board: fail before the photos are read
  CaptureResult result;
  const PhotoSource source = folder_source(photos_dir, lamps, result.findings);
  FolderSession folder = session_from(source, board.tags, progress, lamps.of_folder, f_number);
  const auto add = [&](std::vector<Finding>&& more) {
    result.findings.insert(result.findings.end(), std::make_move_iterator(more.begin()),
                           std::make_move_iterator(more.end()));
  };
  add(std::move(folder.findings));
  add(preflight(folder.session, folder.exif, folder.looks, board.tags));
  merge_notes(result.findings);
  std::stable_sort(result.findings.begin(), result.findings.end(),
                   [](const Finding& a, const Finding& b) { return a.severity > b.severity; });

  result.session = std::move(folder.session);
  result.session.board = board_json;
  for (std::size_t i = 0; i < result.session.photos.size(); ++i)
    result.views += i == 0 || result.session.photos[i].view != result.session.photos[i - 1].view;
  if (has_errors(result.findings)) return result;
  make_output_folder(out_dir);
  result.session.file = out_dir / "session.json";
  write_session(result.session, result.session.file);
  result.written = result.session.file;
  return result;
}

}  // namespace burin

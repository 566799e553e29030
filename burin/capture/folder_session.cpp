#include "burin/capture/folder_session.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <optional>
#include <utility>

#include "burin/capture/photo_memory.h"
#include "burin/capture/preflight.h"
#include "burin/render/board.h"
#include "burin/render/error.h"
#include "burin/render/files/input_file.h"
#include "burin/render/files/json_file.h"
#include "burin/render/limits.h"

namespace burin {
namespace {

namespace fs = std::filesystem;
using enum Finding::Severity;

constexpr double kLongestGap_s = 60;  // within a view
constexpr double kBurst_s = 3;        // photos this close belong together unless their pictures say otherwise
constexpr double kSameDetails = 0.6;  // one pose gives 0.94 and more, two poses less than 0.05
constexpr double kSamePlace_px = 0.5;

// A photo with the exposure that its EXIF tells. Nothing where EXIF tells too little; the findings then say so.
std::optional<Photo> photo_of(const IncomingPhoto& incoming, std::vector<Finding>& findings) {
  if (!incoming.unreadable.empty()) {
    findings.push_back({error, {}, incoming.unreadable, ""});  // names file and remedy already
    return std::nullopt;
  }
  const Exif& exif = incoming.exif;
  std::string missing = exif.exposure_s ? "" : "exposure time";
  if (!exif.f_number) missing += missing.empty() ? "aperture" : " and aperture";
  if (!missing.empty()) {
    findings.push_back(
        {warning, incoming.file, "is left out: its EXIF holds no " + missing,
         "copy the photo from the camera itself (chats and editors strip EXIF), set what is missing with "
         "exiftool -ExposureTime=1/60 -FNumber=8, or write session.json by hand"});
    return std::nullopt;
  }
  Photo photo;
  photo.file = incoming.file;
  photo.exposure_s = *exif.exposure_s;
  photo.f_number = *exif.f_number;
  if (exif.iso)
    photo.iso = *exif.iso;
  else
    findings.push_back(
        {warning, incoming.file, "its EXIF holds no ISO; 100 was assumed", "correct iso in session.json"});
  const AssumedEncoding encoding = encoding_of(exif);
  photo.encoding = encoding.encoding;
  if (encoding.assumed)
    findings.push_back({note, incoming.file,
                        encoding.encoding == Encoding::linear
                            ? "does not say how its values are encoded; linear was assumed, as it has 16 bits"
                            : "does not say how its values are encoded; sRGB was assumed, as it has 8 bits",
                        "correct encoding in session.json if that is wrong"});
  return photo;
}

// One finding for many photos that say the same. Errors stay: each photo has to be put right.
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
    if (count[i] > 1) merged[i].what += " (and " + std::to_string(count[i] - 1) + " more files)";
  findings = std::move(merged);
}

}  // namespace

FolderSession session_from(const PhotoSource& source, const TagSet& tags, const Progress& progress,
                           const std::string& light) {
  FolderSession result;
  std::vector<std::pair<Photo, Exif>> photos;
  while (const auto incoming = source())
    if (const auto photo = photo_of(*incoming, result.findings)) photos.emplace_back(*photo, incoming->exif);
  require_at_most(
      photos.size(), limit::kPhotos, "the photos", "files",
      "take some of them into a folder of their own: a few dozen from many directions tell all there is to know");
  if (photos.empty())  // nothing is left: what each photo lacks is why
    for (Finding& finding : result.findings)
      if (finding.severity == warning) finding.severity = error;
  // By the clock only if every photo has one: half a clock would tear brackets apart.
  const bool timed =
      std::all_of(photos.begin(), photos.end(), [](const auto& p) { return p.second.time_s.has_value(); });
  if (timed)
    std::stable_sort(photos.begin(), photos.end(),
                     [](const auto& a, const auto& b) { return *a.second.time_s < *b.second.time_s; });
  else
    result.findings.push_back(
        {note, {}, "not all photos say when they were taken; the order of their names was used", ""});

  // A few at a time, so that progress can be told from this thread and big photos do not pile up.
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

  int views = 0;
  std::vector<std::size_t> view;  // members of the current one
  for (std::size_t i = 0; i < photos.size(); ++i) {
    auto& [photo, exif] = photos[i];
    if (!looks[i]) {
      result.findings.push_back({error, {}, broken[i], ""});
      continue;
    }
    bool joins = false;
    if (!view.empty()) {
      // The member of nearest exposure is the best witness.
      const double factor = exposure_factor(photo);
      const auto distance = [&](std::size_t k) {
        return std::abs(std::log(exposure_factor(photos[k].first) / factor));
      };
      const std::size_t k =
          *std::min_element(view.begin(), view.end(), [&](auto a, auto b) { return distance(a) < distance(b); });
      const double gap_s =
          timed ? *exif.time_s - *photos[view.back()].second.time_s - photos[view.back()].first.exposure_s : 0;
      const auto same = compare(*looks[k], exposure_factor(photos[k].first), *looks[i], factor);
      if (gap_s <= kLongestGap_s)
        joins =
            same ? same->correlation >= kSameDetails && same->shift_px <= kSamePlace_px : timed && gap_s <= kBurst_s;
      if (!joins && same && same->correlation >= kSameDetails && gap_s <= kLongestGap_s) {
        char text[160];
        std::snprintf(text, sizeof text, "shows the same as %s, but %.1f px aside: it became a view of its own",
                      photos[k].first.file.filename().string().c_str(), same->shift_px);
        result.findings.push_back({warning, photo.file, text, "use a tripod and a remote release for brackets"});
      }
    }
    if (!joins) {
      view.clear();
      ++views;
    }
    view.push_back(i);
    char name[16];
    std::snprintf(name, sizeof name, "v%02d", views - 1);
    photo.view = name;
    photo.light = light;
    result.session.photos.push_back(photo);
    result.exif.push_back(exif);
  }
  for (std::optional<PhotoLook>& look : looks)
    if (look) result.looks.push_back(std::move(*look));
  return result;
}

CaptureResult capture_folder(const fs::path& photos_dir, const fs::path& board_json, const fs::path& out_dir,
                             const Progress& progress, const std::string& light) {
  const Board board =
      read_board(board_json);  // a session whose board cannot be read is of no use: say so before the photos are read
  CaptureResult result;
  const PhotoSource source = folder_source(photos_dir, result.findings);
  FolderSession folder = session_from(source, board.tags, progress, light);
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

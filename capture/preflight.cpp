#include "burin/capture/preflight.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <tuple>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/base/median.h"
#include "burin/capture/photo.h"
#include "burin/capture/photo_memory.h"
#include "burin/capture/tags/tag_coverage.h"
#include "burin/scene/board.h"

namespace burin {
namespace {

using enum Finding::Severity;

constexpr double kMuchClipped = 0.05;        // of the pixels, in the shortest exposure of a view
constexpr double kTooDark = 0.05;            // of the white level: the brightest pixels of a view's longest exposure
constexpr double kBlurred_px = 1.8;          // Gaussian sigma of the sharpest edges
constexpr double kBlurredBesideUsual = 1.6;  // times the session's median
constexpr double kExposureError = 0.08;      // nominal exposure times are rounded by up to 7 % (1/60 for 1/64)
constexpr double kMoved_px = 0.3;
constexpr int kFewViews = 4;
constexpr int kFewTagsInView = 4;          // in a view
constexpr double kSmallTagInView_px = 20;  // the largest families decode from this size on
constexpr double kPaperClipped = 0.2;      // of the white cells of a view's tags, in its shortest exposure
constexpr double kLittleOfFrame = 0.35;
constexpr double kOneDirection_deg = 20;  // largest angle between two views: seen from one direction only
// Nearer to the normal, any focal length fits at some distance, and other faults look like one
constexpr double kTiltForFocal_deg = 20;
constexpr double kWrongSize = 0.08;       // print, lens and bow account for a few per cent of a tag's side
constexpr double kPaperBrightness = 1.4;  // between views, at one tag: lens and paper may account for as much

std::string pixels_text(int width, int height) { return std::to_string(width) + " x " + std::to_string(height); }

std::string shutter_text(double exposure_s) {
  return exposure_s < 0.4 ? "1/" + fixed(1 / exposure_s, 0) + " s" : general(exposure_s, 2) + " s";
}

std::string percent(double share) { return fixed(100 * share, 0) + " %"; }

void judge_files(const Session& session, std::span<const Exif> exif, std::vector<Finding>& findings) {
  int turned = 0;
  // Most photos count as correct; deviating photos are named.
  std::map<std::pair<int, int>, int> sizes;
  for (const Exif& e : exif) ++sizes[{e.width, e.height}];
  const auto usual = std::max_element(sizes.begin(), sizes.end(), [](const auto& a, const auto& b) {
                       return a.second < b.second;
                     })->first;
  std::vector<double> focals;
  for (const Exif& e : exif)
    if (e.focal_mm) focals.push_back(*e.focal_mm);
  std::sort(focals.begin(), focals.end());
  const double focal = focals.empty() ? 0 : focals[focals.size() / 2];
  std::map<std::pair<std::string, std::string>, int> cameras;
  for (const Exif& e : exif) ++cameras[{e.make, e.model}];
  const auto camera = std::max_element(cameras.begin(), cameras.end(), [](const auto& a, const auto& b) {
                        return a.second < b.second;
                      })->first;
  std::map<double, int> apertures;
  for (const Photo& photo : session.photos) ++apertures[photo.f_number];
  const double aperture = std::max_element(apertures.begin(), apertures.end(), [](const auto& a, const auto& b) {
                            return a.second < b.second;
                          })->first;

  for (std::size_t i = 0; i < exif.size(); ++i) {
    const Exif& e = exif[i];
    const auto& file = session.photos[i].file;
    if (e.width == usual.second && e.height == usual.first && e.width != e.height)
      findings.push_back({FindingCode::camera_changed, error, file,
                          "is " + pixels_text(e.width, e.height) + " pixels where others are " +
                              pixels_text(usual.first, usual.second) + ": it was rotated",
                          "copy it from the camera again without \"auto-rotate\""});
    else if (e.width != usual.first || e.height != usual.second)
      findings.push_back({FindingCode::camera_changed, error, file,
                          "is " + pixels_text(e.width, e.height) + " pixels where others are " +
                              pixels_text(usual.first, usual.second),
                          "use photos of one camera, uncropped and at one size"});
    if (e.focal_mm && std::abs(*e.focal_mm / focal - 1) > 0.01)
      findings.push_back(
          {FindingCode::camera_changed, error, file,
           "was taken at " + general(*e.focal_mm, 4) + " mm focal length, others at " + general(focal, 4) + " mm",
           "leave the zoom alone during a session: take this photo again, or leave it out"});
    if (!e.model.empty() && std::pair(e.make, e.model) != camera)
      findings.push_back(
          {FindingCode::camera_changed, error, file,
           "was taken with a " + e.make + " " + e.model + ", others with a " + camera.first + " " + camera.second,
           "use one camera for a session"});
    if (session.photos[i].f_number != aperture)
      findings.push_back({FindingCode::camera_settings, warning, file,
                          "was taken at f/" + general(session.photos[i].f_number, 3) + ", others at f/" +
                              general(aperture, 3) + ": vignetting and sharpness differ",
                          "set the aperture by hand"});
    turned += e.orientation != 1;
  }
  if (turned > 0)
    findings.push_back({FindingCode::camera_settings,
                        note,
                        {},
                        std::to_string(turned) + (turned == 1 ? " photo carries" : " photos carry") +
                            " an EXIF orientation; pixels are used as the sensor had them",
                        ""});
}

// A photo compared with the longest exposure of its view.
struct ComparedPhoto {
  int photo, longest;
  double times;  // factor by which the longest exposure is longer
  double ratio;  // of the photo's light to the longest's; 1: as in EXIF
};

// True if photos with this ratio of exposures to their views' longest contradict their EXIF all alike.
bool contradict_alike(std::span<const ComparedPhoto> photos) {
  constexpr std::size_t kFew = 3;
  constexpr double kAlike = 0.3;
  if (photos.size() < kFew) return false;
  std::vector<double> logs, off;
  for (const ComparedPhoto& one : photos) logs.push_back(std::log(one.ratio));
  const double middle = median_of(logs);
  for (const double log_ratio : logs) off.push_back(std::abs(log_ratio - middle));
  return std::abs(middle) > std::log1p(kExposureError) && median_of(std::move(off)) < kAlike * std::abs(middle);
}

std::string how_far(double ratio) { return percent(std::abs(ratio - 1)) + (ratio > 1 ? " brighter" : " darker"); }

// Flicker affects single photos; a camera's tone curve bends the brightness of all views alike.
void judge_exposures(const Session& session, const std::vector<ComparedPhoto>& compared,
                     std::vector<Finding>& findings) {
  std::map<long, std::vector<ComparedPhoto>> by_half_stops;
  for (const ComparedPhoto& one : compared) by_half_stops[std::lround(2 * std::log2(one.times))].push_back(one);
  std::string alike;
  for (const auto& [half_stops, photos] : by_half_stops) {
    if (contradict_alike(photos)) {
      std::vector<double> ratios;
      for (const ComparedPhoto& one : photos) ratios.push_back(one.ratio);
      alike += (alike.empty() ? "" : ", ") + how_far(median_of(ratios)) +
               " than by their EXIF if a view's longest exposure is " + general(photos.front().times, 3) +
               " times as long";
      continue;
    }
    for (const ComparedPhoto& one : photos)
      if (std::abs(one.ratio - 1) > kExposureError)
        findings.push_back({FindingCode::exif, warning, session.photos[one.photo].file,
                            "is " + how_far(one.ratio) + " than its EXIF and " +
                                session.photos[one.longest].file.filename().string() + " say",
                            "switch off flicker, automatic ISO and exposure correction, and use a steady lamp"});
  }
  if (!alike.empty())
    findings.push_back(
        {FindingCode::response_curve,
         note,
         {},
         "in all views alike photos are " + alike +
             ": the camera bends brightness by a curve of its own, which burin calibrate finds from these "
             "exposures",
         "raw photos, or the camera's flattest picture style, need no such curve"});
}

// Photos of another board show several tags missing in board.json, and hardly a listed one.
void judge_strays(const Session& session, std::span<const PhotoLook> looks, std::vector<Finding>& findings) {
  constexpr std::size_t kFewStrays = 3, kFewOwn = 3;
  // If no photo shows this board, its board.json is wrong, and judge_tags() reports it.
  if (std::none_of(looks.begin(), looks.end(), [](const PhotoLook& look) { return look.tags.size() >= kFewOwn; }))
    return;
  for (std::size_t i = 0; i < looks.size(); ++i) {
    const std::vector<int>& stray = looks[i].stray_tags;
    if (stray.size() < kFewStrays || looks[i].tags.size() >= kFewOwn) continue;
    std::string list;
    for (std::size_t k = 0; k < std::min<std::size_t>(stray.size(), 5); ++k)
      list += (k == 0 ? "" : ", ") + std::to_string(stray[k]);
    findings.push_back({FindingCode::wrong_board, error, session.photos[i].file,
                        "its tags are not this board's: it shows " + list + (stray.size() > 5 ? ", ..." : "") +
                            ", which board.json does not list",
                        "take the photo out, or give the board.json of the board that it shows"});
  }
}

// Views whose exposure times differ from most views' by a step or two of the camera's dial: the camera took a neighbor
// of the set time. EXIF holds the actual time, which counts.
void judge_shutter_times(const Session& session, const std::vector<Bracket>& brackets, std::vector<Finding>& findings) {
  constexpr double kOneStep = 1.1, kTwoSteps = 1.7;        // a dial's steps are a third or half of a stop
  std::vector<std::vector<std::pair<double, int>>> times;  // with the photo; one list per bracket, ascending
  // in sixteenths of a stop: number of views, first view
  std::map<std::vector<long>, std::pair<int, std::size_t>> sets;
  for (std::size_t b = 0; b < brackets.size(); ++b) {
    auto& of_bracket = times.emplace_back();
    for (const int i : brackets[b].photos) of_bracket.emplace_back(session.photos[i].exposure_s, i);
    std::sort(of_bracket.begin(), of_bracket.end());
    std::vector<long> key;
    for (const auto& [seconds, photo] : of_bracket) key.push_back(std::lround(16 * std::log2(seconds)));
    const auto [at, is_new] = sets.try_emplace(key, 0, b);
    ++at->second.first;
  }
  const auto usual = std::max_element(sets.begin(), sets.end(),
                                      [](const auto& a, const auto& b) { return a.second.first < b.second.first; });
  if (usual == sets.end() || usual->first.size() < 2 || 2 * usual->second.first <= static_cast<int>(brackets.size()))
    return;
  const auto& wanted = times[usual->second.second];
  for (const auto& of_bracket : times) {
    if (of_bracket.size() != wanted.size()) continue;
    for (std::size_t k = 0; k < wanted.size(); ++k) {
      const double ratio = of_bracket[k].first / wanted[k].first, steps = std::max(ratio, 1 / ratio);
      if (steps > kOneStep && steps < kTwoSteps)
        findings.push_back({FindingCode::exif, note, session.photos[of_bracket[k].second].file,
                            "was exposed for " + shutter_text(of_bracket[k].first) + " where most views have " +
                                shutter_text(wanted[k].first) + "; the time in its EXIF is used",
                            ""});
    }
  }
}

void judge_views(const Session& session, std::span<const PhotoLook> looks, std::vector<Finding>& findings) {
  std::vector<double> edges;
  for (const PhotoLook& look : looks)
    if (look.edge_sigma_px) edges.push_back(*look.edge_sigma_px);
  std::sort(edges.begin(), edges.end());
  const double usual_edge = edges.empty() ? 0 : edges[edges.size() / 2];

  std::vector<ComparedPhoto> compared;
  const std::vector<Bracket> brackets = brackets_of(session);
  judge_shutter_times(session, brackets, findings);
  for (const Bracket& bracket : brackets) {
    const auto factor = [&](int i) { return exposure_factor(session.photos[i]); };
    const auto [shortest, longest] = std::minmax_element(bracket.photos.begin(), bracket.photos.end(),
                                                         [&](int a, int b) { return factor(a) < factor(b); });
    const PhotoLook &dark = looks[*shortest], &bright = looks[*longest];
    if (dark.clipped_fraction > kMuchClipped)
      findings.push_back({FindingCode::exposure, warning, session.photos[*shortest].file,
                          percent(dark.clipped_fraction) + " of view " + bracket.view +
                              " (glints, paper or background) is clipped even in its shortest exposure",
                          "add an exposure 4 to 8 times shorter"});
    if (bright.bright < kTooDark)
      findings.push_back({FindingCode::exposure, warning, session.photos[*longest].file,
                          "view " + bracket.view + " is dark: its brightest parts reach " +
                              fixed(100 * bright.bright, 1) + " % of white",
                          "add an exposure 8 times longer"});
    for (const int i : bracket.photos) {
      const PhotoLook& look = looks[i];
      if (look.edge_sigma_px && look.bright > kTooDark && *look.edge_sigma_px > kBlurred_px &&
          *look.edge_sigma_px > kBlurredBesideUsual * usual_edge)
        findings.push_back({FindingCode::photo_quality, warning, session.photos[i].file,
                            "is blurred: its sharpest edges are " + fixed(*look.edge_sigma_px, 1) +
                                " px wide, others' " + fixed(usual_edge, 1) + " px",
                            "focus once by hand, use a tripod, and take it again"});
      if (i == *longest) continue;
      const auto same = compare(bright, factor(*longest), look, factor(i));
      if (!same) continue;
      compared.push_back({i, *longest, factor(*longest) / factor(i), same->ratio});
      if (same->shift_px > kMoved_px)
        findings.push_back({FindingCode::camera_moved, warning, session.photos[i].file,
                            "lies " + fixed(same->shift_px, 1) + " px aside of " +
                                session.photos[*longest].file.filename().string() + " of the same view",
                            "use a tripod and a remote release for brackets"});
    }
  }
  judge_exposures(session, compared, findings);
  if (usual_edge > kBlurred_px)
    findings.push_back({FindingCode::photo_quality,
                        warning,
                        {},
                        "all photos are soft: the sharpest edges are " + fixed(usual_edge, 1) + " px wide",
                        "focus on the board's face, close the aperture to f/8, use a tripod"});
  std::vector<std::string> views;
  for (const Photo& photo : session.photos)
    if (std::find(views.begin(), views.end(), photo.view) == views.end()) views.push_back(photo.view);
  if (static_cast<int>(views.size()) < kFewViews)
    findings.push_back(
        {FindingCode::coverage,
         warning,
         {},
         "there are photos from " + counted(views.size(), "place") + " only",
         "photograph the board from eight to twelve places, tilted, near and away from the mirror side"});
}

// The photo of a bracket with most tags; among equals, the longest exposure whose paper is not clipped.
int best_for_tags(const Bracket& bracket, const Session& session, std::span<const PhotoLook> looks) {
  const auto clipped = [&](int i) {
    double sum = 0;
    for (const TagLook& tag : looks[i].tags) sum += tag.clipped_fraction;
    return looks[i].tags.empty() || sum > 0.05 * static_cast<double>(looks[i].tags.size());
  };
  return *std::max_element(bracket.photos.begin(), bracket.photos.end(), [&](int a, int b) {
    const auto rank = [&](int i) {
      return std::tuple(looks[i].tags.size(), !clipped(i), exposure_factor(session.photos[i]));
    };
    return rank(a) < rank(b);
  });
}

// The usual mistake is the paper's width: 9/5 of AprilTag's side for its newer families.
Finding wrong_size(double ratio, const TagSet& tags) {
  const Tag& first = tags.list.front();
  const auto paper = tag_paper(first, tags.family).polygon_mm;
  const double times = (paper[1] - paper[0]).norm() / first.size_mm;
  const std::string meant = std::abs(ratio * times - 1) < kWrongSize ? " (it seems to be the paper's width)" : "";
  return {
      FindingCode::tags_misplaced,
      error,
      {},
      "tags are " + fixed(ratio, 2) + " times as wide as size_mm, measured between their centers: about " +
          fixed(ratio * first.size_mm, 2) + " mm where tag " + std::to_string(first.id) + " has " +
          fixed(first.size_mm, 2) + meant,
      "correct size_mm in board.json: the side of the square whose corners AprilTag reports, measured on the board, " +
          fixed(1 / times, 2) + " of the paper's width; or correct center_mm"};
}

void judge_tags(const Session& session, std::span<const PhotoLook> looks, const TagSet& tags,
                std::vector<Finding>& findings) {
  std::vector<Bracket> brackets = brackets_of(session);
  std::vector<int> photo;  // one per bracket
  std::vector<const PhotoLook*> best;
  std::size_t most = 0;
  for (const Bracket& bracket : brackets) {
    photo.push_back(best_for_tags(bracket, session, looks));
    best.push_back(&looks[photo.back()]);
    most = std::max(most, best.back()->tags.size());
  }
  if (most == 0) {
    findings.push_back(
        {FindingCode::tags_unread,
         error,
         {},
         "no photo shows a tag of family " + tags.family + " that board.json lists",
         "give the board.json of this board, and photos with the tags sharp, 20 pixels wide at least and "
         "not clipped"});
    return;
  }
  const TagCoverage coverage = tag_coverage(best, tags);

  // White paper is equally bright from everywhere: each tag is compared with its median over the views.
  std::map<std::pair<std::string, int>, std::vector<double>> paper;
  for (std::size_t b = 0; b < brackets.size(); ++b)
    for (const TagLook& tag : best[b]->tags)
      if (tag.clipped_fraction == 0)
        paper[{brackets[b].light, tag.id}].push_back(tag.white / exposure_factor(session.photos[photo[b]]));
  std::vector<double> errors;
  for (const TagView& view : coverage.views)
    if (view.normal) errors.push_back(view.error_px);
  const double usual_error = median_of(errors);

  for (std::size_t b = 0; b < brackets.size(); ++b) {
    const TagView& view = coverage.views[b];
    const auto& file = session.photos[photo[b]].file;
    const std::string& name = brackets[b].view;
    double lost = 0;
    for (const TagLook& tag : best[b]->tags) lost += tag.clipped_fraction / static_cast<double>(view.tags);
    if (view.tags < std::min(kFewTagsInView, static_cast<int>(tags.list.size())))
      findings.push_back({FindingCode::tags_unread, warning, file,
                          "view " + name + " shows " + std::to_string(view.tags) + " of the board's " +
                              std::to_string(tags.list.size()) + " tags",
                          "keep the whole board in the photo, sharp and evenly lit, or leave the photo out"});
    else if (view.side_px < kSmallTagInView_px)
      findings.push_back({FindingCode::tags_small, warning, file,
                          "the tags of view " + name + " are " + fixed(view.side_px, 0) + " pixels wide",
                          "go closer, so that the board fills the frame, or print larger tags (40 pixels are good)"});
    if (lost > kPaperClipped)
      findings.push_back({FindingCode::exposure, warning, file,
                          "the tags' white paper is clipped in every exposure of view " + name,
                          "add an exposure 4 times shorter: clipped tags cannot be measured"});
    const double moved = view.own_focal_px / std::max(coverage.focal_px, 1.0);
    // A photo determines its focal length only if the board is tilted.
    if (view.normal && view.tilt_deg > kTiltForFocal_deg && coverage.direction_deg > kOneDirection_deg &&
        view.error_px > 0.001 * best[b]->width && view.error_px > 3 * usual_error &&
        view.own_error_px < 0.5 * view.error_px && std::abs(moved - 1) > 0.05)
      findings.push_back({FindingCode::camera_changed, warning, file,
                          "its tags fit a focal length " + fixed(moved, 2) + " times that of the others",
                          "leave zoom and focus alone during a session: take it again, or leave it out"});
    std::vector<double> ratios;
    for (const TagLook& tag : best[b]->tags) {
      const auto& all = paper[{brackets[b].light, tag.id}];
      if (tag.clipped_fraction == 0 && all.size() >= 3)
        ratios.push_back(tag.white / exposure_factor(session.photos[photo[b]]) / median_of(all));
    }
    const double ratio = median_of(ratios);
    if (ratios.size() >= 3 && std::max(ratio, 1 / ratio) > kPaperBrightness)
      findings.push_back(
          {FindingCode::exif, warning, file,
           "its paper is " + fixed(ratio, 1) + " times as bright as in the other views, at the exposure of its EXIF",
           "correct exposure_s, iso or f_number in session.json, or give the photo a light of its own there if the "
           "lamp "
           "was moved or dimmed"});
  }
  if (coverage.size_ratio > 0 && std::abs(coverage.size_ratio - 1) > kWrongSize)
    findings.push_back(wrong_size(coverage.size_ratio, tags));
  if (coverage.frame_share < kLittleOfFrame)
    findings.push_back(
        {FindingCode::coverage,
         warning,
         {},
         "the tags reach over " + percent(coverage.frame_share) + " of the frame only",
         "come nearer where the wanted places allow it, and let the board lie in the corners of some photos"});
  if (brackets.size() > 1 && coverage.direction_deg < kOneDirection_deg)
    findings.push_back(
        {FindingCode::coverage,
         warning,
         {},
         "all photos see the board from nearly one direction, within " + fixed(coverage.direction_deg, 0) + " degrees",
         "photograph it from the left, the right, above and below, tilted by 30 to 45 degrees"});
}

}  // namespace

std::vector<Finding> preflight(const Session& session, std::span<const Exif> exif, std::span<const PhotoLook> looks,
                               const TagSet& tags) {
  std::vector<Finding> findings;
  if (session.photos.empty()) return findings;
  judge_strays(session, looks, findings);
  judge_files(session, exif, findings);
  judge_views(session, looks, findings);
  if (!has_errors(findings)) judge_tags(session, looks, tags, findings);
  return findings;
}

std::vector<Finding> preflight(const Session& session, const Progress& progress) {
  std::vector<Finding> findings;
  const std::size_t n = session.photos.size();
  std::vector<Exif> exif(n);
  std::vector<PhotoLook> looks(n);
  std::vector<std::string> broken(n);
  const TagSet tags = read_board(session.board).tags;
  constexpr std::size_t kMostAtOnce = 4;
  for (std::size_t begin = 0, end = 0; begin < n; begin = end) {
    if (progress) progress("reading photos", static_cast<double>(begin) / static_cast<double>(n));
    end = std::min(begin + kMostAtOnce, n);
    double largest = 0;
    for (std::size_t i = begin; i < end; ++i) largest = std::max(largest, pixels_of(session.photos[i].file));
    end = begin + static_cast<std::size_t>(groups_at_once(largest, static_cast<int>(end - begin)));
    tbb::parallel_for(begin, end, [&](std::size_t i) {
      try {
        exif[i] = read_exif(session.photos[i].file);
        looks[i] = look_at(session.photos[i], &tags);
      } catch (const Error& unreadable) {
        broken[i] = unreadable.what();
      }
    });
  }
  for (const std::string& what : broken)
    if (!what.empty()) findings.push_back({FindingCode::photo_unusable, error, {}, what, ""});
  return findings.empty() ? preflight(session, exif, looks, tags) : findings;
}

}  // namespace burin

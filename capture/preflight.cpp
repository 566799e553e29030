#include "capture/preflight.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>

#include "capture/photo.h"
#include "render/error.h"

namespace burin {
namespace {

using enum Finding::Severity;

constexpr double kMuchClipped = 0.05;    // of the pixels, in the shortest exposure of a view
constexpr double kTooDark = 0.05;        // of the white level: the brightest pixels of a view's longest exposure
constexpr double kBlurred_px = 1.8;      // Gaussian sigma of the sharpest edges
constexpr double kBlurredFactor = 1.6;   // times the session's median
constexpr double kExposureError = 0.08;  // nominal exposure times are rounded by up to 7 % (1/60 for 1/64)
constexpr double kMoved_px = 0.3;
constexpr int kFewViews = 4;

template <typename... Args>
std::string text(const char* format, Args... args) {
  char buffer[256];
  std::snprintf(buffer, sizeof buffer, format, args...);
  return buffer;
}

void judge_files(const Session& session, std::span<const Exif> exif, std::vector<Finding>& findings) {
  int turned = 0;
  // What most photos have is right; the others are named.
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
      findings.push_back({error, file,
                          text("is %d x %d pixels where others are %d x %d: it was rotated", e.width, e.height,
                               usual.first, usual.second),
                          "copy it from the camera again without \"auto-rotate\""});
    else if (e.width != usual.first || e.height != usual.second)
      findings.push_back(
          {error, file,
           text("is %d x %d pixels where others are %d x %d", e.width, e.height, usual.first, usual.second),
           "use photos of one camera, uncropped and at one size"});
    if (e.focal_mm && std::abs(*e.focal_mm / focal - 1) > 0.01)
      findings.push_back({error, file, text("was taken at %.4g mm focal length, others at %.4g mm", *e.focal_mm, focal),
                          "leave the zoom alone during a session: take this photo again, or leave it out"});
    if (!e.model.empty() && std::pair(e.make, e.model) != camera)
      findings.push_back(
          {error, file,
           "was taken with a " + e.make + " " + e.model + ", others with a " + camera.first + " " + camera.second,
           "use one camera for a session"});
    if (session.photos[i].f_number != aperture)
      findings.push_back({warning, file,
                          text("was taken at f/%.3g, others at f/%.3g: vignetting and sharpness differ",
                               session.photos[i].f_number, aperture),
                          "set the aperture by hand"});
    turned += e.orientation != 1;
  }
  if (turned > 0)
    findings.push_back(
        {note,
         {},
         text("%d photos carry an EXIF orientation; their pixels are used as the sensor had them", turned),
         ""});
}

void judge_views(const Session& session, std::span<const PhotoLook> looks, std::vector<Finding>& findings) {
  std::vector<double> edges;
  for (const PhotoLook& look : looks)
    if (look.edge_sigma_px) edges.push_back(*look.edge_sigma_px);
  std::sort(edges.begin(), edges.end());
  const double usual_edge = edges.empty() ? 0 : edges[edges.size() / 2];

  for (const Bracket& bracket : brackets_of(session)) {
    const auto factor = [&](int i) { return exposure_factor(session.photos[i]); };
    const auto [shortest, longest] = std::minmax_element(bracket.photos.begin(), bracket.photos.end(),
                                                         [&](int a, int b) { return factor(a) < factor(b); });
    const PhotoLook &dark = looks[*shortest], &bright = looks[*longest];
    if (dark.clipped_fraction > kMuchClipped)
      findings.push_back({warning, session.photos[*shortest].file,
                          text("%.0f %% of view %s is clipped even in its shortest exposure",
                               100 * dark.clipped_fraction, bracket.view.c_str()),
                          "add an exposure 4 to 8 times shorter"});
    if (bright.bright < kTooDark)
      findings.push_back({warning, session.photos[*longest].file,
                          text("view %s is dark: its brightest parts reach %.1f %% of white", bracket.view.c_str(),
                               100 * bright.bright),
                          "add an exposure 8 times longer"});
    for (const int i : bracket.photos) {
      const PhotoLook& look = looks[i];
      if (look.edge_sigma_px && look.bright > kTooDark && *look.edge_sigma_px > kBlurred_px &&
          *look.edge_sigma_px > kBlurredFactor * usual_edge)
        findings.push_back(
            {warning, session.photos[i].file,
             text("is blurred: its sharpest edges are %.1f px wide, others' %.1f px", *look.edge_sigma_px, usual_edge),
             "focus once by hand, use a tripod, and take it again"});
      if (i == *longest) continue;
      const auto same = compare(bright, factor(*longest), look, factor(i));
      if (!same) continue;
      if (std::abs(same->ratio - 1) > kExposureError)
        findings.push_back(
            {warning, session.photos[i].file,
             text("is %.0f %% %s than its EXIF and %s say", 100 * std::abs(same->ratio - 1),
                  same->ratio > 1 ? "brighter" : "darker", session.photos[*longest].file.filename().string().c_str()),
             "switch off flicker, automatic ISO and exposure correction, and use a steady lamp"});
      if (same->shift_px > kMoved_px)
        findings.push_back({warning, session.photos[i].file,
                            text("lies %.1f px aside of %s of the same view", same->shift_px,
                                 session.photos[*longest].file.filename().string().c_str()),
                            "use a tripod and a remote release for brackets"});
    }
  }
  if (usual_edge > kBlurred_px)
    findings.push_back({warning,
                        {},
                        text("all photos are soft: the sharpest edges are %.1f px wide", usual_edge),
                        "focus on the board's face, close the aperture to f/8, use a tripod"});
  std::vector<std::string> views;
  for (const Photo& photo : session.photos)
    if (std::find(views.begin(), views.end(), photo.view) == views.end()) views.push_back(photo.view);
  if (static_cast<int>(views.size()) < kFewViews)
    findings.push_back(
        {warning,
         {},
         text("there are photos from %d place%s only", static_cast<int>(views.size()), views.size() == 1 ? "" : "s"),
         "photograph the board from eight to twelve places, tilted, near and away from the mirror side"});
}

}  // namespace

std::vector<Finding> preflight(const Session& session, std::span<const Exif> exif, std::span<const PhotoLook> looks) {
  std::vector<Finding> findings;
  if (session.photos.empty()) return findings;
  judge_files(session, exif, findings);
  judge_views(session, looks, findings);
  return findings;
}

std::vector<Finding> preflight(const Session& session, const Progress& progress) {
  std::vector<Finding> findings;
  const std::size_t n = session.photos.size();
  std::vector<Exif> exif(n);
  std::vector<PhotoLook> looks(n);
  std::vector<std::string> broken(n);
  constexpr std::size_t kAtOnce = 4;
  for (std::size_t begin = 0; begin < n; begin += kAtOnce) {
    if (progress) progress("reading photos", static_cast<double>(begin) / static_cast<double>(n));
    tbb::parallel_for(begin, std::min(begin + kAtOnce, n), [&](std::size_t i) {
      try {
        exif[i] = read_exif(session.photos[i].file);
        looks[i] = look_at(session.photos[i]);
      } catch (const Error& unreadable) {
        broken[i] = unreadable.what();
      }
    });
  }
  for (const std::string& what : broken)
    if (!what.empty()) findings.push_back({error, {}, what, ""});
  return findings.empty() ? preflight(session, exif, looks) : findings;
}

}  // namespace burin

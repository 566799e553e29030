#include "burin/calib/camera_look.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/base/median.h"
#include "burin/calib/light/lamp_colors.h"
#include "burin/capture/bracket_response.h"
#include "burin/capture/green_sites.h"
#include "burin/capture/tags/edge_sharpening.h"

namespace burin {
namespace {

std::string percent(double part, int digits = 2) { return significant(100 * part, digits) + " %"; }

// Multiplies a photo's balance by `by`: a factor relative to the geometric mean over the photos under its light.
void multiply_balance(const Session& session, std::size_t photo, const Eigen::Vector3d& by, Sensor& sensor) {
  Eigen::Vector3d& balance =
      sensor.balance.try_emplace(photo_name(session, session.photos[photo]), Eigen::Vector3d::Ones()).first->second;
  balance = balance.cwiseProduct(by);
}

void look_at_mosaic(const Session& session, Sensor& sensor, std::vector<Finding>& findings) {
  const GreenSitesFound found = find_green_sites(with_camera(session, sensor).photos);
  sensor.green_sites = found.sites;
  if (found.sites == GreenSites::unknown) return;
  findings.push_back(make_note(
      FindingCode::camera_colors,
      "the camera measures one color a pixel and makes up the others, which loses light of fine glints: every "
      "second pixel shows " +
          percent(std::expm1(found.detail)) + " +- " + percent(std::exp(found.detail) * found.detail_sigma, 1) +
          " more fine detail (variance); the fit uses those alone",
      "raw files, which are read without guessing edges, avoid it"));
}

}  // namespace

void look_at_brackets(const Session& session, CurveFrom from, Sensor& sensor, std::vector<Finding>& findings) {
  if (from == CurveFrom::none) return;
  const bool is_told = from == CurveFrom::as_told && session.response.has_value();
  if (is_told) sensor.response = *session.response;
  if (session.sharpening) sensor.sharpening = *session.sharpening;
  look_at_mosaic(session, sensor, findings);
  const BracketResponse found = bracket_response(with_camera(session, sensor), !is_told);
  if (from == CurveFrom::brackets && found.brackets == 0)
    fail(session.file.empty() ? "the session" : session.file.string(),
         "a response curve is requested, but no view has two exposures of which one is 1.25 times the other or more "
         "and "
         "that are neither dark nor clipped: a single exposure holds no curve",
         "take each view with three exposures, a factor of four apart, without moving camera or lamp; or write "
         "\"response\" into session.json");
  if (from == CurveFrom::brackets)
    for (const Finding& finding : found.findings)
      if (found.response.is_none()) fail("the session's brackets", finding.what, finding.remedy);
  append(findings, found.findings);
  if (!is_told && !found.response.is_none()) {
    sensor.response = found.response;
    findings.push_back(make_note(
        FindingCode::response_curve,
        "the camera bends its pictures otherwise than sRGB does: brackets of " + std::to_string(found.brackets) +
            " views show a curve that changes ratios of light by " + percent(found.change) + " +- " +
            percent(found.change_sigma, 1) + "; it is taken back (exposures then agree to " +
            percent(found.error_after) + ", before to " + percent(found.error_before) + ")",
        "raw files, or a camera's neutral setting, need none"));
  }
  for (std::size_t i = 0; i < found.balance.size(); ++i) multiply_balance(session, i, found.balance[i], sensor);
  if (!found.balance.empty()) {
    double sum2 = 0;
    for (const Eigen::Vector3d& b : found.balance) sum2 += b.array().log().square().sum() / 3;
    findings.push_back(make_note(FindingCode::exif,
                                 "a bracket's photos differ in exposure or white balance from their EXIF by " +
                                     percent(std::sqrt(sum2 / static_cast<double>(found.balance.size()))) +
                                     " (standard deviation); that is taken back",
                                 "a fixed white balance and manual exposure avoid it"));
  }
}

void look_at_edges(const Session& session, std::span<const Bracket> brackets, std::span<const TagsInPhoto> tags,
                   int border_cells, const Sensor& sensor, std::vector<Finding>& findings) {
  const Session read = with_camera(session, sensor);
  constexpr std::size_t kMostViews = 4;
  std::vector<EdgePhoto> photos;
  std::vector<std::size_t> with_tags;
  for (std::size_t b = 0; b < brackets.size(); ++b)
    if (!tags[b].tags.empty()) with_tags.push_back(b);
  const std::size_t views = std::min(kMostViews, with_tags.size());
  for (std::size_t i = 0; i < views; ++i) {
    const std::size_t b = with_tags[i * with_tags.size() / views];
    for (const int photo : brackets[b].photos)
      if (read.photos[photo].encoding == Encoding::srgb) photos.push_back({read.photos[photo], tags[b].tags});
  }
  const EdgeSharpening found = edge_sharpening(photos, border_cells);
  if (!found.is_seen) return;
  findings.push_back(make_warning(
      FindingCode::camera_settings,
      "the camera sharpens its pictures: white paper is brighter next to the tags' black borders than further out, "
      "by " +
          percent(found.overshoot) + " +- " + percent(found.overshoot_sigma, 1) +
          " of the step; glints are sharpened as well, which moves roughness and depth by several percent",
      "switch sharpening off or take raw files; or write \"sharpening\": {\"amount\", \"sigma_px\"} into session.json "
      "where they are known, and it is taken back"));
}

std::vector<PaperColor> paper_colors(const MergedView& view, const TagsInPhoto& tags) {
  std::vector<PaperColor> out;
  for (const TagDetection& tag : tags.tags) {
    const std::optional<Eigen::Vector3d> sum = white_paper(view, tag, WhiteBy::green);
    if (sum && (sum->array() > 0).all())
      out.push_back({tag.id, {std::log((*sum)[0] / (*sum)[1]), std::log((*sum)[2] / (*sum)[1])}});
  }
  return out;
}

bool look_at_paper_colors(const Session& session, std::span<const Bracket> brackets,
                          std::span<const std::vector<PaperColor>> colors, Sensor& sensor,
                          std::vector<Finding>& findings) {
  bool changed = false;
  std::vector<std::string> lights;
  for (const Bracket& b : brackets)
    if (std::find(lights.begin(), lights.end(), b.light) == lights.end()) lights.push_back(b.light);
  double worst = 0;
  for (const std::string& light : lights) {
    // A tag's color depends on its place under this lamp; a factor common to a view's tags is the view's balance.
    std::map<int, std::vector<Eigen::Vector2d>> of_tag;
    for (std::size_t b = 0; b < brackets.size(); ++b)
      if (brackets[b].light == light)
        for (const PaperColor& color : colors[b]) of_tag[color.tag].push_back(color.log_ratio);
    std::map<int, Eigen::Vector2d> usual;
    for (const auto& [tag, ratios] : of_tag) {
      std::array<std::vector<double>, 2> values;
      for (const Eigen::Vector2d& r : ratios)
        for (int k = 0; k < 2; ++k) values[k].push_back(r[k]);
      usual[tag] = {median_of(values[0]), median_of(values[1])};
    }
    std::map<std::size_t, Eigen::Vector2d> off;
    double sum2 = 0, error2 = 0;
    Eigen::Vector2d mean(0, 0);
    for (std::size_t b = 0; b < brackets.size(); ++b) {
      constexpr std::size_t kFewestTags = 4;
      if (brackets[b].light != light || colors[b].size() < kFewestTags) continue;
      Eigen::Vector2d middle;
      for (int k = 0; k < 2; ++k) {
        std::vector<double> values;
        for (const PaperColor& color : colors[b]) values.push_back(color.log_ratio[k] - usual[color.tag][k]);
        const MedianAndError of_view = median_and_error(std::move(values));
        middle[k] = of_view.median;
        error2 += of_view.sigma * of_view.sigma;
      }
      off[b] = middle;
      sum2 += middle.squaredNorm();
      mean += middle;
    }
    constexpr double kLeast = 0.003, kErrors = 3;
    if (off.size() < 3) continue;
    mean /= static_cast<double>(off.size());
    const double deviation = std::sqrt(sum2 / static_cast<double>(2 * off.size()));
    if (deviation < kLeast || sum2 < kErrors * kErrors * error2) continue;
    worst = std::max(worst, deviation);
    changed = true;
    for (const auto& [b, ratio] : off)
      for (const int photo : brackets[b].photos)
        multiply_balance(session, static_cast<std::size_t>(photo),
                         {std::exp(ratio[0] - mean[0]), 1, std::exp(ratio[1] - mean[1])}, sensor);
  }
  if (changed)
    findings.push_back(
        make_note(FindingCode::camera_settings,
                  "the camera chose another white balance for each view: the tags' paper differs in color by " +
                      percent(worst) + " (standard deviation); that is taken back",
                  "a fixed white balance avoids it"));
  return changed;
}

}  // namespace burin

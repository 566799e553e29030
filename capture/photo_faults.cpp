// Faults of one photo, in sentences: photo_faults() of burin/capture/judge_photo.h.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>

#include "burin/base/median.h"
#include "burin/capture/judge_photo.h"

namespace burin {
namespace {

using enum Finding::Severity;

constexpr std::size_t kFewTags = 4;
constexpr double kSmallTag_px = 20;             // the largest families decode from this size on
constexpr double kSharp_px = 1.8;               // Gaussian sigma of edges: no photo below it counts as blurred
constexpr double kBlurredBesideSharpest = 1.6;  // times the sharpest of the session
constexpr double kUseless_px = 4;               // wider edges are no edges of a tag, in any session
constexpr double kDarkPaper = 0.15, kLostInTheDark = 0.02;
constexpr double kShake = 1.6;     // times wider in one direction
constexpr double kUnevenBlur = 2;  // one tag's edges over the others'

template <typename... Args>
std::string words(const char* format, Args... args) {
  char buffer[256];
  std::snprintf(buffer, sizeof buffer, format, args...);
  return buffer;
}

std::string listed(const std::vector<int>& ids) {
  constexpr std::size_t kNamed = 6;
  std::string out;
  for (std::size_t i = 0; i < std::min(ids.size(), kNamed); ++i) out += (i ? ", " : "") + std::to_string(ids[i]);
  if (ids.size() > kNamed) out += " and " + std::to_string(ids.size() - kNamed) + " more";
  return out;
}

void judge_tags(const PhotoFacts& facts, const Board& board, std::vector<Finding>& out) {
  const std::size_t all = board.tags.list.size();
  if (facts.tags.empty()) {
    if (facts.place_of_before) return;
    if (facts.bright < kLostInTheDark)
      out.push_back({FindingCode::tags_unread, error, facts.file,
                     words("shows no tag: it is dark, its brightest parts reach %.1f %% of white", 100 * facts.bright),
                     "take it 8 times longer"});
    else
      out.push_back({FindingCode::tags_unread, error, facts.file,
                     "shows no tag of the board's (family " + board.tags.family + ")",
                     "keep the whole board in the photo, sharp, its tags 20 pixels wide at least and not clipped"});
    return;
  }
  if (facts.tags.size() < std::min(kFewTags, all))
    out.push_back({FindingCode::tags_unread, error, facts.file,
                   words("shows %zu of the board's %zu tags (not %s)", facts.tags.size(), all,
                         listed(facts.missing_tags).c_str()),
                   "keep the whole board in the photo, sharp and evenly lit"});
  if (facts.tag_side_px < kSmallTag_px)
    out.push_back({FindingCode::tags_small, warning, facts.file,
                   words("its tags are %.0f pixels wide", facts.tag_side_px),
                   "go closer, so that the board fills the frame"});
  if (!facts.stray_tags.empty())
    out.push_back({FindingCode::tags_misplaced, warning, facts.file,
                   (facts.stray_tags.size() == 1 ? "tag " : "tags ") + listed(facts.stray_tags) +
                       (facts.stray_tags.size() == 1 ? " does" : " do") + " not lie where board.json has " +
                       (facts.stray_tags.size() == 1 ? "it" : "them"),
                   "move the tags to their places in board.json, or correct center_mm there"});
}

void judge_sharpness(const PhotoFacts& facts, std::span<const PhotoFacts* const> others, std::vector<Finding>& out) {
  if (!facts.blur_px) return;
  if (is_blurred(facts, others)) {
    const bool shaken = facts.one_way_blur > kShake;
    out.push_back({FindingCode::photo_quality, error, facts.file,
                   words(shaken ? "was shaken: its tags' edges are %.1f px wide, %.1f times wider in one direction"
                                : "is blurred: its tags' edges are %.1f px wide",
                         *facts.blur_px, facts.one_way_blur),
                   shaken ? "use a tripod and a remote release or the self-timer, and take it again"
                          : "focus once by hand on the board's face, and take it again"});
  } else if (*facts.worst_blur_px > std::max(kSharp_px, kUnevenBlur * *facts.blur_px)) {
    out.push_back({FindingCode::photo_quality, warning, facts.file,
                   words("is soft at tag %d (%.1f px; %.1f px elsewhere)", facts.worst_blur_tag, *facts.worst_blur_px,
                         *facts.blur_px),
                   "close the aperture to f/8 or f/11, and focus on the board's middle"});
  }
}

// The value of most of the others; nothing without others.
template <typename Value, typename Of>
std::optional<Value> usual(std::span<const PhotoFacts* const> others, Of of) {
  std::map<Value, int> times;
  for (const PhotoFacts* other : others) ++times[of(*other)];
  if (times.empty()) return std::nullopt;
  return std::max_element(times.begin(), times.end(), [](const auto& a, const auto& b) { return a.second < b.second; })
      ->first;
}

void judge_file(const PhotoFacts& facts, std::span<const PhotoFacts* const> others, std::vector<Finding>& out) {
  const Exif& exif = facts.exif;
  if (!facts.exposure_factor)
    out.push_back({FindingCode::exif, error, facts.file,
                   std::string("its EXIF holds no ") + (exif.exposure_s ? "aperture"
                                                        : exif.f_number ? "exposure time"
                                                                        : "exposure time and aperture"),
                   std::string(exif.exposure_s ? "give the aperture with --f-number 8, or " : "") +
                       "copy the photo from the camera itself: chats, editors and some apps strip EXIF"});
  else if (!exif.f_number && others.empty())
    out.push_back({FindingCode::exif, warning, facts.file,
                   words("its EXIF holds no aperture; f/%.3g is taken", kAssumedAperture),
                   "leave the aperture ring as it is for all photos"});
  const auto size = usual<std::pair<int, int>>(others, [](const auto& f) { return std::pair(f.width, f.height); });
  if (size && *size != std::pair(facts.width, facts.height)) {
    const bool rotated = size->first == facts.height && size->second == facts.width;
    out.push_back(
        {FindingCode::camera_changed, error, facts.file,
         words("is %d x %d pixels where others are %d x %d", facts.width, facts.height, size->first, size->second),
         rotated ? "hold the phone the same way for all photos, and switch off \"auto-rotate\""
                 : "use one camera at one size, uncropped"});
  }
  const auto focal = usual<double>(others, [](const auto& f) { return f.exif.focal_mm.value_or(0); });
  if (focal && *focal > 0 && exif.focal_mm && std::abs(*exif.focal_mm / *focal - 1) > 0.01)
    out.push_back({FindingCode::camera_changed, error, facts.file,
                   words("was taken at %.4g mm focal length, others at %.4g mm", *exif.focal_mm, *focal),
                   "leave zoom and lens alone during a session"});
  const auto model = usual<std::string>(others, [](const auto& f) { return f.exif.model; });
  if (model && !model->empty() && !exif.model.empty() && exif.model != *model)
    out.push_back({FindingCode::camera_changed, error, facts.file,
                   "was taken with a " + exif.model + ", others with a " + *model, "use one camera"});
  const auto aperture = usual<double>(others, [](const auto& f) { return f.exif.f_number.value_or(0); });
  if (aperture && *aperture > 0 && exif.f_number && *exif.f_number != *aperture)
    out.push_back({FindingCode::camera_settings, warning, facts.file,
                   words("was taken at f/%.3g, others at f/%.3g", *exif.f_number, *aperture),
                   "set the aperture by hand, and change exposures by the time alone"});
}

}  // namespace

bool is_blurred(const PhotoFacts& facts, std::span<const PhotoFacts* const> others) {
  if (!facts.blur_px || *facts.blur_px <= kSharp_px) return false;
  double sharpest = *facts.blur_px;
  for (const PhotoFacts* other : others)
    if (other->blur_px) sharpest = std::min(sharpest, *other->blur_px);
  return *facts.blur_px > kUseless_px || *facts.blur_px > kBlurredBesideSharpest * sharpest;
}

bool shows_tags_well(const PhotoFacts& facts, const Board& board) {
  return facts.exposure_factor && facts.tags.size() >= std::min(kFewTags, board.tags.list.size()) &&
         facts.paper >= kDarkPaper && facts.paper_clipped <= kPaperLost;
}

bool holds_glints(const PhotoFacts& facts) {
  return facts.exposure_factor && facts.glints_clipped && *facts.glints_clipped <= kGlintsClipped;
}

std::vector<Finding> photo_faults(const PhotoFacts& facts, const Board& board,
                                  std::span<const PhotoFacts* const> others) {
  std::vector<Finding> out;
  judge_file(facts, others, out);
  judge_tags(facts, board, out);
  judge_sharpness(facts, others, out);
  return out;
}

}  // namespace burin

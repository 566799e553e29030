#include "burin/calib/light/probe/probe_session.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

namespace burin {
namespace {

constexpr double kLongestGap_s = 60;

// Consecutive photos of one view: from, to (behind the last).
struct Run {
  std::size_t from = 0, to = 0;
  bool shows_tags = false;
};

std::vector<Run> runs_of(const FolderSession& folder) {
  std::vector<Run> runs;
  const std::vector<Photo>& photos = folder.session.photos;
  for (std::size_t i = 0; i < photos.size(); ++i) {
    if (i == 0 || photos[i].view != photos[i - 1].view) runs.push_back({i, i, false});
    runs.back().to = i + 1;
    runs.back().shows_tags = runs.back().shows_tags || !folder.looks[i].tags.empty();
  }
  return runs;
}

}  // namespace

void join_dark_views(FolderSession& folder) {
  std::vector<Photo>& photos = folder.session.photos;
  const bool timed =
      std::all_of(folder.exif.begin(), folder.exif.end(), [](const Exif& exif) { return exif.time_s.has_value(); });
  std::vector<Run> runs = runs_of(folder);
  const auto gap_s = [&](std::size_t before, std::size_t after) {
    if (!timed) return 0.0;
    return std::max(0.0, *folder.exif[after].time_s - *folder.exif[before].time_s - photos[before].exposure_s);
  };
  for (std::size_t r = 0; r < runs.size(); ++r) {
    if (runs[r].shows_tags) continue;
    // Past other dark views, up to one with tags.
    std::optional<std::size_t> before, after;
    for (std::size_t k = r; k-- > 0 && !before;)
      if (runs[k].shows_tags) before = k;
    for (std::size_t k = r + 1; k < runs.size() && !after; ++k)
      if (runs[k].shows_tags) after = k;
    const double to_before = before ? gap_s(runs[*before].to - 1, runs[r].from) : INFINITY;
    const double to_after = after ? gap_s(runs[r].to - 1, runs[*after].from) : INFINITY;
    if (std::min(to_before, to_after) > kLongestGap_s) continue;
    const std::string view = photos[runs[to_before <= to_after ? *before : *after].from].view;
    for (std::size_t i = runs[r].from; i < runs[r].to; ++i) photos[i].view = view;
  }
}

std::optional<Lens> lens_by_exif(const FolderSession& folder) {
  for (const Exif& exif : folder.exif)
    if (exif.focal_35mm && *exif.focal_35mm > 0) return nominal_lens(*exif.focal_35mm, exif.width, exif.height);
  return std::nullopt;
}

}  // namespace burin

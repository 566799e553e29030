// tools/picture_quality.h - how good a design's pictures are, in one figure and in words. The figure is the PSNR of the
// pixels that eyes in the views' places tell apart (DesignedView::eye_psnr_db; design-report.json: "eye_psnr_db"); the
// words follow from it. Every table, page and line of the program says it so.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace burin {

class JsonObject;

/// "18.7 dB (342 px)": the pixels along the longer side that it counts.
std::string decibels_of(double psnr_db, int px);

/// What a PSNR in dB looks like: "hard to recognize", "recognizable", "good", "hard to tell from the target".
const char* quality_in_words(double psnr_db);

/// Below this a picture is hard to recognize, in dB.
inline constexpr double kRecognizable_db = 20;

/// What a view's picture shows: its correlations with its own target, and with the other that it is most like.
struct Likeness {
  double own = 1, other = 0;
};
/// Of a view's correlations with all targets, and its target's with these: targets that are like its own are no other.
Likeness likeness_of(const std::vector<double>& picture, const std::vector<double>& target, std::size_t view);

/// Whether it can hardly be recognized, whatever its PSNR.
bool is_unlike(const Likeness& likeness);

/// A PSNR in words where the likeness is known: pictures that are nearly white, or nearly black, have many dB and show
/// nothing.
const char* quality_in_words(double psnr_db, const Likeness& likeness);

/// Of a view's correlations with all targets the one of another's that is largest, with its sign; 0 if there is none.
double highest_other(const std::vector<double>& correlations, std::size_t own);

/// How good a finished design is, from its design-report.json: a view each.
struct DesignQuality {
  int px = 0;         ///< that the PSNR counts, along the longer side
  double from_m = 0;  ///< the eyes that tell these apart; 0: not known (designs of 0.1)
  std::vector<double> psnr_db;
  std::vector<Likeness> likeness;

  std::string in_decibels(std::size_t view) const { return decibels_of(psnr_db[view], px); }
  const char* in_words(std::size_t view) const { return quality_in_words(psnr_db[view], likeness[view]); }
  double mean_db() const;
  std::size_t worst() const;  ///< view
};
/// Throws Error for a report that cannot be read.
DesignQuality quality_of_design(const std::filesystem::path& report);
DesignQuality quality_of_design(JsonObject& report, const std::filesystem::path& file);  ///< one that is read already

}  // namespace burin

// tools/picture_quality.h - quality of a design's pictures, as one figure and in words. The figure is the PSNR at the
// resolution of an eye at the viewpoint (DesignedView::eye_psnr_db; "eye_psnr_db" in design-report.json). The words
// follow from the figure, in all tables, pages and messages.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace burin {

class JsonObject;

/// "18.7 dB (342 px)": with the number of compared pixels along the longer side.
std::string decibels_of(double psnr_db, int px);

/// Description of a PSNR in dB: "hard to recognize", "recognizable", "good", "hard to tell from the target".
const char* quality_in_words(double psnr_db);

/// Pictures below this PSNR, in dB, are hard to recognize.
inline constexpr double kRecognizable_db = 20;

/// Correlations of a picture with its own target and with the most similar other target.
struct Likeness {
  double own = 1, other = 0;
};
/// Computes the likeness from the correlations of a view's picture with all targets, and of its target with all
/// targets. Targets similar to the view's own do not count as other targets.
Likeness likeness_of(const std::vector<double>& picture, const std::vector<double>& target, std::size_t view);

/// Returns true if the picture is hard to recognize at any PSNR.
bool is_unlike(const Likeness& likeness);

/// Description of a PSNR for a known likeness. Nearly white or nearly black pictures have a high PSNR and show nothing.
const char* quality_in_words(double psnr_db, const Likeness& likeness);

/// Largest correlation, with its sign, of a picture with another view's target; 0 if there is none.
double highest_other(const std::vector<double>& correlations, std::size_t own);

/// Quality of a finished design, from its design-report.json: one entry per view.
struct DesignQuality {
  int px = 0;         ///< compared pixels along the longer side
  double from_m = 0;  ///< viewing distance at which an eye resolves these pixels; 0: unknown (designs of 0.1)
  std::vector<double> psnr_db;
  std::vector<Likeness> likeness;

  std::string in_decibels(std::size_t view) const { return decibels_of(psnr_db[view], px); }
  const char* in_words(std::size_t view) const { return quality_in_words(psnr_db[view], likeness[view]); }
  double mean_db() const;
  std::size_t worst() const;  ///< index of the view
};
/// Throws Error for an unreadable report.
DesignQuality quality_of_design(const std::filesystem::path& report);
DesignQuality quality_of_design(JsonObject& report, const std::filesystem::path& file);  ///< for a report in memory

}  // namespace burin

#include "tools/picture_quality.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/base/files/json_file.h"

namespace burin {

std::string decibels_of(double psnr_db, int px) {
  if (!std::isfinite(psnr_db)) return psnr_db > 0 ? "no difference" : "unknown";
  return fmt::format("{} dB ({} px)", fixed(psnr_db, 1), px);
}

const char* quality_in_words(double psnr_db) {
  return psnr_db >= 30                 ? "hard to tell from the target"
         : psnr_db >= 25               ? "good"
         : psnr_db >= kRecognizable_db ? "recognizable"
                                       : "hard to recognize";
}

Likeness likeness_of(const std::vector<double>& picture, const std::vector<double>& target, std::size_t view) {
  constexpr double kLikeIt = 0.5;
  if (view >= picture.size() || picture.size() != target.size()) return {};
  Likeness out{picture[view], 0};
  for (std::size_t j = 0; j < picture.size(); ++j)
    if (j != view && target[j] < kLikeIt) out.other = std::max(out.other, picture[j]);
  return out;
}

bool is_unlike(const Likeness& likeness) {
  constexpr double kHardly = 0.6;
  return !(likeness.own >= kHardly) || !(likeness.own > likeness.other);
}

const char* quality_in_words(double psnr_db, const Likeness& likeness) {
  constexpr double kNothing = 0.35;
  if (!(likeness.own > kNothing) || !(likeness.own > likeness.other)) return "shows nothing of it";
  return quality_in_words(is_unlike(likeness) ? 0 : psnr_db);
}

double highest_other(const std::vector<double>& correlations, std::size_t own) {
  double highest = 0;
  for (std::size_t j = 0; j < correlations.size(); ++j)
    if (j != own && std::abs(correlations[j]) > std::abs(highest)) highest = correlations[j];
  return highest;
}

double DesignQuality::mean_db() const {
  return std::accumulate(psnr_db.begin(), psnr_db.end(), 0.0) / static_cast<double>(psnr_db.size());
}

std::size_t DesignQuality::worst() const {
  return static_cast<std::size_t>(std::min_element(psnr_db.begin(), psnr_db.end()) - psnr_db.begin());
}

DesignQuality quality_of_design(const std::filesystem::path& file) {
  const Json json = read_json(file, "burin/design-report", 1);
  JsonObject report(json, file.string());
  return quality_of_design(report, file);
}

DesignQuality quality_of_design(JsonObject& report, const std::filesystem::path& file) {
  DesignQuality out;
  const bool of_eyes = report.has("eye");  // designs of 0.1 have only their own pixels
  if (of_eyes) {
    JsonObject eye = report.object("eye");
    out.px = static_cast<int>(eye.integer("px"));
    out.from_m = eye.number("from_m");
  } else if (report.has("pixels")) {
    const std::vector<double> pixels = report.numbers("pixels", 2);
    out.px = static_cast<int>(std::max(pixels[0], pixels[1]));
  }
  for (JsonObject& view : report.objects("views")) {
    const char* key = of_eyes ? "eye_psnr_db" : "psnr_db";  // null stands for NaN and infinity
    out.psnr_db.push_back(view.raw(key).is_number() ? view.number(key) : std::numeric_limits<double>::quiet_NaN());
    out.likeness.push_back(
        likeness_of(view.numbers("ghost", -1), view.numbers("target_correlation", -1), out.likeness.size()));
  }
  if (out.psnr_db.empty()) fail(file.string(), "\"views\" is empty", "run burin design again");
  return out;
}

}  // namespace burin

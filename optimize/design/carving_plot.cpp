#include "burin/optimize/design/carving_plot.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"

namespace burin {
namespace {

constexpr double kWidth = 640, kHeight = 400, kLeft = 56, kRight = 100, kTop = 34, kBottom = 44;

std::string line(double x0, double y0, double x1, double y1) {
  return "<path d=\"M" + fixed(x0, 1) + " " + fixed(y0, 1) + "L" + fixed(x1, 1) + " " + fixed(y1, 1) +
         "\" stroke=\"#ccc\"/>\n";
}

std::string words(double x, double y, const char* anchor, const std::string& text) {
  return "<text x=\"" + fixed(x, 1) + "\" y=\"" + fixed(y, 1) + "\" text-anchor=\"" + anchor + "\">" + text +
         "</text>\n";
}

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

}  // namespace

std::string carving_plot(const std::vector<CarvingPoint>& curve, const std::vector<std::string>& view_names) {
  if (curve.empty() || curve.front().psnr_db.empty()) fail("carving plot", "there is nothing to plot", "give a point");
  double hours = 0, low = 1e9, high = -1e9;
  for (const CarvingPoint& p : curve) {
    hours = std::max(hours, p.hours);
    low = std::min(low, *std::min_element(p.psnr_db.begin(), p.psnr_db.end()));
    high = std::max(high, *std::max_element(p.psnr_db.begin(), p.psnr_db.end()));
  }
  low = std::floor(low);
  high = std::max(low + 1, std::ceil(high));
  const auto x = [&](double h) { return kLeft + (kWidth - kLeft - kRight) * (hours > 0 ? h / hours : 0); };
  const auto y = [&](double db) { return kHeight - kBottom - (kHeight - kTop - kBottom) * (db - low) / (high - low); };
  std::string svg =
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 640 400\" font-family=\"sans-serif\" "
      "font-size=\"12\">\n<rect width=\"640\" height=\"400\" fill=\"white\"/>\n";
  svg += words(kLeft, 20, "start", "PSNR in dB over hours to carve, the least worthy scratches left out first");
  for (int step = high - low > 10 ? 2 : 1, up = 0; low + up <= high; up += step) {
    const double db = low + up;
    svg += line(kLeft, y(db), kWidth - kRight, y(db));
    svg += words(kLeft - 6, y(db) + 4, "end", fixed(db, 0));
  }
  for (int k = 0; k <= 5; ++k) {
    const double h = hours * k / 5;
    svg += line(x(h), kTop, x(h), kHeight - kBottom);
    svg += words(x(h), kHeight - kBottom + 18, "middle", fixed(h, hours < 5 ? 2 : 1) + " h");
  }
  // Names are at the starts of their curves, at least one line of text apart.
  std::vector<std::pair<double, std::string>> names{{y(mean(curve.front().psnr_db)), "mean"}};
  for (std::size_t k = 0; k < view_names.size(); ++k) names.emplace_back(y(curve.front().psnr_db[k]), view_names[k]);
  std::sort(names.begin(), names.end());
  double above = -1e9;
  for (const auto& [at, name] : names) {
    above = std::max(at, above + 13);
    svg += words(kWidth - kRight + 6, above + 4, "start", name);
  }
  const auto path = [&](const char* style, const auto& value) {
    std::string d;
    for (const CarvingPoint& p : curve)
      d += (d.empty() ? "M" : "L") + fixed(x(p.hours), 1) + " " + fixed(y(value(p)), 1);
    svg += "<path d=\"" + d + "\" fill=\"none\" " + style + "/>\n";
  };
  for (std::size_t k = 0; k < view_names.size(); ++k)
    path("stroke=\"#69c\" stroke-width=\"1.2\"", [k](const CarvingPoint& p) { return p.psnr_db[k]; });
  path("stroke=\"#c30\" stroke-width=\"2.5\"", [](const CarvingPoint& p) { return mean(p.psnr_db); });
  return svg + "</svg>\n";
}

}  // namespace burin

#include "tools/report/chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "burin/base/files/svg.h"
#include "tools/report/html.h"

namespace burin {
namespace {

constexpr double kWidth = 440, kHeight = 260, kLeft = 46, kRight = 16, kTop = 22, kBottom = 40;
constexpr int kColors = 6;

struct Axis {
  double bottom = 0, top = 1;  // as drawn: logarithms if `logarithmic`
  bool logarithmic = false;
  std::vector<double> ticks;  // values
};

// Returns an axis with three to six round tick values.
Axis axis_of(double low, double high, bool logarithmic) {
  Axis axis;
  axis.logarithmic = logarithmic;
  if (logarithmic) {
    axis.bottom = std::log10(low);
    axis.top = std::log10(high);
    const bool sparse = axis.top - axis.bottom > 2;
    for (int power = static_cast<int>(std::floor(axis.bottom)); std::pow(10, power) <= high * 1.001; ++power)
      for (const double step : {1.0, 2.0, 5.0}) {
        const double tick = step * std::pow(10, power);
        if ((step == 1 || !sparse) && tick >= low * 0.999 && tick <= high * 1.001) axis.ticks.push_back(tick);
      }
    return axis;
  }
  const double span = std::max(high - low, 1e-3 * std::max({std::abs(low), std::abs(high), 1e-9}));
  const double raw = span / 4, decade = std::pow(10, std::floor(std::log10(raw)));
  const double step = raw / decade > 5   ? 10 * decade
                      : raw / decade > 2 ? 5 * decade
                      : raw / decade > 1 ? 2 * decade
                                         : decade;
  const auto first = static_cast<long long>(std::floor(low / step)),
             last = static_cast<long long>(std::ceil(high / step));
  axis.bottom = static_cast<double>(first) * step;
  axis.top = static_cast<double>(std::max(last, first + 1)) * step;
  for (long long i = first; i <= std::max(last, first + 1); ++i) axis.ticks.push_back(static_cast<double>(i) * step);
  return axis;
}

std::string legend_of(std::span<const Curve> curves, const std::string& of_dashed) {
  std::string out = "<ul class=\"legend\">";
  for (std::size_t c = 0; c < curves.size(); ++c) {
    if (curves[c].dashed && !of_dashed.empty()) continue;
    const int color = curves[c].color >= 0 ? curves[c].color % kColors : static_cast<int>(c) % kColors;
    out += fmt::format(
        "<li><svg viewBox=\"0 0 26 10\" aria-hidden=\"true\"><line x1=\"0\" y1=\"5\" x2=\"26\" y2=\"5\" "
        "class=\"curve s{}{}\"/></svg>{}</li>",
        color, curves[c].dashed ? " promised" : "", html(curves[c].name));
  }
  if (!of_dashed.empty()) out += "<li>" + of_dashed + "</li>";
  return out + "</ul>";
}

}  // namespace

std::string chart(std::span<const Curve> curves, const ChartWords& words) {
  double low = INFINITY, high = -INFINITY;
  std::size_t count = 2;
  for (const Curve& curve : curves) {
    count = std::max(count, curve.values.size());
    for (const double v : curve.values) {
      if (!std::isfinite(v)) continue;
      low = std::min(low, v);
      high = std::max(high, v);
    }
  }
  if (!(low <= high)) return "";
  const Axis axis = axis_of(low, high, !words.marks && low > 0 && high / low >= 10);
  // Marks at the first and last value must not touch the frame.
  const double inset = words.marks ? 28 : 0, left = kLeft + inset, right = kWidth - kRight - inset;
  const auto x_of = [&](double i) { return left + (right - left) * i / static_cast<double>(count - 1); };
  const auto y_of = [&](double v) {
    const double scaled = axis.logarithmic ? std::log10(v) : v;
    return kTop + (kHeight - kTop - kBottom) * (1 - (scaled - axis.bottom) / (axis.top - axis.bottom));
  };
  std::string out;
  for (const double v : axis.ticks) {
    out += svg_line({kLeft, y_of(v)}, {kWidth - kRight, y_of(v)}, "class=\"grid\"");
    out += svg_words({kLeft - 7, y_of(v) + 4}, number(v), "end");
  }
  const double below = kHeight - kBottom + 17;
  out += svg_words({2, 12}, words.y_label, "start");
  if (words.x_names.empty()) {
    out += svg_words({left, below}, "0", "middle") + svg_words({right, below}, std::to_string(count - 1), "end");
    out += svg_words({(left + right) / 2, below}, words.x_label, "middle");
  }
  const std::size_t every = (words.x_names.size() + 7) / 8;  // names must not overlap
  for (std::size_t i = 0; i < words.x_names.size(); i += std::max<std::size_t>(1, every))
    out += svg_words({x_of(static_cast<double>(i)), below}, words.x_names[i], "middle");
  for (std::size_t c = 0; c < curves.size(); ++c) {
    const int color = curves[c].color >= 0 ? curves[c].color % kColors : static_cast<int>(c) % kColors;
    std::vector<Eigen::Vector2d> points;
    for (std::size_t i = 0; i < curves[c].values.size(); ++i)
      if (std::isfinite(curves[c].values[i]))
        points.emplace_back(x_of(static_cast<double>(i)), y_of(curves[c].values[i]));
    if (points.size() > 1)
      out += svg_polyline(points, fmt::format("class=\"curve s{}{}\"", color, curves[c].dashed ? " promised" : ""));
    if (!words.marks) continue;
    for (const Eigen::Vector2d& p : points)
      out += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4\" class=\"mark s{} {}\"/>\n", p.x(), p.y(), color,
                         curves[c].dashed ? "hollow" : fmt::format("f{}", color));
  }
  const std::string drawing =
      svg_drawing({kWidth, kHeight}, fmt::format("role=\"img\" aria-label=\"{}\"", html(words.description)), out);
  return "<figure class=\"chart\">\n" + drawing + legend_of(curves, words.of_dashed) + "</figure>\n";
}

}  // namespace burin

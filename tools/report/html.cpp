#include "tools/report/html.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <OpenImageIO/strutil.h>
#include <fmt/chrono.h>
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <memory>
#include <utility>

#include "burin/render/error.h"
#include "burin/render/files/svg.h"

namespace burin {
namespace {

constexpr const char* kStyle = R"css(
:root { color-scheme: light; --ink: #1d2126; --soft: #5b6570; --line: #d9dde2; --paper: #fbfbf9; --accent: #8a4b12;
        --good: #22683a; --bad: #a3271b; }
* { box-sizing: border-box; }
body { margin: 0; background: var(--paper); color: var(--ink);
       font: 16px/1.5 system-ui, "Segoe UI", "Helvetica Neue", "DejaVu Sans", sans-serif; }
main { max-width: 1180px; margin: 0 auto; padding: 40px 28px 64px; }
h1 { font-size: 30px; line-height: 1.2; margin: 0 0 10px; letter-spacing: -0.01em; }
h2 { font-size: 22px; margin: 52px 0 8px; padding-top: 18px; border-top: 1px solid var(--line); }
h3 { font-size: 17px; margin: 30px 0 6px; }
p { margin: 6px 0 12px; max-width: 78ch; }
.outcome { font-size: 19px; line-height: 1.45; max-width: 72ch; margin: 0 0 20px; }
.soft, figcaption, footer { color: var(--soft); }
.figures { display: flex; flex-wrap: wrap; gap: 18px; margin: 10px 0 22px; align-items: flex-start; }
figure { margin: 0; flex: 1 1 220px; max-width: 560px; min-width: 180px; }
.large figure { flex-basis: 440px; }
.wide figure { max-width: none; }
figure .frame { position: relative; line-height: 0; background: #000; border-radius: 3px; overflow: hidden; }
figure img { width: 100%; height: auto; display: block; }
figure svg { position: absolute; inset: 0; width: 100%; height: 100%; }
figcaption { font-size: 13.5px; line-height: 1.4; padding-top: 6px; }
figcaption b { color: var(--ink); font-weight: 600; }
.scroll { overflow-x: auto; margin: 10px 0 18px; }
table { border-collapse: collapse; font-size: 14.5px; font-variant-numeric: tabular-nums; }
th { text-align: left; font-weight: 600; color: var(--soft); border-bottom: 1px solid var(--ink); padding: 4px 18px 4px 0;
     vertical-align: bottom; }
td { border-bottom: 1px solid var(--line); padding: 5px 18px 5px 0; vertical-align: top; }
td:first-child { font-weight: 600; }
.good { color: var(--good); } .bad { color: var(--bad); font-weight: 600; } .unknown { color: var(--soft); }
svg.chart { width: 100%; max-width: 720px; height: auto; display: block; margin: 8px 0 18px; }
td .soft { display: inline-block; min-width: 28ch; max-width: 60ch; }
td { min-width: 6ch; }
td:last-child { min-width: 18ch; }
@media (max-width: 640px) { main { padding: 20px 14px 40px; } h1 { font-size: 24px; } .outcome { font-size: 17px; } }
ul { margin: 4px 0 14px; padding-left: 22px; max-width: 78ch; }
footer { margin-top: 56px; border-top: 1px solid var(--line); padding-top: 10px; font-size: 13px; }
)css";

constexpr const char* kCurveColors[] = {"#8a4b12", "#1f5f8b", "#22683a", "#7a2a7d", "#a3271b", "#4d5a66"};

}  // namespace

std::string html(std::string_view text) { return xml_text(text); }

std::string plain_text(const std::string& text) {
  std::string out;
  bool in_tag = false;
  for (const char c : text) {
    if (c == '<') in_tag = true;
    if (!in_tag) out += c;
    if (c == '>') in_tag = false;
  }
  for (const auto& [from, to] : {std::pair{"&lt;", "<"}, {"&gt;", ">"}, {"&quot;", "\""}, {"&amp;", "&"}})
    for (std::size_t at = 0; (at = out.find(from, at)) != std::string::npos;) {
      out.replace(at, std::string(from).size(), to);
      ++at;
    }
  return out;
}

std::string data_address(const Image& shown, PictureKind kind) {
  const char* extension = kind == PictureKind::jpeg ? "jpg" : "png";
  std::vector<unsigned char> bytes;
  OIIO::Filesystem::IOVecOutput memory(bytes);
  const std::string name = std::string("picture.") + extension;
  const auto output = OIIO::ImageOutput::create(name, &memory);
  OIIO::ImageSpec spec(shown.width, shown.height, shown.channels, OIIO::TypeDesc::UINT8);
  spec["Compression"] = "jpeg:88";
  if (!output || !output->set_ioproxy(&memory) || !output->open(name, spec) ||
      !output->write_image(OIIO::TypeDesc::FLOAT, shown.data.data()) || !output->close())
    fail(std::string("a picture of the report (") + extension + ")", output ? output->geterror() : OIIO::geterror(),
         "check that OpenImageIO was built with PNG and JPEG");
  const std::string_view raw(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return std::string("data:image/") + (kind == PictureKind::jpeg ? "jpeg" : "png") + ";base64," +
         OIIO::Strutil::base64_encode(OIIO::string_view(raw.data(), raw.size()));
}

std::string figure(const Image& shown, const std::string& caption_html, PictureKind kind,
                   const std::string& svg_overlay) {
  std::string overlay;
  if (!svg_overlay.empty())
    overlay = fmt::format("<svg viewBox=\"-0.5 -0.5 {} {}\" preserveAspectRatio=\"none\">{}</svg>", shown.width,
                          shown.height, svg_overlay);
  return fmt::format(
      "<figure><div class=\"frame\"><img width=\"{}\" height=\"{}\" src=\"{}\" alt=\"{}\">{}</div>"
      "<figcaption>{}</figcaption></figure>\n",
      shown.width, shown.height, data_address(shown, kind), html(plain_text(caption_html)), overlay, caption_html);
}

std::string figure_row(std::span<const std::string> figures, bool large) {
  std::string out = large ? "<div class=\"figures large\">\n" : "<div class=\"figures\">\n";
  for (const std::string& one : figures) out += one;
  return out + "</div>\n";
}

std::string table(const Table& table) {
  std::string out = "<div class=\"scroll\"><table><thead><tr>";
  for (const std::string& cell : table.header) out += "<th>" + cell + "</th>";
  out += "</tr></thead><tbody>\n";
  for (const auto& row : table.rows) {
    out += "<tr>";
    for (const std::string& cell : row) out += "<td>" + cell + "</td>";
    out += "</tr>\n";
  }
  return out + "</tbody></table></div>\n";
}

std::string chart(std::span<const Curve> curves, const std::string& x_label, const std::string& y_label) {
  constexpr double kWidth = 720, kHeight = 280, kLeft = 64, kRight = 130, kTop = 14, kBottom = 40;
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
  const bool logarithmic = low > 0 && high / low >= 10;
  const auto scaled = [&](double v) { return logarithmic ? std::log10(v) : v; };
  double bottom = scaled(low), top = scaled(high);
  if (!logarithmic) bottom = std::min(bottom, 0.0);
  if (top - bottom < 1e-12) top = bottom + 1;
  const auto x_of = [&](double i) { return kLeft + (kWidth - kLeft - kRight) * i / static_cast<double>(count - 1); };
  const auto y_of = [&](double v) {
    return kTop + (kHeight - kTop - kBottom) * (1 - (scaled(v) - bottom) / (top - bottom));
  };

  std::string out;
  constexpr int kTicks = 4;
  for (int i = 0; i <= kTicks; ++i) {
    const double at = bottom + (top - bottom) * i / kTicks;
    const double v = logarithmic ? std::pow(10, at) : at;
    out += svg_line({kLeft, y_of(v)}, {kWidth - kRight, y_of(v)}, "stroke=\"#d9dde2\"");
    out += svg_words({kLeft - 8, y_of(v) + 4}, fmt::format("{:.3g}", v), "end");
  }
  out += svg_words({kLeft, kHeight - kBottom + 18}, "0", "start");
  out += svg_words({kWidth - kRight, kHeight - kBottom + 18}, std::to_string(count - 1), "end");
  out += svg_words({(kLeft + kWidth - kRight) / 2, kHeight - 6}, x_label, "middle");
  double label_y = kTop + 8;
  for (std::size_t c = 0; c < curves.size(); ++c) {
    const char* color = kCurveColors[c % std::size(kCurveColors)];
    std::vector<Eigen::Vector2d> points;
    for (std::size_t i = 0; i < curves[c].values.size(); ++i) {
      const double v = curves[c].values[i];
      if (std::isfinite(v)) points.emplace_back(x_of(static_cast<double>(i)), y_of(v));
    }
    out += svg_polyline(points, fmt::format("fill=\"none\" stroke=\"{}\" stroke-width=\"2\"", color));
    out += svg_words({kWidth - kRight + 10, label_y}, curves[c].name, "start", fmt::format("fill=\"{}\"", color));
    label_y += 18;
  }
  return svg_drawing({kWidth, kHeight},
                     fmt::format("class=\"chart\" role=\"img\" aria-label=\"{} over {}\" font-size=\"12\" "
                                 "fill=\"#5b6570\"",
                                 html(y_label), html(x_label)),
                     out);
}

std::string page(const std::string& title, const std::string& outcome_html, std::span<const std::string> points_html,
                 const std::string& body_html) {
  std::string points;
  for (const std::string& point : points_html) points += "<li>" + point + "</li>\n";
  if (!points.empty()) points = "<ul class=\"points\">\n" + points + "</ul>\n";
  const std::time_t now = std::time(nullptr);
  return fmt::format(
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{0}</title>\n"
      "<style>{1}</style></head>\n<body><main>\n<h1>{0}</h1>\n<p class=\"outcome\">{2}</p>\n{5}{3}"
      "<footer>Made by burin " BURIN_VERSION
      " on {4:%Y-%m-%d %H:%M}. Lengths of boards are in mm, of grooves in µm; ± is one "
      "standard deviation.</footer>\n</main></body></html>\n",
      html(title), kStyle, outcome_html, body_html, fmt::localtime(now), points);
}

std::string with_sigma(double value, double sigma) {
  if (!(sigma > 0) || !std::isfinite(sigma)) return number(value);
  // Two digits of the uncertainty, and the value to the same place.
  const int digits = std::clamp(1 - static_cast<int>(std::floor(std::log10(sigma))), 0, 9);
  return fmt::format("{:.{}f} ± {:.{}f}", value, digits, sigma, digits);
}

std::string number(double value) { return fmt::format("{:.4g}", value); }

}  // namespace burin

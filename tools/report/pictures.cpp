#include "tools/report/pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include "burin/pictures/encoded_bytes.h"
#include "burin/pictures/linear_picture.h"
#include "tools/base64.h"
#include "tools/report/html.h"

namespace burin {

std::string data_address(const Image& shown, PictureKind kind) {
  constexpr int kQuality = 86;  // at full color resolution, because a difference consists of colors alone
  std::vector<std::uint8_t> stored(shown.data.size());
  std::transform(shown.data.begin(), shown.data.end(), stored.begin(),
                 [](float v) { return static_cast<std::uint8_t>(v > 0 ? std::lround(255 * std::min(v, 1.0F)) : 0); });
  const EightBits picture{shown.width, shown.height, shown.channels, stored};
  return kind == PictureKind::jpeg
             ? "data:image/jpeg;base64," + base64(jpeg_bytes(picture, kQuality, "a picture of the report"))
             : "data:image/png;base64," + base64(png_bytes(picture, "a picture of the report"));
}

std::string figure(const Figure& figure) {
  if (figure.alt.empty()) throw std::logic_error("a picture of a report without an alt text");
  const Image& shown = figure.shown;
  std::string overlay;
  if (!figure.overlay.empty())
    overlay = fmt::format("<svg viewBox=\"-0.5 -0.5 {} {}\" preserveAspectRatio=\"none\" aria-hidden=\"true\">{}</svg>",
                          shown.width, shown.height, figure.overlay);
  return fmt::format(
      "<figure{}><div class=\"frame\"><img width=\"{}\" height=\"{}\" src=\"{}\" alt=\"{}\">{}</div>"
      "<figcaption>{}</figcaption></figure>\n",
      figure.name.empty() ? "" : " data-name=\"" + html(figure.name) + "\"", shown.width, shown.height,
      data_address(shown, figure.kind), html(figure.alt), overlay, figure.caption);
}

std::string figure_row(std::span<const Figure> figures, FigureSize size) {
  std::string out = size == FigureSize::large    ? "<div class=\"figures large\">\n"
                    : size == FigureSize::single ? "<div class=\"figures single\">\n"
                                                 : "<div class=\"figures\">\n";
  for (const Figure& one : figures) out += figure(one);
  return out + "</div>\n";
}

std::string compared(const std::string& title, std::span<const Figure> figures, std::size_t left, std::size_t right) {
  return fmt::format(
      "<section class=\"compare\" data-title=\"{0}\" data-left=\"{1}\" data-right=\"{2}\">\n<h3>{0}</h3>\n{3}"
      "</section>\n",
      html(title), left, right, figure_row(figures));
}

std::string compared_in_lockstep(const std::string& place, const std::string& compared_html) {
  return fmt::format("<div class=\"compares\" data-place=\"{}\">\n{}</div>\n", html(place), compared_html);
}

Image picture_within(const std::filesystem::path& file, int longer_side_px) {
  int width = 0, height = 0;
  Image image = read_large_picture(file, longer_side_px, width, height);
  const int longer = std::max(image.width, image.height);
  if (longer <= longer_side_px) return image;
  return resized(image, std::max(1, image.width * longer_side_px / longer),
                 std::max(1, image.height * longer_side_px / longer));
}

}  // namespace burin

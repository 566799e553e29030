#include "tools/report/pictures.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <OpenImageIO/strutil.h>
#include <fmt/core.h>

#include <algorithm>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "burin/render/error.h"
#include "burin/render/linear_picture.h"
#include "tools/report/html.h"

namespace burin {

std::string data_address(const Image& shown, PictureKind kind) {
  const char* extension = kind == PictureKind::jpeg ? "jpg" : "png";
  std::vector<unsigned char> bytes;
  OIIO::Filesystem::IOVecOutput memory(bytes);
  const std::string name = std::string("picture.") + extension;
  const auto output = OIIO::ImageOutput::create(name, &memory);
  OIIO::ImageSpec spec(shown.width, shown.height, shown.channels, OIIO::TypeDesc::UINT8);
  spec["Compression"] = "jpeg:86";
  spec["jpeg:subsampling"] = "4:4:4";  // a difference is told by its colors alone
  if (!output || !output->set_ioproxy(&memory) || !output->open(name, spec) ||
      !output->write_image(OIIO::TypeDesc::FLOAT, shown.data.data()) || !output->close())
    fail(std::string("a picture of the report (") + extension + ")", output ? output->geterror() : OIIO::geterror(),
         "check that OpenImageIO was built with PNG and JPEG");
  const std::string_view raw(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return std::string("data:image/") + (kind == PictureKind::jpeg ? "jpeg" : "png") + ";base64," +
         OIIO::Strutil::base64_encode(OIIO::string_view(raw.data(), raw.size()));
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

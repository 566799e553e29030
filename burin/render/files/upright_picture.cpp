#include "burin/render/files/upright_picture.h"

#include <string>
#include <string_view>

#include "burin/render/error.h"
#include "burin/render/files/input_file.h"
#include "burin/render/files/picture_file.h"
#include "burin/render/limits.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

/// libjpeg fills a file that was cut short with gray and only warns. The end marker stands behind the last scan: within
/// a scan neither marker can occur.
bool jpeg_is_whole(const fs::path& file) {
  const std::string bytes = read_bytes(file, limit::kPictureBytes, "a picture");
  const std::size_t end = bytes.rfind("\xFF\xD9"), scan = bytes.rfind("\xFF\xDA");
  return end != std::string::npos && (scan == std::string::npos || end > scan);
}

}  // namespace

UprightPicture open_upright(const fs::path& file) {
  // Colors as stored, not multiplied by alpha in 8 bits behind our back.
  OIIO::ImageSpec config;
  config["oiio:UnassociatedAlpha"] = 1;
  UprightPicture picture;
  picture.input = open_picture(file, {limit::kPicturePixels, "a picture", kPictureRemedy}, config);
  picture.spec = picture.input->spec();
  if (std::string_view(picture.input->format_name()) == "jpeg" && !jpeg_is_whole(file))
    fail(file.string(), "is cut short", "copy it again from where it came from");
  const int said = picture.spec.get_int_attribute("Orientation", 1);
  picture.orientation = said >= 1 && said <= 8 ? said : 1;
  picture.width = picture.lies() ? picture.spec.height : picture.spec.width;
  picture.height = picture.lies() ? picture.spec.width : picture.spec.height;
  picture.channels = picture.spec.nchannels >= 3 ? 3 : 1;
  picture.to_srgb = ToSrgbColors(file_colors(*picture.input, file), picture.channels);
  return picture;
}

}  // namespace burin

#include "burin/pictures/upright_picture.h"

#include <string>
#include <string_view>

#include "burin/base/error.h"
#include "burin/base/files/input_file.h"
#include "burin/base/limits.h"
#include "burin/pictures/picture_file.h"

namespace burin {

namespace fs = std::filesystem;

UprightPicture open_upright(const fs::path& file) {
  // Colors as stored, so that OpenImageIO does not multiply them by alpha in 8 bits.
  OIIO::ImageSpec config;
  config["oiio:UnassociatedAlpha"] = 1;
  UprightPicture picture;
  picture.input = open_picture(file, {limit::kPicturePixels, "a picture", kPictureRemedy}, config);
  picture.spec = described(*picture.input, file);
  require_whole(*picture.input, file);
  const std::string_view kind = picture.input->format_name();
  picture.linear = kind == "openexr" || kind == "hdr";
  const int said = picture.spec.get_int_attribute("Orientation", 1);
  picture.orientation = said >= 1 && said <= 8 ? said : 1;
  picture.width = picture.lies() ? picture.spec.height : picture.spec.width;
  picture.height = picture.lies() ? picture.spec.width : picture.spec.height;
  picture.channels = picture.spec.nchannels >= 3 ? 3 : 1;
  picture.to_srgb = ToSrgbColors(file_colors(*picture.input, file), picture.channels);
  return picture;
}

}  // namespace burin

#include "burin/pictures/picture.h"

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "burin/base/error.h"
#include "burin/base/files/file_names.h"
#include "burin/base/files/write_file.h"
#include "burin/pictures/encoded_picture.h"
#include "burin/pictures/upright_picture.h"

namespace burin {

Image read_picture(const std::filesystem::path& file) {
  UprightPicture picture = open_upright(file);
  Image image(picture.width, picture.height, picture.channels);
  for_each_pixel(picture, file, [&](int x, int y, const std::array<float, 3>& values) {
    std::copy_n(values.begin(), image.channels, &image.at(x, y));
  });
  return image;
}

void write_picture(const Image& image, const std::filesystem::path& file, int png_bits) {
  if (image.width < 1 || image.height < 1 || image.channels < 1 ||
      image.data.size() != static_cast<std::size_t>(image.width) * image.height * image.channels)
    fail(file.string(), "the picture to be written is empty", "this is a fault of the calculation before");
  const std::string extension = lower_extension(file);
  OIIO::TypeDesc type = OIIO::TypeDesc::UINT8;
  if (extension == ".png") {
    if (png_bits == 16) type = OIIO::TypeDesc::UINT16;
  } else if (extension == ".exr" || extension == ".tif" || extension == ".tiff") {
    type = OIIO::TypeDesc::FLOAT;
  } else if (extension != ".jpg" && extension != ".jpeg") {
    fail(file.string(), "unknown kind of picture \"" + extension + "\"", "use .png, .jpg, .exr or .tif");
  }

  std::vector<float> clamped;
  const float* pixels = image.data.data();
  if (type != OIIO::TypeDesc::FLOAT) {
    clamped.resize(image.data.size());
    std::transform(image.data.begin(), image.data.end(), clamped.begin(),
                   [](float v) { return v > 0 ? std::min(v, 1.0f) : 0.0f; });  // NaN becomes 0 too
    pixels = clamped.data();
  }
  OIIO::ImageSpec spec(image.width, image.height, image.channels, type);
  if (type != OIIO::TypeDesc::FLOAT) spec.attribute("oiio:ColorSpace", "sRGB");
  if (extension == ".jpg" || extension == ".jpeg") spec.attribute("Compression", "jpeg:95");
  write_file(encoded_picture(extension, spec, OIIO::TypeDesc::FLOAT, pixels, file), file, Durability::by_the_system);
}

}  // namespace burin

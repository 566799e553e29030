#include "burin/pictures/encoded_picture.h"

#include <OpenImageIO/filesystem.h>

#include <memory>
#include <vector>

#include "burin/base/error.h"
#include "burin/pictures/encoded_bytes.h"

namespace burin {

std::string encoded_picture(const std::string& extension, OIIO::ImageSpec spec, const OIIO::TypeDesc& type,
                            const void* pixels, const std::filesystem::path& file) {
  // OpenImageIO writes the present time into EXR and TIFF files without a date.
  const bool dates = extension == ".exr" || extension == ".tif" || extension == ".tiff";
  if (dates && spec.find_attribute("DateTime") == nullptr) spec.attribute("DateTime", "");
  const std::string name = "picture" + extension;
  std::vector<unsigned char> bytes;
  OIIO::Filesystem::IOVecOutput memory(bytes);
  const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create(name);
  if (!output || !output->supports("ioproxy") || !output->set_ioproxy(&memory) || !output->open(name, spec) ||
      !output->write_image(type, pixels) || !output->close()) {
    const std::string said = output ? output->geterror() : OIIO::geterror();
    fail(file.string(), "cannot be made: " + (said.empty() ? "OpenImageIO gives no reason" : said),
         "use .png, .jpg, .exr or .tif");
  }
  return {bytes.begin(), bytes.end()};
}

std::string png_bytes(const EightBits& picture, const std::filesystem::path& file) {
  const OIIO::ImageSpec spec(picture.width, picture.height, picture.channels, OIIO::TypeDesc::UINT8);
  return encoded_picture(".png", spec, OIIO::TypeDesc::UINT8, picture.values.data(), file);
}

std::string jpeg_bytes(const EightBits& picture, int quality, const std::filesystem::path& file) {
  OIIO::ImageSpec spec(picture.width, picture.height, picture.channels, OIIO::TypeDesc::UINT8);
  spec["Compression"] = "jpeg:" + std::to_string(quality);
  spec["jpeg:subsampling"] = "4:4:4";
  return encoded_picture(".jpg", spec, OIIO::TypeDesc::UINT8, picture.values.data(), file);
}

}  // namespace burin

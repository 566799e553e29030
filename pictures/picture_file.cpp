#include "burin/pictures/picture_file.h"

#include <OpenImageIO/tiffutils.h>

#include <algorithm>
#include <string_view>

#include "burin/base/error.h"
#include "burin/base/files/input_file.h"
#include "burin/base/limits.h"
#include "burin/base/threads.h"
#include "burin/pictures/heif_picture.h"
#include "burin/pictures/jpeg_picture.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

std::int64_t side_of(const PictureLimits& limits) { return limits.photo ? limit::kPhotoSide : limit::kPictureSide; }

/// Checks the library's values, which may differ from our reading of the header.
void require_usable(const OIIO::ImageSpec& spec, const fs::path& file, const PictureLimits& limits) {
  const std::string name = file.string();
  if (spec.width < 1 || spec.height < 1 || spec.depth > 1 || spec.nchannels < 1 || spec.deep)
    fail(name, "is not a flat picture of usable size", limits.remedy);
  require_picture_size(spec.width, spec.height, limits.pixels, name, limits.kind, side_of(limits));
  if (spec.nchannels > limit::kChannels)
    fail(name,
         "has " + std::to_string(spec.nchannels) + " values a pixel, more than " + std::to_string(limit::kChannels),
         "export it with three, or with one");
  const double tile_bytes = 1.0 * spec.tile_width * spec.tile_height * static_cast<double>(spec.pixel_bytes(true));
  if (tile_bytes > static_cast<double>(limit::kTileBytes))
    fail(name, "is cut into tiles of " + std::to_string(spec.tile_width) + " x " + std::to_string(spec.tile_height),
         "export it with smaller tiles, or with none");
}

std::unique_ptr<OIIO::ImageInput> opened(const std::string& kind, const fs::path& file, bool as_the_sensor,
                                         const OIIO::ImageSpec& config, std::string& why) {
  std::unique_ptr<OIIO::ImageInput> input = kind == "heif"   ? make_heif_input(as_the_sensor)
                                            : kind == "jpeg" ? make_jpeg_input()
                                                             : OIIO::ImageInput::create(kind);
  OIIO::attribute("threads", thread_count());
  OIIO::ImageSpec spec;
  if (input && input->open(file.string(), spec, config)) {
    input->geterror();  // discards the error, because reading could continue
    return input;
  }
  why = input ? input->geterror() : OIIO::geterror();
  return nullptr;
}

}  // namespace

std::unique_ptr<OIIO::ImageInput> open_picture(const fs::path& file, const PictureLimits& limits,
                                               const OIIO::ImageSpec& config) {
  const PictureHeader header = read_picture_header(file);
  const bool raw = header.kind == "raw";
  if (raw && !limits.photo)
    fail(file.string(), "is a camera's raw file, not a developed picture",
         "export it as JPEG or PNG with the camera's program, or use the camera's own JPEG");
  require_picture_size(header.width, header.height, limits.pixels, file.string(), limits.kind, side_of(limits));
  std::string why;
  std::unique_ptr<OIIO::ImageInput> input = opened(header.kind, file, limits.photo, config, why);
  if (!input && raw) {  // a plain TIFF with a raw file's name
    std::string ignored;
    input = opened("tiff", file, limits.photo, config, ignored);
  }
  if (!input && header.has_runs)
    fail(file.string(), "is a BMP compressed by runs (RLE), which could not be read", "save it as PNG, or without RLE");
  if (!input) fail(file.string(), "is no picture that can be read (" + why + ")", limits.remedy);
  require_usable(input->spec(), file, limits);
  return input;
}

OIIO::ImageSpec described(const OIIO::ImageInput& input, const fs::path& file) {
  OIIO::ImageSpec spec = input.spec();
  const std::string_view kind = input.format_name();
  if (kind != "png" && kind != "webp" && kind != "tiff") return spec;
  const PictureHeader header = read_picture_header(file);
  if (!header.exif.empty()) OIIO::decode_exif(OIIO::string_view(header.exif.data(), header.exif.size()), spec);
  constexpr const char* kIso = "Exif:PhotographicSensitivity";
  if (header.iso > 0 && spec.find_attribute(kIso) == nullptr) spec.attribute(kIso, static_cast<int>(header.iso));
  return spec;
}

void require_read(bool read, const OIIO::ImageInput& input, const fs::path& file, const std::string& remedy) {
  if (read && !input.has_error()) return;
  const std::string why = input.geterror();
  fail(file.string(), "is damaged or cut short" + (why.empty() ? why : " (" + why + ")"), remedy);
}

}  // namespace burin

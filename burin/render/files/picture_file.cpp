#include "burin/render/files/picture_file.h"

#include <algorithm>

#include "burin/render/error.h"
#include "burin/render/files/heif_picture.h"
#include "burin/render/files/input_file.h"
#include "burin/render/limits.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

/// What the library says of it, which may differ from what we read of its header.
void require_usable(const OIIO::ImageSpec& spec, const fs::path& file, const PictureLimits& limits) {
  const std::string name = file.string();
  if (spec.width < 1 || spec.height < 1 || spec.depth > 1 || spec.nchannels < 1 || spec.deep)
    fail(name, "is not a flat picture of usable size", limits.remedy);
  require_picture_size(spec.width, spec.height, limits.pixels, name, limits.kind);
  if (spec.nchannels > limit::kChannels)
    fail(name,
         "has " + std::to_string(spec.nchannels) + " values a pixel, more than " + std::to_string(limit::kChannels),
         "export it with three, or with one");
  const double tile_bytes = 1.0 * spec.tile_width * spec.tile_height * static_cast<double>(spec.pixel_bytes(true));
  if (tile_bytes > static_cast<double>(limit::kTileBytes))
    fail(name, "is cut into tiles of " + std::to_string(spec.tile_width) + " x " + std::to_string(spec.tile_height),
         "export it with smaller tiles, or with none");
}

std::unique_ptr<OIIO::ImageInput> opened(const std::string& kind, const fs::path& file, const OIIO::ImageSpec& config,
                                         std::string& why) {
  std::unique_ptr<OIIO::ImageInput> input = kind == "heif" ? make_heif_input() : OIIO::ImageInput::create(kind);
  OIIO::ImageSpec spec;
  if (input && input->open(file.string(), spec, config)) return input;
  why = input ? input->geterror() : OIIO::geterror();
  return nullptr;
}

}  // namespace

void require_picture_size(std::int64_t width, std::int64_t height, std::int64_t most, const std::string& where,
                          const std::string& kind) {
  const bool too_wide = std::max(width, height) > limit::kPictureSide;
  if (!too_wide && width * height <= most) return;
  fail(where,
       "is of " + with_commas(static_cast<std::uintmax_t>(width)) + " x " +
           with_commas(static_cast<std::uintmax_t>(height)) + " pixels, more than " +
           (too_wide ? with_commas(limit::kPictureSide) + " on a side"
                     : "the " + with_commas(static_cast<std::uintmax_t>(most)) + " that Burin takes of " + kind),
       "make it smaller with another program (docs/limits.md)");
}

std::unique_ptr<OIIO::ImageInput> open_picture(const fs::path& file, const PictureLimits& limits,
                                               const OIIO::ImageSpec& config) {
  const PictureHeader header = read_picture_header(file, limits.raw_name);
  require_picture_size(header.width, header.height, limits.pixels, file.string(), limits.kind);
  std::string why;
  std::unique_ptr<OIIO::ImageInput> input = opened(header.kind, file, config, why);
  if (!input && limits.raw_name) {  // another kind under a raw file's name
    const std::string plain = read_picture_header(file, false).kind;
    std::string ignored;
    input = opened(plain, file, config, ignored);
  }
  if (!input) fail(file.string(), "is no picture that can be read (" + why + ")", limits.remedy);
  require_usable(input->spec(), file, limits);
  return input;
}

}  // namespace burin

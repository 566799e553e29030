// burin/pictures/upright_picture.h - reads a picture a few rows at a time, upright and over white. Readers of pictures
// and of linear light use it.
#pragma once

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <utility>
#include <vector>

#include "burin/base/error.h"
#include "burin/pictures/file_colors.h"
#include "burin/pictures/picture_file.h"

namespace burin {

inline constexpr const char* kPictureRemedy = "use a PNG, TIFF, JPEG or EXR picture that other programs open";

/// Rows of a picture, upright by its EXIF orientation, with colors over white. Rows are delivered a few at a time, so
/// memory holds no more than the caller keeps.
struct UprightPicture {
  std::unique_ptr<OIIO::ImageInput> input;
  OIIO::ImageSpec spec;
  ToSrgbColors to_srgb;  ///< converts from the file's declared colors
  int orientation = 1;
  int width = 0, height = 0, channels = 1;  ///< upright; 1 or 3 channels
  bool linear = false;                      ///< the format stores light itself (EXR, HDR), not sRGB
  float ground = 1;                         ///< background of transparent parts: white

  /// The stored alpha channel; -1: opaque.
  int alpha_channel() const {
    const int stored = spec.nchannels;
    // OpenImageIO's reader of GIF declares a fifth channel as alpha, of four channels.
    return spec.alpha_channel >= 0 && spec.alpha_channel < stored ? spec.alpha_channel
           : stored == 2 || stored == 4                           ? stored - 1
                                                                  : -1;
  }
  bool lies() const { return orientation >= 5; }

  /// Upright position of the stored pixel (x, y) (TIFF 6.0, Orientation).
  std::pair<int, int> place(int x, int y) const {
    const int right = spec.width - 1 - x, bottom = spec.height - 1 - y;
    switch (orientation) {
      case 2:
        return {right, y};
      case 3:
        return {right, bottom};
      case 4:
        return {x, bottom};
      case 5:
        return {y, x};
      case 6:
        return {bottom, x};
      case 7:
        return {bottom, right};
      case 8:
        return {y, right};
      default:
        return {x, y};
    }
  }
};

/// Throws Error for a file that is missing, truncated or no picture.
UprightPicture open_upright(const std::filesystem::path& file);

/// Calls take(x, y, values) for each pixel, with upright x and y. Values are as sRGB stores them, composited over the
/// ground; those of EXR and HDR are linear. Throws Error for a broken file.
template <typename Take>
void for_each_pixel(UprightPicture& picture, const std::filesystem::path& file, const Take& take) {
  const OIIO::ImageSpec& spec = picture.spec;
  const int stored = spec.nchannels, channels = picture.channels;
  const int alpha = picture.alpha_channel();
  const bool unassociated = spec.get_int_attribute("oiio:UnassociatedAlpha", 0) != 0;
  const auto row_values = static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(stored);
  constexpr std::size_t kValuesAtOnce = 1 << 22;
  const int at_once = spec.tile_height > 0
                          ? spec.tile_height
                          : static_cast<int>(std::clamp<std::size_t>(kValuesAtOnce / row_values, 1, 1024));
  std::vector<float> rows(row_values * static_cast<std::size_t>(std::min(at_once, spec.height)));
  std::array<float, 3> values{};
  for (int y0 = 0; y0 < spec.height; y0 += at_once) {
    const int y1 = std::min(y0 + at_once, spec.height);
    const bool read = spec.tile_height > 0
                          ? picture.input->read_tiles(0, 0, spec.x, spec.x + spec.width, spec.y + y0, spec.y + y1,
                                                      spec.z, spec.z + 1, 0, stored, OIIO::TypeDesc::FLOAT, rows.data())
                          : picture.input->read_scanlines(0, 0, spec.y + y0, spec.y + y1, 0, 0, stored,
                                                          OIIO::TypeDesc::FLOAT, rows.data());
    require_read(read, *picture.input, file, kPictureRemedy);
    picture.to_srgb.convert(rows.data(), static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(y1 - y0),
                            stored);
    const float* pixels = rows.data();
    for (int y = y0; y < y1; ++y)
      for (int x = 0; x < spec.width; ++x, pixels += stored) {
        for (int c = 0; c < channels; ++c) {
          float value = pixels[c];
          if (alpha >= 0 && alpha != c)
            value = (unassociated ? value * pixels[alpha] : value) + picture.ground * (1 - pixels[alpha]);
          if (!std::isfinite(value)) fail(file.string(), "has pixels that are not numbers", "export the picture again");
          values[static_cast<std::size_t>(c)] = value;
        }
        const auto [upright_x, upright_y] = picture.place(x, y);
        take(upright_x, upright_y, values);
      }
  }
}

}  // namespace burin

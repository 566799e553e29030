#include "burin/render/image.h"

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "burin/render/error.h"
#include "burin/render/files/encoded_picture.h"
#include "burin/render/files/file_names.h"
#include "burin/render/files/input_file.h"
#include "burin/render/files/json_file.h"
#include "burin/render/files/picture_file.h"
#include "burin/render/files/write_file.h"
#include "burin/render/limits.h"
#include "burin/render/linear_picture.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPictureRemedy = "use a PNG, TIFF, JPEG or EXR picture that other programs open";

/// libjpeg fills a file that was cut short with gray and only warns. The end marker stands behind the last scan: within
/// a scan neither marker can occur.
bool jpeg_is_whole(const fs::path& file) {
  const std::string bytes = read_bytes(file, limit::kPictureBytes, "a picture");
  const std::size_t end = bytes.rfind("\xFF\xD9"), scan = bytes.rfind("\xFF\xDA");
  return end != std::string::npos && (scan == std::string::npos || end > scan);
}

/// One destination sample as a weighted run of source samples.
struct Tap {
  int first = 0;
  std::vector<float> weights;
};

/// Down: every source sample counts by how much of the destination's span it covers. Up: linear between centers.
std::vector<Tap> taps(int source, int destination) {
  std::vector<Tap> list(destination);
  const double scale = static_cast<double>(source) / destination;
  for (int i = 0; i < destination; ++i) {
    Tap& tap = list[i];
    if (scale >= 1) {
      const double begin = i * scale, end = std::min<double>(source, (i + 1) * scale);
      tap.first = static_cast<int>(begin);
      for (int s = tap.first; s < end; ++s) {
        const double covered = std::min<double>(end, s + 1) - std::max<double>(begin, s);
        if (covered > 1e-9 || tap.weights.empty()) tap.weights.push_back(static_cast<float>(covered / (end - begin)));
      }
    } else {
      const double at = std::clamp((i + 0.5) * scale - 0.5, 0.0, source - 1.0);
      tap.first = std::min(static_cast<int>(at), std::max(0, source - 2));
      const auto t = static_cast<float>(at - tap.first);
      tap.weights = source > 1 ? std::vector<float>{1 - t, t} : std::vector<float>{1};
    }
  }
  return list;
}

/// A picture's rows, upright as its EXIF orientation says, colors over white, are handed on a few at a time: no more of
/// it is in memory than what the caller keeps.
struct UprightPicture {
  std::unique_ptr<OIIO::ImageInput> input;
  OIIO::ImageSpec spec;
  int orientation = 1;
  int width = 0, height = 0, channels = 1;  ///< upright; 1 or 3 channels

  bool lies() const { return orientation >= 5; }

  /// Where the stored pixel (x, y) stands upright (TIFF 6.0, Orientation).
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
  return picture;
}

/// Hands each pixel's values, over white, to take(x, y, values), x and y being upright.
template <typename Take>
void for_each_pixel(UprightPicture& picture, const fs::path& file, const Take& take) {
  const OIIO::ImageSpec& spec = picture.spec;
  const int stored = spec.nchannels, channels = picture.channels;
  // OpenImageIO's reader of GIF names a fifth channel of four.
  const int alpha = spec.alpha_channel >= 0 && spec.alpha_channel < stored ? spec.alpha_channel
                    : stored == 2 || stored == 4                           ? stored - 1
                                                                           : -1;
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
    if (!read) fail(file.string(), "is broken: " + picture.input->geterror(), kPictureRemedy);
    const float* pixels = rows.data();
    for (int y = y0; y < y1; ++y)
      for (int x = 0; x < spec.width; ++x, pixels += stored) {
        for (int c = 0; c < channels; ++c) {
          float value = pixels[c];
          if (alpha >= 0 && alpha != c) value = (unassociated ? value * pixels[alpha] : value) + (1 - pixels[alpha]);
          if (!std::isfinite(value)) fail(file.string(), "has pixels that are not numbers", "export the picture again");
          values[static_cast<std::size_t>(c)] = value;
        }
        const auto [upright_x, upright_y] = picture.place(x, y);
        take(upright_x, upright_y, values);
      }
  }
}

float luminance_of(const float* p) { return 0.2126f * p[0] + 0.7152f * p[1] + 0.0722f * p[2]; }

}  // namespace

Image read_picture(const std::filesystem::path& file) {
  UprightPicture picture = open_upright(file);
  Image image(picture.width, picture.height, picture.channels);
  for_each_pixel(picture, file, [&](int x, int y, const std::array<float, 3>& values) {
    std::copy_n(values.begin(), image.channels, &image.at(x, y));
  });
  return image;
}

Image read_linear_luminance(const std::filesystem::path& file) {
  const std::string extension = lower_extension(file);
  const bool linear = extension == ".exr" || extension == ".hdr";
  UprightPicture picture = open_upright(file);
  Image image(picture.width, picture.height, 1);
  for_each_pixel(picture, file, [&](int x, int y, std::array<float, 3> values) {
    for (float& v : values)
      if (!linear) v = srgb_to_linear(std::clamp(v, 0.0F, 1.0F));
    image.at(x, y) = picture.channels == 3 ? luminance_of(values.data()) : values[0];
  });
  return image;
}

// A side of a huge picture in color, which would take six times the memory of its luminance.
constexpr int kMostColored_px = 4096;

namespace {

/// Reads a picture, averaging huge ones over squares of what `decode` makes of each value.
template <typename Decode>
Image read_in_squares(const fs::path& file, int longest_px, int& width, int& height, const Decode& decode) {
  constexpr std::int64_t kLargePixels = 64'000'000;
  UprightPicture picture = open_upright(file);
  width = picture.width;
  height = picture.height;
  const int square = static_cast<std::int64_t>(width) * height <= kLargePixels
                         ? 1
                         : std::max(1, std::max(width, height) / std::max(1, longest_px));
  // What is left over at the right and at the bottom is less than a square.
  Image image(std::max(1, width / square), std::max(1, height / square), picture.channels);
  const float share = 1.0f / (static_cast<float>(square) * static_cast<float>(square));
  for_each_pixel(picture, file, [&](int x, int y, const std::array<float, 3>& values) {
    const int column = x / square, row = y / square;
    if (column >= image.width || row >= image.height) return;
    for (int c = 0; c < image.channels; ++c) {
      float& sum = image.at(column, row, c);
      const float value = decode(values[static_cast<std::size_t>(c)]);
      sum = square == 1 ? value : sum + share * value;
    }
  });
  return image;
}

}  // namespace

Image read_linear_picture(const std::filesystem::path& file) {
  const std::string extension = lower_extension(file);
  const bool linear = extension == ".exr" || extension == ".hdr";
  int width = 0, height = 0;
  return read_in_squares(file, kMostColored_px, width, height,
                         [&](float value) { return linear ? value : srgb_to_linear(std::clamp(value, 0.0F, 1.0F)); });
}

Image read_large_picture(const std::filesystem::path& file, int longest_px, int& width, int& height) {
  return read_in_squares(file, longest_px, width, height, [](float value) { return value; });
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

Image luminance(const Image& image) {
  Image out(image.width, image.height, 1);
  const std::size_t count = out.data.size();
  for (std::size_t i = 0; i < count; ++i) {
    const float* p = &image.data[i * image.channels];
    out.data[i] = image.channels >= 3 ? luminance_of(p) : p[0];
  }
  return out;
}

Image resized(const Image& image, int width, int height) {
  if (width < 1 || height < 1 || image.width < 1 || image.height < 1)
    fail("picture", "cannot be resized from or to an empty picture", "ask for a width and height of at least 1");
  const int channels = image.channels;
  const std::vector<Tap> columns = taps(image.width, width), rows = taps(image.height, height);
  Image narrow(width, image.height, channels);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < channels; ++c) {
        float sum = 0;
        for (std::size_t k = 0; k < columns[x].weights.size(); ++k)
          sum += columns[x].weights[k] * image.at(columns[x].first + static_cast<int>(k), y, c);
        narrow.at(x, y, c) = sum;
      }
  Image out(width, height, channels);
  for (int y = 0; y < height; ++y)
    for (std::size_t k = 0; k < rows[y].weights.size(); ++k) {
      const float* from =
          &narrow.data[static_cast<std::size_t>(rows[y].first + static_cast<int>(k)) * width * channels];
      float* to = &out.data[static_cast<std::size_t>(y) * width * channels];
      for (int i = 0; i < width * channels; ++i) to[i] += rows[y].weights[k] * from[i];
    }
  return out;
}

float srgb_to_linear(float v) { return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f); }

float linear_to_srgb(float v) { return v <= 0.0031308f ? v * 12.92f : 1.055f * std::pow(v, 1 / 2.4f) - 0.055f; }

}  // namespace burin

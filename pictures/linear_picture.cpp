#include "burin/pictures/linear_picture.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include "burin/pictures/upright_picture.h"

namespace burin {
namespace {

// Side of a huge picture in color, which needs six times the memory of its luminance.
constexpr int kMostColored_px = 4096;

/// Reads a picture and averages huge ones over squares of decoded values. `decode` converts each value; its argument is
/// whether the picture is linear.
template <typename Decode>
Image read_in_squares(UprightPicture picture, const std::filesystem::path& file, int longest_px, int& width,
                      int& height, const Decode& decode) {
  constexpr std::int64_t kLargePixels = 64'000'000;
  width = picture.width;
  height = picture.height;
  const int square = static_cast<std::int64_t>(width) * height <= kLargePixels
                         ? 1
                         : std::max(1, std::max(width, height) / std::max(1, longest_px));
  // The remainder at the right and at the bottom is smaller than a square.
  Image image(std::max(1, width / square), std::max(1, height / square), picture.channels);
  const float share = 1.0f / (static_cast<float>(square) * static_cast<float>(square));
  for_each_pixel(picture, file, [&](int x, int y, const std::array<float, 3>& values) {
    const int column = x / square, row = y / square;
    if (column >= image.width || row >= image.height) return;
    for (int c = 0; c < image.channels; ++c) {
      float& sum = image.at(column, row, c);
      const float value = decode(values[static_cast<std::size_t>(c)], picture.linear);
      sum = square == 1 ? value : sum + share * value;
    }
  });
  return image;
}

}  // namespace

Image read_linear_luminance(const std::filesystem::path& file) {
  UprightPicture picture = open_upright(file);
  Image image(picture.width, picture.height, 1);
  for_each_pixel(picture, file, [&](int x, int y, std::array<float, 3> values) {
    for (float& v : values)
      if (!picture.linear) v = srgb_to_linear(std::clamp(v, 0.0F, 1.0F));
    image.at(x, y) = picture.channels == 3 ? luminance_of(values.data()) : values[0];
  });
  return image;
}

Image read_linear_picture(const std::filesystem::path& file) {
  int width = 0, height = 0;
  return read_in_squares(open_upright(file), file, kMostColored_px, width, height, [](float value, bool linear) {
    return linear ? value : srgb_to_linear(std::clamp(value, 0.0F, 1.0F));
  });
}

Image read_large_picture(const std::filesystem::path& file, int longest_px, int& width, int& height) {
  return read_in_squares(open_upright(file), file, longest_px, width, height, [](float value, bool) { return value; });
}

std::optional<Image> read_large_picture_on_black(const std::filesystem::path& file, int longest_px) {
  UprightPicture picture = open_upright(file);
  if (picture.alpha_channel() < 0) return std::nullopt;
  picture.ground = 0;
  int width = 0, height = 0;
  return read_in_squares(std::move(picture), file, longest_px, width, height, [](float value, bool) { return value; });
}

}  // namespace burin

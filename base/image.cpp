#include "burin/base/image.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "burin/base/error.h"
#include "burin/base/files/input_file.h"
#include "burin/base/limits.h"

namespace burin {
namespace {

/// One destination sample as a weighted run of source samples.
struct Tap {
  int first = 0;
  std::vector<float> weights;
};

/// Down: the weight of a source sample is its overlap with the destination's span. Up: linear between centers.
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

}  // namespace

void require_picture_size(std::int64_t width, std::int64_t height, std::int64_t most, const std::string& where,
                          const std::string& kind, std::int64_t most_side) {
  const bool too_wide = std::max(width, height) > most_side;
  if (!too_wide && width * height <= most) return;
  fail(where,
       "is of " + with_commas(static_cast<std::uintmax_t>(width)) + " x " +
           with_commas(static_cast<std::uintmax_t>(height)) + " pixels, more than " +
           (too_wide ? with_commas(static_cast<std::uintmax_t>(most_side)) + " on a side"
                     : "the " + with_commas(static_cast<std::uintmax_t>(most)) + " that Burin takes of " + kind),
       "make it smaller with another program (docs/limits.md)");
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

}  // namespace burin

#include "burin/capture/photo_memory.h"

#include <algorithm>
#include <string>

#include "burin/base/error.h"
#include "burin/base/files/input_file.h"
#include "burin/base/limits.h"
#include "burin/pictures/picture_header.h"

namespace burin {

double pixels_of(const std::filesystem::path& file) {
  try {
    const PictureHeader header = read_picture_header(file);
    if (header.width > 0) return static_cast<double>(header.width) * static_cast<double>(header.height);
  } catch (const Error&) {  // the reader of the photo reports it
  }
  return static_cast<double>(limit::kPhotoPixels);
}

int groups_at_once(double pixels, int most) {
  constexpr double kPixelsAtOnce = 150e6;  // 12 bytes each, and half as much again during decoding
  return std::clamp(static_cast<int>(std::min(kPixelsAtOnce / std::max(1.0, pixels), 1e6)), 1, std::max(1, most));
}

void require_bracket_fits(std::span<const Photo> bracket) {
  if (bracket.size() < 2) return;
  const double pixels = pixels_of(bracket[0].file);
  if (pixels * static_cast<double>(bracket.size()) <= static_cast<double>(limit::kBracketPixels)) return;
  fail(bracket[0].file.string(),
       "and the other exposures of view \"" + bracket[0].view + "\" are " + std::to_string(bracket.size()) +
           " photos of " + with_commas(static_cast<std::uintmax_t>(pixels)) + " pixels, more than the " +
           with_commas(limit::kBracketPixels) + " that Burin takes of one bracket",
       "leave exposures out, or take smaller photos (docs/limits.md)");
}

}  // namespace burin

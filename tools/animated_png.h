// tools/animated_png.h - pictures that follow each other in one file that browsers play: PNG with animation chunks
// (W3C, Portable Network Graphics, third edition, 2025: acTL, fcTL, fdAT). A viewer that knows none of it shows the
// first picture.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace burin {

/// One file of frames that are PNG files of one size and kind, shown `frames_per_s` times a second, over and over.
/// Throws Error for no frames, frames that are no PNG, or frames that differ in size or kind.
std::string animated_png(const std::vector<std::string>& frames, double frames_per_s);

}  // namespace burin

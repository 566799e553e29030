// tools/animated_png.h - animated PNG: several pictures in one file, for browsers. Source: W3C, Portable Network
// Graphics, third edition, 2025, chunks acTL, fcTL and fdAT. Viewers without support for these chunks show the first
// picture.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace burin {

/// Joins PNG files of one size and color type into one animation. It runs at `frames_per_s` and repeats forever. Throws
/// Error for no frames, for a frame in another format, and for frames of different sizes or color types.
std::string animated_png(const std::vector<std::string>& frames, double frames_per_s);

}  // namespace burin

// burin/capture/photo_memory.h - how many photos are held in memory at once: by their size, whatever the machine's
// number of cores.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

#include "burin/capture/session.h"

namespace burin {

/// A photo's pixels by its header; for a raw file that only its library can measure, and for one that cannot be read
/// (which is said where it is read), as many as the largest has.
double pixels_of(const std::filesystem::path& file);

/// How many photos, or groups of them, of `pixels` in all each may be read at once: at least 1, at most `most`.
int groups_at_once(double pixels, int most);

/// Throws Error where a bracket's exposures are too many pixels to be in memory together (limit::kBracketPixels).
void require_bracket_fits(std::span<const Photo> bracket);

}  // namespace burin

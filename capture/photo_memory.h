// burin/capture/photo_memory.h - the number of photos in memory at once: by their size, for any number of cores.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

#include "burin/capture/session.h"

namespace burin {

/// A photo's pixels by its header. Raw files without a readable size, and unreadable files, count as the largest size;
/// the reader reports the latter.
double pixels_of(const std::filesystem::path& file);

/// The number of photos, or groups of photos with `pixels` pixels each, to read at once: at least 1, at most `most`.
int groups_at_once(double pixels, int most);

/// Throws Error if a bracket's exposures have too many pixels for memory together (limit::kBracketPixels).
void require_bracket_fits(std::span<const Photo> bracket);

}  // namespace burin

// tests/reliability/gcode_fuzz.h - G-code and machine profiles, changed at random: whatever the replay accepts, a
// second reader (strict_gcode.h) has to execute to the same path within a micrometer; whatever a profile lets be
// written, too.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace burin {

struct GcodeFuzz {
  std::uint64_t runs = 0;
  std::uint64_t accepted = 0;         ///< by the replay, or profiles that G-code was written with
  std::uint64_t released = 0;         ///< given out by the release check
  std::vector<std::string> findings;  ///< what was wrong, and the input; at most ten
};

/// So many files from this seed, or as many as `seconds` allow.
GcodeFuzz fuzz_gcode(std::uint64_t seed, std::uint64_t runs, double seconds);

/// So many profiles; each is written to `folder` and read back by the ordinary reader.
GcodeFuzz fuzz_profiles(std::uint64_t seed, std::uint64_t runs, double seconds, const std::filesystem::path& folder);

/// So many times a tool path from files of which one number was changed: board, bench, heights, scratches or profile.
/// Whatever is given out has to obey strict::Sheet.
GcodeFuzz fuzz_inputs(std::uint64_t seed, std::uint64_t runs, double seconds, const std::filesystem::path& folder);

}  // namespace burin

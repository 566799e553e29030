// tests/fuzz/readers.h - every reader of Burin as a function of bytes: what the fuzzer feeds (fuzz_main.cpp, preset
// `fuzz`), and what the tests replay its findings through (tests/tools/fuzz_seeds_test.cpp).
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace burin {

struct FuzzReader {
  const char* name;       ///< also of its folder of seeds below tests/data/fuzz
  const char* extension;  ///< of the file that the bytes are written into: ".json"
  void (*read)(const std::filesystem::path& file);
};

std::vector<FuzzReader> fuzz_readers();

/// Writes the bytes into a file of `folder` and reads it. What bad input has to give is burin::Error, which is caught;
/// any other exception is let out: it is a finding. Returns whether the file was taken.
bool read_fuzzed(const FuzzReader& reader, const std::filesystem::path& folder, std::string_view bytes);

/// Puts the files that some readers ask for beside theirs (a lens model, a board, a picture) into the folder.
void prepare_fuzz_folder(const std::filesystem::path& folder);

}  // namespace burin

// What libFuzzer calls: BURIN_FUZZ names the reader (tests/fuzz/readers.h), BURIN_FUZZ_DIR a folder for its files, best
// in memory (/dev/shm). tests/reliability/fuzz runs it.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>

#include "tests/fuzz/readers.h"

namespace {

burin::FuzzReader reader{};
std::filesystem::path folder;

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* /*argc*/, char*** /*argv*/) {
  const char* const name = std::getenv("BURIN_FUZZ");
  const char* const place = std::getenv("BURIN_FUZZ_DIR");
  for (const burin::FuzzReader& one : burin::fuzz_readers())
    if (name != nullptr && std::string(one.name) == name) reader = one;
  if (reader.read == nullptr || place == nullptr) {
    for (const burin::FuzzReader& one : burin::fuzz_readers()) std::printf("%s\n", one.name);
    std::fprintf(stderr, "set BURIN_FUZZ to one of these, and BURIN_FUZZ_DIR to an empty folder\n");
    std::exit(2);
  }
  folder = place;
  burin::prepare_fuzz_folder(folder);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    burin::read_fuzzed(reader, folder, {reinterpret_cast<const char*>(data), size});
  } catch (const std::exception& error) {
    std::fprintf(stderr, "FINDING: an exception that is no burin::Error: %s\n", error.what());
    std::abort();
  }
  return 0;
}

// Proves: every input that once broke a reader, and the seeds that the fuzzer (preset fuzz, tests/reliability/fuzz)
// starts from, are read or refused by burin::Error; the seeds called good-... are read.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/fuzz/readers.h"
#include "tests/places.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

const FuzzReader* reader_called(const std::string& name) {
  static const std::vector<FuzzReader> readers = fuzz_readers();
  const auto found = std::find_if(readers.begin(), readers.end(), [&](const FuzzReader& r) { return r.name == name; });
  return found == readers.end() ? nullptr : &*found;
}

TEST(FuzzSeeds, AreReadOrRefused) {
  const TemporaryFolder folder;
  prepare_fuzz_folder(folder.path());
  std::size_t seeds = 0;
  for (const fs::directory_entry& reader : fs::directory_iterator(fs::path(places::data()) / "fuzz")) {
    if (!reader.is_directory()) continue;
    const FuzzReader* const with = reader_called(reader.path().filename().string());
    ASSERT_NE(with, nullptr) << reader.path() << " is the folder of no reader";
    for (const fs::directory_entry& seed : fs::directory_iterator(reader.path())) {
      ++seeds;
      bool taken = false;
      EXPECT_NO_THROW(taken = read_fuzzed(*with, folder.path(), file_text(seed.path()))) << seed.path();
      const bool good = seed.path().filename().string().starts_with("good-");
      EXPECT_TRUE(taken || !good) << seed.path();
    }
  }
  EXPECT_GT(seeds, 60U);
}

// A fuzzer without a compiler of its own: bytes changed, cut, doubled. A minute of libFuzzer finds more; this finds
// what breaks at once.
TEST(FuzzSeeds, ChangedAtRandomAreReadOrRefused) {
  const TemporaryFolder folder;
  prepare_fuzz_folder(folder.path());
  std::mt19937 random(7);
  const auto below = [&](std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random); };
  for (const fs::directory_entry& reader : fs::directory_iterator(fs::path(places::data()) / "fuzz")) {
    if (!reader.is_directory()) continue;
    const FuzzReader* const with = reader_called(reader.path().filename().string());
    ASSERT_NE(with, nullptr);
    std::vector<fs::path> seeds;
    for (const fs::directory_entry& seed : fs::directory_iterator(reader.path())) seeds.push_back(seed.path());
    std::sort(seeds.begin(), seeds.end());
    for (int run = 0; run < 30; ++run) {
      std::string bytes = file_text(seeds[below(seeds.size())]);
      for (std::size_t change = below(4) + 1; change > 0 && !bytes.empty(); --change) {
        const std::size_t at = below(bytes.size());
        switch (below(4)) {
          case 0:
            bytes[at] = static_cast<char>(below(256));
            break;
          case 1:
            bytes.resize(at);
            break;
          case 2:
            bytes.insert(at, bytes.substr(at, below(40) + 1));
            break;
          default:
            bytes.erase(at, below(40) + 1);
        }
      }
      EXPECT_NO_THROW(read_fuzzed(*with, folder.path(), bytes)) << reader.path() << ", run " << run;
    }
  }
}

}  // namespace
}  // namespace burin

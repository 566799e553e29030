// One photo of 12 megapixels, as a phone takes it, judged from file to facts (burin/capture/judge_photo.h): what a
// person waits for in `burin watch`, beside the time until a file counts as whole (tools/watch/photo_inbox.h). JPEG,
// and HEIC where libheif can write one.
#include <benchmark/benchmark.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "burin/capture/judge_photo.h"
#include "tests/drawn_photo.h"

namespace burin {
namespace {

// A photo drawn small and enlarged: as many pixels, tags as large, edges softer.
bool write_enlarged(DrawnPhoto& photo, const std::filesystem::path& file) {
  constexpr int kLarger = 4;
  photo.width = 4032 / kLarger;
  photo.height = 3024 / kLarger;
  photo.glint = 3;
  return write_drawn(resized(drawn(photo), kLarger * photo.width, kLarger * photo.height), photo, file);
}

void BM_JudgePhoto12Megapixels(benchmark::State& state, const std::string& ending) {
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("burin-bench-" + std::to_string(getpid()) + ending);
  DrawnPhoto photo;
  if (!write_enlarged(photo, file)) {
    state.SkipWithError("this libheif has no encoder");
    return;
  }
  for (auto _ : state) {
    PhotoFacts facts = judge_photo(file, photo.board);
    if (facts.tags.size() != photo.board.tags.list.size()) state.SkipWithError("not all tags are found");
    benchmark::DoNotOptimize(facts.bright);
  }
  std::error_code ignored;
  std::filesystem::remove(file, ignored);
}
BENCHMARK_CAPTURE(BM_JudgePhoto12Megapixels, jpeg, std::string(".jpg"))->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(BM_JudgePhoto12Megapixels, heic, std::string(".heic"))->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace burin

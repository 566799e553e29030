// Proves: every example of docs/file-formats.md is a file that Burin accepts, and together they are a bench that can be
// designed for, rendered and carved. The page is read as it stands.
#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "burin/capture/session.h"
#include "burin/optimize/machine_profile.h"
#include "burin/optimize/toolpath/height_map.h"
#include "burin/scene/coupon.h"
#include "burin/scene/scratches.h"
#include "tests/places.h"
#include "tests/tools/program.h"
#include "tools/loop/options.h"
#include "tools/loop/record.h"
#include "tools/round_names.h"
#include "tools/wall/wall_file.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

struct Example {
  std::string kind, text;  ///< kind: "burin/board", "toml burin/machine", or the language of a block without a format
};

// The "burin/..." of a file in TOML.
std::string format_of_toml(const std::string& text) {
  const std::string key = "format = \"";
  const std::size_t at = text.find(key) + key.size();
  return text.substr(at, text.find('"', at) - at);
}

/// The blocks between fences. JSON is named by its "format".
std::vector<Example> examples_of(const std::string& page) {
  const std::string fence = "```";
  std::vector<Example> out;
  for (std::size_t at = page.find(fence); at != std::string::npos; at = page.find(fence, at)) {
    const std::size_t line_end = page.find('\n', at), end = page.find(fence, line_end);
    const std::string language = page.substr(at + fence.size(), line_end - at - fence.size());
    const std::string text = page.substr(line_end + 1, end - line_end - 1);
    out.push_back({language == "json"   ? nlohmann::json::parse(text).at("format").get<std::string>()
                   : language == "toml" ? "toml " + format_of_toml(text)
                                        : language,
                   text});
    at = end + fence.size();
  }
  return out;
}

class FileFormats : public ::testing::Test {
 protected:
  void SetUp() override {
    for (const Example& e : examples_of(file_text(fs::path(places::source()) / "docs" / "file-formats.md"))) {
      // The second of a kind is named after it: bench-2.json.
      const auto before = std::count(kinds_.begin(), kinds_.end(), e.kind);
      kinds_.push_back(e.kind);
      const std::string again = before > 0 ? "-" + std::to_string(before + 1) : "";
      const bool toml = e.kind.starts_with("toml ");
      folder_.write(
          e.kind == "csv" ? "scratches.csv" : e.kind.substr(e.kind.find('/') + 1) + again + (toml ? ".toml" : ".json"),
          e.text);
    }
    const fs::path sample = fs::path(places::source()) / "samples" / "small-bench";
    fs::copy_file(sample / "camera.cameramodel", folder_ / "camera.cameramodel");
    fs::copy_file(sample / "targets" / "moon.png", folder_ / "cat.png");
    fs::create_directory(folder_ / "photos");  // any picture: it is not looked at
    fs::copy_file(sample / "targets" / "moon.png", folder_ / "photos" / "v00_a.png");
  }

  TemporaryFolder folder_;
  std::vector<std::string> kinds_;
};

TEST_F(FileFormats, PageHasAnExampleOfEachFile) {
  EXPECT_THAT(kinds_, ::testing::UnorderedElementsAre("burin/board", "csv", "burin/machine", "toml burin/machine",
                                                      "burin/session", "burin/bench", "burin/bench", "burin/design",
                                                      "burin/design", "toml burin/loop", "burin/made", "burin/heights",
                                                      "burin/names", "burin/coupon", "burin/wall"));
}

TEST_F(FileFormats, TablesSessionAndMachinesAreRead) {
  EXPECT_EQ(read_scratches(folder_ / "scratches.csv").size(), 2U);
  EXPECT_EQ(read_session(folder_ / "session.json").photos.size(), 1U);
  EXPECT_EQ(read_names(folder_ / "names.json").lamps.at("ceiling"), "lamp");
  EXPECT_EQ(read_machine_profile(folder_ / "machine.json").limits.max_grooves, 3);
  EXPECT_EQ(read_machine_profile(folder_ / "machine.json").depth_by, DepthBy::drag);
  EXPECT_EQ(read_machine_profile(folder_ / "machine.json").depth_table.rows.back().sigma_um, 0.4);
  EXPECT_EQ(read_coupon(folder_ / "coupon.json").fans.front().rows, 58U);
  EXPECT_EQ(read_machine_profile(folder_ / "machine.toml").limits.max_overlap, 0.3);
  EXPECT_EQ(read_heights(folder_ / "heights.json").columns, 3);
  EXPECT_EQ(read_loop_options(folder_.path()).design.at("tolerance").front(), "3");
  EXPECT_TRUE(read_record(folder_ / "made.json")->holds());
  EXPECT_EQ(read_wall(folder_.path()).boards.back().machine, "grbl");
}

TEST_F(FileFormats, BenchInAPersonsWordsIsDesignedForAndRendered) {
  folder_.write("small.json", R"({"format": "burin/design", "version": 1, "board": "board.json",
    "bench": "bench-2.json", "scratches": 40, "views": [{"view": "front", "target": "cat.png"}]})");
  const Outcome design =
      run_burin(folder_, {"design", "small.json", "--pixels", "32", "--iterations", "1", "--out", "design"});
  ASSERT_EQ(design.exit_code, 0) << design.err;
  const Outcome render =
      run_burin(folder_, {"render", "board.json", "--bench", "bench-2.json", "--view", "left", "--out", "left.exr"});
  EXPECT_EQ(render.exit_code, 0) << render.err;
}

TEST_F(FileFormats, PicturesInColorAreDesignedForTheLampsInAPersonsWords) {
  const Outcome design = run_burin(folder_, {"design", "design-2.json", "--bench", "bench-2.json", "--count", "60",
                                             "--pixels", "32", "--iterations", "1", "--out", "design"});
  ASSERT_EQ(design.exit_code, 0) << design.err;
  EXPECT_THAT(design.out, ::testing::HasSubstr("in color: red"));
}

TEST_F(FileFormats, BenchIsDesignedForRenderedAndCarved) {
  const Outcome design = run_burin(
      folder_, {"design", "design.json", "--count", "40", "--pixels", "32", "--iterations", "1", "--out", "design"});
  ASSERT_EQ(design.exit_code, 0) << design.err;
  const Outcome render =
      run_burin(folder_, {"render", "board.json", "--bench", "bench.json", "--view", "v00", "--out", "v00.exr"});
  EXPECT_EQ(render.exit_code, 0) << render.err;
  for (const char* machine : {"machine.json", "machine.toml"}) {
    const Outcome toolpath = run_burin(folder_, {"toolpath", "scratches.csv", "--board", "board.json", "--bench",
                                                 "bench.json", "--machine", machine, "--mend", "--out", "board.gcode"});
    EXPECT_EQ(toolpath.exit_code, 0) << machine << ": " << toolpath.err;
  }
}

}  // namespace
}  // namespace burin

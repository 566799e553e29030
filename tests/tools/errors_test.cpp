// What a person does wrong is said in one sentence that names the file and the remedy; the exit code is 1, and nothing
// is left behind that looks like a result. Each case of bad input goes through the program itself, as a person would
// meet it. The photos are those of the simulated camera: three views of the sample's bench.
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/places.h"
#include "tests/tools/program.h"

namespace burin {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using ::testing::HasSubstr;
using ::testing::StartsWith;

const fs::path kSample = fs::path(places::source()) / "samples" / "small-bench";

Json parsed(const fs::path& file) { return Json::parse(file_text(file)); }

void write(const fs::path& file, const std::string& text) { std::ofstream(file, std::ios::binary) << text; }
void write(const fs::path& file, const Json& json) { write(file, json.dump(1)); }

std::size_t files_under(const fs::path& folder) {
  if (!fs::exists(folder)) return 0;
  return static_cast<std::size_t>(std::count_if(fs::recursive_directory_iterator(folder),
                                                fs::recursive_directory_iterator(),
                                                [](const auto& entry) { return entry.is_regular_file(); }));
}

// One sentence on stderr: what it is about, and, after a semicolon, what to do. Notes may stand before it.
void expect_refusal(const Outcome& run, const std::string& about, const std::string& what) {
  EXPECT_EQ(run.exit_code, 1) << run.out << run.err;
  const auto at = run.err.rfind("burin: ");
  ASSERT_NE(at, std::string::npos) << run.err;
  const std::string sentence = run.err.substr(at);
  EXPECT_EQ(std::count(sentence.begin(), sentence.end(), '\n'), 1) << sentence;
  EXPECT_THAT(sentence, HasSubstr(about));
  EXPECT_THAT(sentence, HasSubstr(what));
  EXPECT_THAT(sentence, HasSubstr("; ")) << "no remedy";
  EXPECT_THAT(sentence, ::testing::Not(HasSubstr("fault in Burin"))) << "an error that nobody foresaw";
}

// A folder with board.json, scratches.csv, photos of three views and the session.json that names them.
class PhotographedBoard : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    photographed_ = new fs::path(fs::temp_directory_path() / ("burin-photographed-" + std::to_string(::getpid())));
    fs::remove_all(*photographed_);
    fs::create_directories(*photographed_);
    Json truth = parsed(kSample / "truth.json");
    truth["session"] = true;
    truth["samples_plain"] = 4;
    truth["scratches"]["random"]["count"] = 200;
    write(*photographed_ / "truth.json", truth);
    const std::string line =
        quoted(places::program()) + " simulate " + quoted((*photographed_ / "truth.json").string()) +
        " --view d0 --view d1 c3 --samples 4 --out " + quoted((*photographed_ / "bench").string()) + " >/dev/null";
    ASSERT_EQ(std::system(line.c_str()), 0);
  }
  static void TearDownTestSuite() {
    fs::remove_all(*photographed_);
    delete photographed_;
  }

  void SetUp() override { fs::copy(*photographed_ / "bench", folder_ / "bench", fs::copy_options::recursive); }

  fs::path bench() const { return folder_ / "bench"; }
  fs::path photo(int index) const {
    return bench() / parsed(bench() / "session.json")["photos"][index]["file"].get<std::string>();
  }
  Outcome calibrate() const { return run_burin(folder_, {"calibrate", "bench/session.json", "--out", "measured"}); }
  void expect_nothing_measured() const { EXPECT_EQ(files_under(folder_ / "measured"), 0U); }

  TemporaryFolder folder_;

 private:
  static fs::path* photographed_;
};
fs::path* PhotographedBoard::photographed_ = nullptr;

TEST_F(PhotographedBoard, MissingPhoto) {
  const fs::path missing = photo(1);
  fs::remove(missing);
  expect_refusal(calibrate(), missing.filename().string(), "");
  expect_nothing_measured();
}

TEST_F(PhotographedBoard, BrokenPhoto) {
  const std::string whole = file_text(photo(1));
  write(photo(1), whole.substr(0, whole.size() / 3));
  expect_refusal(calibrate(), photo(1).filename().string(), "");
  expect_nothing_measured();
}

TEST_F(PhotographedBoard, PhotoThatIsNoPicture) {
  write(photo(0), std::string("these are my holiday notes"));
  expect_refusal(calibrate(), photo(0).filename().string(), "");
  expect_nothing_measured();
}

TEST_F(PhotographedBoard, NoTagsFound) {
  // The board's own picture of one gray: a photo, and not a tag in it.
  Json truth = parsed(kSample / "truth.json");
  truth["session"] = true;
  truth["samples_plain"] = 1;
  truth["scratches"]["random"]["count"] = 1;
  truth["board"]["tags"]["white_albedo"] = 0.0401;
  write(folder_ / "dark.json", truth);
  ASSERT_EQ(
      run_burin(folder_, {"simulate", "dark.json", "--views", "d0", "d1", "c3", "--samples", "1", "--out", "dark"})
          .exit_code,
      0);
  expect_refusal(run_burin(folder_, {"calibrate", "dark/session.json", "--out", "measured"}), "d0_a.png", "no tags");
  expect_nothing_measured();
}

TEST_F(PhotographedBoard, WrongTagFamily) {
  Json board = parsed(bench() / "board.json");
  board["tags"]["family"] = "tag36h11";
  write(bench() / "board.json", board);
  expect_refusal(calibrate(), "tag36h11", "tagStandard41h12");
  expect_nothing_measured();
}

TEST_F(PhotographedBoard, TagFamilyThatNobodyKnows) {
  Json board = parsed(bench() / "board.json");
  board["tags"]["family"] = "tag99";
  write(bench() / "board.json", board);
  expect_refusal(calibrate(), "board.json", "tag99");
  expect_nothing_measured();
}

TEST_F(PhotographedBoard, OneViewOnly) {
  Json session = parsed(bench() / "session.json");
  Json kept = Json::array();
  for (const Json& p : session["photos"])
    if (p["view"] == "d0") kept.push_back(p);
  session["photos"] = kept;
  write(bench() / "session.json", session);
  expect_refusal(calibrate(), "session.json", "view");
  expect_nothing_measured();
}

TEST_F(PhotographedBoard, PhotoSizesDiffer) {
  Json truth = parsed(kSample / "truth.json");
  truth["session"] = true;
  truth["samples_plain"] = 1;
  truth["scratches"]["random"]["count"] = 1;
  truth["camera"]["imagersize"] = {600, 500};
  write(folder_ / "other.json", truth);
  ASSERT_EQ(
      run_burin(folder_, {"simulate", "other.json", "--views", "c3", "--samples", "1", "--out", "other"}).exit_code, 0);
  for (const auto& entry : fs::directory_iterator(folder_ / "other" / "photos"))
    fs::copy_file(entry.path(), bench() / "photos" / entry.path().filename(), fs::copy_options::overwrite_existing);
  expect_refusal(calibrate(), "600", "900");
  expect_nothing_measured();
}

TEST_F(PhotographedBoard, UnknownKeyInTheManifest) {
  Json session = parsed(bench() / "session.json");
  session["photos"][0]["shutter"] = 3;
  write(bench() / "session.json", session);
  expect_refusal(calibrate(), "session.json", "shutter");
  expect_nothing_measured();
}

TEST_F(PhotographedBoard, OutputFolderThatCannotBeMade) {
  write(folder_ / "measured", std::string("a file where the folder should go"));
  expect_refusal(calibrate(), "measured", "");
  EXPECT_EQ(file_text(folder_ / "measured"), "a file where the folder should go");
}

TEST_F(PhotographedBoard, FolderOfPhotosThatIsNotThere) {
  expect_refusal(run_burin(folder_, {"capture", "phtos", "--board", "bench/board.json", "--out", "out"}), "phtos", "");
  EXPECT_EQ(files_under(folder_ / "out"), 0U);
}

TEST_F(PhotographedBoard, FolderOfPhotosWithoutPhotos) {
  fs::create_directories(folder_ / "empty");
  expect_refusal(run_burin(folder_, {"capture", "empty", "--board", "bench/board.json", "--out", "out"}), "empty", "");
  EXPECT_EQ(files_under(folder_ / "out"), 0U);
}

// A copy of the sample's board with scratches of the test's own.
class BoardFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::copy(kSample, folder_ / "bench", fs::copy_options::recursive);
    write(folder_ / "bench" / "scratches.csv", std::string("x0_mm,y0_mm,x1_mm,y1_mm\n30,30,34,33\n50,40,52,44\n"));
  }
  Outcome toolpath() const {
    return run_burin(folder_, {"toolpath", "bench/scratches.csv", "--board", "bench/board.json", "--out", "out.gcode"});
  }
  Outcome render() const {
    return run_burin(folder_,
                     {"render", "bench/board.json", "--bench", "bench/bench.json", "--view", "d0", "--out", "out.exr"});
  }
  void expect_nothing_written() const {
    EXPECT_FALSE(fs::exists(folder_ / "out.gcode"));
    EXPECT_FALSE(fs::exists(folder_ / "out.exr"));
    EXPECT_EQ(folder_.file_count(), 1U) << "something was left behind";
  }

  TemporaryFolder folder_;
};

TEST_F(BoardFiles, AreGoodBeforeTheyAreSpoilt) {
  EXPECT_EQ(render().exit_code, 0);
  EXPECT_EQ(toolpath().exit_code, 0);
}

TEST_F(BoardFiles, NaNInScratches) {
  write(folder_ / "bench" / "scratches.csv", std::string("x0_mm,y0_mm,x1_mm,y1_mm\n30,30,34,33\n50,nan,52,44\n"));
  expect_refusal(toolpath(), "scratches.csv:3", "nan");
  expect_refusal(render(), "scratches.csv:3", "nan");
  expect_nothing_written();
}

TEST_F(BoardFiles, ScratchOfNoLength) {
  write(folder_ / "bench" / "scratches.csv", std::string("x0_mm,y0_mm,x1_mm,y1_mm\n30,30,30,30\n"));
  expect_refusal(toolpath(), "scratches.csv:2", "");
  expect_refusal(render(), "scratches.csv:2", "");
  expect_nothing_written();
}

TEST_F(BoardFiles, UnknownKeyInTheBoard) {
  Json board = parsed(folder_ / "bench" / "board.json");
  board["color"] = "silver";
  write(folder_ / "bench" / "board.json", board);
  expect_refusal(render(), "board.json", "color");
  expect_nothing_written();
}

TEST_F(BoardFiles, JsonThatIsCutShort) {
  const std::string whole = file_text(folder_ / "bench" / "bench.json");
  write(folder_ / "bench" / "bench.json", whole.substr(0, whole.size() / 2));
  expect_refusal(render(), "bench.json", "line");
  expect_nothing_written();
}

TEST_F(BoardFiles, ViewThatTheBenchDoesNotHave) {
  expect_refusal(run_burin(folder_, {"render", "bench/board.json", "--bench", "bench/bench.json", "--view", "d9",
                                     "--out", "out.exr"}),
                 "d9", "d0");
  expect_nothing_written();
}

TEST_F(BoardFiles, MeshWithoutUv) {
  write(folder_ / "bench" / "bent.obj", std::string("v 0 0 0\nv 120 0 0\nv 120 120 1\nv 0 120 0\nf 1 2 3\nf 1 3 4\n"));
  Json board = parsed(folder_ / "bench" / "board.json");
  board["mesh"] = "bent.obj";
  write(folder_ / "bench" / "board.json", board);
  expect_refusal(render(), "bent.obj", "uv");
  expect_nothing_written();
}

TEST_F(BoardFiles, OutputInAFolderThatIsNotThere) {
  expect_refusal(run_burin(folder_, {"toolpath", "bench/scratches.csv", "--board", "bench/board.json", "--out",
                                     "nowhere/out.gcode"}),
                 "nowhere", "");
  expect_refusal(run_burin(folder_, {"render", "bench/board.json", "--bench", "bench/bench.json", "--view", "d0",
                                     "--out", "nowhere/out.exr"}),
                 "nowhere", "");
  expect_nothing_written();
}

TEST_F(BoardFiles, FolderThatCannotBeWritten) {
  // Nobody, not even root, can make files in /proc.
  expect_refusal(run_burin(folder_, {"toolpath", "bench/scratches.csv", "--board", "bench/board.json", "--out",
                                     "/proc/out.gcode"}),
                 "/proc", "");
  expect_refusal(
      run_burin(folder_, {"design", "bench/design.json", "--count", "50", "--iterations", "1", "--out", "/proc/out"}),
      "/proc/out", "");
  expect_nothing_written();
}

TEST_F(BoardFiles, FileThatIsNotThere) {
  expect_refusal(run_burin(folder_, {"design", "bench/desing.json", "--out", "out"}), "desing.json", "");
  expect_refusal(run_burin(folder_, {"report", "out"}), "out", "folder");
  expect_refusal(run_burin(folder_, {"loop", "out"}), "board.json", "loop project");
  expect_nothing_written();
}

TEST_F(BoardFiles, ReportOfAFolderWithNothingToReport) {
  expect_refusal(run_burin(folder_, {"report", "bench/targets"}), "targets", "nothing to report");
  EXPECT_FALSE(fs::exists(folder_ / "bench" / "targets" / "report.html"));
}

TEST_F(BoardFiles, TargetThatIsNoPicture) {
  write(folder_ / "bench" / "targets" / "boat.png", std::string("not a picture"));
  expect_refusal(
      run_burin(folder_, {"design", "bench/design.json", "--count", "50", "--iterations", "1", "--out", "out"}),
      "boat.png", "");
  EXPECT_EQ(files_under(folder_ / "out"), 0U);
}

}  // namespace
}  // namespace burin

// Proves: `burin new` makes a whole project of a person's words, for boards, cameras, lamps and pictures of all kinds:
// what it writes is read back without a warning, and what cannot be is refused with nothing left behind.
#include <gmock/gmock.h>

#include <OpenImageIO/imageio.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <sstream>

#include "burin/base/error.h"
#include "burin/base/image.h"
#include "burin/optimize/design/glint.h"
#include "burin/optimize/design/glint_check.h"
#include "burin/optimize/design_file.h"
#include "burin/pictures/picture.h"
#include "burin/scene/bench_of_board.h"
#include "tests/places.h"
#include "tests/temporary_folder.h"
#include "tests/tools/program.h"
#include "tools/new/ask.h"
#include "tools/new/lay_out.h"
#include "tools/new/pictures.h"
#include "tools/new/project_files.h"
#include "tools/new/words.h"

namespace burin {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::ThrowsMessage;

// ---- words ----

TEST(NewWords, LengthsInAnyUnit) {
  EXPECT_DOUBLE_EQ(length_in_words("1.2m", "stand"), 1200);
  EXPECT_DOUBLE_EQ(length_in_words("48in", "stand"), 48 * 25.4);
  EXPECT_DOUBLE_EQ(length_in_words(" 60 CM ", "stand"), 600);
  EXPECT_DOUBLE_EQ(length_in_words("600", "stand"), 600);
  for (const char* wrong : {"", "m", "1,2m", "far", "-3m", "0", "1e9m", "3 parsec", "1.2.3m", "nan", "inf", "1m2"})
    EXPECT_THAT([&] { length_in_words(wrong, "stand"); }, ThrowsMessage<Error>(HasSubstr("stand"))) << wrong;
}

TEST(NewWords, SizesInAnyUnit) {
  const auto is = [](const char* text, double w, double h) {
    EXPECT_LT((size_in_words(text, "board") - Eigen::Vector2d(w, h)).norm(), 1e-9) << text;
  };
  is("200x150", 200, 150);
  is("20x15cm", 200, 150);
  is("20cm x 15 cm", 200, 150);
  is("8X6in", 203.2, 152.4);
  is("200mmx15cm", 200, 150);
  is("200 \xC3\x97 150", 200, 150);
  for (const char* wrong : {"", "200", "200x", "x150", "200x150x3", "0x150", "-2x3", "200cmx150", "axb"})
    EXPECT_THROW(size_in_words(wrong, "board"), Error) << wrong;
}

TEST(NewWords, InchesAreWholeInMm) {
  EXPECT_EQ(size_in_words("6x4in", "board").x(), 152.4);
  EXPECT_EQ(length_in_words("6in", "stand"), 152.4);
}

// As people type them, and as terminals and file managers drop them.
TEST(NewWords, FilesOfALine) {
  using ::testing::ElementsAre;
  const char* home = std::getenv("HOME");
  ASSERT_NE(home, nullptr);
  EXPECT_THAT(files_in_words("a.png  b.png"), ElementsAre("a.png", "b.png"));
  EXPECT_THAT(files_in_words("a.png, b.png,c.png"), ElementsAre("a.png", "b.png", "c.png"));
  EXPECT_THAT(files_in_words("'my cat.png', \"Käse, alt.png\" x.png"),
              ElementsAre("my cat.png", "Käse, alt.png", "x.png"));
  EXPECT_THAT(files_in_words("K\xC3\xA4se\\ Br\xC3\xBC"
                             "cke.png it\\'s.png"),
              ElementsAre("K\xC3\xA4se Br\xC3\xBC"
                          "cke.png",
                          "it's.png"));
  EXPECT_THAT(files_in_words("~/pic.png ~ '~/kept.png' a~b"),
              ElementsAre(std::string(home) + "/pic.png", home, "~/kept.png", "a~b"));
  EXPECT_THAT(files_in_words("file:///home/me/my%20cat.png 100%25.png"),
              ElementsAre("/home/me/my cat.png", "100%25.png"));
  EXPECT_THAT(files_in_words("  "), IsEmpty());
  EXPECT_EQ(file_in_words("~/my boards"), std::string(home) + "/my boards");
  EXPECT_EQ(file_in_words("'my boards'"), "my boards");
  const TemporaryFolder folder;
  const std::string comma = folder.write("a,b.png", "").string();
  EXPECT_THAT(files_in_words(comma), ElementsAre(comma)) << "a file that there is";
}

TEST(NewWords, Lamps) {
  const Eigen::Vector2d board(200, 100);
  const auto at = [&](const char* text) { return lamp_position_mm(lamp_in_words(text), board, 1000); };
  EXPECT_EQ(at("10,-20,300"), Eigen::Vector3d(10, -20, 300));
  EXPECT_EQ(at("above"), Eigen::Vector3d(100, 50 + 643, 766));
  EXPECT_EQ(at("Above 500mm"), Eigen::Vector3d(100, 50 + 321, 383));
  EXPECT_EQ(at("left 2m"), Eigen::Vector3d(100 - 1286, 50, 1532));
  const Eigen::Vector3d corner = at("above-right 1m");
  EXPECT_NEAR(corner.x() - 100, corner.y() - 50, 1);
  for (const char* wrong : {"", "behind", "above x", "1,2", "1,2,-3", "1,2,three", "above 0", "leftish", "above -600mm",
                            "above - 600mm", "above-.5m"})
    EXPECT_THROW(lamp_in_words(wrong), Error) << wrong;
}

TEST(NewWords, Cameras) {
  EXPECT_EQ(camera_in_words("phone").lens.width, 4032);
  EXPECT_DOUBLE_EQ(camera_in_words("50mm").focal_35mm, 50);
  EXPECT_THAT([] { camera_in_words("no-such.jpg"); }, ThrowsMessage<Error>(HasSubstr("neither a word")));
  const fs::path sample = fs::path(places::source()) / "samples" / "small-bench";
  EXPECT_EQ(camera_in_words((sample / "camera.cameramodel").string()).lens.width, 900);
  // A photo of 53 mm as on film, 1400 x 1050 pixels.
  const SaidCamera photo = camera_in_words(
      (fs::path(places::source()) / "tests" / "data" / "rigs" / "b-small" / "photos" / "IMG_4127.JPG").string());
  EXPECT_DOUBLE_EQ(photo.focal_35mm, 53);
  EXPECT_EQ(photo.lens.height, 1050);
  // A drawing says nothing of a camera.
  EXPECT_THAT([&] { camera_in_words((sample / "targets" / "moon.png").string()); },
              ThrowsMessage<Error>(AllOf(HasSubstr("moon.png"), HasSubstr("--camera"))));
}

// ---- questions ----

TEST(NewQuestions, TakeTheUsualAskAgainAndEnd) {
  std::istringstream in("\n  seven \n7\n");
  std::ostringstream out;
  Conversation talk{in, out};
  std::string first, second;
  ask(talk, "Name", "usual", [&](const std::string& answer) { first = answer; });
  EXPECT_EQ(first, "usual");
  ask(talk, "Number", "", [&](const std::string& answer) {
    if (answer != "7") fail("number", "\"" + answer + "\" is not 7", "say 7");
    second = answer;
  });
  EXPECT_EQ(second, "7");
  EXPECT_THAT(out.str(), AllOf(HasSubstr("Name [usual]: "), HasSubstr("\"seven\" is not 7")));
  EXPECT_THAT([&] { ask(talk, "More", "", [](const std::string&) {}); },
              ThrowsMessage<Error>(HasSubstr("nothing was written")));
}

TEST(NewQuestions, BackReturnsToTheQuestionBefore) {
  std::istringstream in("back\none\nback\nuno\n\nback\ntwo\nthree\n");
  std::ostringstream out;
  Conversation talk{in, out};
  std::vector<std::string> answers(3);
  std::vector<Question> questions;
  for (std::size_t k = 0; k < 3; ++k)
    questions.push_back({"Q" + std::to_string(k), [] { return std::string("usual"); },
                         [&answers, k](const std::string& answer) { answers[k] = answer; }});
  ask_all(talk, questions);
  EXPECT_THAT(answers, ::testing::ElementsAre("uno", "two", "three"));
  EXPECT_THAT(out.str(), HasSubstr("there is no question before this one"));
}

// ---- benches ----

std::vector<Finding> findings_of(const LaidOutBench& bench) {
  std::vector<GlintView> views;
  for (std::size_t k = 0; k < bench.eyes_mm.size(); ++k)
    views.push_back({std::to_string(k), bench.eyes_mm[k], bench.lamp_mm});
  const Material& m = bench.board.material;
  return check_glints(views, bench.board.carve_min_mm, bench.board.carve_max_mm, bench.board.tool_width_um,
                      [&](const Eigen::Vector2d&) {
                        return GrooveShape{m.depth_um, m.alpha};
                      });
}

TEST(NewBench, HasNothingToWarnOfForBoardsAndPicturesOfAnyNumber) {
  for (const char* camera : {"phone", "50mm"})
    for (const Eigen::Vector2d& size :
         {Eigen::Vector2d(60, 60), {60, 120}, {100, 70}, {120, 120}, {200, 150}, {150, 200}, {300, 300}, {600, 400}})
      for (int views = 1; views <= 7; ++views) {
        SCOPED_TRACE(testing::Message() << camera << ", " << size.transpose() << " mm, " << views << " views");
        BenchWishes wanted;
        wanted.board_mm = size;
        wanted.views = views;
        wanted.camera = camera_in_words(camera);
        wanted.lamp = lamp_in_words("above");
        const LaidOutBench bench = lay_out(wanted);
        EXPECT_THAT(bench.findings, IsEmpty());
        EXPECT_GE(bench.tag_px, 24);
        for (const Finding& finding : findings_of(bench)) ADD_FAILURE() << sentence(finding);
        EXPECT_LE(bench.board.material.depth_um, 20);
        for (const Eigen::Vector3d& eye : bench.eyes_mm)
          EXPECT_NEAR((eye - Eigen::Vector3d(size.x() / 2, size.y() / 2, 0)).norm(), bench.stand_mm, 2);
      }
}

TEST(NewBench, SaysWhatFallsShortAndWhatWouldDo) {
  BenchWishes wanted;
  wanted.views = 3;
  wanted.camera = camera_in_words("phone");
  wanted.lamp = lamp_in_words("above");
  wanted.board_mm = {60, 60};
  wanted.stand_mm = 3000;
  EXPECT_THAT(lay_out(wanted).findings, ::testing::ElementsAre(Field(&Finding::what, HasSubstr("smallest tag"))));
  wanted.board_mm = {200, 150};
  wanted.camera = camera_in_words("200mm");
  wanted.stand_mm = 600;
  EXPECT_THAT(lay_out(wanted).findings,
              ::testing::Contains(Field(&Finding::what, HasSubstr("only a part of the board"))));
  wanted.stand_mm = 100;
  std::string said;
  try {
    lay_out(wanted);
  } catch (const Error& error) {
    said = error.what();
  }
  ASSERT_THAT(said, HasSubstr("stand at least "));
  // And that is enough.
  wanted.stand_mm = length_in_words(said.substr(said.find("at least ") + 9, 6), "remedy");
  EXPECT_NO_THROW(lay_out(wanted)) << said;
}

// ---- pictures ----

class NewProjectTest : public ::testing::Test {
 protected:
  void SetUp() override {
    drawing(150, 100, folder_ / "a.png");
    drawing(150, 100, folder_ / "b.png", 11);
    drawing(150, 100, folder_ / "c.png", 24);
  }

  // Stripes with a bright upper left corner: not of one tone, and with an up and a left.
  static void drawing(int width, int height, const fs::path& file, int square = 16) {
    Image image(width, height, 1, 0.2F);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        if ((x / square + y / square) % 2 == 0) image.at(x, y) = 0.6F;
        if (x < width / 4 && y < height / 4) image.at(x, y) = 1;
      }
    write_picture(image, file);
  }

  Outcome make(std::vector<std::string> more) {
    more.insert(more.begin(), "new");
    return run_burin(folder_, more);
  }

  // What lies in the folder beside the pictures.
  std::vector<std::string> left_behind() const {
    std::vector<std::string> names;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_.path()))
      if (const std::string name = entry.path().filename(); name.find(".png") == std::string::npos)
        names.push_back(name);
    return names;
  }

  TemporaryFolder folder_;
};

TEST_F(NewProjectTest, IsReadByTheOrdinaryReadersAndPreviewed) {
  const Outcome made =
      make({"my board", "--board", "12x9cm", "--pictures", "a.png", "b.png", "c.png", "--count", "600"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(made.err, AllOf(Not(HasSubstr("note:")), Not(HasSubstr("warning:"))));
  EXPECT_THAT(made.out, AllOf(HasSubstr("next: burin loop 'my board'"), HasSubstr(" dB"),
                              HasSubstr("b.png, 150 x 100 on 88 x 58 mm: fits"),
                              HasSubstr("Not said, so taken: --camera phone")));
  const fs::path project = folder_ / "my board";
  const DesignSpec spec = read_design(project / "design.json");
  const Board board = read_board(spec.board);
  const Bench bench = read_bench_of(board, spec.board, spec.bench);
  EXPECT_EQ(board.size_mm, Eigen::Vector2d(120, 90));
  EXPECT_THAT(bench.findings, IsEmpty());
  ASSERT_EQ(spec.views.size(), 3U);
  for (const DesignView& view : spec.views) {
    EXPECT_EQ(view.target.picture.parent_path(), project / "targets");  // a project moves with its pictures
    EXPECT_NO_THROW(find_view(bench, view.view, "design"));
  }
  // Three rows of shown over three of targets, side by side, on the carve area's shape.
  const Image preview = read_picture(project / "preview.png");
  EXPECT_GT(preview.width, 3 * 120);
  EXPECT_NO_THROW(read_picture(project / "crops.png"));
  EXPECT_EQ(left_behind(), std::vector<std::string>{"my board"});
  // What the loop says first of it: a board to carve.
  const Outcome status = run_burin(folder_, {"status", "my board"});
  EXPECT_EQ(status.exit_code, 0) << status.err;
}

TEST_F(NewProjectTest, DefaultsNeedPicturesOnly) {
  const Outcome made = make({"p", "--pictures", "a.png", "--count", "300"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("--board 200x150, --camera phone"));
  EXPECT_THAT(file_text(folder_ / "p" / "loop.toml"), HasSubstr("machine = \"grbl-spring\""));
}

TEST_F(NewProjectTest, NotesNameFilesWhereTheyAreInTheEnd) {
  Image night(60, 40, 1, 0.0F);
  night.at(20, 20) = 1;
  write_picture(night, folder_ / "night.png");
  const Outcome made = make({"p", "--pictures", "night.png", "--count", "300"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(made.err, HasSubstr("warning: p/targets/night.png: is nearly black"));
}

TEST_F(NewProjectTest, BoardsInInchesAreEchoedAndBareSmallOnesAskedFor) {
  const Outcome made = make({"p", "--board", "6x4in", "--lamp", "above 24in", "--pictures", "a.png", "--count", "300"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(made.out,
              AllOf(HasSubstr("Board: 6x4in, that is 152.4 x 101.6 mm"), HasSubstr("Lamp: above 24in, that is")));
  EXPECT_THAT(file_text(folder_ / "p" / "board.json"), AllOf(HasSubstr("152.4"), Not(HasSubstr("152.39"))));
  const Outcome bare = make({"q", "--board", "6x4", "--pictures", "a.png"});
  EXPECT_EQ(bare.exit_code, 1);
  EXPECT_THAT(bare.err, AllOf(HasSubstr("6 x 4 mm"), HasSubstr("6x4in, 6x4cm")));
}

// Dots that nothing on a board can show beside six large pictures.
TEST_F(NewProjectTest, PicturesThatCannotBeRecognizedAreNotPraised) {
  // Of a width that the preview's pixels do not hold.
  Image lines(1200, 800, 1, 1.0F);
  for (int y = 0; y < 800; y += 160)
    for (int x = 80; x < 1120; ++x) lines.at(x, y) = 0;
  write_picture(lines, folder_ / "lines.png");
  const Outcome made = make({"p", "--board", "6x4in", "--pictures", "a.png", "lines.png", "--count", "2000"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(made.err, HasSubstr("lines.png: is nearly white"));
  EXPECT_THAT(made.out, ::testing::ContainsRegex("lines [0-9.]+ dB \\((shows nothing of it|hard to recognize)\\)"));
  EXPECT_THAT(made.out, AllOf(HasSubstr(" of 128 px "), HasSubstr(" px that eyes ")));
}

TEST_F(NewProjectTest, TooManyPicturesForABoardAreSaidBeforeTheLoop) {
  std::vector<std::string> line{"p", "--board", "100x75", "--count", "3000", "--pictures"};
  for (int k = 0; k < 9; ++k) {
    Image image(120, 90, 1, 0.1F);
    for (int y = 0; y < 90; ++y)
      for (int x = 0; x < 120; ++x)
        if (((x / (4 + k)) + (y / (12 - k))) % 2 == 0) image.at(x, y) = 0.8F;
    line.push_back("p" + std::to_string(k) + ".png");
    write_picture(image, folder_ / line.back());
  }
  const Outcome made = make(line);
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(made.err, AllOf(HasSubstr("of the 9 pictures can hardly be recognized"),
                              HasSubstr("are small for so many"), HasSubstr("fewer pictures")));
}

TEST_F(NewProjectTest, ThePreviewNamesItsPictures) {
  ASSERT_EQ(make({"p", "--pictures", "a.png", "b.png", "--count", "300"}).exit_code, 0);
  for (const char* file : {"preview.png", "crops.png"}) {
    const Image picture = read_picture(folder_ / "p" / file);
    float brightest = 0;  // in the line of names
    for (int y = 0; y < (std::string(file) == "crops.png" ? 30 : 20); ++y)
      for (int x = 0; x < 60; ++x) brightest = std::max(brightest, picture.at(x, y));
    EXPECT_GT(brightest, 0.7F) << file;
  }
}

TEST_F(NewProjectTest, OnePictureGivenTwiceIsNoticed) {
  fs::copy_file(folder_ / "a.png", folder_ / "again.png");
  const Outcome made = make({"p", "--pictures", "a.png", "b.png", "again.png", "--count", "300"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(made.err, HasSubstr("a.png and again.png are the same picture"));
  EXPECT_THAT(made.err, Not(HasSubstr("b.png and")));
}

TEST_F(NewProjectTest, InAPipeWithoutArgumentsSaysWhatIsMissing) {
  const Outcome made = make({});
  EXPECT_EQ(made.exit_code, 2);
  EXPECT_THAT(made.err, AllOf(HasSubstr("DIR"), HasSubstr("burin new DIR --pictures")));
  EXPECT_EQ(make({"p"}).exit_code, 2);
  EXPECT_THAT(left_behind(), IsEmpty());
}

TEST_F(NewProjectTest, NothingIsOverwrittenOrLeftBehind) {
  fs::create_directory(folder_ / "full");
  folder_.write("full/mine.txt", "keep");
  const auto refuses = [&](const std::vector<std::string>& arguments, const std::string& why) {
    const Outcome made = make(arguments);
    EXPECT_EQ(made.exit_code, 1) << why;
    EXPECT_THAT(made.err, HasSubstr(why));
  };
  refuses({"full", "--pictures", "a.png"}, "not empty");
  refuses({"full/mine.txt", "--pictures", "a.png"}, "is a file");
  refuses({"p", "--pictures", "a.png", "missing.png"}, "missing.png");
  folder_.write("broken.jpg", "no picture");
  refuses({"p", "--pictures", "broken.jpg"}, "broken.jpg");
  write_picture(Image(40, 30, 1, 0.5F), folder_ / "flat.png");
  refuses({"p", "--pictures", "flat.png"}, "one tone");
  refuses({"p", "--board", "30x200", "--pictures", "a.png"}, "too small for tags");
  refuses({"p", "--board", "wide", "--pictures", "a.png"}, "width and height");
  refuses({"p", "--stand", "10cm", "--pictures", "a.png", "b.png", "c.png"}, "too near");
  refuses({"p", "--machine", "no-such", "--pictures", "a.png"}, "no-such");
  refuses({"p", "--lamp", "100,100,-5", "--pictures", "a.png"}, "behind");
  std::vector<std::string> ten{"p", "--pictures"};
  for (int i = 0; i < 10; ++i) ten.push_back("a.png");
  refuses(ten, "too many");
  EXPECT_EQ(make({"p", "--pictures", "a.png", "b.png", "c.png", "--fit", "cover", "contain"}).exit_code, 2);
  EXPECT_THAT(left_behind(), ::testing::UnorderedElementsAre("full", "broken.jpg"));
  EXPECT_EQ(file_text(folder_ / "full" / "mine.txt"), "keep");
}

TEST_F(NewProjectTest, PicturesOfOneNameAndOfAnyShape) {
  fs::create_directory(folder_ / "other");
  drawing(90, 200, folder_ / "other" / "a.png");
  drawing(100, 100, folder_ / "my cat (1).png");
  fs::create_directory(folder_ / "p");  // empty: that is as good as none
  const Outcome made = make({"p/", "--pictures", "a.png", "other/a.png", "my cat (1).png", "--count", "300"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const DesignSpec spec = read_design(folder_ / "p" / "design.json");
  EXPECT_EQ(spec.views[0].view, "a");
  EXPECT_EQ(spec.views[1].view, "a-2");
  EXPECT_EQ(spec.views[2].view, "my-cat-1");
  EXPECT_EQ(spec.views[2].target.picture.filename(), "my cat (1).png");
  EXPECT_EQ(read_picture(spec.views[1].target.picture).height, 200);
  // Twice as high as wide on a wide board: shown whole; a square keeps its top.
  EXPECT_EQ(spec.views[1].target.fit, Fit::contain);
  EXPECT_EQ(spec.views[2].target.keep, Keep::top);
  EXPECT_THAT(made.out, HasSubstr("shown whole"));
}

TEST_F(NewProjectTest, CropsAreSaidAndObeyed) {
  drawing(512, 512, folder_ / "square.png");
  const Outcome made = make({"p", "--board", "200x150", "--pictures", "square.png", "a.png", "--keep", "bottom",
                             "middle", "--fit", "cover", "contain", "--count", "300"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("square.png, 512 x 512 on "));
  EXPECT_THAT(made.out, HasSubstr("the top loses"));
  const DesignSpec spec = read_design(folder_ / "p" / "design.json");
  EXPECT_EQ(spec.views[0].target.keep, Keep::bottom);
  EXPECT_EQ(spec.views[1].target.fit, Fit::contain);
}

// A face is 64 pixels high where a board is three times as wide as high.
TEST_F(NewProjectTest, ALongBoardsPreviewIsNotCoarse) {
  const Outcome made = make({"p", "--board", "450x200", "--pictures", "a.png", "--count", "300"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr(" x 64 pixels, "));
}

// Pictures are read two at a time: they stay in their order, and of several faults the first picture's is told.
TEST(NewPictures, ReadAtTheSameTimeKeepTheirOrder) {
  const TemporaryFolder folder;
  std::vector<fs::path> files;
  for (int i = 0; i < 9; ++i) {
    Image image(i == 0 ? 900 : 40 + i, 30, 1, 0.2F);  // the first takes longest
    image.at(3, 3) = 0.9F;
    files.push_back(folder / "a.png");
    files.back().replace_filename("p" + std::to_string(i) + ".png");
    write_picture(image, files.back());
  }
  const std::vector<ChosenPicture> pictures = choose_pictures(files, 9);
  ASSERT_EQ(pictures.size(), 9U);
  for (int i = 0; i < 9; ++i) {
    EXPECT_EQ(pictures[static_cast<std::size_t>(i)].width, i == 0 ? 900 : 40 + i);
    EXPECT_EQ(pictures[static_cast<std::size_t>(i)].view, "p" + std::to_string(i));
  }
  write_picture(Image(1500, 1500, 1, 0.5F), files[4]);  // of one tone, known when it is read; the others at once
  folder.write("p5.png", "no picture");
  fs::remove(files[8]);
  for (int again = 0; again < 10; ++again)
    EXPECT_THAT([&] { choose_pictures(files, 9); }, ThrowsMessage<Error>(HasSubstr("p4.png: is of one tone")));
}

// A logo without ground: white ones shine on black, black ones need white, and it is said.
TEST(NewPictures, SeeThroughOnesAreLaidOnWhatShowsThem) {
  const TemporaryFolder folder;
  const auto logo = [&](float tone, const char* name) {
    const fs::path file = folder.path() / name;
    std::vector<float> pixels(80 * 60 * 4, 0.0F);
    for (int y = 0; y < 60; ++y)
      for (int x = 0; x < 80; ++x)
        if (std::hypot(x - 40, y - 30) < 20) {
          float* p = &pixels[static_cast<std::size_t>(4 * (80 * y + x))];
          p[0] = p[1] = p[2] = tone;
          p[3] = 1;
        }
    auto out = OIIO::ImageOutput::create(file.string());
    out->open(file.string(), OIIO::ImageSpec(80, 60, 4, OIIO::TypeDesc::UINT8));
    out->write_image(OIIO::TypeDesc::FLOAT, pixels.data());
    out->close();
    return file;
  };
  const ChosenPicture white = choose_pictures({logo(1, "white.png")}, 9).front();
  EXPECT_EQ(white.ground, "black");
  EXPECT_THAT(crop_in_words(white, {88, 66}), HasSubstr("is see-through, laid on black"));
  store_picture(white, folder.path());
  const Image stored = read_picture(folder.path() / white.stored);
  EXPECT_GT(stored.at(40, 30), 0.99F);
  EXPECT_LT(stored.at(2, 2), 0.01F);
  const ChosenPicture black = choose_pictures({logo(0, "black.png")}, 9).front();
  EXPECT_EQ(black.ground, "white");
  EXPECT_LT(black.small.at(40, 30), 0.01F);
  EXPECT_GT(black.small.at(2, 2), 0.99F);
  Image opaque(80, 60, 1, 0.2F);
  opaque.at(4, 4) = 1;
  write_picture(opaque, folder / "opaque.png");
  EXPECT_EQ(choose_pictures({folder / "opaque.png"}, 9).front().ground, "");
}

TEST(NewPictures, LargeOnesAreStoredSmaller) {
  const TemporaryFolder folder;
  Image large(5000, 40, 3, 0.1F);
  for (int x = 0; x < 2500; ++x)
    for (int y = 0; y < 40; ++y) large.at(x, y, 1) = 0.9F;
  write_picture(large, folder / "large.jpg");
  const std::vector<ChosenPicture> pictures = choose_pictures({folder / "large.jpg"}, 9);
  EXPECT_EQ(pictures[0].width, 5000);
  store_picture(pictures[0], folder.path());
  const fs::path stored = folder / "targets.jpg";
  ChosenPicture renamed = pictures[0];
  renamed.stored = "targets.jpg";
  store_picture(renamed, folder.path());
  EXPECT_EQ(read_picture(stored).width, 2400);
}

}  // namespace
}  // namespace burin

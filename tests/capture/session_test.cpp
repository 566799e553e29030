// Proves: session.json survives a round trip; every kind of bad manifest is refused with a message that names the file,
// the field and a remedy. Does not prove anything about pixels (photo_test.cpp).
#include "burin/capture/session.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "burin/base/error.h"
#include "burin/base/files/json_file.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

struct SessionTest : testing::Test {
  TemporaryFolder folder;
  fs::path file = folder / "session.json";

  SessionTest() {
    folder.write("board.json", "{}");
    folder.write("photos/a.png", "not read here");
    folder.write("photos/b.png", "not read here");
  }

  static std::string entry(const std::string& more = "") {
    return R"({"file": "photos/a.png", "view": "v00", "exposure_s": 0.5, "f_number": 8, "encoding": "linear")" + more +
           "}";
  }

  std::string error_of(const std::string& photos, const std::string& more = "") {
    folder.write("session.json", R"({"format": "burin/session", "version": 1, "board": "board.json")" + more +
                                     R"(, "photos": [)" + photos + "]}");
    try {
      read_session(file);
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  }
};

TEST_F(SessionTest, RoundTrip) {
  Session session;
  session.board = folder / "board.json";
  session.photos = {{folder / "photos/a.png", "v00", "lamp", 1.0 / 30, 100, 8, Encoding::srgb, {}, {}},
                    {folder / "photos/b.png", "v01", "other", 0.1, 250, 5.6, Encoding::raw, {}, {}}};
  write_session(session, file);
  const Session back = read_session(file);
  EXPECT_EQ(back.file, file);
  EXPECT_TRUE(fs::equivalent(back.board, session.board));
  ASSERT_EQ(back.photos.size(), 2U);
  for (int i = 0; i < 2; ++i) {
    EXPECT_TRUE(fs::equivalent(back.photos[i].file, session.photos[i].file));
    EXPECT_EQ(back.photos[i].view, session.photos[i].view);
    EXPECT_EQ(back.photos[i].light, session.photos[i].light);
    EXPECT_EQ(back.photos[i].exposure_s, session.photos[i].exposure_s);
    EXPECT_EQ(back.photos[i].iso, session.photos[i].iso);
    EXPECT_EQ(back.photos[i].f_number, session.photos[i].f_number);
    EXPECT_EQ(back.photos[i].encoding, session.photos[i].encoding);
  }
}

TEST_F(SessionTest, ALampOnTheCameraIsOneForEachView) {
  EXPECT_EQ(error_of(entry(R"(, "light": "torch", "on_camera": true)")), "no error");
  Session session = read_session(file);
  EXPECT_EQ(session.photos[0].light, "torch@v00");
  write_session(session, file);
  EXPECT_EQ(read_session(file).photos[0].light, "torch@v00");
  EXPECT_THAT(read_text(file), testing::HasSubstr("\"light\": \"torch\""));
}

TEST_F(SessionTest, PathsAreRelativeToTheManifest) {
  Session session;
  session.board = folder / "board.json";
  session.photos = {{folder / "photos/a.png", "v00", "lamp", 0.1, 100, 8, Encoding::linear, {}, {}}};
  fs::create_directories(folder / "out");
  write_session(session, folder / "out/session.json");
  std::ifstream in(folder / "out/session.json");
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  EXPECT_THAT(text, HasSubstr("\"../photos/a.png\""));
  EXPECT_THAT(text, HasSubstr("\"../board.json\""));
  // The whole tree may move.
  TemporaryFolder elsewhere;
  fs::copy(folder.path(), elsewhere / "moved", fs::copy_options::recursive);
  EXPECT_TRUE(fs::equivalent(read_session(elsewhere / "moved/out/session.json").photos[0].file,
                             elsewhere / "moved/photos/a.png"));
}

TEST_F(SessionTest, ErrorsNameFileFieldAndRemedy) {
  EXPECT_EQ(error_of(entry()), "no error");
  EXPECT_THAT(error_of(""), HasSubstr("at least one photo"));
  EXPECT_THAT(error_of(entry() + "," + entry()), HasSubstr("listed twice"));
  EXPECT_THAT(error_of(entry(R"(, "color": 1)")), HasSubstr("color"));
  EXPECT_THAT(error_of(entry(), R"(, "lens": 1)"), HasSubstr("lens"));
  EXPECT_THAT(
      error_of(R"({"file": "photos/a.png", "view": "v", "exposure_s": 0, "f_number": 8, "encoding": "linear"})"),
      HasSubstr("exposure_s"));
  EXPECT_THAT(error_of(R"({"file": "photos/a.png", "view": "v", "exposure_s": 1, "f_number": 8, "encoding": "log"})"),
              testing::AllOf(HasSubstr("\"log\""), HasSubstr("\"srgb\"")));
  EXPECT_THAT(
      error_of(R"({"file": "photos/z.png", "view": "v", "exposure_s": 1, "f_number": 8, "encoding": "linear"})"),
      testing::AllOf(HasSubstr("session.json"), HasSubstr("z.png")));
  EXPECT_THAT(error_of(R"({"file": "photos/a.png", "exposure_s": 1, "f_number": 8, "encoding": "linear"})"),
              HasSubstr("view"));
  EXPECT_THROW(read_session(folder / "none.json"), Error);
}

TEST_F(SessionTest, UnwritableFolder) {
  Session session;
  session.board = folder / "board.json";
  EXPECT_THROW(write_session(session, folder / "missing/session.json"), Error);
  EXPECT_FALSE(fs::exists(folder / "missing"));
}

TEST_F(SessionTest, ExposureFactorIsThatOfTheDesign) {
  const Photo photo{"p", "v", "lamp", 0.0125, 200, 8, Encoding::linear, {}, {}};
  EXPECT_DOUBLE_EQ(exposure_factor(photo), 0.0125 * 2 / 64);
  EXPECT_THROW(exposure_factor(Photo{"p", "v", "lamp", 0.0125, 100, 0, Encoding::linear, {}, {}}), Error);
}

}  // namespace
}  // namespace burin

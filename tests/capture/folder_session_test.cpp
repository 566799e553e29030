// Proves: a plain folder of photos becomes the session that a person would have written: brackets found by the
// pictures, not by the clock alone; what stands in the way of that is an error that names file and remedy, and then
// nothing is written. Photos come from the simulated camera; the rig's own truth says how its photos belong together.
// Also proves pre-flight's findings one by one (burin/capture/preflight.h), each next to a session that does not have
// it.
#include "burin/capture/folder_session.h"
#include "tests/places.h"

#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <random>

#include "burin/base/error.h"
#include "burin/capture/preflight.h"
#include "burin/scene/board.h"
#include "burin/simulate/simulated_camera.h"
#include "tests/capture/small_truth.h"

namespace burin {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using Severity = Finding::Severity;

// Three exposures from each of four places; each test changes a photo or two before `capture`.
struct FolderSessionTest : testing::Test {
  TemporaryFolder folder;
  Json json = small_truth();
  double tilt_deg = 25;

  FolderSessionTest() {
    json["samples"] = 16;
    json["session"] = false;
    json["sensor"]["gain"] = 12000;
    json["views"] = Json::array();
    for (int v = 0; v < 4; ++v) add_view(v, 8.0 * v, 0);
  }

  /// The board is tilted by 25 degrees, another way in each view, and lies shift_mm to the side; exposures two seconds
  /// apart, places a minute and a half.
  void add_view(int v, double shift_mm, int minute_offset, std::vector<double> exposures_s = {0.01, 0.04, 0.0025}) {
    Json view;
    view["view"] = "place" + std::to_string(v);
    // None of these mirrors the lamp.
    const std::array<Eigen::Vector2d, 4> tilts{{{1, 0}, {-1, 0}, {0, -1}, {0.5, -0.7}}};
    const Eigen::Vector2d turn = tilt_deg * std::numbers::pi / 180 * tilts[static_cast<std::size_t>(v % 4)];
    const Eigen::Matrix3d R =
        Eigen::Vector3d(1, -1, -1).asDiagonal() *
        Eigen::AngleAxisd(turn.norm(), Eigen::Vector3d(turn.x(), turn.y(), 0).normalized()).toRotationMatrix();
    const Eigen::Vector3d t = Eigen::Vector3d(shift_mm, 0, 400) - R * Eigen::Vector3d(50, 40, 0);
    for (int r = 0; r < 3; ++r) view["T_camera_board"].push_back({R(r, 0), R(r, 1), R(r, 2), t[r]});
    view["T_camera_board"].push_back({0, 0, 0, 1});
    for (std::size_t k = 0; k < exposures_s.size(); ++k) {
      const int s = 90 * v + 60 * minute_offset + 2 * static_cast<int>(k);
      char time[32];
      std::snprintf(time, sizeof time, "2024:05:01 12:%02d:%02d", s / 60, s % 60);
      view["photos"].push_back({{"file", "photos/IMG_" + std::to_string(100 + 10 * v + k) + ".png"},
                                {"exposure_s", exposures_s[k]},
                                {"f_number", 8},
                                {"datetime", time}});
    }
    json["views"].push_back(view);
  }

  void take_photos() { simulate(write_truth(folder, json), folder.path()); }

  CaptureResult capture() const { return capture_folder(folder / "photos", folder / "board.json", folder / "out"); }

  /// Reads a photo, lets the caller change pixels and header, writes it back.
  void change(const std::string& name, const std::function<void(std::vector<float>&, OIIO::ImageSpec&)>& how) const {
    const std::string file = (folder / "photos" / name).string();
    auto in = OIIO::ImageInput::open(file);
    OIIO::ImageSpec spec = in->spec();
    std::vector<float> pixels(spec.image_pixels() * spec.nchannels);
    ASSERT_TRUE(in->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, pixels.data()));
    in->close();
    how(pixels, spec);
    // TIFF keeps EXIF when OpenImageIO writes it; the PNG gives way.
    const std::string tiff = fs::path(file).replace_extension(".tif").string();
    auto out = OIIO::ImageOutput::create(tiff);
    ASSERT_TRUE(out->open(tiff, spec));
    ASSERT_TRUE(out->write_image(OIIO::TypeDesc::FLOAT, pixels.data()));
    ASSERT_TRUE(out->close());
    fs::remove(file);
  }

  static std::string text_of(const std::vector<Finding>& findings, Severity severity) {
    std::string text;
    for (const Finding& f : findings)
      if (f.severity == severity) text += sentence(f) + "\n";
    return text;
  }
};

TEST_F(FolderSessionTest, BracketsBecomeViews) {
  take_photos();
  const CaptureResult result = capture();
  EXPECT_EQ(text_of(result.findings, Severity::error), "");
  EXPECT_EQ(text_of(result.findings, Severity::warning), "");
  EXPECT_EQ(text_of(result.findings, Severity::note), "") << "their gAMA chunks state a linear curve";
  EXPECT_EQ(result.views, 4);
  const Session session = read_session(folder / "out/session.json");
  ASSERT_EQ(session.photos.size(), 12U);
  for (int i = 0; i < 12; ++i) {
    EXPECT_EQ(session.photos[i].view, "v0" + std::to_string(i / 3));
    EXPECT_EQ(session.photos[i].file.filename(), "IMG_" + std::to_string(100 + 10 * (i / 3) + i % 3) + ".png");
    EXPECT_EQ(session.photos[i].encoding, Encoding::linear);
  }
  EXPECT_NEAR(session.photos[1].exposure_s, 0.04, 1e-9);
  EXPECT_TRUE(fs::equivalent(session.board, folder / "board.json"));
}

// Photos a second apart from two places must not be merged, and one place kept for minutes is not torn by a slow hand.
TEST_F(FolderSessionTest, PicturesDecideNotTheClockAlone) {
  for (int v = 0; v < 4; ++v)
    for (int k = 0; k < 3; ++k) {
      char time[32];
      std::snprintf(time, sizeof time, "2024:05:01 12:00:%02d", 3 * v + k);
      json["views"][v]["photos"][k]["datetime"] = time;
    }
  take_photos();
  EXPECT_EQ(capture().views, 4);
  for (int v = 0; v < 4; ++v)
    for (int k = 0; k < 3; ++k) {
      char time[32];
      std::snprintf(time, sizeof time, "2024:05:01 12:%02d:%02d", (3 * v + k) * 40 / 60, (3 * v + k) * 40 % 60);
      json["views"][v]["photos"][k]["datetime"] = time;
    }
  take_photos();
  EXPECT_EQ(capture().views, 4);
}

// A hand-held bracket: 1.5 pixels between exposures. Merging would blur; each photo gets a pose of its own.
TEST_F(FolderSessionTest, ABracketThatMovedIsTakenApart) {
  add_view(4, 40, 0, {0.01});
  add_view(8, 40.75, -6, {0.02});  // tilted the same way, in the same minute
  take_photos();
  const CaptureResult result = capture();
  EXPECT_EQ(result.views, 6);
  EXPECT_THAT(text_of(result.findings, Severity::warning),
              AllOf(testing::ContainsRegex("1\\.[2-8] px aside"), HasSubstr("tripod")));
}

// A photo that lost its EXIF is left out, and the rest serves; where none has it, there is nothing to work with.
TEST_F(FolderSessionTest, MissingExif) {
  take_photos();
  const auto strip = [](auto&, OIIO::ImageSpec& spec) {
    spec.erase_attribute("ExposureTime");
    spec.erase_attribute("FNumber");
  };
  change("IMG_111.png", strip);
  const CaptureResult result = capture();
  EXPECT_THAT(
      text_of(result.findings, Severity::warning),
      AllOf(HasSubstr("IMG_111.tif: is left out"), HasSubstr("exposure time and aperture"), HasSubstr("exiftool")));
  EXPECT_EQ(result.session.photos.size(), 11U);
  EXPECT_EQ(result.views, 4);
  fs::remove_all(folder / "out");
  for (const auto& entry : fs::directory_iterator(folder / "photos"))
    if (entry.path().filename() != "IMG_111.tif") fs::remove(entry.path());
  const CaptureResult none = capture();
  EXPECT_THAT(text_of(none.findings, Severity::error), HasSubstr("IMG_111.tif"));
  EXPECT_TRUE(none.written.empty());
  EXPECT_FALSE(fs::exists(folder / "out"));
}

TEST_F(FolderSessionTest, BrokenPhotosAreNamed) {
  take_photos();
  const fs::path whole = folder / "photos/IMG_120.png";
  fs::resize_file(whole, fs::file_size(whole) / 2);
  folder.write("photos/IMG_121.png", "no picture");
  const CaptureResult result = capture();
  EXPECT_THAT(text_of(result.findings, Severity::error), AllOf(HasSubstr("IMG_120.png"), HasSubstr("IMG_121.png")));
  EXPECT_TRUE(result.written.empty());
}

TEST_F(FolderSessionTest, OtherFilesArePassedOver) {
  take_photos();
  folder.write("photos/notes.md", "f/8");
  folder.write("photos/notes.txt", "f/8");  // cameras and programs write such beside photos
  folder.write("photos/.hidden", "");
  const CaptureResult result = capture();
  EXPECT_EQ(result.session.photos.size(), 12U);
  EXPECT_THAT(text_of(result.findings, Severity::note), AllOf(HasSubstr("notes.md"), Not(HasSubstr("notes.txt"))));
}

// Two lamps: photos lie in the folder of theirs, and one place is one view under both, whatever its grooves show; the
// first photo under the second lamp is too dark for tags. A tripod that was touched between the lamps is told.
TEST_F(FolderSessionTest, FoldersNameTheLamps) {
  Json left = json["lights"][0];
  left["id"] = "left";
  left["position_mm"] = {-400, -60, 300};
  json["lights"].push_back(left);
  for (Json& view : json["views"]) {
    const Json photos = view["photos"];
    for (int k = 0; k < 3; ++k) {
      Json photo = photos[k];
      photo["light"] = "left";
      const std::string file = photo["file"], time = photo["datetime"];
      photo["file"] = "photos/Left/" + file.substr(7, 6) + std::to_string(5 + k) + ".png";
      if (k == 0) photo["exposure_s"] = 0.0002;
      const int seconds = std::stoi(time.substr(14, 2)) * 60 + std::stoi(time.substr(17)) + 30;
      char later[32];
      std::snprintf(later, sizeof later, "2024:05:01 12:%02d:%02d", seconds / 60, seconds % 60);
      photo["datetime"] = later;
      view["photos"].push_back(photo);
    }
  }
  take_photos();
  for (int v = 0; v < 4; ++v) {
    fs::create_directories(folder / "photos/lamp");
    for (int k = 0; k < 3; ++k) {
      const std::string name = "IMG_" + std::to_string(100 + 10 * v + k) + ".png";
      fs::rename(folder / "photos" / name, folder / "photos/lamp" / name);
    }
  }
  const auto captured = [&] {
    return capture_folder(folder / "photos", folder / "board.json", folder / "out", {}, {"", {"lamp", "left"}});
  };
  CaptureResult result = captured();
  EXPECT_EQ(text_of(result.findings, Severity::error), "");
  EXPECT_THAT(text_of(result.findings, Severity::warning), Not(HasSubstr("aside")));
  EXPECT_EQ(result.views, 4);
  const Session session = read_session(folder / "out/session.json");
  ASSERT_EQ(session.photos.size(), 24U);
  for (int i = 0; i < 24; ++i) {
    EXPECT_EQ(session.photos[i].view, "v0" + std::to_string(i / 6)) << session.photos[i].file;
    EXPECT_EQ(session.photos[i].light, i % 6 < 3 ? "lamp" : "left");
    EXPECT_TRUE(fs::exists(session.photos[i].file)) << session.photos[i].file;
  }
  // Without a clock, as the camera counted them; what shows no tags belongs nowhere then.
  for (int v = 0; v < 4; ++v) fs::remove(folder / "photos/Left" / ("IMG_1" + std::to_string(v) + "5.png"));
  change("lamp/IMG_100.png", [](auto&, OIIO::ImageSpec& spec) {
    for (const char* name : {"DateTime", "Exif:DateTimeOriginal", "Exif:DateTimeDigitized"})
      spec.attribute(name, "0000:00:00 00:00:00");
  });
  result = captured();
  EXPECT_THAT(text_of(result.findings, Severity::note), HasSubstr("in the order of their names"));
  EXPECT_EQ(result.views, 4);
}

TEST_F(FolderSessionTest, PhotosOfWhichNobodyKnowsTheLamp) {
  json["views"].erase(json["views"].begin() + 1, json["views"].end());
  take_photos();
  const auto capture_as = [&](const PhotoLamps& lamps) {
    return capture_folder(folder / "photos", folder / "board.json", folder / "out", {}, lamps);
  };
  EXPECT_THAT(
      [&] {
        capture_as({"", {"red", "the blue one"}});
      },
      testing::ThrowsMessage<Error>(AllOf(HasSubstr("IMG_100.png: and 2 more lie in no lamp's folder"),
                                          HasSubstr("photos/red and"), HasSubstr("photos/the_blue_one"))));
  EXPECT_EQ(capture_as({"red", {"red", "blue"}}).session.photos[0].light, "red") << "said";
  // A misspelled folder is no silent loss, nor one of a project with one lamp.
  fs::create_directories(folder / "photos/the blue one");
  fs::create_directories(folder / "photos/bleu");
  fs::rename(folder / "photos/IMG_100.png", folder / "photos/the blue one/IMG_100.png");
  fs::rename(folder / "photos/IMG_101.png", folder / "photos/bleu/IMG_101.png");
  CaptureResult result = capture_as({"red", {"red", "the blue one"}});
  EXPECT_THAT(text_of(result.findings, Severity::error), HasSubstr("bleu: holds photos, and no lamp of the bench"));
  EXPECT_TRUE(result.written.empty());
  result = capture_as({"red", {"red"}});
  EXPECT_THAT(text_of(result.findings, Severity::warning), HasSubstr("bleu: holds photos, and folders within"));
  EXPECT_EQ(result.session.photos.size(), 1U);
  fs::remove_all(folder / "photos/bleu");
  fs::remove(folder / "photos/IMG_102.png");
  result = capture_as({"", {"red", "the blue one"}});
  ASSERT_EQ(result.session.photos.size(), 1U);
  EXPECT_EQ(result.session.photos[0].light, "the blue one");
  EXPECT_EQ(lamp_folder(folder / "photos", "the blue one", {"red", "the blue one"}), folder / "photos/the blue one");
  EXPECT_EQ(lamp_folder(folder / "photos", "a b", {"a_b", "a b"}), folder / "photos/a_b-2");
}

TEST_F(FolderSessionTest, FoldersThatDoNotServe) {
  take_photos();
  const fs::path board = folder / "board.json";
  EXPECT_THROW(capture_folder(folder / "none", board, folder / "out"), Error);
  fs::create_directories(folder / "empty");
  EXPECT_THROW(capture_folder(folder / "empty", board, folder / "out"), Error);
  EXPECT_THROW(capture_folder(folder / "photos", folder / "none.json", folder / "out"), Error);
  folder.write("file", "");
  EXPECT_THROW(capture_folder(folder / "photos", board, folder / "file/out"), Error);
}

TEST_F(FolderSessionTest, SizesAndRotatedFiles) {
  take_photos();
  change("IMG_101.png", [](auto& pixels, OIIO::ImageSpec& spec) {
    spec.height = 200;
    spec.full_height = 200;
    pixels.resize(static_cast<std::size_t>(320) * 200);
  });
  change("IMG_112.png", [](auto&, OIIO::ImageSpec& spec) {
    std::swap(spec.width, spec.height);
    std::swap(spec.full_width, spec.full_height);
  });
  const std::string errors = text_of(capture().findings, Severity::error);
  EXPECT_THAT(errors,
              AllOf(HasSubstr("IMG_101.tif: is 320 x 200 pixels"), HasSubstr("IMG_112.tif"), HasSubstr("rotated")));
}

TEST_F(FolderSessionTest, FocalLengthCameraAndAperture) {
  take_photos();
  change("IMG_101.png", [](auto&, OIIO::ImageSpec& spec) { spec.attribute("Exif:FocalLength", 50.0F); });
  change("IMG_111.png", [](auto&, OIIO::ImageSpec& spec) { spec.attribute("Model", "Other"); });
  change("IMG_121.png", [](auto&, OIIO::ImageSpec& spec) { spec.attribute("Orientation", 6); });
  const CaptureResult result = capture();
  EXPECT_THAT(text_of(result.findings, Severity::error),
              AllOf(HasSubstr("IMG_101.tif: was taken at 50 mm"), HasSubstr("IMG_111.tif"), HasSubstr("Other")));
  EXPECT_THAT(text_of(result.findings, Severity::note), HasSubstr("orientation"));
}

TEST_F(FolderSessionTest, BlurClippingAndFalseExposures) {
  take_photos();
  change("IMG_110.png", [](auto& pixels, OIIO::ImageSpec&) {
    for (int pass = 0; pass < 6; ++pass) {  // a smear of a dozen pixels: the camera shook
      auto before = pixels;
      for (std::size_t i = 2; i + 2 < pixels.size(); ++i)
        pixels[i] = (before[i - 2] + before[i - 1] + before[i] + before[i + 1] + before[i + 2]) / 5;
      before = pixels;
      for (std::size_t i = 640; i + 640 < pixels.size(); ++i)
        pixels[i] = (before[i - 640] + before[i - 320] + before[i] + before[i + 320] + before[i + 640]) / 5;
    }
  });
  change("IMG_122.png", [](auto& pixels, OIIO::ImageSpec&) {
    for (float& v : pixels) v *= 0.8F;
  });
  const std::string warnings = text_of(capture().findings, Severity::warning);
  EXPECT_THAT(warnings, AllOf(HasSubstr("IMG_110.tif: is blurred"), HasSubstr("IMG_122.tif"), HasSubstr("darker")));
}

TEST_F(FolderSessionTest, TooBrightTooDarkTooFew) {
  json["views"].erase(json["views"].begin() + 2, json["views"].end());
  for (auto& photo : json["views"][0]["photos"]) photo["exposure_s"] = 2;
  for (auto& photo : json["views"][1]["photos"]) photo["exposure_s"] = 0.0001;
  take_photos();
  const std::string warnings = text_of(capture().findings, Severity::warning);
  EXPECT_THAT(warnings,
              AllOf(HasSubstr("clipped even in its shortest"), HasSubstr("is dark"), HasSubstr("2 places only")));
}

TEST_F(FolderSessionTest, ClippedPaper) {
  for (auto& photo : json["views"][1]["photos"]) photo["exposure_s"] = photo["exposure_s"].get<double>() * 150;
  take_photos();
  EXPECT_THAT(text_of(capture().findings, Severity::warning),
              AllOf(HasSubstr("white paper is clipped in every exposure of view v01"), HasSubstr("4 times shorter")));
}

TEST_F(FolderSessionTest, FewTags) {
  take_photos();
  for (const char* name : {"IMG_110.png", "IMG_111.png", "IMG_112.png"})
    change(name, [](auto& pixels, OIIO::ImageSpec& spec) {
      for (std::size_t i = 0; i < pixels.size(); ++i)
        if (i % static_cast<std::size_t>(spec.width) < 160) pixels[i] = 0;
    });
  EXPECT_THAT(text_of(capture().findings, Severity::warning), HasSubstr("view v01 shows 2 of the board's 4 tags"));
}

TEST_F(FolderSessionTest, NoTagsOfTheBoard) {
  take_photos();
  Json board = read_json(folder / "board.json", "burin/board", 1);
  board["tags"]["family"] = "tag25h9";
  folder.write("board.json", board.dump());
  const CaptureResult result = capture();
  EXPECT_THAT(text_of(result.findings, Severity::error),
              AllOf(HasSubstr("no photo shows a tag"), HasSubstr("tag25h9")));
  EXPECT_TRUE(result.written.empty());
}

TEST_F(FolderSessionTest, AlwaysFromOneSide) {
  json["views"] = Json::array();
  tilt_deg = 2;
  for (int v = 0; v < 4; ++v) add_view(v, 8.0 * v, 0);
  take_photos();
  EXPECT_THAT(text_of(capture().findings, Severity::warning), HasSubstr("from nearly one direction"));
}

// The zoom was touched, and the file does not tell.
TEST_F(FolderSessionTest, AnotherZoom) {
  json["views"] = Json::array();
  tilt_deg = 40;
  for (int v = 0; v < 4; ++v) add_view(v, 8.0 * v - 12, 0);
  take_photos();
  for (const char* name : {"IMG_110.png", "IMG_111.png", "IMG_112.png"})
    change(name, [](auto& pixels, OIIO::ImageSpec& spec) {
      const auto before = pixels;
      for (int y = 0; y < spec.height; ++y)
        for (int x = 0; x < spec.width; ++x) {
          const double u = 159.5 + (x - 159.5) / 1.4, v = 119.5 + (y - 119.5) / 1.4;
          const int i = static_cast<int>(u), j = static_cast<int>(v);
          const double a = u - i, b = v - j;
          const auto at = [&](int column, int row) { return before[static_cast<std::size_t>(row) * 320 + column]; };
          pixels[static_cast<std::size_t>(y) * 320 + x] = static_cast<float>(
              (1 - b) * ((1 - a) * at(i, j) + a * at(i + 1, j)) + b * ((1 - a) * at(i, j + 1) + a * at(i + 1, j + 1)));
        }
    });
  EXPECT_THAT(text_of(capture().findings, Severity::warning),
              AllOf(HasSubstr("fit a focal length"), HasSubstr("leave zoom and focus alone")));
}

// Seen from straight above every focal length fits at some distance: such a photo tells nothing of the zoom, whatever
// suits it best. (As a plan asks for: 1.2 degrees from the normal.) Here its pixels are 4 % wider than high, which a
// tilt of 16 degrees through a much longer lens would explain as well.
TEST_F(FolderSessionTest, APhotoFromStraightAboveIsNotBlamedForItsZoom) {
  json["views"] = Json::array();
  for (int v = 0; v < 4; ++v) {
    tilt_deg = v == 1 ? 1.2 : 40;
    add_view(v, 8.0 * v - 12, 0);
  }
  take_photos();
  for (const char* name : {"IMG_110.png", "IMG_111.png", "IMG_112.png"})
    change(name, [](auto& pixels, OIIO::ImageSpec& spec) {
      const auto before = pixels;
      for (int y = 0; y < spec.height; ++y)
        for (int x = 0; x < spec.width; ++x) {
          const double u = 159.5 + (x - 159.5) / 1.04;
          const int i = static_cast<int>(u);
          const auto at = [&](int column) { return before[static_cast<std::size_t>(y) * 320 + column]; };
          pixels[static_cast<std::size_t>(y) * 320 + x] =
              static_cast<float>((1 - (u - i)) * at(i) + (u - i) * at(i + 1));
        }
    });
  EXPECT_THAT(text_of(capture().findings, Severity::warning), Not(HasSubstr("fit a focal length")));
}

// The paper's width where the side that AprilTag reports is meant.
TEST_F(FolderSessionTest, AWrongSizeOfTheTags) {
  take_photos();
  EXPECT_THAT(text_of(capture().findings, Severity::error), Not(HasSubstr("size_mm")));
  Board board = read_board(folder / "board.json");
  for (Tag& tag : board.tags.list) tag.size_mm *= 1.25;  // tag36h11: ten modules of eight
  write_board(board, folder / "board.json");
  const CaptureResult result = capture();
  EXPECT_THAT(text_of(result.findings, Severity::error),
              AllOf(testing::ContainsRegex("tags are 0.(79|80|81) times as wide as size_mm"),
                    HasSubstr("it seems to be the paper's width"), HasSubstr("correct size_mm in board.json")));
  EXPECT_TRUE(result.written.empty());
}

TEST_F(FolderSessionTest, AViewThatIsDarkerThanItsExifSays) {
  take_photos();
  for (const char* name : {"IMG_120.png", "IMG_121.png", "IMG_122.png"})
    change(name, [](auto& pixels, OIIO::ImageSpec&) {
      for (float& v : pixels) v *= 0.5F;
    });
  EXPECT_THAT(text_of(capture().findings, Severity::warning),
              testing::ContainsRegex("IMG_12..tif: its paper is 0.5 times as bright"));
}

// One photo beside its bracket is flicker; the same in all views is the camera's curve, and told once.
TEST_F(FolderSessionTest, ACurveOfTheCamerasIsToldFromFlicker) {
  take_photos();
  change("IMG_120.png", [](auto& pixels, OIIO::ImageSpec&) {
    for (float& v : pixels) v *= 0.8F;
  });
  EXPECT_THAT(text_of(capture().findings, Severity::warning),
              testing::ContainsRegex("IMG_120.tif: is (19|20|21) % darker than its EXIF .*flicker"));
  fs::remove_all(folder / "photos");
  take_photos();
  for (int v = 0; v < 4; ++v)
    for (int k = 0; k < 3; ++k)
      change("IMG_" + std::to_string(100 + 10 * v + k) + ".png", [](auto& pixels, OIIO::ImageSpec&) {
        for (float& value : pixels) value = std::pow(value, 1.2F);
      });
  const std::vector<Finding> findings = capture().findings;
  EXPECT_THAT(text_of(findings, Severity::warning), Not(HasSubstr("flicker")));
  EXPECT_THAT(text_of(findings, Severity::note),
              AllOf(HasSubstr("in all views alike photos are"), HasSubstr("a curve of its own")));
}

TEST_F(FolderSessionTest, AWrittenSessionIsJudgedTheSameWay) {
  take_photos();
  const CaptureResult result = capture();
  ASSERT_FALSE(result.written.empty());
  const Session session = read_session(result.written);
  EXPECT_TRUE(preflight(session).empty());
  folder.write("photos/IMG_100.png", "no picture");
  EXPECT_THAT(text_of(preflight(session), Severity::error), HasSubstr("IMG_100.png"));
}

// One exposure of the sensor in several files is one measurement. Which file is kept, and of which others it is said,
// does not hang on names.
TEST_F(FolderSessionTest, OnePhotoPerShot) {
  take_photos();
  fs::copy_file(folder / "photos/IMG_111.png", folder / "photos/IMG_111 (1).png");
  // A cover with a tone curve of its own, under another stem, of every shot; one is smaller.
  const auto save_as = [&](const std::string& from, const std::string& to, const auto& how) {
    auto in = OIIO::ImageInput::open((folder / "photos" / from).string());
    OIIO::ImageSpec spec = in->spec();
    std::vector<float> pixels(spec.image_pixels() * spec.nchannels);
    ASSERT_TRUE(in->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, pixels.data()));
    for (float& v : pixels) v = how(v);
    spec.set_format(OIIO::TypeDesc::UINT8);
    spec.attribute("Compression", "jpeg:90");
    spec.erase_attribute("oiio:ColorSpace");
    auto out = OIIO::ImageOutput::create((folder / "photos" / to).string());
    ASSERT_TRUE(out->open((folder / "photos" / to).string(), spec));
    ASSERT_TRUE(out->write_image(OIIO::TypeDesc::FLOAT, pixels.data()));
  };
  const auto s_curve = [](float v) {
    const float stored = std::pow(std::clamp(v, 0.0F, 1.0F), 1 / 2.2F);
    return stored * stored * (3 - 2 * stored);
  };
  for (int v = 0; v < 4; ++v)
    for (int k = 0; k < 3; ++k) {
      const std::string shot = "IMG_" + std::to_string(100 + 10 * v + k);
      save_as(shot + ".png", "PXL_" + shot + ".COVER.jpg", s_curve);
    }
  const CaptureResult result = capture();
  EXPECT_EQ(text_of(result.findings, Severity::error), "");
  EXPECT_EQ(result.views, 4);
  ASSERT_EQ(result.session.photos.size(), 12U);
  for (const Photo& photo : result.session.photos) EXPECT_EQ(photo.file.extension(), ".png") << photo.file;
  EXPECT_THAT(text_of(result.findings, Severity::note),
              AllOf(HasSubstr("IMG_111 (1).png: holds the same bytes as IMG_111.png"),
                    HasSubstr(".COVER.jpg: was passed over for IMG_"), HasSubstr("11 more files likewise")));
}

TEST_F(FolderSessionTest, APhotoSavedAnewIsNoSecondMeasurement) {
  take_photos();
  for (const char* name : {"IMG_100.png", "IMG_112.png", "IMG_131.png"}) {
    const std::string copy = std::string(name).substr(0, 7) + "~2.png";
    fs::copy_file(folder / "photos" / name, folder / "photos" / copy);
    change(copy, [](auto& pixels, OIIO::ImageSpec&) {
      for (float& v : pixels) v = std::round(v * 1000) / 1000;
    });
  }
  // What a chat sends has a name of its own, shorter than the camera's, and less detail.
  fs::copy_file(folder / "photos/IMG_120.png", folder / "photos/WA1.png");
  change("IMG_120.png", [](auto&, OIIO::ImageSpec& spec) { spec.attribute("Compression", "zip"); });
  change("WA1.png", [](auto& pixels, OIIO::ImageSpec& spec) {
    spec.attribute("Compression", "zip");
    for (float& v : pixels) v = std::round(v * 200) / 200;
  });
  const CaptureResult result = capture();
  EXPECT_EQ(result.session.photos.size(), 12U);
  EXPECT_THAT(text_of(result.findings, Severity::note),
              AllOf(HasSubstr("IMG_100~2.tif: was passed over for IMG_100.png"),
                    HasSubstr("IMG_131~2.tif: was passed over for IMG_131.png"),
                    HasSubstr("WA1.tif: was passed over for IMG_120.tif")));
}

// A burst and a bracket share a second: none of these photos is another's copy. Repeats from a tripod have noise of
// their own.
TEST_F(FolderSessionTest, PhotosOfOneSecondAreDifferentPhotos) {
  json["views"] = Json::array();
  for (int v = 0; v < 4; ++v) add_view(v, 8.0 * v, 0, {0.01, 0.01, 0.04, 0.0025});
  for (auto& view : json["views"])
    for (auto& photo : view["photos"]) photo["datetime"] = "2024:05:01 12:00:00";
  take_photos();
  const CaptureResult result = capture();
  EXPECT_EQ(result.session.photos.size(), 16U) << text_of(result.findings, Severity::note);
  EXPECT_THAT(text_of(result.findings, Severity::note), Not(HasSubstr("passed over")));
}

// EXIF knows what the lamp and the lens cannot explain.
TEST_F(FolderSessionTest, FlashAndDigitalZoomAreKnownByExif) {
  take_photos();
  change("IMG_110.png", [](auto&, OIIO::ImageSpec& spec) { spec.attribute("Exif:Flash", 25); });
  change("IMG_121.png", [](auto&, OIIO::ImageSpec& spec) { spec.attribute("Exif:DigitalZoomRatio", 2.0F); });
  for (int v = 0; v < 4; ++v)
    for (int k = 0; k < 3; ++k)
      if (const std::string name = "IMG_" + std::to_string(100 + 10 * v + k) + ".png";
          fs::exists(folder / "photos" / name))
        change(name, [&](auto&, OIIO::ImageSpec& spec) {
          spec.attribute("Exif:FocalLength", 5.0F);
          spec.attribute("Exif:FocalLengthIn35mmFilm", v == 3 && k == 2 ? 39 : 26);
        });
  const CaptureResult result = capture();
  EXPECT_THAT(
      text_of(result.findings, Severity::warning),
      AllOf(HasSubstr("IMG_110.tif: is left out: by its EXIF the flash fired"),
            HasSubstr("IMG_121.tif: is left out: by its EXIF the camera zoomed digitally or cropped, 2 times"),
            HasSubstr("IMG_132.tif: is left out: by its EXIF the camera zoomed digitally or cropped, 1.5 times")));
  EXPECT_EQ(result.session.photos.size(), 9U);
}

// Cameras for measuring write gray of 16 bits, and that its colors are uncalibrated: gray has none.
TEST_F(FolderSessionTest, GrayOfUncalibratedColorsIsLinear) {
  take_photos();
  change("IMG_100.png", [](auto&, OIIO::ImageSpec& spec) {
    ASSERT_EQ(spec.nchannels, 1);
    spec.attribute("Exif:ColorSpace", 65535);
  });
  const CaptureResult result = capture();
  EXPECT_FALSE(has_errors(result.findings)) << text_of(result.findings, Severity::error);
  ASSERT_EQ(result.session.photos.size(), 12U);
  EXPECT_EQ(result.session.photos[0].encoding, Encoding::linear);
  EXPECT_THAT(text_of(result.findings, Severity::note), HasSubstr("IMG_100.tif: does not name its encoding"));
}

TEST_F(FolderSessionTest, ALensThatTheCameraDoesNotKnow) {
  take_photos();
  const auto forget = [](auto&, OIIO::ImageSpec& spec) {
    spec.erase_attribute("FNumber");
    spec.erase_attribute("Exif:ApertureValue");
  };
  change("IMG_100.png", forget);
  CaptureResult result = capture();
  EXPECT_THAT(text_of(result.findings, Severity::warning),
              AllOf(HasSubstr("IMG_100.tif: is left out: its EXIF holds no aperture"), HasSubstr("--f-number 8")));
  result = capture_folder(folder / "photos", folder / "board.json", folder / "out", {}, {Photo().light, {}}, 8);
  EXPECT_EQ(result.session.photos.size(), 12U);
  EXPECT_THAT(text_of(result.findings, Severity::note), HasSubstr("1 photo without an aperture in EXIF: f/8 is used"));
  for (int v = 0; v < 4; ++v)
    for (int k = 0; k < 3; ++k)
      if (v + k > 0) change("IMG_" + std::to_string(100 + 10 * v + k) + ".png", forget);
  result = capture();
  ASSERT_EQ(result.session.photos.size(), 12U);
  for (const Photo& photo : result.session.photos) EXPECT_EQ(photo.f_number, kAssumedAperture);
  EXPECT_THAT(text_of(result.findings, Severity::warning), HasSubstr("no photo holds an aperture in its EXIF"));
}

TEST_F(FolderSessionTest, ANeighboringShutterTimeIsNamed) {
  json["views"] = Json::array();
  for (int v = 0; v < 4; ++v) add_view(v, 8.0 * v, 0, {0.01, v == 2 ? 0.05 : 0.04, 0.0025});
  take_photos();
  EXPECT_THAT(text_of(capture().findings, Severity::note),
              HasSubstr("IMG_121.png: was exposed for 1/20 s where most views have 1/25 s"));
}

TEST_F(FolderSessionTest, TagsOfAnotherBoardAreNamed) {
  take_photos();
  TagSet tags = read_board(folder / "board.json").tags;
  std::vector<Finding> ignored;
  FolderSession taken = session_from(folder_source(folder / "photos", ignored), tags);
  // The same photo for somebody whose board has other tags.
  TagSet others = tags;
  for (Tag& tag : others.list) tag.id += 50;
  const PhotoLook other = look_at(taken.session.photos[1], &others);
  EXPECT_TRUE(other.tags.empty());
  EXPECT_EQ(other.stray_tags.size(), taken.looks[1].tags.size());
  EXPECT_TRUE(taken.looks[1].stray_tags.empty());
  taken.looks[1] = other;
  EXPECT_THAT(text_of(preflight(taken.session, taken.exif, taken.looks, tags), Severity::error),
              HasSubstr("its tags are not this board's: it shows 3, 4, 5"));
}

TEST_F(FolderSessionTest, PhotosInAFolderOfNoLampAreNamed) {
  take_photos();
  fs::rename(folder / "photos", folder / "Lampe");
  fs::create_directories(folder / "photos");
  fs::rename(folder / "Lampe", folder / "photos/Lampe");
  EXPECT_THAT([&] { capture(); }, testing::ThrowsMessage<Error>(HasSubstr("holds no photo but in Lampe")));
}

// The rig's truth says which photos belong together; only this test reads it.
class FolderSessionOfRig : public testing::TestWithParam<const char*> {};
TEST_P(FolderSessionOfRig, FindsWhichPhotosBelongTogether) {
  const fs::path rig = places::rig(GetParam());
  if (!fs::exists(rig / "truth.json")) GTEST_SKIP() << "needs the photographed bench " << rig;
  const BenchTruth truth = read_bench_truth(rig / "truth.json");
  TemporaryFolder out;
  const CaptureResult result = capture_folder(rig / "photos", rig / "board.json", out.path());
  ASSERT_FALSE(result.written.empty());
  std::size_t count = 0;
  for (const TruthView& view : truth.views) count += view.photos.size();
  ASSERT_EQ(result.session.photos.size(), count);
  std::size_t i = 0;
  for (const TruthView& view : truth.views)
    for (const TruthPhoto& photo : view.photos) {
      const Photo& found = result.session.photos[i++];
      EXPECT_EQ(found.file.filename(), photo.file.filename());
      EXPECT_EQ(found.view, view.name);
      EXPECT_DOUBLE_EQ(found.exposure_s, photo.photo.exposure_s);
      EXPECT_EQ(found.encoding, Encoding::srgb);
    }
}
INSTANTIATE_TEST_SUITE_P(Rigs, FolderSessionOfRig, testing::Values("b-small", "b"), places::as_test_name);

}  // namespace
}  // namespace burin

// Proves: what EXIF says is read from the kinds of files that photos come in, exactly; what it does not say stays
// unsaid; how values are encoded is taken from the file and, where it is silent, said to be assumed.
#include "burin/capture/exif.h"
#include "tests/places.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "burin/base/error.h"
#include "burin/simulate/simulated_camera.h"
#include "tests/capture/small_truth.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

struct ExifTest : testing::Test {
  TemporaryFolder folder;

  void write(const std::string& name, OIIO::TypeDesc type, const std::function<void(OIIO::ImageSpec&)>& change = {}) {
    OIIO::ImageSpec spec(16, 8, 3, type);
    if (change) change(spec);
    auto out = OIIO::ImageOutput::create((folder / name).string());
    ASSERT_TRUE(out->open((folder / name).string(), spec));
    ASSERT_TRUE(out->write_image(OIIO::TypeDesc::FLOAT, std::vector<float>(16 * 8 * 3, 0.5F).data()));
    ASSERT_TRUE(out->close());
  }
};

TEST_F(ExifTest, WhetherTheCameraChoseTheWhiteBalance) {
  for (const int code : {0, 1}) {
    write("a.jpg", OIIO::TypeDesc::UINT8, [&](OIIO::ImageSpec& spec) { spec.attribute("Exif:WhiteBalance", code); });
    ASSERT_TRUE(read_exif(folder / "a.jpg").auto_white.has_value());
    EXPECT_EQ(*read_exif(folder / "a.jpg").auto_white, code == 0);
  }
  write("b.jpg", OIIO::TypeDesc::UINT8);
  EXPECT_FALSE(read_exif(folder / "b.jpg").auto_white.has_value());
}

// What the simulated camera writes, in PNG and in JPEG, is what is read: fractions to the last digit.
TEST_F(ExifTest, SimulatedPhotosSayHowTheyWereTaken) {
  Json json = small_truth();
  json["exif"]["focal_35mm"] = 53;
  for (const bool jpeg : {false, true}) {
    const std::string name = jpeg ? "photos/v00.jpg" : "photos/v00.png";
    json["sensor"]["encoding"] = jpeg ? "srgb" : "linear";
    json["views"][0]["photos"][0]["file"] = name;
    json["views"][0]["photos"][0]["iso"] = 200;
    for (const double exposure_s : {1.0 / 60, 1.0 / 640, 0.3, 2.5}) {
      json["views"][0]["photos"][0]["exposure_s"] = exposure_s;
      simulate(write_truth(folder, json), folder / "out");
      const Exif exif = read_exif(folder / "out" / name);
      EXPECT_NEAR(exif.exposure_s.value_or(0), exposure_s, 1e-6 * exposure_s) << name;
      EXPECT_DOUBLE_EQ(exif.f_number.value_or(0), 8) << name;
      EXPECT_DOUBLE_EQ(exif.iso.value_or(0), 200) << name;
      EXPECT_DOUBLE_EQ(exif.focal_mm.value_or(0), 35) << name;
      EXPECT_DOUBLE_EQ(exif.focal_35mm.value_or(0), 53) << name;
      EXPECT_EQ(exif.model, "M12") << name;
      EXPECT_DOUBLE_EQ(exif.time_s.value_or(0), 1714564800) << "2024-05-01 12:00:00, " << name;
      EXPECT_EQ(exif.width, 320) << name;
      EXPECT_EQ(exif.orientation, 1) << name;
      EXPECT_EQ(encoding_of(exif).encoding, jpeg ? Encoding::srgb : Encoding::linear);
    }
  }
}

// As phones save them: exposure and clock are read, and values are sRGB.
TEST_F(ExifTest, HeicOfAPhone) {
  if (!OIIO::ImageOutput::create("x.heic")) GTEST_SKIP() << "this OpenImageIO writes no HEIC";
  OIIO::ImageSpec spec(64, 32, 3, OIIO::TypeDesc::UINT8);
  spec.attribute("ExposureTime", 1.0F / 60);
  spec.attribute("FNumber", 1.8F);
  spec.attribute("Exif:DateTimeOriginal", "2024:05:01 12:00:00");
  const std::string file = (folder / "IMG_1.HEIC").string();
  auto out = OIIO::ImageOutput::create(file);
  if (!out || !out->open(file, spec)) GTEST_SKIP() << "this libheif has no encoder";
  ASSERT_TRUE(out->write_image(OIIO::TypeDesc::FLOAT, std::vector<float>(64 * 32 * 3, 0.5F).data()));
  ASSERT_TRUE(out->close());
  EXPECT_TRUE(is_photo(file));
  const Exif exif = read_exif(file);
  EXPECT_EQ(exif.kind, "heif");
  EXPECT_NEAR(exif.exposure_s.value_or(0), 1.0 / 60, 1e-8);
  EXPECT_NEAR(exif.f_number.value_or(0), 1.8, 1e-6);
  EXPECT_DOUBLE_EQ(exif.time_s.value_or(0), 1714564800);
  EXPECT_EQ(encoding_of(exif).encoding, Encoding::srgb);
  EXPECT_FALSE(encoding_of(exif).assumed);
}

TEST_F(ExifTest, SilentFilesStaySilent) {
  write("p.jpg", OIIO::TypeDesc::UINT8);
  const Exif exif = read_exif(folder / "p.jpg");
  EXPECT_FALSE(exif.exposure_s);
  EXPECT_FALSE(exif.f_number);
  EXPECT_FALSE(exif.iso);
  EXPECT_FALSE(exif.time_s);
  EXPECT_FALSE(exif.focal_mm);
}

TEST_F(ExifTest, EncodingIsWhatTheFileSays) {
  const auto encoding = [&](const std::string& name) { return encoding_of(read_exif(folder / name)); };
  write("a.png", OIIO::TypeDesc::UINT16, [](OIIO::ImageSpec& s) { s.attribute("oiio:ColorSpace", "sRGB"); });
  EXPECT_EQ(encoding("a.png").encoding, Encoding::srgb);
  EXPECT_FALSE(encoding("a.png").assumed);
  write("b.png", OIIO::TypeDesc::UINT16, [](OIIO::ImageSpec& s) { s.attribute("oiio:ColorSpace", "Linear"); });
  EXPECT_EQ(encoding("b.png").encoding, Encoding::linear);
  EXPECT_FALSE(encoding("b.png").assumed) << "its gAMA chunk is 1";
  write("c.tif", OIIO::TypeDesc::UINT16);
  EXPECT_EQ(encoding("c.tif").encoding, Encoding::linear);
  EXPECT_TRUE(encoding("c.tif").assumed);
  write("d.tif", OIIO::TypeDesc::UINT8);
  EXPECT_EQ(encoding("d.tif").encoding, Encoding::srgb);
  EXPECT_TRUE(encoding("d.tif").assumed);
  write("e.exr", OIIO::TypeDesc::FLOAT);
  EXPECT_EQ(encoding("e.exr").encoding, Encoding::linear);
  EXPECT_FALSE(encoding("e.exr").assumed);
  write("f.jpg", OIIO::TypeDesc::UINT8);
  EXPECT_EQ(encoding("f.jpg").encoding, Encoding::srgb);
}

TEST_F(ExifTest, OrientationAndApexValues) {
  write("p.jpg", OIIO::TypeDesc::UINT8, [](OIIO::ImageSpec& s) {
    s.attribute("Orientation", 6);
    s.attribute("Exif:ShutterSpeedValue", 5.0F);  // 2^-5 s
    s.attribute("Exif:ApertureValue", 6.0F);      // f/8
  });
  const Exif exif = read_exif(folder / "p.jpg");
  EXPECT_EQ(exif.orientation, 6);
  EXPECT_NEAR(exif.exposure_s.value_or(0), 1.0 / 32, 1e-6);
  EXPECT_NEAR(exif.f_number.value_or(0), 8, 1e-4);
}

// Libraries hold whole numbers in 16 or 32 bits, as the kind of file has it.
TEST_F(ExifTest, WholeNumbersAreReadFromEveryKind) {
  for (const char* name : {"p.jpg", "p.tif"}) {
    write(name, OIIO::TypeDesc::UINT8, [](OIIO::ImageSpec& s) {
      s.attribute("Exif:FocalLengthIn35mmFilm", 39);
      s.attribute("Exif:Flash", 25);
    });
    const Exif exif = read_exif(folder / name);
    EXPECT_EQ(exif.focal_35mm.value_or(0), 39) << name;
    EXPECT_TRUE(exif.flash.value_or(false)) << name;
  }
  // OpenImageIO writes no ISO into a TIFF, and reads none: the other number's tag, 0xA405, becomes ISO's, 0x8827.
  std::string tiff = file_text(folder / "p.tif");
  const std::size_t entry = tiff.find(std::string("\x05\xA4\x03\0", 4));
  ASSERT_NE(entry, std::string::npos);
  EXPECT_EQ(read_exif(folder.write("q.tif", tiff.replace(entry, 2, "\x27\x88"))).iso.value_or(0), 39);
}

TEST_F(ExifTest, SensorIsAsWideAsItsPixelsAre) {
  const auto width = [&](float resolution, int unit, int counted) {
    write("p.jpg", OIIO::TypeDesc::UINT8, [&](OIIO::ImageSpec& s) {
      s.attribute("Exif:FocalPlaneXResolution", resolution);
      s.attribute("Exif:FocalPlaneResolutionUnit", unit);
      s.attribute("Exif:PixelXDimension", counted);
    });
    return read_exif(folder / "p.jpg").sensor_width_mm;
  };
  EXPECT_NEAR(width(4233.333F, 2, 6000).value_or(0), 36, 1e-3);  // 6000 pixels on 36 mm, an inch
  EXPECT_NEAR(width(1666.667F, 3, 6000).value_or(0), 36, 1e-3);  // a centimeter
  EXPECT_FALSE(width(300, 2, 6000));                             // a scan: half a meter
  EXPECT_FALSE(width(4233, 1, 6000));                            // no unit
  EXPECT_FALSE(width(0, 2, 6000));
}

TEST_F(ExifTest, NoPictureIsAnError) {
  EXPECT_THROW(read_exif(folder / "none.jpg"), Error);
  folder.write("text.jpg", "no picture");
  EXPECT_THROW(read_exif(folder / "text.jpg"), Error);
}

TEST_F(ExifTest, RigB) {
  const fs::path file = fs::path(places::rig("b-small")) / "photos/IMG_4128.JPG";
  const Exif exif = read_exif(file);
  EXPECT_DOUBLE_EQ(exif.exposure_s.value_or(0), 1.0 / 15);
  EXPECT_DOUBLE_EQ(exif.f_number.value_or(0), 9);
  EXPECT_DOUBLE_EQ(exif.focal_35mm.value_or(0), 53);
  EXPECT_EQ(exif.make, "Kestrel");
}

}  // namespace
}  // namespace burin

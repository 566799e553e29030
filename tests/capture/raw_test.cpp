// Proves: raw files give sensor values in proportion to light: a linear ramp stays one, the black level is gone, the
// maker's white is 1, red, green and blue get no white balance and no matrix, and a noted orientation turns nothing.
// The DNG is made by hand, from the DNG 1.4 specification. Does not prove anything about cameras' own formats, which
// LibRaw unpacks.
#include <gmock/gmock.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "burin/base/error.h"
#include "burin/capture/exif.h"
#include "burin/capture/photo.h"
#include "tests/drawn_dng.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

constexpr int kColumns = 320, kRows = 240, kBlack = 512, kWhite = 15000;

std::string dng(const std::vector<std::uint16_t>& pixels, int orientation) {
  Dng file;
  file.width = kColumns;
  file.height = kRows;
  file.black = kBlack;
  file.white = kWhite;
  file.orientation = orientation;
  file.pixels = pixels;
  return dng_file(file);
}

// Ramp along x: red 0.2 times, green 1 times, blue 0.5 times the light.
double light(int x) { return static_cast<double>(x) / kColumns; }
double share(int channel) { return channel == 0 ? 0.2 : channel == 1 ? 1.0 : 0.5; }

struct RawTest : testing::Test {
  TemporaryFolder folder;
  Photo photo{folder / "p.dng", "v00", "lamp", 0.02, 200, 8, Encoding::raw, {}, {}};

  void write(int orientation) {
    std::vector<std::uint16_t> pixels;
    for (int y = 0; y < kRows; ++y)
      for (int x = 0; x < kColumns; ++x) {
        const int channel = y % 2 == 0 ? (x % 2 == 0 ? 0 : 1) : (x % 2 == 0 ? 1 : 2);
        pixels.push_back(static_cast<std::uint16_t>(kBlack + light(x) * share(channel) * (kWhite - kBlack) + 0.5));
      }
    folder.write("p.dng", dng(pixels, orientation));
  }
};

TEST_F(RawTest, LinearRampInLinearRampOut) {
  for (const int orientation : {1, 6}) {
    write(orientation);
    const LinearPhoto p = read_photo(photo);
    ASSERT_EQ(p.value.width, kColumns) << "orientation " << orientation;
    ASSERT_EQ(p.value.height, kRows);
    ASSERT_EQ(p.value.channels, 3);
    // One raw level is 7e-5 of white; filling in the mosaic linearly is exact on a ramp. Borders are left out.
    for (int y = 8; y < kRows - 8; y += 7)
      for (int x = 8; x < kColumns - 8; ++x)
        for (int c = 0; c < 3; ++c)
          EXPECT_NEAR(p.value.at(x, y, c), light(x) * share(c), 2e-4) << x << " " << y << " " << c;
  }
}

TEST_F(RawTest, ClipsAtTheMakersWhite) {
  std::vector<std::uint16_t> pixels(static_cast<std::size_t>(kColumns) * kRows, kBlack + (kWhite - kBlack) / 2);
  for (int y = 100; y < 140; ++y)
    for (int x = 100; x < 140; ++x) pixels[y * kColumns + x] = kWhite + 800;
  folder.write("p.dng", dng(pixels, 1));
  const LinearPhoto p = read_photo(photo);
  EXPECT_FLOAT_EQ(p.value.at(120, 120, 1), 1);
  EXPECT_TRUE(p.clipped[120 * kColumns + 120]);
  EXPECT_FALSE(p.clipped[50 * kColumns + 50]);
  EXPECT_NEAR(p.value.at(50, 50, 0), 0.5, 1e-3) << "no exposure of LibRaw's own";
}

TEST_F(RawTest, ACutIsRefusedOrTakesNoPixel) {
  write(1);
  const std::string whole = file_text(photo.file);
  const std::vector<float> pixels = read_photo(photo).value.data;
  for (std::size_t percent = 0; percent < 100; ++percent) {
    folder.write("p.dng", whole.substr(0, whole.size() * percent / 100));
    try {
      EXPECT_EQ(read_photo(photo).value.data, pixels) << percent << " %";
    } catch (const Error& refused) {
      EXPECT_NE(std::string(refused.what()).find("p.dng"), std::string::npos);
    }
  }
}

TEST_F(RawTest, ExifIsRead) {
  write(6);
  const Exif exif = read_exif(photo.file);
  EXPECT_EQ(exif.kind, "raw");
  EXPECT_EQ(encoding_of(exif).encoding, Encoding::raw);
  EXPECT_NEAR(exif.exposure_s.value_or(0), 0.02, 1e-9);
  EXPECT_NEAR(exif.f_number.value_or(0), 8, 1e-6);
  EXPECT_FALSE(exif.iso) << "the file holds none";
  EXPECT_TRUE(is_raw(photo.file));
  std::filesystem::copy_file(photo.file, folder / "p.tif");
  EXPECT_TRUE(is_raw(folder / "p.tif")) << "by what it holds";
}

TEST_F(RawTest, WrongEncodingIsRefused) {
  write(1);
  photo.encoding = Encoding::linear;
  EXPECT_THROW(read_photo(photo), Error);
}

TEST_F(RawTest, CutShortIsRefused) {
  write(1);
  std::filesystem::resize_file(photo.file, std::filesystem::file_size(photo.file) / 2);
  EXPECT_THROW(read_photo(photo), Error);
}

}  // namespace
}  // namespace burin

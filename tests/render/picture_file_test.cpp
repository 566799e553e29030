// Proves: what kind a picture is and how large is known from its first bytes, as OpenImageIO knows it after opening;
// what claims to be larger than the limits, or than its file, is refused before a library takes memory for it; and
// pictures that lie on their side, are tiled or have alpha are read as before.
#include "burin/render/files/picture_file.h"

#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <map>

#include "burin/render/error.h"
#include "burin/render/image.h"
#include "burin/render/limits.h"
#include "burin/render/linear_picture.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

std::string bytes_of(std::uint64_t value, int bytes, bool big) {
  std::string out;
  for (int i = 0; i < bytes; ++i) out += static_cast<char>(value >> (8 * (big ? bytes - 1 - i : i)) & 0xFFU);
  return out;
}

std::string png_of(std::uint64_t width, std::uint64_t height) {
  return "\x89PNG\r\n\x1a\n" + bytes_of(13, 4, true) + "IHDR" + bytes_of(width, 4, true) + bytes_of(height, 4, true) +
         std::string("\x08\0\0\0\0", 5) + "crc.";
}

/// Writes waves through OpenImageIO; false where it has no writer for that kind.
bool write_with_oiio(const std::filesystem::path& file, OIIO::ImageSpec spec) {
  const auto out = OIIO::ImageOutput::create(file.string());
  if (!out) return false;
  std::vector<float> values(static_cast<std::size_t>(spec.width) * spec.height * spec.nchannels);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = 0.5F + 0.5F * std::sin(0.37F * static_cast<float>(i));
  return out->open(file.string(), spec) && out->write_image(OIIO::TypeDesc::FLOAT, values.data()) && out->close();
}

TEST(PictureFile, SizeAndKindAreReadFromTheHeader) {
  const TemporaryFolder folder;
  const std::map<std::string, std::string> kinds{
      {"a.png", "png"}, {"a.jpg", "jpeg"}, {"a.tif", "tiff"},  {"a.hdr", "hdr"}, {"a.exr", "openexr"},
      {"a.bmp", "bmp"}, {"a.gif", "gif"},  {"a.webp", "webp"}, {"a.ppm", "pnm"}, {"a.heic", "heif"}};
  int written = 0;
  for (const auto& [name, kind] : kinds) {
    // OpenImageIO 2.4 writes HEIF by rows of a multiple of 16 bytes, from beyond the picture's end where they are
    // others.
    const int width = kind == "heif" ? 64 : 67;
    if (!write_with_oiio(folder / name, OIIO::ImageSpec(width, 34, 3, OIIO::TypeDesc::UINT8))) continue;
    ++written;
    const PictureHeader header = read_picture_header(folder / name, false);
    EXPECT_EQ(header.kind, kind);
    if (kind != "heif") {  // tiles of a HEIC may be larger than the picture
      EXPECT_EQ(header.width, width) << name;
      EXPECT_EQ(header.height, 34) << name;
    }
    // Under another name it is the same picture.
    std::filesystem::copy_file(folder / name, folder / "other.txt", std::filesystem::copy_options::overwrite_existing);
    EXPECT_EQ(read_picture(folder / "other.txt").width, width) << name;
  }
  EXPECT_GE(written, 7);
}

// OpenImageIO 2.4 reads past a picture whose grid, or whose tile, is smaller than the container's word for it.
TEST(PictureFile, AHeicSmallerThanItsContainerSaysIsRefused) {
  const TemporaryFolder folder;
  const std::string file = (folder / "a.heic").string();
  if (!write_with_oiio(file, OIIO::ImageSpec(64, 64, 3, OIIO::TypeDesc::UINT8))) GTEST_SKIP() << "no encoder of HEIC";
  EXPECT_EQ(read_picture(file).height, 64);
  std::string bytes;
  {
    std::ifstream in(file, std::ios::binary);
    bytes.assign(std::istreambuf_iterator<char>(in), {});
  }
  std::size_t said = 0;
  for (std::size_t at = bytes.find("ispe"); at != std::string::npos; at = bytes.find("ispe", at + 4), ++said)
    bytes.replace(at + 12, 4, bytes_of(255, 4, true));
  ASSERT_GE(said, 1U);
  std::ofstream(file, std::ios::binary) << bytes;
  EXPECT_THAT([&] { read_picture(file); }, ThrowsMessage<Error>(HasSubstr("a.heic")));
}

// LibRaw writes past a Hasselblad's name, wherever the file has it.
TEST(PictureFile, AHasselbladsRawFileIsRefused) {
  const TemporaryFolder folder;
  const std::string head = "P6\n8 8\n255\n";
  for (const std::size_t at : {std::size_t{100}, std::size_t{(1 << 20) - 4}, std::size_t{1 << 20}}) {
    const auto file = folder.write("a.dng", head + std::string(at, 'x') + "HasselBLAD" + std::string(9, 'x'));
    EXPECT_THAT([&] { read_picture_header(file, true); },
                ThrowsMessage<Error>(AllOf(HasSubstr("a.dng"), HasSubstr("Hasselblad"), HasSubstr("export it"))));
    EXPECT_NO_THROW(read_picture_header(file, false)) << "no raw file";
  }
  EXPECT_NO_THROW(read_picture_header(folder.write("b.dng", head + "Hasselbla"), true));
}

TEST(PictureFile, WhatIsNoneOfOursIsNamed) {
  const TemporaryFolder folder;
  for (const char* bytes : {"%PDF-1.7 and more", "8BPS", "<svg xmlns=''/>", "x"})
    EXPECT_THAT([&] { read_picture_header(folder.write("a.png", bytes), false); },
                ThrowsMessage<Error>(AllOf(HasSubstr("no picture of a kind"), HasSubstr("use PNG"))))
        << bytes;
  EXPECT_THAT([&] { read_picture_header(folder.write("a.png", ""), false); },
              ThrowsMessage<Error>(HasSubstr("is empty")));
}

TEST(PictureFile, BombsAreRefusedByTheirHeaders) {
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& name, const std::string& bytes, const std::string& words) {
    EXPECT_THAT([&] { read_picture(folder.write(name, bytes)); }, ThrowsMessage<Error>(HasSubstr(words))) << name;
  };
  refused("wide.png", png_of(2'000'000'000, 1), "more than 100,000 on a side");
  refused("large.png", png_of(60'000, 60'000), "more than the 268,435,456");
  // Made libpng ask for 2 GB: a note that says so long a text. Before the pixels, and behind them.
  const auto chunk = [](const std::string& name, std::uint64_t length) {
    return bytes_of(length, 4, true) + name + std::string(300, 'x');
  };
  refused("note.png", png_of(12, 8) + chunk("tEXt", 2'000'000'000), "a chunk is longer than the file");
  refused("end.png", png_of(12, 8) + chunk("IDAT", 296) + chunk("eXIf", 1'800'000'000),
          "a chunk is longer than the file");
  refused("cut.png", "\x89PNG\r\n\x1a\n", "ends within its header");
  // A TIFF of 60,000 x 60,000; one whose tile is of a gigabyte; one whose directory is longer than the file.
  const auto tiff = [](std::vector<std::pair<int, std::uint64_t>> tags, std::uint64_t count) {
    std::string out = std::string("II*\0", 4) + bytes_of(8, 4, false) + bytes_of(count, 2, false);
    for (const auto& [tag, value] : tags)
      out += bytes_of(static_cast<std::uint64_t>(tag), 2, false) + bytes_of(4, 2, false) + bytes_of(1, 4, false) +
             bytes_of(value, 4, false);
    return out + bytes_of(0, 4, false);
  };
  refused("large.tif", tiff({{256, 60'000}, {257, 60'000}}, 2), "more than the 268,435,456");
  refused("tile.tif", tiff({{256, 100}, {257, 100}, {322, 32'768}, {323, 32'768}}, 4), "its tiles are of 32768");
  // Strips higher than their picture: OpenImageIO asked for 50 GB.
  refused("strip.tif", tiff({{256, 24}, {257, 24}, {278, 1'056'964'632}}, 3), "its strips are of 24 x 1056964632");
  refused("long.tif", tiff({{256, 100}}, 4000), "a directory is larger than the file");
  // 367 bytes that make OpenEXR ask for 1.95 GB: an attribute that says so long a value. And a window of 2^31 rows.
  const std::string exr = std::string("\x76\x2f\x31\x01\x02\0\0\0", 8);
  const auto attribute = [](const std::string& name, const std::string& type, std::uint64_t bytes) {
    return name + '\0' + type + '\0' + bytes_of(bytes, 4, false);
  };
  refused("long.exr", exr + attribute("comments", "string", 1'950'000'000) + std::string(300, 'x'),
          "an attribute is longer than the file");
  refused("tall.exr",
          exr + attribute("dataWindow", "box2i", 16) + bytes_of(0, 4, false) + bytes_of(0, 4, false) +
              bytes_of(9, 4, false) + bytes_of(2'000'000'000, 4, false) + std::string(1, '\0'),
          "more than 100,000 on a side");
  refused("tile.exr",
          exr + attribute("tiles", "tiledesc", 9) + bytes_of(1U << 20U, 4, false) + bytes_of(1U << 20U, 4, false) +
              std::string(2, '\0'),
          "its tiles are of 1048576");
  refused("large.heic",
          bytes_of(16, 4, true) + "ftypheic" + bytes_of(0, 4, true) + bytes_of(40, 4, true) + "meta" +
              bytes_of(0, 4, true) + bytes_of(20, 4, true) + "ispe" + bytes_of(0, 4, true) + bytes_of(32'000, 4, true) +
              bytes_of(32'000, 4, true) + bytes_of(0, 8, true),
          "more than the 268,435,456");
  refused("large.ppm", "P6\n# a comment\n70000 70000\n255\n", "more than the 268,435,456");
  refused("large.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 70000 +X 70000\n", "more than the 268,435,456");
  refused("large.bmp",
          "BM" + std::string(12, '\0') + bytes_of(40, 4, false) + bytes_of(70'000, 4, false) +
              bytes_of(70'000, 4, false) + std::string(40, '\0'),
          "more than the 268,435,456");
}

// All eight ways in which a camera may have been held, in color and gray, against the words of the standard (EXIF 2.3,
// tag 274): which side of the upright picture the stored row 0 is, and the stored column 0. (OpenImageIO 2.4's own
// turning exchanges 5 and 7.)
TEST(PictureFile, PicturesAreReadUpright) {
  const TemporaryFolder folder;
  const std::vector<std::pair<std::string, std::string>> sides{
      {"top", "left"}, {"top", "right"}, {"bottom", "right"}, {"bottom", "left"},
      {"left", "top"}, {"right", "top"}, {"right", "bottom"}, {"left", "bottom"}};
  constexpr int kWidth = 13, kHeight = 7;
  for (const int channels : {1, 3})
    for (int orientation = 1; orientation <= 8; ++orientation) {
      const auto file = folder / (std::to_string(channels) + "-" + std::to_string(orientation) + ".tif");
      OIIO::ImageSpec spec(kWidth, kHeight, channels, OIIO::TypeDesc::FLOAT);
      ASSERT_TRUE(write_with_oiio(folder / "stored.tif", spec));
      spec.attribute("Orientation", orientation);
      ASSERT_TRUE(write_with_oiio(file, spec));
      const Image stored = read_picture(folder / "stored.tif"), image = read_picture(file);
      const auto& [row_0, column_0] = sides[static_cast<std::size_t>(orientation) - 1];
      const bool lies = row_0 == "left" || row_0 == "right";
      ASSERT_EQ(image.width, lies ? kHeight : kWidth);
      ASSERT_EQ(image.height, lies ? kWidth : kHeight);
      for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
          int across = 0, down = 0;
          for (const auto& [side, distance] : {std::pair(row_0, y), std::pair(column_0, x)}) {
            if (side == "top") down = distance;
            if (side == "bottom") down = image.height - 1 - distance;
            if (side == "left") across = distance;
            if (side == "right") across = image.width - 1 - distance;
          }
          for (int c = 0; c < channels; ++c)
            ASSERT_EQ(image.at(across, down, c), stored.at(x, y, c)) << orientation << ": " << x << ", " << y;
        }
    }
}

// Tiles are read a row of tiles at a time; the last are only partly within the picture.
TEST(PictureFile, TiledPicturesAreTheSame) {
  const TemporaryFolder folder;
  for (const char* extension : {".tif", ".exr"}) {
    OIIO::ImageSpec spec(77, 53, 3, OIIO::TypeDesc::FLOAT);
    ASSERT_TRUE(write_with_oiio(folder / (std::string("rows") + extension), spec));
    spec.tile_width = spec.tile_height = 32;
    ASSERT_TRUE(write_with_oiio(folder / (std::string("tiles") + extension), spec));
    const Image rows = read_picture(folder / (std::string("rows") + extension));
    EXPECT_EQ(read_picture(folder / (std::string("tiles") + extension)).data, rows.data) << extension;
  }
}

TEST(PictureFile, LightIsWhatThePictureInColorGives) {
  const TemporaryFolder folder;
  for (const char* name : {"a.png", "a.exr"}) {
    ASSERT_TRUE(write_with_oiio(folder / name, OIIO::ImageSpec(31, 17, 3, OIIO::TypeDesc::FLOAT)));
    Image color = read_picture(folder / name);
    if (std::string(name) == "a.png")
      for (float& v : color.data) v = srgb_to_linear(std::clamp(v, 0.0F, 1.0F));
    EXPECT_EQ(read_linear_luminance(folder / name).data, luminance(color).data) << name;
  }
}

// 9000 x 8000 pixels are more than 64 million: squares of 4 pixels (9000 / 2000) are averaged while they are read.
TEST(PictureFile, VeryLargePicturesAreReadSmaller) {
  const TemporaryFolder folder;
  Image large(9000, 8000, 1);
  for (int y = 0; y < large.height; ++y)
    for (int x = 0; x < large.width; ++x) large.at(x, y) = static_cast<float>(x % 2);
  write_picture(large, folder / "a.png");
  int width = 0, height = 0;
  const Image small = read_large_picture(folder / "a.png", 2000, width, height);
  EXPECT_EQ(width, 9000);
  EXPECT_EQ(height, 8000);
  EXPECT_EQ(small.width, 2250);
  EXPECT_EQ(small.height, 2000);
  for (const float v : small.data) ASSERT_NEAR(v, 0.5F, 1e-6F);
  // Light is averaged, not what stands for it: half of the pixels are white.
  const Image light = read_linear_picture(folder / "a.png");
  EXPECT_EQ(light.width, 4500);
  for (const float v : light.data) ASSERT_NEAR(v, 0.5F, 1e-6F);
}

}  // namespace
}  // namespace burin

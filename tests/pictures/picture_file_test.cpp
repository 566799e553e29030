// Proves: what kind a picture is and how large is known from its first bytes, as OpenImageIO knows it after opening;
// what claims to be larger than the limits, or than its file, is refused before a library takes memory for it; and
// pictures that lie on their side, are tiled or have alpha are read as before.
#include "burin/pictures/picture_file.h"

#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <map>

#include "burin/base/error.h"
#include "burin/base/image.h"
#include "burin/base/limits.h"
#include "burin/pictures/linear_picture.h"
#include "burin/pictures/picture.h"
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
  const std::string head =
      "IHDR" + bytes_of(width, 4, true) + bytes_of(height, 4, true) + std::string("\x08\0\0\0\0", 5);
  const uLong sum = crc32(0, reinterpret_cast<const Bytef*>(head.data()), static_cast<uInt>(head.size()));
  return "\x89PNG\r\n\x1a\n" + bytes_of(13, 4, true) + head + bytes_of(sum, 4, true);
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
    const PictureHeader header = read_picture_header(folder / name);
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

/// A TIFF of one directory whose entries are of one word, or texts behind it.
std::string tiff_of(const std::vector<std::pair<int, std::uint64_t>>& words,
                    const std::vector<std::pair<int, std::string>>& texts = {}) {
  const std::size_t count = words.size() + texts.size();
  std::string out = std::string("II*\0", 4) + bytes_of(8, 4, false) + bytes_of(count, 2, false), behind;
  const std::size_t end = 8 + 2 + 12 * count + 4;
  const auto entry = [&](int tag, std::uint64_t type, std::uint64_t values, std::uint64_t value) {
    out += bytes_of(static_cast<std::uint64_t>(tag), 2, false) + bytes_of(type, 2, false) + bytes_of(values, 4, false) +
           bytes_of(value, 4, false);
  };
  for (const auto& [tag, value] : words) entry(tag, 4, 1, value);
  for (const auto& [tag, text] : texts) {
    entry(tag, 2, text.size(), end + behind.size());
    behind += text;
  }
  return out + bytes_of(0, 4, false) + behind;
}

// LibRaw writes past a Hasselblad's name. The file's maker decides, and not a word that stands somewhere else; where no
// maker is named, the word anywhere does.
TEST(PictureFile, AHasselbladsRawFileIsRefused) {
  const TemporaryFolder folder;
  const auto refused = ThrowsMessage<Error>(AllOf(HasSubstr("a.dng"), HasSubstr("Hasselblad"), HasSubstr("export it")));
  const std::vector<std::pair<int, std::uint64_t>> raw{{262, 32803}};
  for (const int tag : {271, 50708})
    EXPECT_THAT([&] { read_picture_header(folder.write("a.dng", tiff_of(raw, {{tag, "HasselBLAD X2D"}}))); }, refused);
  for (const std::size_t at : {std::size_t{100}, std::size_t{(1 << 20) - 4}, std::size_t{1 << 20}})
    EXPECT_THAT([&] { read_picture_header(folder.write("a.dng", tiff_of(raw) + std::string(at, 'x') + "hasselblad")); },
                refused);
  const std::string other = tiff_of({{256, 4}, {257, 4}, {258, 8}, {259, 7}, {262, 32803}, {273, 8}, {279, 8}},
                                    {{271, "Canon"}, {315, "by a friend of Hasselblad"}});
  EXPECT_EQ(read_picture_header(folder.write("b.dng", other)).kind, "raw");
}

TEST(PictureFile, ARawFileOfJpegXlIsNamed) {
  const TemporaryFolder folder;
  const std::string dng =
      tiff_of({{256, 4}, {257, 4}, {259, 52546}, {262, 34892}, {273, 8}, {279, 8}}, {{271, "Apple"}});
  EXPECT_THAT([&] { read_picture_header(folder.write("a.dng", dng)); },
              ThrowsMessage<Error>(AllOf(HasSubstr("JPEG XL"), HasSubstr("JPEG Lossless"))));
  const std::string tiff = tiff_of({{256, 4}, {257, 4}, {259, 50002}, {262, 2}, {273, 8}, {279, 8}});
  EXPECT_THAT([&] { read_picture_header(folder.write("a.tif", tiff)); },
              ThrowsMessage<Error>(AllOf(HasSubstr("TIFF compressed by JPEG XL"), HasSubstr("PNG"))));
}

// By its mark, its directories, or its name; and as a picture to be shown it is refused with the remedy, instead of the
// thumbnail in its first directory.
TEST(PictureFile, RawFilesAreKnownAndAreNoPictures) {
  const TemporaryFolder folder;
  const std::string tiff = tiff_of({{256, 4}, {257, 4}, {258, 8}, {273, 8}, {279, 16}});
  EXPECT_EQ(picture_kind(folder.write("a.tif", tiff)), "tiff");
  EXPECT_EQ(picture_kind(folder.write("a.nef", tiff)), "raw") << "its maker's own way is not known";
  EXPECT_EQ(picture_kind(folder.write("b.tif", tiff_of({{256, 4}, {257, 4}, {50706, 260}}))), "raw");
  EXPECT_EQ(picture_kind(folder.write("c.tif", tiff_of({{256, 4}, {262, 32803}}))), "raw");
  for (const std::string& mark : {std::string("FUJIFILMCCD-RAW 0201"), std::string("IIU\0\x18", 5), std::string("IIRO"),
                                  std::string("\0\0\0\x18"
                                              "ftypcrx ",
                                              12),
                                  std::string("II\x1a\0\0\0HEAPCCDR", 14)}) {
    const auto file = folder.write("x.jpg", mark + std::string(64, '\0'));
    EXPECT_EQ(picture_kind(file), "raw");
    EXPECT_THAT([&] { read_picture(file); },
                ThrowsMessage<Error>(AllOf(HasSubstr("camera's raw file"), HasSubstr("export it as JPEG or PNG"))));
  }
}

TEST(PictureFile, APhotosSidesAreThoseOfTheTagDetector) {
  const TemporaryFolder folder;
  const PictureLimits photo{limit::kPhotoPixels, "a photo", "", true};
  for (const auto& [width, height] : {std::pair(32'768, 20), std::pair(20, 32'768)}) {
    const auto file = folder / "a.png";
    ASSERT_TRUE(write_with_oiio(file, OIIO::ImageSpec(width, height, 1, OIIO::TypeDesc::UINT8)));
    EXPECT_THAT([&] { open_picture(file, photo); }, ThrowsMessage<Error>(HasSubstr("more than 32,767 on a side")));
    EXPECT_EQ(read_picture(file).width, width) << "a picture to be shown";
  }
  ASSERT_TRUE(write_with_oiio(folder / "b.png", OIIO::ImageSpec(32'767, 20, 1, OIIO::TypeDesc::UINT8)));
  EXPECT_NO_THROW(open_picture(folder / "b.png", photo));
}

// EXIF that OpenImageIO 2.4 passes over: behind a PNG's pixels, in its texts as they were written before it had a chunk
// for them, in a WebP. A picture lies on its side without it.
TEST(PictureFile, ExifIsReadWhereverItStands) {
  const TemporaryFolder folder;
  const std::string exif = tiff_of({{274, 6}});
  const auto chunk = [](const std::string& name, const std::string& bytes) {
    return bytes_of(bytes.size(), 4, true) + name + bytes + "crc.";
  };
  ASSERT_TRUE(write_with_oiio(folder / "a.png", OIIO::ImageSpec(40, 20, 3, OIIO::TypeDesc::UINT8)));
  const std::string png = file_text(folder / "a.png");
  const std::size_t pixels = png.find("IDAT") - 4, end = png.find("IEND") - 4;
  std::string text = "Raw profile type exif";
  text += std::string(1, '\0') + "\nexif\n" + std::to_string(exif.size()) + "\n";
  for (const char c : exif) {
    constexpr const char* kDigits = "0123456789abcdef";
    text += kDigits[static_cast<unsigned char>(c) / 16];
    text += kDigits[static_cast<unsigned char>(c) % 16];
  }
  const auto with = [&](std::size_t at, const std::string& more) {
    return folder.write("b.png", png.substr(0, at) + more + png.substr(at));
  };
  EXPECT_EQ(read_picture(folder / "a.png").width, 40);
  EXPECT_EQ(read_picture(with(end, chunk("eXIf", exif))).width, 20) << "behind the pixels";
  EXPECT_EQ(read_picture_header(with(pixels, chunk("tEXt", text))).exif, exif);
  // A TIFF's ISO, behind a place for EXIF; one that is none does no harm.
  const std::string tiff = tiff_of({{256, 4}, {257, 4}, {258, 8}, {273, 8}, {279, 16}, {34665, 96}}).append(96, '\0');
  const std::string notes = bytes_of(1, 2, false) + bytes_of(34855, 2, false) + bytes_of(3, 2, false) +
                            bytes_of(1, 4, false) + bytes_of(400, 4, false) + bytes_of(0, 4, false);
  EXPECT_EQ(read_picture_header(folder.write("a.tif", tiff.substr(0, 96) + notes)).iso, 400);
  EXPECT_EQ(read_picture_header(folder.write("b.tif", tiff.substr(0, 90))).iso, 0);
  if (!write_with_oiio(folder / "a.webp", OIIO::ImageSpec(40, 20, 3, OIIO::TypeDesc::UINT8))) return;
  const std::string webp = file_text(folder / "a.webp");
  const std::string extended =
      "VP8X" + bytes_of(10, 4, false) + bytes_of(8, 4, false) + bytes_of(39, 3, false) + bytes_of(19, 3, false) +
      webp.substr(12) + (webp.size() % 2 ? std::string(1, '\0') : "") + "EXIF" + bytes_of(exif.size() + 6, 4, false) +
      std::string("Exif\0\0", 6) + exif + (exif.size() % 2 ? std::string(1, '\0') : "");
  const auto file = folder.write("b.webp", "RIFF" + bytes_of(4 + extended.size(), 4, false) + "WEBP" + extended);
  EXPECT_EQ(read_picture(file).width, 20);
}

TEST(PictureFile, AnimationsAreKnown) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_with_oiio(folder / "a.png", OIIO::ImageSpec(8, 8, 3, OIIO::TypeDesc::UINT8)));
  EXPECT_FALSE(read_picture_header(folder / "a.png").moves);
  const std::string png = file_text(folder / "a.png");
  const std::size_t pixels = png.find("IDAT") - 4;
  EXPECT_TRUE(read_picture_header(folder.write("b.png", png.substr(0, pixels) + bytes_of(8, 4, true) + "acTL" +
                                                            bytes_of(2, 4, true) + bytes_of(0, 4, true) + "crc." +
                                                            png.substr(pixels)))
                  .moves);
  const std::string frame = "," + std::string("\0\0\0\0\x01\0\x01\0\0", 9) + std::string("\x02\x02\x44\x01\0", 5);
  const std::string head = "GIF89a" + std::string("\x01\0\x01\0\x80\0\0", 7) + std::string(6, '\0');
  EXPECT_FALSE(read_picture_header(folder.write("a.gif", head + frame + ";")).moves);
  EXPECT_TRUE(read_picture_header(folder.write("b.gif", head + frame + frame + ";")).moves);
}

TEST(PictureFile, WhatIsNoneOfOursIsNamed) {
  const TemporaryFolder folder;
  const std::map<std::string, std::string> words{
      {"%PDF-1.7 and more", "is a PDF"}, {"8BPS", "Photoshop"},
      {"<svg xmlns=''/>", "SVG"},        {"<?xml version='1.0'?>\n<!-- x -->\n<svg/>", "SVG"},
      {"\xFF\x0A more", "JPEG XL"},      {std::string("\0\0\0\x18", 4) + "ftypqt  ", "film"},
      {"x", "no picture of a kind"}};
  for (const auto& [bytes, word] : words) {
    const std::string file = folder.write("a.png", bytes);
    EXPECT_THAT([&] { read_picture_header(file); },
                ThrowsMessage<Error>(AllOf(HasSubstr("a.png"), HasSubstr(word), HasSubstr("PNG"))))
        << bytes;
  }
  EXPECT_THAT([&] { read_picture_header(folder.write("a.png", "")); }, ThrowsMessage<Error>(HasSubstr("is empty")));
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
  refused("large.tif", tiff_of({{256, 60'000}, {257, 60'000}, {259, 6}}), "more than the 268,435,456");
  refused("tile.tif", tiff_of({{256, 100}, {257, 100}, {322, 32'768}, {323, 32'768}}), "its tiles are of 32768");
  // Strips higher than their picture: OpenImageIO asked for 50 GB.
  refused("strip.tif", tiff_of({{256, 24}, {257, 24}, {278, 1'056'964'632}}), "its strips are of 24 x 1056964632");
  refused("long.tif", tiff_of({{256, 100}}).replace(8, 2, bytes_of(4000, 2, false)),
          "a directory is larger than the file");
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

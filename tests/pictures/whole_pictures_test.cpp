// Proves: a picture that was cut anywhere is refused, or has the pixels of the whole one; so is one that was cut and
// then ended by a marker or by other bytes; bytes behind a whole one, and a missing end marker, are no damage; holes
// and flipped bits are found as far as the file's coding shows them. Does not prove anything about pixels that are
// stored as they are: whatever stands there is a picture.
#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cctype>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "burin/base/error.h"
#include "burin/base/image.h"
#include "burin/pictures/picture.h"
#include "burin/pictures/picture_file.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr int kSide = 256;  // a multiple of 16: OpenImageIO 2.4 writes HEIF beyond other widths' end

struct Written {
  const char* name;
  const char* compression = "";
  int tile = 0, rows = 0;
  bool progressive = false;
  OIIO::TypeDesc::BASETYPE type = OIIO::TypeDesc::UINT8;
};

/// A picture that is neither flat nor noise; false if nothing here writes that kind.
bool write_waves(const std::filesystem::path& file, const Written& how) {
  OIIO::ImageSpec spec(kSide, kSide, 3, OIIO::TypeDesc(how.type));
  if (how.compression[0] != '\0') spec.attribute("compression", how.compression);
  if (how.tile > 0) spec.tile_width = spec.tile_height = how.tile;
  if (how.rows > 0) spec.attribute("tiff:RowsPerStrip", how.rows);
  if (how.progressive) spec.attribute("jpeg:progressive", 1);
  std::mt19937 random(11);
  std::vector<float> values(static_cast<std::size_t>(kSide) * kSide * 3);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto x = static_cast<float>(i / 3 % kSide), y = static_cast<float>(i / 3 / kSide);
    values[i] = 0.5F + 0.3F * std::sin(0.11F * x + static_cast<float>(i % 3)) * std::cos(0.07F * y) +
                0.1F * static_cast<float>(random() % 256) / 256;
  }
  const auto out = OIIO::ImageOutput::create(file.string());
  return out && out->open(file.string(), spec) && out->write_image(OIIO::TypeDesc::FLOAT, values.data()) &&
         out->close();
}

class WholePictures : public testing::TestWithParam<Written> {
 protected:
  TemporaryFolder folder;
  std::string whole;
  std::vector<float> pixels;

  void SetUp() override {
    const auto file = folder / GetParam().name;
    if (!write_waves(file, GetParam())) GTEST_SKIP() << "nothing here writes " << GetParam().name;
    whole = file_text(file);
    pixels = read_picture(file).data;
  }

  enum class Fate { refused, same, other };
  Fate fate_of(const std::string& bytes) {
    try {
      return read_picture(folder.write(std::string("t-") + GetParam().name, bytes)).data == pixels ? Fate::same
                                                                                                   : Fate::other;
    } catch (const Error&) {
      return Fate::refused;
    }
  }
  std::string part(int percent) const {
    return whole.substr(0, whole.size() * static_cast<std::size_t>(percent) / 100);
  }
};

TEST_P(WholePictures, ACutIsRefusedOrTakesNoPixel) {
  for (int percent = 0; percent < 100; ++percent) EXPECT_NE(fate_of(part(percent)), Fate::other) << percent << " %";
  EXPECT_EQ(fate_of(part(60)), Fate::refused);
}

TEST_P(WholePictures, BytesBehindTheEndAreNoDamage) {
  std::mt19937 random(2);
  std::string film(200'000, '\0');
  for (char& c : film) c = static_cast<char>(random());
  EXPECT_EQ(fate_of(whole + film), Fate::same) << "a motion photo";
  EXPECT_EQ(fate_of(whole + "\xFF\xDA"), Fate::same);
  EXPECT_EQ(fate_of(whole + "\xFF\xD9"), Fate::same);
}

const auto name_of_kind = [](const testing::TestParamInfo<Written>& info) {
  std::string name = info.param.name;
  for (char& c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  return name;
};

const std::vector<Written> kCoded{{"baseline.jpg"},
                                  {"lzw.tif", "lzw"},
                                  {"one-lzw.tif", "lzw", 0, kSide, false, OIIO::TypeDesc::UINT16},
                                  {"lzw-tiles.tif", "lzw", 64},
                                  {"packbits.tif", "packbits"},
                                  {"deflate.tif", "zip", 0, 0, false, OIIO::TypeDesc::UINT16},
                                  {"one-deflate.tif", "zip", 0, kSide},
                                  {"deflate-tiles.tif", "zip", 64},
                                  {"float.tif", "zip", 0, 0, false, OIIO::TypeDesc::FLOAT},
                                  {"p.png", "", 0, 0, false, OIIO::TypeDesc::UINT16},
                                  {"p.exr", "zip", 0, 0, false, OIIO::TypeDesc::HALF},
                                  {"p.heic"}};
const std::vector<Written> kOthers{{"progressive.jpg", "", 0, 0, true},
                                   {"none.tif", "none"},
                                   {"lines.tif", "none", 0, 1},
                                   {"tiles.tif", "none", 64},
                                   {"jpeg.tif", "jpeg"},
                                   {"p.webp"},
                                   {"p.bmp"},
                                   {"p.ppm"},
                                   {"p.hdr"},
                                   {"p.gif"}};

INSTANTIATE_TEST_SUITE_P(Coded, WholePictures, testing::ValuesIn(kCoded), name_of_kind);
INSTANTIATE_TEST_SUITE_P(Others, WholePictures, testing::ValuesIn(kOthers), name_of_kind);

// Kinds whose coding has a checksum, or lengths that damage changes.
class HolesInPictures : public WholePictures {};

TEST_P(HolesInPictures, AreFoundIfTheCodingShowsThem) {
  std::mt19937 random(5);
  int missed = 0;
  for (int hole = 0; hole < 40; ++hole) {
    std::string bytes = whole;
    const std::size_t at = whole.size() / 10 + random() % (whole.size() * 8 / 10);
    for (std::size_t i = at; i < std::min(at + 512, bytes.size()); ++i) bytes[i] = '\0';
    missed += fate_of(bytes) == Fate::other;
  }
  EXPECT_LE(missed, std::string(GetParam().name).ends_with(".jpg") ? 4 : 0)
      << "a JPEG's codes may fall into step again";
}

INSTANTIATE_TEST_SUITE_P(Coded, HolesInPictures, testing::ValuesIn(kCoded), name_of_kind);

class CutAndEnded : public WholePictures {};

// What a search for the end marker takes for a whole JPEG: it stands at the end, or somewhere in what follows.
TEST_P(CutAndEnded, AJpegIsRefused) {
  std::mt19937 random(3);
  std::string noise(100'000, '\0');
  for (char& c : noise) c = static_cast<char>(random());
  for (int percent = 5; percent < 100; percent += 5) {
    EXPECT_EQ(fate_of(part(percent) + "\xFF\xD9"), Fate::refused) << percent << " %";
    EXPECT_EQ(fate_of(part(percent) + noise), Fate::refused) << percent << " %, noise";
    EXPECT_EQ(fate_of(part(percent) + std::string(whole.size(), '\0')), Fate::refused) << percent << " %, zeros";
  }
  EXPECT_EQ(fate_of(whole.substr(0, whole.size() - 2)), Fate::same) << "without its end marker";
}

INSTANTIATE_TEST_SUITE_P(Kinds, CutAndEnded,
                         testing::Values(Written{"baseline.jpg"}, Written{"progressive.jpg", "", 0, 0, true}),
                         [](const auto& info) { return info.param.progressive ? "progressive" : "baseline"; });

TEST(WholePicturesByName, AZeroedTailOfAHeicIsFound) {
  const TemporaryFolder folder;
  if (!write_waves(folder / "a.heic", {"a.heic"})) GTEST_SKIP() << "no encoder of HEIC";
  std::string bytes = file_text(folder / "a.heic");
  for (std::size_t i = bytes.size() * 7 / 10; i < bytes.size(); ++i) bytes[i] = '\0';
  EXPECT_THAT([&] { read_picture(folder.write("b.heic", bytes)); }, ThrowsMessage<Error>(HasSubstr("ends in zeros")));
}

// Erased memory of a card, in a file of its full length. libde265 takes it for blocks without detail.
TEST(WholePicturesByName, AnErasedTailOfAHeicIsFound) {
  const TemporaryFolder folder;
  if (!write_waves(folder / "a.heic", {"a.heic"})) GTEST_SKIP() << "no encoder of HEIC";
  const std::string whole = file_text(folder / "a.heic");
  for (const char erased : {'\xff', '\xf6'}) {
    std::string bytes = whole;
    for (std::size_t i = std::min(bytes.size() * 7 / 10, bytes.size() - 1100); i < bytes.size(); ++i) bytes[i] = erased;
    EXPECT_THAT([&] { read_picture(folder.write("b.heic", bytes)); }, ThrowsMessage<Error>(HasSubstr("damaged")));
  }
}

// Each scan of a progressive JPEG goes over all of its pixels; a file of some kilobytes can ask for hours.
TEST(WholePicturesByName, AJpegOfThousandsOfScansIsRefused) {
  const TemporaryFolder folder;
  if (!write_waves(folder / "a.jpg", {"a.jpg", "", 0, 0, true})) GTEST_SKIP() << "no writer of progressive JPEG";
  const std::string bytes = file_text(folder / "a.jpg");
  const std::size_t scan = bytes.rfind("\xFF\xDA");
  ASSERT_NE(scan, std::string::npos);
  std::string many = bytes.substr(0, scan);
  for (int i = 0; i < 600; ++i) many += bytes.substr(scan, bytes.size() - 2 - scan);
  EXPECT_THAT([&] { read_picture(folder.write("many.jpg", many + "\xFF\xD9")); },
              ThrowsMessage<Error>(HasSubstr("more scans than 500")));
}

// The kind is what the first bytes are, whatever the name.
TEST(WholePicturesByName, NamesCountForNothing) {
  const TemporaryFolder folder;
  for (const Written& how : {Written{"a.jpg"}, Written{"a.png"}, Written{"a.bmp"}, Written{"a.webp"}, Written{"a.exr"},
                             Written{"a.tif"}, Written{"a.ppm"}, Written{"a.heic"}}) {
    if (!write_waves(folder / how.name, how)) continue;
    const std::string kind = picture_kind(folder / how.name), bytes = file_text(folder / how.name);
    EXPECT_FALSE(kind.empty()) << how.name;
    for (const char* name : {"IMG_1.jfif", "IMG_1.HIF", "IMG_1", "IMG_1.PNG", "IMG_1.mov"})
      EXPECT_EQ(picture_kind(folder.write(name, bytes)), kind) << how.name << " as " << name;
  }
  for (const char* bytes : {"P1 was taken at noon\n", "BM, the second\n", "GIF8", "RIFFxxxxAVI xxxx", "",
                            "\0\0\0\x14"
                            "ftypqt  \0\0\0\0qt  "})
    EXPECT_EQ(picture_kind(folder.write("a.jpg", bytes)), "") << bytes;
  const std::string film = std::string("\0\0\0\x18", 4) + "ftypmp42" + std::string(4, '\0') + "isommp42";
  EXPECT_EQ(picture_kind(folder.write("a.heic", film)), "");
  EXPECT_EQ(picture_kind(folder / "none"), "");
}

}  // namespace
}  // namespace burin

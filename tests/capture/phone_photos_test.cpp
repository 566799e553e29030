// Proves: photos in the kinds of files that phones, scanners and programs make are known by their first bytes; what
// lies beside them is passed over; and a HEIC's pixels are those of the sensor, however the phone was held, as a JPEG's
// are.
#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <libheif/heif.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "burin/base/error.h"
#include "burin/base/image.h"
#include "burin/capture/exif.h"
#include "burin/capture/photo.h"
#include "burin/capture/photo_source.h"
#include "burin/pictures/picture.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr int kHeicWidth = 96, kHeicHeight = 64;

Photo photo_at(const fs::path& file) {
  Photo photo;
  photo.file = file;
  photo.view = "v";
  photo.exposure_s = 0.01;
  photo.f_number = 8;
  photo.encoding = Encoding::srgb;
  return photo;
}

/// A slope to the right and down, red and green.
std::vector<std::uint8_t> two_slopes() {
  std::vector<std::uint8_t> rgb;
  for (int y = 0; y < kHeicHeight; ++y)
    for (int x = 0; x < kHeicWidth; ++x)
      for (const int v : {40 + 2 * x, 40 + 3 * y, 128}) rgb.push_back(static_cast<std::uint8_t>(v));
  return rgb;
}

struct FreeHeif {
  void operator()(heif_context* p) const { heif_context_free(p); }
  void operator()(heif_encoder* p) const { heif_encoder_release(p); }
  void operator()(heif_image* p) const { heif_image_release(p); }
  void operator()(heif_encoding_options* p) const { heif_encoding_options_free(p); }
};

/// A HEIC that asks its readers to turn it as EXIF's code says, by `irot` and `imir`; false without an encoder.
bool write_turned_heic(const fs::path& file, int orientation) {
  const std::unique_ptr<heif_context, FreeHeif> context(heif_context_alloc());
  heif_encoder* found = nullptr;
  if (heif_context_get_encoder_for_format(context.get(), heif_compression_HEVC, &found).code != heif_error_Ok)
    return false;
  const std::unique_ptr<heif_encoder, FreeHeif> encoder(found);
  heif_encoder_set_lossy_quality(encoder.get(), 90);
  heif_image* made = nullptr;
  heif_image_create(kHeicWidth, kHeicHeight, heif_colorspace_RGB, heif_chroma_interleaved_RGB, &made);
  const std::unique_ptr<heif_image, FreeHeif> image(made);
  heif_image_add_plane(made, heif_channel_interleaved, kHeicWidth, kHeicHeight, 8);
  int stride = 0;
  std::uint8_t* const rows = heif_image_get_plane(made, heif_channel_interleaved, &stride);
  const std::vector<std::uint8_t> rgb = two_slopes();
  for (int y = 0; y < kHeicHeight; ++y)
    std::copy_n(rgb.begin() + 3 * kHeicWidth * y, 3 * kHeicWidth, rows + static_cast<std::ptrdiff_t>(stride) * y);
  const std::unique_ptr<heif_encoding_options, FreeHeif> options(heif_encoding_options_alloc());
  options->image_orientation = static_cast<heif_orientation>(orientation);
  return heif_context_encode_image(context.get(), made, found, options.get(), nullptr).code == heif_error_Ok &&
         heif_context_write_to_file(context.get(), file.c_str()).code == heif_error_Ok;
}

TEST(PhonePhotos, AHeicIsReadAsTheSensorHasIt) {
  const TemporaryFolder folder;
  if (!write_turned_heic(folder / "1.heic", 1)) GTEST_SKIP() << "this libheif has no encoder";
  const Image upright = read_photo(photo_at(folder / "1.heic")).value;
  ASSERT_EQ(upright.width, kHeicWidth);
  ASSERT_EQ(upright.height, kHeicHeight);
  EXPECT_LT(upright.at(4, 4, 0), upright.at(90, 4, 0));
  EXPECT_LT(upright.at(4, 4, 1), upright.at(4, 60, 1));
  for (int orientation = 2; orientation <= 8; ++orientation) {
    const fs::path file = folder / (std::to_string(orientation) + ".heic");
    ASSERT_TRUE(write_turned_heic(file, orientation));
    EXPECT_EQ(read_photo(photo_at(file)).value.data, upright.data) << orientation;
    const Exif exif = read_exif(file);
    EXPECT_EQ(exif.width, kHeicWidth) << orientation;
    EXPECT_EQ(exif.height, kHeicHeight) << orientation;
    Image shown = read_picture(file);  // as a picture to be shown it is turned
    EXPECT_EQ(shown.width, orientation >= 5 ? kHeicHeight : kHeicWidth) << orientation;
    for (float& v : shown.data) v = srgb_to_linear(v);
    EXPECT_NE(shown.data, upright.data) << orientation;
  }
}

// Sizes that HEVC cannot code are filled up, and cropped again ("clap").
TEST(PhonePhotos, FillingIsNoPartOfAHeic) {
  const TemporaryFolder folder;
  OIIO::ImageSpec spec(80, 51, 3, OIIO::TypeDesc::UINT8);
  const auto out = OIIO::ImageOutput::create("a.heic");
  const std::string file = (folder / "a.heic").string();
  if (!out || !out->open(file, spec)) GTEST_SKIP() << "nothing here writes HEIC";
  ASSERT_TRUE(out->write_image(OIIO::TypeDesc::FLOAT, std::vector<float>(80 * 51 * 3, 0.5F).data()) && out->close());
  EXPECT_EQ(read_exif(file).height, 51);
  const Image value = read_photo(photo_at(file)).value;
  EXPECT_EQ(value.height, 51);
  for (const float v : value.data) ASSERT_NEAR(v, srgb_to_linear(0.5F), 0.03F);
}

TEST(PhonePhotos, AFolderIsJudgedByFirstBytes) {
  const TemporaryFolder folder;
  OIIO::ImageSpec spec(16, 16, 3, OIIO::TypeDesc::UINT8);
  float gray = 0.4F;  // each its own: a copy would be passed over
  const auto write = [&](const std::string& written, const std::string& name) {
    gray += 0.05F;
    const auto out = OIIO::ImageOutput::create(written);
    ASSERT_TRUE(out && out->open((folder / written).string(), spec));
    ASSERT_TRUE(out->write_image(OIIO::TypeDesc::FLOAT, std::vector<float>(16 * 16 * 3, gray).data()) && out->close());
    fs::rename(folder / written, folder / name);
  };
  write("w.jpg", "IMG_1.jfif");
  write("w.png", "IMG_2");
  write("w.bmp", "IMG_3.BMP");
  write("w.tif", "IMG_4.JPG");
  write("w.jpg", "IMG_5.dat");
  write("w.jpg", "MVI_6.THM");
  folder.write("MVI_6.MOV", std::string("\0\0\0\x14", 4) + "ftypqt  ");
  folder.write("IMG_1.xmp", "<x:xmpmeta/>");
  folder.write("IMG_1.AAE", "<plist/>");
  folder.write(".DS_Store", "Bud1");
  folder.write("._IMG_1.jfif", "AppleDouble");
  folder.write("Thumbs.db", "x");
  folder.write("notes.md", "P1 is the best");
  std::vector<Finding> findings;
  std::vector<std::string> names;
  const PhotoSource source = folder_source(folder.path(), findings);
  while (const auto photo = source()) {
    EXPECT_EQ(photo->unreadable, "");
    names.push_back(photo->file.filename().string());
  }
  EXPECT_THAT(names, ElementsAre("IMG_1.jfif", "IMG_2", "IMG_3.BMP", "IMG_4.JPG", "IMG_5.dat"));
  ASSERT_EQ(findings.size(), 1U) << "what lies beside photos is passed over without a word";
  EXPECT_THAT(findings[0].file.string(), HasSubstr("notes.md"));
}

// A photo by its name that holds none is damage, which nobody may pass over.
TEST(PhonePhotos, APhotosNameWithOtherBytesIsSaid) {
  const TemporaryFolder folder;
  folder.write("IMG_1.JPG", std::string(5000, '\0'));
  std::vector<Finding> findings;
  const auto photo = folder_source(folder.path(), findings)();
  ASSERT_TRUE(photo);
  EXPECT_THAT(photo->unreadable, HasSubstr("IMG_1.JPG"));
}

TEST(PhonePhotos, APanoramaIsRefusedBeforeItsTagsAreSought) {
  const TemporaryFolder folder;
  OIIO::ImageSpec spec(32'768, 20, 1, OIIO::TypeDesc::UINT8);
  const auto out = OIIO::ImageOutput::create("a.png");
  ASSERT_TRUE(out && out->open((folder / "a.png").string(), spec));
  ASSERT_TRUE(out->write_image(OIIO::TypeDesc::FLOAT, std::vector<float>(32'768 * 20, 0.5F).data()) && out->close());
  const auto refused = ThrowsMessage<Error>(AllOf(HasSubstr("a.png"), HasSubstr("32,767 on a side")));
  EXPECT_THAT([&] { read_exif(folder / "a.png"); }, refused);
  EXPECT_THAT([&] { read_photo(photo_at(folder / "a.png")); }, refused);
}

// Behind a PNG's pixels, as ImageMagick writes it.
TEST(PhonePhotos, ExposureBehindThePixelsOfAPngIsRead) {
  const TemporaryFolder folder;
  OIIO::ImageSpec spec(16, 16, 3, OIIO::TypeDesc::UINT8);
  spec.attribute("ExposureTime", 1.0F / 60);
  spec.attribute("FNumber", 8.0F);
  spec.attribute("Exif:PhotographicSensitivity", 200);
  for (const char* name : {"a.jpg", "a.png"}) {
    const auto out = OIIO::ImageOutput::create(name);
    ASSERT_TRUE(out && out->open((folder / name).string(), spec));
    ASSERT_TRUE(out->write_image(OIIO::TypeDesc::FLOAT, std::vector<float>(16 * 16 * 3, 0.5F).data()) && out->close());
  }
  const std::string jpeg = file_text(folder / "a.jpg"), png = file_text(folder / "a.png");
  const std::size_t exif = jpeg.find(std::string("Exif\0\0", 6)), end = png.find("IEND") - 4;
  ASSERT_NE(exif, std::string::npos);
  const auto byte = [&](std::size_t at) { return static_cast<unsigned char>(jpeg[at]); };
  const std::size_t length = byte(exif - 2) * 256U + byte(exif - 1) - 2;
  const std::string bytes = jpeg.substr(exif + 6, length - 6);
  std::string chunk{'\0', '\0', static_cast<char>(bytes.size() / 256), static_cast<char>(bytes.size() % 256)};
  chunk += "eXIf" + bytes + "crc.";
  const Exif read = read_exif(folder.write("b.png", png.substr(0, end) + chunk + png.substr(end)));
  EXPECT_NEAR(read.exposure_s.value_or(0), 1.0 / 60, 1e-6);
  EXPECT_NEAR(read.f_number.value_or(0), 8, 1e-6);
  EXPECT_NEAR(read.iso.value_or(0), 200, 1e-6);
}

}  // namespace
}  // namespace burin

// Proves: stored values become linear ones as docs/model.md 5 says (exact values at known pixels, 12-bit white, sRGB,
// EXIF orientation left alone); brackets merge without bias and with sigmas that hold (synthetic photos with known
// noise); replay is bit-identical whatever the number of threads; broken files are refused by name. Real photos: the
// benches beside the checkout, where the sensor's electrons are known.
#include "burin/capture/photo.h"
#include "tests/places.h"

#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>
#include <tbb/global_control.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>

#include "burin/base/error.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

template <typename T>
void write_pixels(const fs::path& file, OIIO::ImageSpec spec, const std::vector<T>& pixels) {
  auto out = OIIO::ImageOutput::create(file.string());
  ASSERT_TRUE(out && out->open(file.string(), spec)) << file;
  ASSERT_TRUE(out->write_image(OIIO::BaseTypeFromC<T>::value, pixels.data()));
  ASSERT_TRUE(out->close());
}

std::string error_of(const Photo& photo) {
  try {
    read_photo(photo);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

// A photo with known noise: 12 bits in the high end of 16.
void write_noisy(const fs::path& file, const Image& truth, double exposure, double electrons, double read_e,
                 unsigned seed) {
  std::mt19937 random(seed);
  std::vector<std::uint16_t> stored(truth.data.size());
  for (std::size_t i = 0; i < stored.size(); ++i) {
    const double mean = truth.data[i] * exposure * electrons;
    const double e = std::poisson_distribution<int>(mean)(random) + read_e * std::normal_distribution<>()(random);
    stored[i] = static_cast<std::uint16_t>(std::lround(std::clamp(e / electrons, 0.0, 1.0) * 4095)) * 16;
  }
  write_pixels(file, OIIO::ImageSpec(truth.width, truth.height, truth.channels, OIIO::TypeDesc::UINT16), stored);
}

struct PhotoTest : testing::Test {
  TemporaryFolder folder;
  Photo photo(const std::string& name, Encoding encoding, double exposure_s = 1) const {
    return {folder / name, "v00", "lamp", exposure_s, 100, 1, encoding, {}, {}};
  }
};

TEST_F(PhotoTest, TwelveBitsInSixteenHaveTheirOwnWhite) {
  std::vector<std::uint16_t> stored{0, 16, 32752, 62000, 65504, 65520};
  for (auto& v : stored) v = v / 16 * 16;
  write_pixels(folder / "p.png", OIIO::ImageSpec(3, 2, 1, OIIO::TypeDesc::UINT16), stored);
  const LinearPhoto p = read_photo(photo("p.png", Encoding::linear));
  EXPECT_EQ(p.value.data[0], 0);
  EXPECT_FLOAT_EQ(p.value.data[1], 1.0F / 4095);
  EXPECT_FLOAT_EQ(p.value.data[5], 1);
  EXPECT_NEAR(p.stored.step, 1.0 / 4095, 1e-12);
  EXPECT_THAT(p.clipped, testing::ElementsAre(0, 0, 0, 0, 1, 1));
}

TEST_F(PhotoTest, SixteenBitsKeepTheirWhite) {
  write_pixels(folder / "p.tif", OIIO::ImageSpec(3, 1, 1, OIIO::TypeDesc::UINT16),
               std::vector<std::uint16_t>{1, 32767, 65535});
  const LinearPhoto p = read_photo(photo("p.tif", Encoding::linear));
  EXPECT_FLOAT_EQ(p.value.data[0], 1.0F / 65535);
  EXPECT_FLOAT_EQ(p.value.data[2], 1);
}

TEST_F(PhotoTest, SrgbIsDecodedPerValue) {
  std::vector<std::uint8_t> stored{0, 10, 128, 200, 250, 255};
  write_pixels(folder / "p.png", OIIO::ImageSpec(2, 1, 3, OIIO::TypeDesc::UINT8), stored);
  const LinearPhoto p = read_photo(photo("p.png", Encoding::srgb));
  ASSERT_EQ(p.value.channels, 3);
  // IEC 61966-2-1, worked by hand.
  EXPECT_NEAR(p.value.data[1], 10.0 / 255 / 12.92, 1e-7);
  EXPECT_NEAR(p.value.data[2], 0.2158605, 1e-6);
  EXPECT_NEAR(p.value.data[5], 1, 1e-7);
  EXPECT_THAT(p.clipped, testing::ElementsAre(0, 1));
}

TEST_F(PhotoTest, FloatFilesAndAlpha) {
  write_pixels(folder / "p.exr", OIIO::ImageSpec(2, 1, 4, OIIO::TypeDesc::FLOAT),
               std::vector<float>{0.25F, 0.5F, 0.75F, 0.5F, NAN, 0, 0, 1});
  const LinearPhoto p = read_photo(photo("p.exr", Encoding::linear));
  ASSERT_EQ(p.value.channels, 3);
  EXPECT_EQ(p.value.data[2], 0.75F);
  EXPECT_TRUE(std::isfinite(p.value.data[3]));
  EXPECT_THAT(p.clipped, testing::ElementsAre(0, 1));
}

// An EXIF orientation must not turn pixels: the bright corner stays where the sensor had it.
TEST_F(PhotoTest, OrientationIsNotApplied) {
  for (const char* name : {"p.jpg", "p.tif"}) {
    OIIO::ImageSpec spec(48, 32, 3, OIIO::TypeDesc::UINT8);
    spec.attribute("Orientation", 6);
    std::vector<std::uint8_t> stored(48 * 32 * 3, 20);
    for (int y = 0; y < 16; ++y)
      for (int x = 0; x < 16; ++x)
        for (int c = 0; c < 3; ++c) stored[(y * 48 + x) * 3 + c] = 200;
    write_pixels(folder / name, spec, stored);
    const LinearPhoto p = read_photo(photo(name, Encoding::srgb));
    EXPECT_EQ(p.value.width, 48) << name;
    EXPECT_EQ(p.value.height, 32) << name;
    EXPECT_GT(p.value.at(4, 4), 0.5) << name;
    EXPECT_LT(p.value.at(40, 4), 0.1) << name;
    EXPECT_LT(p.value.at(4, 28), 0.1) << name;
  }
}

TEST_F(PhotoTest, BrokenFilesAreNamed) {
  EXPECT_THAT(error_of(photo("none.png", Encoding::linear)), AllOf(HasSubstr("none.png"), HasSubstr("does not exist")));
  folder.write("empty.jpg", "");
  EXPECT_THAT(error_of(photo("empty.jpg", Encoding::srgb)), HasSubstr("empty.jpg"));
  folder.write("text.png", "this is no picture");
  EXPECT_THAT(error_of(photo("text.png", Encoding::linear)), HasSubstr("text.png"));
  write_pixels(folder / "p.png", OIIO::ImageSpec(4, 4, 1, OIIO::TypeDesc::UINT16), std::vector<std::uint16_t>(16, 9));
  EXPECT_THAT(error_of(photo("p.png", Encoding::raw)), HasSubstr("not a raw file"));
}

// Files cut short, as by a pulled card, at several places. libjpeg alone would fill the rest with gray.
TEST_F(PhotoTest, FilesCutShortAreRefused) {
  std::mt19937 random(3);
  std::vector<std::uint8_t> pixels(200 * 200 * 3);
  for (auto& p : pixels) p = static_cast<std::uint8_t>(random());
  for (const char* name : {"p.jpg", "p.png", "p.tif", "p.exr"}) {
    write_pixels(folder / name, OIIO::ImageSpec(200, 200, 3, OIIO::TypeDesc::UINT8), pixels);
    const Encoding encoding = Encoding::srgb;
    EXPECT_EQ(error_of(photo(name, encoding)), "no error") << name;
    const auto size = fs::file_size(folder / name);
    for (const double part : {0.9, 0.5, 0.1}) {
      fs::resize_file(folder / name, static_cast<std::uintmax_t>(part * static_cast<double>(size)));
      EXPECT_THAT(error_of(photo(name, encoding)), HasSubstr(name)) << part;
    }
  }
}

// Noise of known electrons: the model is recovered, the merge has no bias at any brightness (near the clipping
// threshold of the long exposure above all), and its sigmas are those of the errors.
TEST_F(PhotoTest, BracketMergesWithoutBiasAndWithTrueSigmas) {
  constexpr double kElectrons = 18000, kRead = 9;
  Image truth(512, 512, 1);  // 64 bars of constant light, from 0.01 to 3.7 times the long exposure's white
  for (int y = 0; y < 512; ++y)
    for (int x = 0; x < 512; ++x) truth.at(x, y) = static_cast<float>(0.01 * std::pow(370, (x / 8) / 63.0));
  std::vector<Photo> photos;
  for (int k = 0; k < 2; ++k) {
    const double exposure = k == 0 ? 1 : 0.125;
    const std::string name = "p" + std::to_string(k) + ".png";
    write_noisy(folder / name, truth, exposure, kElectrons, kRead, 17 + k);
    photos.push_back(photo(name, Encoding::linear, exposure));
  }
  const NoiseModel noise = estimate_noise(photos);
  EXPECT_NEAR(1 / noise.photon, kElectrons, 0.03 * kElectrons);
  EXPECT_NEAR(std::sqrt(noise.read) / noise.photon, kRead, 0.15 * kRead);

  const MergedView merged = merge_bracket(photos, noise);
  for (int bar = 0; bar < 64; ++bar) {
    double sum_z = 0, sum_z2 = 0;
    int n = 0;
    for (int y = 0; y < 512; ++y)
      for (int x = bar * 8; x < bar * 8 + 8; ++x) {
        if (!merged.valid[y * 512 + x]) continue;
        const double z = (merged.value.at(x, y) - truth.at(x, y)) / merged.sigma.at(x, y);
        sum_z += z;
        sum_z2 += z * z;
        ++n;
      }
    ASSERT_EQ(n, 4096) << "the short exposure holds everything";
    // 4096 values: the mean is known to 1/64, the variance to 2 %. Five of those; 0.05 more for 12-bit rounding.
    EXPECT_LT(std::abs(sum_z / n), 5.0 / 64 + 0.05) << "bar " << bar << " at " << truth.at(bar * 8, 0);
    EXPECT_NEAR(sum_z2 / n, 1, 0.15) << "bar " << bar << " at " << truth.at(bar * 8, 0);
  }
}

TEST_F(PhotoTest, OneExposureTellsItsNoiseToo) {
  Image truth(512, 512, 1);
  for (int y = 0; y < 512; ++y)
    for (int x = 0; x < 512; ++x) truth.at(x, y) = static_cast<float>(0.02 + 0.8 * x * y / (512.0 * 512));
  write_noisy(folder / "p.png", truth, 1, 18000, 9, 5);
  const NoiseModel noise = estimate_noise(std::vector<Photo>{photo("p.png", Encoding::linear)});
  EXPECT_NEAR(1 / noise.photon, 18000, 0.1 * 18000);
}

TEST_F(PhotoTest, ClippedInAllExposuresIsInvalidAndGrown) {
  std::vector<std::uint16_t> stored(32 * 32, 4096);
  stored[10 * 32 + 10] = 65535;
  stored[0] = 4097;  // so that all 16 bits are in use
  write_pixels(folder / "p.png", OIIO::ImageSpec(32, 32, 1, OIIO::TypeDesc::UINT16), stored);
  const MergedView m = merge_bracket(std::vector<Photo>{photo("p.png", Encoding::linear)}, NoiseModel{});
  int invalid = 0;
  for (const auto v : m.valid) invalid += !v;
  EXPECT_EQ(invalid, 25);
  EXPECT_FALSE(m.valid[10 * 32 + 12]);
  EXPECT_TRUE(m.valid[10 * 32 + 13]);
  EXPECT_TRUE(std::isinf(m.sigma.at(10, 10)));
  EXPECT_FLOAT_EQ(m.value.at(10, 10), 1);
}

TEST_F(PhotoTest, SizesThatDifferAreRefused) {
  write_pixels(folder / "p.png", OIIO::ImageSpec(4, 4, 1, OIIO::TypeDesc::UINT16), std::vector<std::uint16_t>(16, 9));
  write_pixels(folder / "q.png", OIIO::ImageSpec(4, 3, 1, OIIO::TypeDesc::UINT16), std::vector<std::uint16_t>(12, 9));
  Session session;
  session.photos = {photo("p.png", Encoding::linear), photo("q.png", Encoding::linear)};
  for (const bool bracket : {true, false}) {
    try {
      if (bracket)
        merge_bracket(session.photos, NoiseModel{});
      else
        merge_session(session);
      FAIL();
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), AllOf(HasSubstr("q.png"), HasSubstr("4 x 3"), HasSubstr("4 x 4")));
    }
  }
}

// The rig's sensor: 18000 electrons at white, 9 electrons of read noise (its README and truth).
TEST(PhotoOfRigs, NoiseOfRigAIsItsSensors) {
  const fs::path file = fs::path(places::rig("a")) / "session.json";
  if (!fs::exists(file)) GTEST_SKIP() << "needs the photographed bench " << file;
  const Session session = read_session(file);
  const NoiseModel noise = estimate_noise(session.photos);
  EXPECT_NEAR(1 / noise.photon, 18000, 0.03 * 18000);
  EXPECT_NEAR(std::sqrt(noise.read) / noise.photon, 9, 1);
}

TEST(PhotoOfRigs, ReplayIsBitIdenticalForAnyThreads) {
  Session session = read_session(fs::path(places::rig("b-small")) / "session.json");
  session.photos.resize(9);  // three brackets of three
  const auto merged_with = [&](int threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return merge_session(session);
  };
  const auto one = merged_with(1), many = merged_with(4);
  ASSERT_EQ(one.size(), 3U);
  ASSERT_EQ(many.size(), 3U);
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].view, many[i].view);
    EXPECT_EQ(one[i].valid, many[i].valid);
    EXPECT_EQ(0, std::memcmp(one[i].value.data.data(), many[i].value.data.data(), one[i].value.data.size() * 4));
    EXPECT_EQ(0, std::memcmp(one[i].sigma.data.data(), many[i].sigma.data.data(), one[i].sigma.data.size() * 4));
  }
}

}  // namespace
}  // namespace burin

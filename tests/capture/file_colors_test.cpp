// Colors that files state: profiles, gammas, code points. Known light is stored along each curve and read back.
#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <lcms2.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <random>
#include <vector>

#include "burin/base/error.h"
#include "burin/base/image.h"
#include "burin/capture/exif.h"
#include "burin/capture/photo.h"
#include "burin/pictures/picture.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

struct FreeProfile {
  void operator()(void* p) const { cmsCloseProfile(p); }
};
using ProfilePtr = std::unique_ptr<void, FreeProfile>;

std::vector<std::uint8_t> bytes_of(cmsHPROFILE profile) {
  cmsUInt32Number size = 0;
  cmsSaveProfileToMem(profile, nullptr, &size);
  std::vector<std::uint8_t> out(size);
  cmsSaveProfileToMem(profile, out.data(), &size);
  return out;
}

constexpr cmsCIExyY kD65{0.3127, 0.3290, 1};
constexpr cmsCIExyYTRIPLE kSrgb{{0.64, 0.33, 1}, {0.30, 0.60, 1}, {0.15, 0.06, 1}};
constexpr cmsCIExyYTRIPLE kAdobe{{0.64, 0.33, 1}, {0.21, 0.71, 1}, {0.15, 0.06, 1}};
constexpr cmsCIExyYTRIPLE kP3{{0.68, 0.32, 1}, {0.265, 0.69, 1}, {0.15, 0.06, 1}};

std::vector<std::uint8_t> rgb_icc(const cmsCIExyYTRIPLE& primaries, cmsToneCurve* curve) {
  std::array<cmsToneCurve*, 3> curves{curve, curve, curve};
  const ProfilePtr profile(cmsCreateRGBProfile(&kD65, &primaries, curves.data()));
  cmsFreeToneCurve(curve);
  return bytes_of(profile.get());
}

cmsToneCurve* parametric_srgb() {
  const std::array<double, 5> p{2.4, 1 / 1.055, 0.055 / 1.055, 1 / 12.92, 0.04045};
  return cmsBuildParametricToneCurve(nullptr, 4, p.data());
}

cmsToneCurve* table_curve(const std::function<double(double)>& light) {
  std::vector<float> table(1024);
  for (std::size_t i = 0; i < table.size(); ++i) table[i] = static_cast<float>(light(static_cast<double>(i) / 1023));
  return cmsBuildTabulatedToneCurveFloat(nullptr, static_cast<cmsUInt32Number>(table.size()), table.data());
}

struct FileColorsTest : testing::Test {
  TemporaryFolder folder;
  std::vector<float> light;  // 32 x 32 x 3

  void SetUp() override {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> uniform(0.02F, 0.9F);
    for (int i = 0; i < 32 * 32 * 3; ++i) light.push_back(uniform(random));
  }

  // Stores `light` along a curve: stored = inverse(light).
  std::filesystem::path write(const std::string& name, int channels, OIIO::TypeDesc type,
                              const std::vector<std::uint8_t>& icc, const std::function<double(double)>& inverse,
                              const std::function<void(OIIO::ImageSpec&)>& more = {}) {
    const std::filesystem::path file = folder / name;
    OIIO::ImageSpec spec(32, 32, channels, type);
    if (!icc.empty())
      spec.attribute("ICCProfile", OIIO::TypeDesc(OIIO::TypeDesc::UINT8, static_cast<int>(icc.size())), icc.data());
    if (more) more(spec);
    std::vector<float> stored;
    for (int i = 0; i < 32 * 32; ++i)
      for (int c = 0; c < channels; ++c) stored.push_back(static_cast<float>(inverse(light[3 * i + c])));
    auto out = OIIO::ImageOutput::create(file.string());
    EXPECT_TRUE(out && out->open(file.string(), spec)) << OIIO::geterror();
    EXPECT_TRUE(out->write_image(OIIO::TypeDesc::FLOAT, stored.data()));
    out->close();
    return file;
  }

  // The largest relative error of the photo's light.
  double off(const std::filesystem::path& file, int channels) const {
    Photo photo;
    photo.file = file;
    photo.encoding = encoding_of(read_exif(file)).encoding;
    EXPECT_FALSE(encoding_of(read_exif(file)).assumed) << file;
    const LinearPhoto read = read_photo(photo);
    double most = 0;
    for (int i = 0; i < 32 * 32; ++i)
      for (int c = 0; c < channels; ++c)
        most = std::max<double>(most, std::abs(read.value.data[i * channels + c] / light[3 * i + c] - 1));
    return most;
  }
};

TEST_F(FileColorsTest, CurvesOfPhotosAreUndone) {
  const auto power = [](double g) { return [g](double l) { return std::pow(l, 1 / g); }; };
  const auto srgb = [](double l) { return static_cast<double>(linear_to_srgb(static_cast<float>(l))); };
  const auto same = [](double l) { return l; };
  const auto u16 = OIIO::TypeDesc::UINT16;
  EXPECT_LT(off(write("adobe.tif", 3, u16, rgb_icc(kAdobe, cmsBuildGamma(nullptr, 563 / 256.)), power(563 / 256.)), 3),
            2e-3);
  EXPECT_LT(off(write("prophoto.tif", 3, u16, rgb_icc(kAdobe, cmsBuildGamma(nullptr, 1.8)), power(1.8)), 3), 2e-3);
  EXPECT_LT(off(write("p3.tif", 3, u16, rgb_icc(kP3, parametric_srgb()), srgb), 3), 2e-3);
  EXPECT_LT(off(write("p3.png", 3, u16, rgb_icc(kP3, parametric_srgb()), srgb), 3), 2e-3);
  EXPECT_LT(off(write("linear.tif", 3, u16, rgb_icc(kSrgb, cmsBuildGamma(nullptr, 1)), same), 3), 2e-3);
  EXPECT_LT(off(write("table.tif", 3, u16, rgb_icc(kSrgb, table_curve([](double s) { return s * s * s; })),
                      [](double l) { return std::cbrt(l); }),
                3),
            3e-3);
  // JPEG holds eight bits: a level is 2 % of what is dark.
  const auto quality = [](OIIO::ImageSpec& spec) { spec.attribute("Compression", "jpeg:100"); };
  light.assign(light.size(), 0.3F);
  EXPECT_LT(off(write("a.jpg", 3, OIIO::TypeDesc::UINT8, rgb_icc(kAdobe, cmsBuildGamma(nullptr, 563 / 256.)),
                      power(563 / 256.), quality),
                3),
            0.015);
  EXPECT_LT(off(write("l.jpg", 3, OIIO::TypeDesc::UINT8, rgb_icc(kSrgb, cmsBuildGamma(nullptr, 1)), same, quality), 3),
            0.015);
  cmsToneCurve* gamma = cmsBuildGamma(nullptr, 2.2);
  const ProfilePtr gray(cmsCreateGrayProfile(&kD65, gamma));
  cmsFreeToneCurve(gamma);
  EXPECT_LT(off(write("gray.tif", 1, u16, bytes_of(gray.get()), power(2.2)), 1), 2e-3);
  // A gamma without a profile, as PNG states it.
  EXPECT_LT(off(write("gamma.png", 3, u16, {}, power(1.8),
                      [](OIIO::ImageSpec& s) {
                        s.attribute("oiio:ColorSpace", "GammaCorrected");
                        s.attribute("oiio:Gamma", 1.8F);
                      }),
                3),
            2e-3);
}

TEST_F(FileColorsTest, WhatCannotBeUndoneIsRefused) {
  const auto same = [](double l) { return l; };
  const auto broken = write("broken.tif", 3, OIIO::TypeDesc::UINT16, std::vector<std::uint8_t>(200, 7), same);
  EXPECT_THAT([&] { read_exif(broken); }, ThrowsMessage<Error>(testing::AllOf(
                                              HasSubstr("broken.tif"), HasSubstr("color profile that cannot be read"),
                                              HasSubstr("exiftool -icc_profile="))));
  EXPECT_THROW(read_picture(broken), Error);
  // "Uncalibrated", and nothing says which space that is.
  const auto lost = write("lost.tif", 3, OIIO::TypeDesc::UINT16, {}, same,
                          [](OIIO::ImageSpec& s) { s.attribute("Exif:ColorSpace", 65535); });
  EXPECT_TRUE(read_exif(lost).uncalibrated);
}

TEST_F(FileColorsTest, PicturesComeAsSrgb) {
  // One color of Adobe RGB and of P3, as lcms2 has it in sRGB.
  for (const cmsCIExyYTRIPLE& primaries : {kAdobe, kP3}) {
    const std::vector<std::uint8_t> icc = rgb_icc(primaries, cmsBuildGamma(nullptr, 2.2));
    const ProfilePtr from(cmsOpenProfileFromMem(icc.data(), static_cast<cmsUInt32Number>(icc.size())));
    const ProfilePtr to(cmsCreate_sRGBProfile());
    const auto transform =
        cmsCreateTransform(from.get(), TYPE_RGB_DBL, to.get(), TYPE_RGB_DBL, INTENT_RELATIVE_COLORIMETRIC, 0);
    const auto file =
        write("picture.png", 3, OIIO::TypeDesc::UINT16, icc, [](double l) { return std::pow(0.2 + 0.5 * l, 1 / 2.2); });
    const Image picture = read_picture(file);
    double most = 0, plain = 0;
    for (int i = 0; i < 32 * 32; ++i) {
      std::array<double, 3> in{}, out{};
      for (int c = 0; c < 3; ++c) in[c] = std::pow(0.2 + 0.5 * light[3 * i + c], 1 / 2.2);
      cmsDoTransform(transform, in.data(), out.data(), 1);
      for (int c = 0; c < 3; ++c) {
        most = std::max(most, std::abs(out[c] - picture.data[3 * i + c]));
        plain = std::max(plain, std::abs(in[c] - out[c]));
      }
    }
    cmsDeleteTransform(transform);
    EXPECT_LT(most, 0.002);
    EXPECT_GT(plain, 0.02) << "a picture that needs no conversion shows nothing";
  }
}

}  // namespace
}  // namespace burin

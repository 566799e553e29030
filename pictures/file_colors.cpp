#include "burin/pictures/file_colors.h"

#include <lcms2.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <string_view>

#include "burin/base/error.h"
#include "burin/base/files/input_file.h"
#include "burin/base/files/printable.h"
#include "burin/base/limits.h"
#include "burin/base/srgb.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

constexpr const char* kAsSrgb =
    "export it once more with its colors converted to sRGB, or, if they are sRGB already, take the statement out: "
    "exiftool -icc_profile= FILE";

// Code points of ITU-T H.273; 2: unspecified.
struct CodePoints {
  int primaries = 2, transfer = 2;
};

std::shared_ptr<void> profile_handle(cmsHPROFILE profile) {
  return {profile, [](void* p) {
            if (p != nullptr) cmsCloseProfile(p);
          }};
}

struct FreeCurve {
  void operator()(cmsToneCurve* curve) const { cmsFreeToneCurve(curve); }
};
using Curve = std::unique_ptr<cmsToneCurve, FreeCurve>;

constexpr cmsCIExyY kD65{0.3127, 0.3290, 1};

std::shared_ptr<void> rgb_profile(const cmsCIExyYTRIPLE& primaries, cmsToneCurve* curve) {
  std::array<cmsToneCurve*, 3> curves{curve, curve, curve};
  return profile_handle(cmsCreateRGBProfile(&kD65, &primaries, curves.data()));
}

// Chromaticities of H.273's table 2 for the primaries of pictures; sRGB's for all others.
cmsCIExyYTRIPLE primaries_of(int code) {
  if (code == 9) return {{0.708, 0.292, 1}, {0.170, 0.797, 1}, {0.131, 0.046, 1}};                 // BT.2020
  if (code == 11 || code == 12) return {{0.680, 0.320, 1}, {0.265, 0.690, 1}, {0.150, 0.060, 1}};  // P3
  return {{0.640, 0.330, 1}, {0.300, 0.600, 1}, {0.150, 0.060, 1}};
}

constexpr cmsCIExyYTRIPLE kAdobePrimaries{{0.640, 0.330, 1}, {0.210, 0.710, 1}, {0.150, 0.060, 1}};
constexpr double kAdobeGamma = 563.0 / 256;  // Adobe RGB (1998) Color Image Encoding, 4.3.4.2

Curve srgb_curve() {
  const std::array<double, 5> parameters{2.4, 1 / 1.055, 0.055 / 1.055, 1 / 12.92, 0.04045};
  return Curve(cmsBuildParametricToneCurve(nullptr, 4, parameters.data()));
}

Curve gamma_curve(double gamma) { return Curve(cmsBuildGamma(nullptr, gamma)); }

std::uint32_t big_endian(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8U | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

// Colors in a PNG's chunks before its pixels, because OpenImageIO labels every PNG as sRGB.
struct PngColors {
  std::optional<CodePoints> code_points;
  std::optional<double> gamma;
  bool srgb = false;
};

PngColors png_colors(const fs::path& file) {
  PngColors out;
  const std::string head = read_head(file, 8 * limit::kMiB);
  for (std::size_t at = 8; at + 12 <= head.size();) {
    const std::string_view type = std::string_view(head).substr(at + 4, 4);
    const std::size_t length = big_endian(head, at), data = at + 8;
    if (type == "IDAT" || length > head.size() - data) break;
    if (type == "sRGB") out.srgb = true;
    if (type == "gAMA" && length == 4 && big_endian(head, data) > 0) out.gamma = 1e5 / big_endian(head, data);
    if (type == "cICP" && length == 4)
      out.code_points = {static_cast<unsigned char>(head[data]), static_cast<unsigned char>(head[data + 1])};
    at = data + length + 4;
  }
  return out;
}

// Calls take(marker, bytes) for a JPEG's segments before its first scan.
template <typename Take>
void for_each_segment(const fs::path& file, const Take& take) {
  const std::string head = read_head(file, limit::kMiB);
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(head[i]); };
  for (std::size_t i = 2; i + 4 <= head.size() && byte(i) == 0xFF && byte(i + 1) != 0xDA;) {
    if (byte(i + 1) == 0xFF) {
      ++i;
      continue;
    }
    const std::size_t length = byte(i + 2) * std::size_t{256} + byte(i + 3);
    if (length < 2 || i + 2 + length > head.size()) return;
    take(byte(i + 1), std::string_view(head).substr(i + 4, length - 2));
    i += 2 + length;
  }
}

// Value of an entry, or its offset, in the directory at `directory` of TIFF bytes; EXIF 2.32, 4.6.2.
std::optional<std::uint32_t> tiff_entry(std::string_view tiff, std::size_t directory, unsigned tag, bool place) {
  const bool big = tiff.starts_with("MM");
  const auto number = [&](std::size_t at, std::size_t bytes) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < bytes; ++i)
      value = value << 8U | static_cast<unsigned char>(tiff[at + (big ? i : bytes - 1 - i)]);
    return value;
  };
  if (directory + 2 > tiff.size()) return std::nullopt;
  const std::size_t count = number(directory, 2);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = directory + 2 + 12 * i;
    if (at + 12 > tiff.size()) return std::nullopt;
    if (number(at, 2) == tag) return place ? static_cast<std::uint32_t>(at + 8) : number(at + 8, 4);
  }
  return std::nullopt;
}

// DCF 2.0, 3.3: "R03" in EXIF's interoperability directory means Adobe RGB, which EXIF itself marks as uncalibrated.
bool is_dcf_option_file(const fs::path& file) {
  bool found = false;
  for_each_segment(file, [&](unsigned char marker, std::string_view bytes) {
    constexpr std::string_view kExif("Exif\0\0", 6);
    if (marker != 0xE1 || !bytes.starts_with(kExif)) return;
    const std::string_view tiff = bytes.substr(kExif.size());
    constexpr unsigned kExifDirectory = 0x8769, kInteropDirectory = 0xA005, kInteropIndex = 1;
    if (tiff.size() < 8) return;
    const bool big = tiff.starts_with("MM");
    std::uint32_t first = 0;
    for (std::size_t i = 0; i < 4; ++i) first = first << 8U | static_cast<unsigned char>(tiff[big ? 4 + i : 7 - i]);
    const auto exif = tiff_entry(tiff, first, kExifDirectory, false);
    const auto interop = exif ? tiff_entry(tiff, *exif, kInteropDirectory, false) : std::nullopt;
    const auto index = interop ? tiff_entry(tiff, *interop, kInteropIndex, true) : std::nullopt;
    if (index && *index + 3 <= tiff.size() && tiff.substr(*index, 3) == "R03") found = true;
  });
  return found;
}

std::string icc_of(const OIIO::ImageSpec& spec) {
  const OIIO::ParamValue* profile = spec.find_attribute("ICCProfile");
  if (profile == nullptr || profile->type().basetype != OIIO::TypeDesc::UINT8) return {};
  return {static_cast<const char*>(profile->data()), static_cast<std::size_t>(profile->type().size())};
}

std::string description_of(cmsHPROFILE profile) {
  std::array<char, 256> text{};
  cmsGetProfileInfoASCII(profile, cmsInfoDescription, "en", "US", text.data(), text.size());
  return printable(text.data());
}

// Light along the grays of a profile with a table instead of curves; white is 1.
std::optional<std::vector<double>> gray_axis(cmsHPROFILE profile, std::size_t size) {
  const auto xyz = profile_handle(cmsCreateXYZProfile());
  const bool gray = cmsGetColorSpace(profile) == cmsSigGrayData;
  const auto transform = cmsCreateTransform(profile, gray ? TYPE_GRAY_DBL : TYPE_RGB_DBL, xyz.get(), TYPE_XYZ_DBL,
                                            INTENT_RELATIVE_COLORIMETRIC, cmsFLAGS_NOCACHE | cmsFLAGS_NOOPTIMIZE);
  if (transform == nullptr) return std::nullopt;
  std::vector<double> light(size);
  for (std::size_t i = 0; i < size; ++i) {
    const double v = static_cast<double>(i) / static_cast<double>(size - 1);
    const std::array<double, 3> in{v, v, v};
    cmsCIEXYZ out{};
    cmsDoTransform(transform, in.data(), &out, 1);
    light[i] = out.Y;
  }
  cmsDeleteTransform(transform);
  if (!(light.back() > 0)) return std::nullopt;
  for (double& l : light) l /= light.back();
  return light;
}

constexpr std::size_t kCurveSize = 4097;

// Light as a function of the stored value, one curve per channel.
std::optional<std::vector<std::vector<double>>> light_curves(cmsHPROFILE profile, int channels) {
  const bool gray = cmsGetColorSpace(profile) == cmsSigGrayData;
  const std::array<cmsTagSignature, 3> tags{gray ? cmsSigGrayTRCTag : cmsSigRedTRCTag,
                                            gray ? cmsSigGrayTRCTag : cmsSigGreenTRCTag,
                                            gray ? cmsSigGrayTRCTag : cmsSigBlueTRCTag};
  std::vector<std::vector<double>> out;
  for (int c = 0; c < channels; ++c) {
    const auto* curve =
        static_cast<const cmsToneCurve*>(cmsReadTag(profile, tags[static_cast<std::size_t>(channels == 1 ? 1 : c)]));
    if (curve == nullptr) break;
    std::vector<double> light(kCurveSize);
    for (std::size_t i = 0; i < kCurveSize; ++i)
      light[i] = cmsEvalToneCurveFloat(curve, static_cast<float>(i) / static_cast<float>(kCurveSize - 1));
    out.push_back(std::move(light));
  }
  if (out.size() == static_cast<std::size_t>(channels)) return out;
  const auto gray_light = gray_axis(profile, kCurveSize);
  if (!gray_light) return std::nullopt;
  return std::vector<std::vector<double>>(static_cast<std::size_t>(channels), *gray_light);
}

ToSrgbCurve stored_by_srgb(const std::vector<double>& light) {
  ToSrgbCurve stored(light.size());
  std::transform(light.begin(), light.end(), stored.begin(),
                 [](double l) { return linear_to_srgb(static_cast<float>(std::clamp(l, 0.0, 1.0))); });
  return stored;
}

FileColors::Curve curve_kind(const std::vector<std::vector<double>>& light) {
  constexpr double kSame = 0.006;  // in stored values: sRGB as programs write it differs by 1.5 levels of 255
  double off_srgb = 0, off_linear = 0;
  for (const std::vector<double>& curve : light)
    for (std::size_t i = 0; i < curve.size(); ++i) {
      const double stored = static_cast<double>(i) / static_cast<double>(curve.size() - 1);
      const auto as_srgb = linear_to_srgb(static_cast<float>(std::clamp(curve[i], 0.0, 1.0)));
      off_srgb = std::max(off_srgb, std::abs(as_srgb - stored));
      off_linear = std::max(off_linear, std::abs(curve[i] - stored));
    }
  return off_srgb < kSame     ? FileColors::Curve::srgb
         : off_linear < kSame ? FileColors::Curve::linear
                              : FileColors::Curve::other;
}

// True if a profile's colors are sRGB's, tested on a few of them.
bool shows_srgb(cmsHPROFILE profile) {
  if (cmsGetColorSpace(profile) != cmsSigRgbData) return false;
  const auto srgb = profile_handle(cmsCreate_sRGBProfile());
  const auto transform = cmsCreateTransform(profile, TYPE_RGB_FLT, srgb.get(), TYPE_RGB_FLT,
                                            INTENT_RELATIVE_COLORIMETRIC, cmsFLAGS_NOCACHE | cmsFLAGS_NOOPTIMIZE);
  if (transform == nullptr) return false;
  constexpr float kSame = 0.02F;
  bool same = true;
  for (int i = 0; i < 27; ++i) {
    const std::array<float, 3> in{0.5F * static_cast<float>(i % 3), 0.5F * static_cast<float>(i / 3 % 3),
                                  0.5F * static_cast<float>(i / 9 % 3)};
    std::array<float, 3> out{};
    cmsDoTransform(transform, in.data(), out.data(), 1);
    for (std::size_t c = 0; c < 3; ++c) same = same && std::abs(out[c] - in[c]) < kSame;
  }
  cmsDeleteTransform(transform);
  return same;
}

FileColors stated(const std::shared_ptr<void>& profile, const std::string& name, int channels, const fs::path& file) {
  FileColors out;
  out.name = name;
  const auto light = light_curves(profile.get(), channels);
  if (!light) fail(file.string(), "carries " + name + ", which cannot be undone", kAsSrgb);
  out.curve = curve_kind(*light);
  out.is_srgb = out.curve == FileColors::Curve::srgb && (channels == 1 || shows_srgb(profile.get()));
  if (!out.is_srgb) out.profile = profile;
  return out;
}

FileColors by_code_points(const CodePoints& points, int channels, const fs::path& file) {
  constexpr int kLinear = 8, kGamma22 = 4, kGamma28 = 5, kPq = 16, kHlg = 18;
  if (points.transfer == kPq || points.transfer == kHlg)
    fail(
        file.string(),
        std::string("is an HDR picture (") + (points.transfer == kPq ? "PQ" : "HLG") +
            "), whose values follow an HDR display's curve",
        "export it as an ordinary (SDR) picture in sRGB, or switch HDR off in the camera's settings and take it again");
  const Curve curve = points.transfer == kLinear    ? gamma_curve(1)
                      : points.transfer == kGamma22 ? gamma_curve(2.2)
                      : points.transfer == kGamma28 ? gamma_curve(2.8)
                                                    : srgb_curve();
  return stated(rgb_profile(primaries_of(points.primaries), curve.get()), "color code points", channels, file);
}

}  // namespace

FileColors file_colors(const OIIO::ImageInput& input, const fs::path& file) {
  const OIIO::ImageSpec& spec = input.spec();
  const std::string kind = input.format_name();
  if (kind == "raw" || kind == "openexr" || kind == "hdr") return {};
  const int channels = spec.nchannels >= 3 ? 3 : 1;
  const PngColors png = kind == "png" ? png_colors(file) : PngColors();
  if (png.code_points && png.code_points->transfer != 2) return by_code_points(*png.code_points, channels, file);
  if (const std::string icc = icc_of(spec); !icc.empty()) {
    const auto profile = profile_handle(cmsOpenProfileFromMem(icc.data(), static_cast<cmsUInt32Number>(icc.size())));
    if (!profile) fail(file.string(), "carries a color profile that cannot be read", kAsSrgb);
    const cmsColorSpaceSignature space = cmsGetColorSpace(profile.get());
    // For CMYK and Lab, OpenImageIO has converted the colors, so the profile does not describe them.
    if (space == cmsSigRgbData || space == cmsSigGrayData)
      return stated(profile, "the color profile \"" + description_of(profile.get()) + "\"", channels, file);
    return {};
  }
  const auto* code = spec.find_attribute("CICP");
  if (code != nullptr && code->type().basetype == OIIO::TypeDesc::INT && code->type().numelements() == 4) {
    const auto* points = static_cast<const int*>(code->data());
    if (points[1] != 2) return by_code_points({points[0], points[1]}, channels, file);
  }
  if (png.gamma && !png.srgb)
    return stated(rgb_profile(primaries_of(1), gamma_curve(*png.gamma).get()), "a gamma", channels, file);
  constexpr int kSrgb = 1, kAdobe = 2, kUncalibrated = 65535;
  const int space = spec.get_int_attribute("Exif:ColorSpace");
  if (space == kAdobe || (space == kUncalibrated && kind == "jpeg" && is_dcf_option_file(file)))
    return stated(rgb_profile(kAdobePrimaries, gamma_curve(kAdobeGamma).get()), "Adobe RGB by its EXIF", channels,
                  file);
  FileColors out;
  if (png.srgb || space == kSrgb) {
    out.curve = FileColors::Curve::srgb;
    out.is_srgb = true;
    out.name = "sRGB";
  }
  out.uncalibrated = space == kUncalibrated && !png.srgb;
  return out;
}

bool has_gain_map(const OIIO::ImageInput& input, const fs::path& file) {
  if (std::string_view(input.format_name()) == "heif") return input.spec().get_int_attribute("heif:GainMap") != 0;
  if (std::string_view(input.format_name()) != "jpeg") return false;
  bool found = false;
  for_each_segment(file, [&](unsigned char marker, std::string_view bytes) {
    // Google's Ultra HDR 1.1 in XMP, ISO 21496-1 annex C, Apple's in XMP.
    constexpr std::string_view kXmp("http://ns.adobe.com/xap/1.0/"), kIso("urn:iso:std:iso:ts:21496:-1");
    if (marker == 0xE2 && bytes.starts_with(kIso)) found = true;
    if (marker != 0xE1 || !bytes.starts_with(kXmp)) return;
    for (const std::string_view name : {"http://ns.adobe.com/hdr-gain-map/1.0/", "http://ns.apple.com/HDRGainMap/1.0/"})
      if (bytes.find(name) != std::string_view::npos) found = true;
  });
  return found;
}

std::vector<ToSrgbCurve> to_srgb_curves(const FileColors& colors, int channels) {
  if (!colors.profile || colors.curve != FileColors::Curve::other) return {};
  const auto light = light_curves(colors.profile.get(), channels);
  if (!light) return {};
  std::vector<ToSrgbCurve> out;
  for (const std::vector<double>& curve : *light) out.push_back(stored_by_srgb(curve));
  return out;
}

float curve_at(const ToSrgbCurve& curve, float stored) {
  const auto last = static_cast<float>(curve.size() - 1);
  const float at = std::clamp(stored, 0.0F, 1.0F) * last;
  const auto i = std::min(static_cast<std::size_t>(at), curve.size() - 2);
  return curve[i] + (at - static_cast<float>(i)) * (curve[i + 1] - curve[i]);
}

ToSrgbColors::ToSrgbColors(const FileColors& colors, int channels) : channels_(channels) {
  if (!colors.profile) return;
  cmsHPROFILE profile = colors.profile.get();
  if (channels == 1 || cmsGetColorSpace(profile) == cmsSigGrayData) {
    if (const auto light = light_curves(profile, 1)) gray_ = stored_by_srgb(light->front());
    return;
  }
  const auto srgb = profile_handle(cmsCreate_sRGBProfile());
  transform_ = {cmsCreateTransform(profile, TYPE_RGB_FLT, srgb.get(), TYPE_RGB_FLT, INTENT_RELATIVE_COLORIMETRIC,
                                   cmsFLAGS_NOCACHE),
                [](void* t) {
                  if (t != nullptr) cmsDeleteTransform(t);
                }};
}

void ToSrgbColors::convert(float* pixels, std::size_t count, int stride) const {
  if (!gray_.empty())
    for (std::size_t i = 0; i < count; ++i)
      for (int c = 0; c < channels_; ++c) {
        float& value = pixels[i * static_cast<std::size_t>(stride) + static_cast<std::size_t>(c)];
        value = curve_at(gray_, value);
      }
  if (!transform_) return;
  std::vector<float> in(3 * count), out(3 * count);
  for (std::size_t i = 0; i < count; ++i)
    std::copy_n(pixels + i * static_cast<std::size_t>(stride), 3, in.begin() + static_cast<std::ptrdiff_t>(3 * i));
  cmsDoTransform(transform_.get(), in.data(), out.data(), static_cast<cmsUInt32Number>(count));
  for (std::size_t i = 0; i < count; ++i)
    std::copy_n(out.begin() + static_cast<std::ptrdiff_t>(3 * i), 3, pixels + i * static_cast<std::size_t>(stride));
}

}  // namespace burin

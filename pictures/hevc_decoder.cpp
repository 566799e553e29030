#include "burin/pictures/hevc_decoder.h"

#include <libde265/de265.h>
#include <libheif/heif.h>
#include <libheif/heif_plugin.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string_view>

#include "burin/base/limits.h"

namespace burin {
namespace {

using namespace std::string_view_literals;

constexpr heif_error kHeifOk{heif_error_Ok, heif_suberror_Unspecified, "Success"};

heif_error hevc_damage(const char* message) {
  return {heif_error_Decoder_plugin_error, heif_suberror_Unspecified, message};
}

struct FreeHevc {
  void operator()(heif_image* image) const { heif_image_release(image); }
  void operator()(heif_color_profile_nclx* colors) const { heif_nclx_color_profile_free(colors); }
};

heif_error new_hevc_decoder(void** decoder) {
  *decoder = de265_new_decoder();
  return *decoder != nullptr ? kHeifOk : hevc_damage("libde265 makes no decoder");
}

void free_hevc_decoder(void* decoder) { de265_free_decoder(decoder); }

/// Reason why a unit (NAL, ITU-T H.265, 7.3.1) is damaged, or null. A valid unit does not end in zeros and has no three
/// zeros in a row, because these mark the start of the next unit (7.4.2.1).
const char* fault_of_unit(std::string_view unit) {
  if (unit.size() < 2 || unit.back() == '\0') return "a unit of it ends in zeros";
  for (std::size_t i = unit.find("\0\0"sv); i != std::string_view::npos && i + 2 < unit.size();
       i = unit.find("\0\0"sv, i + 1))
    if (static_cast<unsigned char>(unit[i + 2]) < 3) return "bytes of it have been overwritten by zeros";
  // Raw samples of one white block are the longest run that coding makes (7.3.8.7). Erased memory is all ones.
  constexpr std::ptrdiff_t kLongestRun = 32 * 32;
  for (auto same = unit.begin(); same != unit.end();) {
    const auto next = std::find_if(same, unit.end(), [&](char c) { return c != *same; });
    if (next - same > kLongestRun) return "bytes of it have been overwritten by one value";
    same = next;
  }
  return nullptr;
}

/// Pushes units, each preceded by its length.
heif_error push_units(void* decoder, const void* data, std::size_t size) {
  constexpr std::size_t kLength = 4;
  const std::string_view bytes(static_cast<const char*>(data), size);
  for (std::size_t at = 0; at < size;) {
    if (size - at < kLength) return hevc_damage("a unit of it has no length");
    std::size_t length = 0;
    for (std::size_t i = 0; i < kLength; ++i) length = length << 8U | static_cast<unsigned char>(bytes[at + i]);
    at += kLength;
    if (length > size - at) return hevc_damage("a unit of it is longer than what is there");
    const std::string_view unit = bytes.substr(at, length);
    if (const char* const fault = fault_of_unit(unit)) return hevc_damage(fault);
    if (const de265_error error = de265_push_NAL(decoder, unit.data(), static_cast<int>(length), 0, nullptr);
        error != DE265_OK)
      return hevc_damage(de265_get_error_text(error));
    at += length;
  }
  return kHeifOk;
}

heif_error copied_image(const de265_image* from, heif_image** out) {
  constexpr std::array<heif_channel, 3> kChannels{heif_channel_Y, heif_channel_Cb, heif_channel_Cr};
  constexpr std::array<heif_chroma, 4> kChromas{heif_chroma_monochrome, heif_chroma_420, heif_chroma_422,
                                                heif_chroma_444};
  const int kind = de265_get_chroma_format(from), width = de265_get_image_width(from, 0),
            height = de265_get_image_height(from, 0);
  if (kind < 0 || kind > 3 || width < 1 || height < 1 ||
      1.0 * width * height > static_cast<double>(limit::kPicturePixels))
    return hevc_damage("it is coded to a size that cannot be");
  heif_image* made = nullptr;
  heif_error error = heif_image_create(width, height, kind == 0 ? heif_colorspace_monochrome : heif_colorspace_YCbCr,
                                       kChromas[static_cast<std::size_t>(kind)], &made);
  std::unique_ptr<heif_image, FreeHevc> owner(made);
  for (int c = 0; c < (kind == 0 ? 1 : 3) && error.code == heif_error_Ok; ++c) {
    const int w = de265_get_image_width(from, c), h = de265_get_image_height(from, c),
              bits = de265_get_bits_per_pixel(from, c);
    int stride = 0, out_stride = 0;
    const std::uint8_t* rows = de265_get_image_plane(from, c, &stride);
    const heif_channel channel = kChannels[static_cast<std::size_t>(c)];
    error = heif_image_add_plane(made, channel, w, h, bits);
    if (error.code != heif_error_Ok) break;
    std::uint8_t* const to = heif_image_get_plane(made, channel, &out_stride);
    const std::size_t row_bytes = static_cast<std::size_t>(w) * static_cast<std::size_t>((bits + 7) / 8);
    for (int y = 0; y < h && to != nullptr && rows != nullptr; ++y)
      std::memcpy(to + static_cast<std::ptrdiff_t>(y) * out_stride, rows + static_cast<std::ptrdiff_t>(y) * stride,
                  row_bytes);
  }
  if (error.code != heif_error_Ok) return error;
  // The conversion of its values to red, green and blue, which the container may override. Codes unknown to libheif
  // stay unset.
  const std::unique_ptr<heif_color_profile_nclx, FreeHevc> colors(heif_nclx_color_profile_alloc());
  heif_nclx_color_profile_set_color_primaries(colors.get(),
                                              static_cast<std::uint16_t>(de265_get_image_colour_primaries(from)));
  heif_nclx_color_profile_set_transfer_characteristics(
      colors.get(), static_cast<std::uint16_t>(de265_get_image_transfer_characteristics(from)));
  heif_nclx_color_profile_set_matrix_coefficients(
      colors.get(), static_cast<std::uint16_t>(de265_get_image_matrix_coefficients(from)));
  colors->full_range_flag = de265_get_image_full_range_flag(from) != 0;
  heif_image_set_nclx_color_profile(made, colors.get());
  *out = owner.release();
  return kHeifOk;
}

heif_error decode_hevc(void* decoder, heif_image** out) {
  de265_error error = de265_flush_data(decoder);
  const de265_image* image = nullptr;
  for (int more = 1; more != 0 && error == DE265_OK && image == nullptr;) {
    error = de265_decode(decoder, &more);
    if (error == DE265_OK) error = de265_get_warning(decoder);
    if (error == DE265_OK) image = de265_get_next_picture(decoder);
  }
  if (error != DE265_OK) return hevc_damage(de265_get_error_text(error));
  if (image == nullptr) return hevc_damage("no picture is coded in it");
  return copied_image(image, out);
}

}  // namespace

void use_hevc_decoder() {
  static heif_decoder_plugin plugin{};
  static const heif_error registered = [] {
    constexpr static int kBeforeItsOwn = 1000;
    plugin.plugin_api_version = 1;
    plugin.get_plugin_name = [] { return "libde265, its warnings heard"; };
    plugin.does_support_format = [](heif_compression_format format) {
      return format == heif_compression_HEVC ? kBeforeItsOwn : 0;
    };
    plugin.new_decoder = new_hevc_decoder;
    plugin.free_decoder = free_hevc_decoder;
    plugin.push_data = push_units;
    plugin.decode_image = decode_hevc;
#if LIBHEIF_NUMERIC_VERSION >= ((1 << 24) | (21 << 16))  // rejects plug-ins of an older API
    plugin.plugin_api_version = 5;
    plugin.id_name = "burin";
    plugin.does_support_format2 = [](const heif_decoder_plugin_compressed_format_description* wanted) {
      return wanted->format == heif_compression_HEVC ? kBeforeItsOwn : 0;
    };
    plugin.new_decoder2 = [](void** decoder, const heif_decoder_plugin_options*) { return new_hevc_decoder(decoder); };
    plugin.push_data2 = [](void* decoder, const void* data, std::size_t size, std::uintptr_t) {
      return push_units(decoder, data, size);
    };
    plugin.flush_data = [](void*) { return kHeifOk; };  // decode_hevc() flushes
    plugin.decode_next_image2 = [](void* decoder, heif_image** out, std::uintptr_t*, const heif_security_limits*) {
      return decode_hevc(decoder, out);
    };
#endif
    return heif_register_decoder_plugin(&plugin);
  }();
  (void)registered;
}

}  // namespace burin

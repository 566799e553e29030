#include "burin/pictures/heif_picture.h"

#include <OpenImageIO/tiffutils.h>
#include <libheif/heif.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "burin/pictures/heif_boxes.h"
#include "burin/pictures/hevc_decoder.h"

namespace burin {
namespace {

struct Free {
  void operator()(heif_context* context) const { heif_context_free(context); }
  void operator()(heif_image_handle* handle) const { heif_image_handle_release(handle); }
  void operator()(heif_image* image) const { heif_image_release(image); }
  void operator()(heif_decoding_options* options) const { heif_decoding_options_free(options); }
};

/// EXIF of a HEIF, from its TIFF header on. Four bytes hold the number of bytes before the header (ISO 23008-12, annex
/// A.2.1). If they are invalid, as libheif 1.15 writes them for OpenImageIO's EXIF, the header follows "Exif\0\0".
std::string exif_of(const heif_image_handle* handle) {
  constexpr std::size_t kPlaceBytes = 4, kNameBytes = 6;
  heif_item_id id = 0;
  if (heif_image_handle_get_list_of_metadata_block_IDs(handle, "Exif", &id, 1) != 1) return {};
  std::string bytes(heif_image_handle_get_metadata_size(handle, id), '\0');
  if (bytes.size() < kPlaceBytes || heif_image_handle_get_metadata(handle, id, bytes.data()).code != heif_error_Ok)
    return {};
  std::size_t before = 0;
  for (std::size_t i = 0; i < kPlaceBytes; ++i) before = before << 8U | static_cast<unsigned char>(bytes[i]);
  for (const std::size_t at : {kPlaceBytes + before, kPlaceBytes + kNameBytes}) {
    if (at >= bytes.size()) continue;
    const std::string_view rest = std::string_view(bytes).substr(at);
    if (rest.starts_with("II") || rest.starts_with("MM")) return std::string(rest);
  }
  return {};
}

/// Declares the container's colors (burin/pictures/file_colors.h) under OpenImageIO's names.
void state_colors(const heif_image_handle* handle, OIIO::ImageSpec& spec) {
  if (const std::size_t bytes = heif_image_handle_get_raw_color_profile_size(handle); bytes > 0) {
    std::vector<std::uint8_t> profile(bytes);
    if (heif_image_handle_get_raw_color_profile(handle, profile.data()).code == heif_error_Ok)
      spec.attribute("ICCProfile", OIIO::TypeDesc(OIIO::TypeDesc::UINT8, static_cast<int>(bytes)), profile.data());
  }
  heif_color_profile_nclx* points = nullptr;
  if (heif_image_handle_get_nclx_color_profile(handle, &points).code == heif_error_Ok && points != nullptr) {
    const std::array<int, 4> codes{points->color_primaries, points->transfer_characteristics,
                                   points->matrix_coefficients, points->full_range_flag};
    spec.attribute("CICP", OIIO::TypeDesc(OIIO::TypeDesc::INT, 4), codes.data());
    heif_nclx_color_profile_free(points);
  }
}

/// True if an auxiliary picture is a gain map, of Apple's type or of ISO 21496-1's.
bool carries_gain_map(const heif_image_handle* handle) {
  const int count = heif_image_handle_get_number_of_auxiliary_images(
      handle, LIBHEIF_AUX_IMAGE_FILTER_OMIT_ALPHA | LIBHEIF_AUX_IMAGE_FILTER_OMIT_DEPTH);
  std::vector<heif_item_id> ids(static_cast<std::size_t>(std::max(0, count)));
  const int got = heif_image_handle_get_list_of_auxiliary_image_IDs(
      handle, LIBHEIF_AUX_IMAGE_FILTER_OMIT_ALPHA | LIBHEIF_AUX_IMAGE_FILTER_OMIT_DEPTH, ids.data(), count);
  bool found = false;
  for (int i = 0; i < got; ++i) {
    heif_image_handle* auxiliary = nullptr;
    if (heif_image_handle_get_auxiliary_image_handle(handle, ids[static_cast<std::size_t>(i)], &auxiliary).code !=
        heif_error_Ok)
      continue;
    const char* type = nullptr;
    if (heif_image_handle_get_auxiliary_type(auxiliary, &type).code == heif_error_Ok && type != nullptr) {
      const std::string_view name(type);
      found =
          found || name.find("hdrgainmap") != std::string_view::npos || name.find("21496") != std::string_view::npos;
      heif_image_handle_free_auxiliary_types(auxiliary, &type);
    }
    heif_image_handle_release(auxiliary);
  }
  return found;
}

class HeifInput final : public OIIO::ImageInput {
 public:
  explicit HeifInput(bool as_the_sensor) : as_the_sensor_(as_the_sensor) {
    static const heif_error ready = heif_init(nullptr);  // loads decoders that are plug-ins
    (void)ready;
    use_hevc_decoder();
  }
  const char* format_name() const override { return "heif"; }

  bool open(const std::string& name, OIIO::ImageSpec& spec) override {
    const lock_guard lock(*this);
    close();
    context_.reset(heif_context_alloc());
    heif_image_handle* handle = nullptr;
    if (!succeeded(heif_context_read_from_file(context_.get(), name.c_str(), nullptr)) ||
        !succeeded(heif_context_get_primary_image_handle(context_.get(), &handle)))
      return false;
    handle_.reset(handle);
    const bool has_alpha = heif_image_handle_has_alpha_channel(handle) != 0;
    crop_ = {0, 0, heif_image_handle_get_width(handle), heif_image_handle_get_height(handle)};
    if (as_the_sensor_ && !find_crop(name)) return false;
    m_spec = OIIO::ImageSpec(crop_.width, crop_.height, has_alpha ? 4 : 3, OIIO::TypeDesc::UINT8);
    m_spec.attribute("oiio:ColorSpace", "sRGB");
    if (has_alpha && heif_image_handle_is_premultiplied_alpha(handle) == 0)
      m_spec.attribute("oiio:UnassociatedAlpha", 1);
    if (const std::string exif = exif_of(handle); !exif.empty())
      OIIO::decode_exif(OIIO::string_view(exif.data(), exif.size()), m_spec);
    state_colors(handle, m_spec);
    if (carries_gain_map(handle)) m_spec.attribute("heif:GainMap", 1);
    if (!as_the_sensor_) m_spec.attribute("Orientation", 1);  // pixels are upright, for any orientation in EXIF
    spec = m_spec;
    return true;
  }

  bool close() override {
    image_.reset();
    handle_.reset();
    context_.reset();
    return true;
  }

  int current_subimage() const override { return 0; }
  bool seek_subimage(int subimage, int miplevel) override { return subimage == 0 && miplevel == 0; }

  bool read_native_scanline(int subimage, int miplevel, int y, int /*z*/, void* data) override {
    const lock_guard lock(*this);
    if (!seek_subimage(subimage, miplevel) || y < 0 || y >= m_spec.height || !decoded()) return false;
    int stride = 0;
    const std::uint8_t* pixels = heif_image_get_plane_readonly(image_.get(), heif_channel_interleaved, &stride);
    const std::size_t row_bytes = m_spec.scanline_bytes(true);
    if (pixels == nullptr || stride < 0 || static_cast<std::size_t>(stride) < row_bytes) {
      errorfmt("it was decoded to pixels of another kind");
      return false;
    }
    const std::size_t row = static_cast<std::size_t>(crop_.top + y) * static_cast<std::size_t>(stride),
                      column = static_cast<std::size_t>(crop_.left) * m_spec.pixel_bytes(true);
    std::memcpy(data, pixels + row + column, row_bytes);
    return true;
  }

 private:
  bool succeeded(const heif_error& error) {
    if (error.code == heif_error_Ok) return true;
    // libheif puts the kind of error before a decoder's own message.
    const std::string_view words = error.message;
    const std::size_t own = error.code == heif_error_Decoder_plugin_error ? words.rfind(": ") : std::string_view::npos;
    errorfmt("{}", std::string(own == std::string_view::npos ? words : words.substr(own + 2)));
    return false;
  }

  /// Finds the part of the coded picture without padding.
  bool find_crop(const std::string& name) {
    const int width = heif_image_handle_get_ispe_width(handle_.get()),
              height = heif_image_handle_get_ispe_height(handle_.get());
    try {
      const std::filesystem::path file(name);
      PictureBytes bytes(file, std::filesystem::file_size(file));
      crop_ = heif_crop(bytes, width, height);
    } catch (const std::exception& broken) {
      errorfmt("{}", broken.what());
      return false;
    }
    return true;
  }

  bool decoded() {
    if (image_) return true;
    heif_image* image = nullptr;
    const bool has_alpha = m_spec.nchannels == 4;
    const heif_chroma layout = has_alpha ? heif_chroma_interleaved_RGBA : heif_chroma_interleaved_RGB;
    if (!handle_) return false;
    const std::unique_ptr<heif_decoding_options, Free> options(heif_decoding_options_alloc());
    options->ignore_transformations = as_the_sensor_;
    const heif_error error = heif_decode_image(handle_.get(), &image, heif_colorspace_RGB, layout, options.get());
    if (!succeeded(error)) return false;
    std::unique_ptr<heif_image, Free> kept(image);
    const int width = heif_image_get_width(image, heif_channel_interleaved),
              height = heif_image_get_height(image, heif_channel_interleaved);
    if (width < crop_.left + crop_.width || height < crop_.top + crop_.height) {
      errorfmt("its container declares {} x {} pixels, but {} x {} are coded in it", crop_.left + crop_.width,
               crop_.top + crop_.height, width, height);
      return false;
    }
    image_ = std::move(kept);
    return true;
  }

  bool as_the_sensor_ = false;
  HeifCrop crop_;
  std::unique_ptr<heif_context, Free> context_;
  std::unique_ptr<heif_image_handle, Free> handle_;
  std::unique_ptr<heif_image, Free> image_;  // empty before the first row is read
};

}  // namespace

std::unique_ptr<OIIO::ImageInput> make_heif_input(bool as_the_sensor) {
  return std::make_unique<HeifInput>(as_the_sensor);
}

}  // namespace burin

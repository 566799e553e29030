#include "burin/pictures/jpeg_picture.h"

#include <OpenImageIO/tiffutils.h>

#include <array>
#include <csetjmp>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

// libjpeg's header does not include the headers that it needs.
#include <jpeglib.h>

#include <jerror.h>

#include "burin/base/limits.h"

namespace burin {
namespace {

using namespace std::string_view_literals;

/// libjpeg's state with the results of its callbacks. A plain struct, because libjpeg's longjmp skips destructors.
struct JpegDecoder {
  jpeg_decompress_struct info{};
  jpeg_error_mgr errors{};
  jpeg_progress_mgr progress{};
  std::jmp_buf back{};
  bool scanning = false;                       // after the header
  std::array<char, JMSG_LENGTH_MAX> fault{};   // reason why no further data can be read
  std::array<char, JMSG_LENGTH_MAX> damage{};  // first warning of damage
};

JpegDecoder& decoder_of(j_common_ptr info) { return *static_cast<JpegDecoder*>(info->client_data); }

[[noreturn]] void stop_decoding(j_common_ptr info) {
  JpegDecoder& decoder = decoder_of(info);
  info->err->format_message(info, decoder.fault.data());
  std::longjmp(decoder.back, 1);
}

/// libjpeg calls it for warnings (level below 0) and for trace messages. Warnings in the header affect no pixel. The
/// decoder reads the last bits of a scan some bytes ahead, so a few extra bytes are no sign of damage. More extra bytes
/// remain after misread codes.
void hear_warning(j_common_ptr info, int level) {
  constexpr int kFewBytes = 8;
  JpegDecoder& decoder = decoder_of(info);
  if (level >= 0 || !decoder.scanning) return;
  const int code = info->err->msg_code;
  if (code == JWRN_JPEG_EOF) return;
  if (code == JWRN_EXTRANEOUS_DATA && info->err->msg_parm.i[0] <= kFewBytes) return;
  if (decoder.damage[0] == '\0') info->err->format_message(info, decoder.damage.data());
}

/// Limits the number of scans. Each scan of a progressive picture covers all of it, and a file of a few kilobytes may
/// have thousands.
void count_scans(j_common_ptr info) {
  const auto* jpeg = reinterpret_cast<j_decompress_ptr>(info);
  const double pixels = 1.0 * jpeg->image_width * jpeg->image_height;
  if (jpeg->input_scan_number <= limit::kJpegScans && jpeg->input_scan_number * pixels <= limit::kJpegScanPixels)
    return;
  JpegDecoder& decoder = decoder_of(info);
  std::snprintf(decoder.fault.data(), decoder.fault.size(),
                "it has more scans than %d, or than its size allows: save it again as a baseline JPEG",
                limit::kJpegScans);
  std::longjmp(decoder.back, 1);
}

/// True if the scans contain all coefficients of all components, to their last bit.
bool has_all_scans(const jpeg_decompress_struct& info) {
  for (int c = 0; c < info.num_components; ++c) {
    if (info.comp_info[c].quant_table == nullptr) return false;
    for (int k = 0; info.progressive_mode && info.coef_bits != nullptr && k < DCTSIZE2; ++k)
      if (info.coef_bits[c][k] != 0) return false;
  }
  return true;
}

/// Converts inks as OpenImageIO does; JPEG stores 255 for no ink.
void cmyk_to_rgb(const JSAMPLE* cmyk, int pixels, std::uint8_t* rgb) {
  for (int i = 0; i < pixels; ++i, cmyk += 4, rgb += 3)
    for (int c = 0; c < 3; ++c)
      rgb[c] = static_cast<std::uint8_t>(static_cast<float>(cmyk[c]) * static_cast<float>(cmyk[3]) / 255.0F + 0.5F);
}

class JpegInput final : public OIIO::ImageInput {
 public:
  JpegInput() = default;
  JpegInput(const JpegInput&) = delete;
  JpegInput& operator=(const JpegInput&) = delete;
  ~JpegInput() override { JpegInput::close(); }
  const char* format_name() const override { return "jpeg"; }

  bool open(const std::string& name, OIIO::ImageSpec& spec) override {
    const lock_guard lock(*this);
    close();
    file_.reset(std::fopen(name.c_str(), "rb"));
    if (!file_) {
      errorfmt("it cannot be opened");
      return false;
    }
    decoder_ = std::make_unique<JpegDecoder>();
    JpegDecoder& decoder = *decoder_;
    decoder.info.err = jpeg_std_error(&decoder.errors);
    decoder.errors.error_exit = stop_decoding;
    decoder.errors.emit_message = hear_warning;
    decoder.progress.progress_monitor = count_scans;
    decoder.info.client_data = &decoder;
    if (!guarded([&] {
          jpeg_create_decompress(&decoder.info);
          decoder.info.progress = &decoder.progress;
          jpeg_stdio_src(&decoder.info, file_.get());
          constexpr unsigned kWhole = 0xFFFF;
          jpeg_save_markers(&decoder.info, JPEG_APP0 + 1, kWhole);
          jpeg_save_markers(&decoder.info, JPEG_APP0 + 2, kWhole);
          jpeg_read_header(&decoder.info, TRUE);
        }))
      return false;
    const jpeg_decompress_struct& info = decoder.info;
    if (info.data_precision != 8 ||
        (info.num_components != 1 && info.num_components != 3 && info.num_components != 4)) {
      errorfmt("it has {} values a pixel, of {} bits", info.num_components, info.data_precision);
      return false;
    }
    if (info.arith_code) {  // its last bytes may be missing, so no decoder detects a truncated file
      errorfmt("it is coded arithmetically");
      return false;
    }
    if (info.num_components == 4) decoder.info.out_color_space = JCS_CMYK;
    m_spec = OIIO::ImageSpec(static_cast<int>(info.image_width), static_cast<int>(info.image_height),
                             info.num_components == 1 ? 1 : 3, OIIO::TypeDesc::UINT8);
    m_spec.attribute("oiio:ColorSpace", "sRGB");
    read_notes();
    decoder.scanning = true;
    spec = m_spec;
    return true;
  }

  bool close() override {
    if (decoder_) guarded([this] { jpeg_destroy_decompress(&decoder_->info); });
    decoder_.reset();
    file_.reset();
    next_row_ = 0;
    return true;
  }

  int current_subimage() const override { return 0; }
  bool seek_subimage(int subimage, int miplevel) override { return subimage == 0 && miplevel == 0; }

  bool read_native_scanline(int subimage, int miplevel, int y, int /*z*/, void* data) override {
    const lock_guard lock(*this);
    if (!seek_subimage(subimage, miplevel) || !decoder_ || y != next_row_ || y >= m_spec.height) {
      errorfmt("its rows can be read in their order alone");
      return false;
    }
    if (y == 0 && !started()) return false;
    jpeg_decompress_struct& info = decoder_->info;
    const bool inks = info.num_components == 4;
    if (inks) inks_.resize(static_cast<std::size_t>(m_spec.width) * 4);
    JSAMPROW row = inks ? inks_.data() : static_cast<JSAMPLE*>(data);
    if (!guarded([&] { jpeg_read_scanlines(&info, &row, 1); })) return false;
    if (inks) cmyk_to_rgb(inks_.data(), m_spec.width, static_cast<std::uint8_t*>(data));
    ++next_row_;
    if (next_row_ == m_spec.height && !guarded([&] {
          if (!has_all_scans(info)) ERREXIT(&info, JERR_INPUT_EOF);
          jpeg_finish_decompress(&info);  // reads up to the end marker
        }))
      return false;
    return not_damaged();
  }

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };

  /// Runs calls into libjpeg, whose errors jump back here. The calls must not create objects with destructors.
  template <typename Calls>
  bool guarded(const Calls& calls) {
    if (setjmp(decoder_->back) != 0) {
      errorfmt("{}", decoder_->fault.data());
      return false;
    }
    calls();
    return true;
  }

  /// Starts decoding; decodes the whole of a progressive picture.
  bool started() {
    jpeg_decompress_struct& info = decoder_->info;
    return guarded([&] {
             jpeg_start_decompress(&info);
             if (jpeg_has_multiple_scans(&info) && !has_all_scans(info)) ERREXIT(&info, JERR_INPUT_EOF);
           }) &&
           not_damaged();
  }

  bool not_damaged() {
    if (decoder_->damage[0] == '\0') return true;
    errorfmt("{}", decoder_->damage.data());
    return false;
  }

  void read_notes() {
    std::string_view exif, xmp;
    for (auto* marker = decoder_->info.marker_list; marker != nullptr; marker = marker->next) {
      const std::string_view text(reinterpret_cast<const char*>(marker->data), marker->data_length);
      constexpr std::string_view kExif = "Exif\0\0"sv, kXmp = "http://ns.adobe.com/xap/1.0/\0"sv;
      if (marker->marker != JPEG_APP0 + 1) continue;
      if (exif.empty() && text.starts_with(kExif)) exif = text.substr(kExif.size());
      if (xmp.empty() && text.starts_with(kXmp)) xmp = text.substr(kXmp.size());
    }
    if (!xmp.empty()) OIIO::decode_xmp(OIIO::string_view(xmp.data(), xmp.size()), m_spec);
    if (!exif.empty())
      OIIO::decode_exif(OIIO::string_view(exif.data(), exif.size()), m_spec);  // EXIF has precedence over XMP
    JOCTET* profile = nullptr;
    unsigned bytes = 0;
    if (guarded([&] { jpeg_read_icc_profile(&decoder_->info, &profile, &bytes); }) && profile != nullptr) {
      m_spec.attribute("ICCProfile", OIIO::TypeDesc(OIIO::TypeDesc::UINT8, static_cast<int>(bytes)), profile);
      std::string ignored;
      OIIO::decode_icc_profile(OIIO::cspan<std::uint8_t>(profile, static_cast<int>(bytes)), m_spec, ignored);
    }
    std::free(profile);  // allocated by libjpeg with malloc
  }

  std::unique_ptr<std::FILE, Close> file_;
  std::unique_ptr<JpegDecoder> decoder_;
  std::vector<JSAMPLE> inks_;
  int next_row_ = 0;
};

}  // namespace

std::unique_ptr<OIIO::ImageInput> make_jpeg_input() { return std::make_unique<JpegInput>(); }

}  // namespace burin

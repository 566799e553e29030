// The sizes that pictures say they have, read by hand: a few fixed places, or a walk over sections whose lengths are
// held against the file's. Nothing is taken for granted, and nothing is decoded.
#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <fstream>
#include <string_view>

#include "burin/render/error.h"
#include "burin/render/files/input_file.h"
#include "burin/render/files/picture_file.h"
#include "burin/render/limits.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

/// Bytes of a file by their place. What lies behind its end is refused.
class FileBytes {
 public:
  FileBytes(const fs::path& file, std::uintmax_t size) : file_(file), size_(size), in_(file, std::ios::binary) {}

  std::uintmax_t size() const { return size_; }

  std::string at(std::uintmax_t place, std::uintmax_t count) {
    if (place > size_ || count > size_ - place) broken("ends within its header");
    std::string bytes(count, '\0');
    in_.clear();
    in_.seekg(static_cast<std::streamoff>(place));
    in_.read(bytes.data(), static_cast<std::streamsize>(count));
    if (!in_) broken("cannot be read to its end");
    return bytes;
  }
  /// As many as there are, up to `count`.
  std::string up_to(std::uintmax_t place, std::uintmax_t count) {
    return at(place, place > size_ ? 0 : std::min(count, size_ - place));
  }
  std::uint64_t big_endian(std::uintmax_t place, int bytes) { return number(place, bytes, true); }
  std::uint64_t little_endian(std::uintmax_t place, int bytes) { return number(place, bytes, false); }
  std::uint64_t number(std::uintmax_t place, int bytes, bool big) {
    const std::string b = at(place, static_cast<std::uintmax_t>(bytes));
    std::uint64_t value = 0;
    for (int i = 0; i < bytes; ++i)
      value = value << 8U | static_cast<unsigned char>(b[static_cast<std::size_t>(big ? i : bytes - 1 - i)]);
    return value;
  }

  [[noreturn]] void broken(const std::string& what) const {
    fail(file_.string(), "is a broken picture: " + what, "copy it again from where it came from, or export it again");
  }

 private:
  const fs::path& file_;
  std::uintmax_t size_;
  std::ifstream in_;
};

/// Two sizes in one file: the larger counts.
void take(PictureHeader& header, std::int64_t width, std::int64_t height) {
  if (width <= 0 || height <= 0) return;
  if (static_cast<double>(width) * static_cast<double>(height) >
      static_cast<double>(header.width) * static_cast<double>(header.height)) {
    header.width = width;
    header.height = height;
  }
}

std::int64_t as_signed(std::uint64_t v) { return static_cast<std::int32_t>(static_cast<std::uint32_t>(v)); }

// Segments up to the frame's (ITU T.81, B.2.2).
void jpeg_size(FileBytes& file, PictureHeader& header) {
  constexpr int kMostSegments = 10'000;
  std::uintmax_t at = 2;
  for (int segment = 0; segment < kMostSegments; ++segment) {
    if (file.big_endian(at, 1) != 0xFF) file.broken("a marker is missing");
    const auto marker = file.big_endian(at + 1, 1);
    if (marker == 0xFF) {  // filling
      ++at;
      continue;
    }
    if (marker == 0x01 || (marker >= 0xD0 && marker <= 0xD8)) {  // without a length
      at += 2;
      continue;
    }
    if (marker == 0xD9 || marker == 0xDA) file.broken("it names no size");
    const auto length = file.big_endian(at + 2, 2);
    const bool frame = marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
    if (frame)
      return take(header, static_cast<std::int64_t>(file.big_endian(at + 7, 2)),
                  static_cast<std::int64_t>(file.big_endian(at + 5, 2)));
    if (length < 2) file.broken("a segment has no length");
    at += 2 + length;
  }
  file.broken("its segments do not end");
}

/// One directory of a TIFF (version 6, section 2; BigTIFF with 8 bytes instead of 4). Its sub-directories go to `more`.
std::uint64_t tiff_directory(FileBytes& file, std::uint64_t at, bool big, bool large, PictureHeader& header,
                             std::vector<std::uint64_t>& more) {
  const int word = large ? 8 : 4;
  const std::uint64_t count = file.number(at, large ? 8 : 2, big), entry_bytes = large ? 20 : 12;
  const std::uint64_t first = at + (large ? 8 : 2);
  if (count > 4096 || first + count * entry_bytes > file.size()) file.broken("a directory is larger than the file");
  std::int64_t width = 0, height = 0, tile_width = 0, tile_height = 0, strip_height = 0, samples = 1, bits = 8;
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::uint64_t entry = first + i * entry_bytes, value_at = entry + 4 + static_cast<std::uint64_t>(word);
    const auto tag = file.number(entry, 2, big), type = file.number(entry + 2, 2, big),
               values = file.number(entry + 4, word, big);
    const auto value = [&] {
      return static_cast<std::int64_t>(
          std::min<std::uint64_t>(file.number(value_at, type == 3 ? 2 : 4, big), 0xFFFFFFFFU));
    };
    if (tag == 256) width = value();
    if (tag == 257) height = value();
    if (tag == 258 && values == 1) bits = value();
    if (tag == 277) samples = value();
    if (tag == 278) strip_height = value();
    if (tag == 322) tile_width = value();
    if (tag == 323) tile_height = value();
    if (tag == 330) {  // SubIFDs
      const std::uint64_t most = std::min<std::uint64_t>(values, 16);
      const bool inside = values * static_cast<std::uint64_t>(word) <= static_cast<std::uint64_t>(word);
      const std::uint64_t list = inside ? value_at : file.number(value_at, word, big);
      for (std::uint64_t k = 0; k < most; ++k)
        more.push_back(file.number(list + k * static_cast<std::uint64_t>(word), word, big));
    }
  }
  take(header, width, height);
  if (samples > limit::kChannels || bits > 64)
    file.broken("its pixels have " + std::to_string(samples) + " values of " + std::to_string(bits) + " bits");
  if (tile_width > 0 && tile_height > 0 &&
      (tile_width > (1 << 16) || tile_height > (1 << 16) || tile_width * tile_height * samples * 8 > limit::kTileBytes))
    file.broken("its tiles are of " + std::to_string(tile_width) + " x " + std::to_string(tile_height) + " pixels");
  // Strips may be higher than the picture, and 2^32 - 1 is what a writer says that thinks of none; OpenImageIO takes
  // memory for whatever a signed number holds.
  if (strip_height > height && strip_height <= std::numeric_limits<std::int32_t>::max() &&
      strip_height > limit::kTileBytes / (8 * std::max<std::int64_t>(1, width * samples)))
    file.broken("its strips are of " + std::to_string(width) + " x " + std::to_string(strip_height) + " pixels");
  return file.number(first + count * entry_bytes, word, big);
}

void tiff_size(FileBytes& file, PictureHeader& header) {
  const bool big = file.at(0, 1) == "M";
  const auto version = file.number(2, 2, big);
  const bool large = version == 43;
  std::vector<std::uint64_t> wanted{file.number(large ? 8 : 4, large ? 8 : 4, big)};
  constexpr std::size_t kMostDirectories = 64;
  for (std::size_t i = 0; i < wanted.size() && i < kMostDirectories; ++i) {
    if (wanted[i] == 0) continue;
    const std::uint64_t at = wanted[i], next = tiff_directory(file, at, big, large, header, wanted);
    if (next != 0 && next > at) wanted.push_back(next);  // forward only: no circles
  }
}

/// Whether an EXR's attribute has the bytes that its type has. OpenEXR reads by the type and passes over the length
/// that is said, so that a wrong one moves all that follows.
bool is_as_long_as_its_type(std::string_view type, std::string_view value) {
  struct Fixed {
    std::string_view type;
    std::size_t bytes;
  };
  constexpr std::array<Fixed, 24> kFixed{
      {{"box2i", 16}, {"box2f", 16},   {"compression", 1}, {"lineOrder", 1}, {"envmap", 1},   {"deepImageState", 1},
       {"float", 4},  {"double", 8},   {"int", 4},         {"v2i", 8},       {"v2f", 8},      {"v2d", 16},
       {"v3i", 12},   {"v3f", 12},     {"v3d", 24},        {"m33f", 36},     {"m33d", 72},    {"m44f", 64},
       {"m44d", 128}, {"rational", 8}, {"timecode", 8},    {"keycode", 28},  {"tiledesc", 9}, {"chromaticities", 32}}};
  for (const Fixed& fixed : kFixed)
    if (type == fixed.type) return value.size() == fixed.bytes;
  const auto number = [&](std::size_t at) {
    std::uint64_t out = 0;
    for (std::size_t i = 4; i-- > 0;) out = out << 8U | static_cast<unsigned char>(value[at + i]);
    return out;
  };
  if (type == "preview")
    return value.size() >= 8 && number(0) <= limit::kPictureSide && number(4) <= limit::kPictureSide &&
           value.size() - 8 == 4 * number(0) * number(4);
  if (type == "chlist") {  // names with 16 bytes each, and an empty name
    constexpr std::size_t kChannelBytes = 16;
    std::size_t at = 0;
    while (at < value.size() && value[at] != '\0') {
      const std::size_t end = value.find('\0', at);
      if (end == std::string_view::npos) return false;
      at = end + 1 + kChannelBytes;
    }
    return at + 1 == value.size();
  }
  if (type == "stringvector") {  // each with its length
    std::size_t at = 0;
    while (at + 4 <= value.size() && number(at) <= value.size() - at - 4) at += 4 + number(at);
    return at == value.size();
  }
  return true;
}

/// Header attributes of an EXR (openexr.com, file layout): name, type, length, value. Lengths must fit into the file.
void exr_size(FileBytes& file, PictureHeader& header) {
  const auto version = file.little_endian(4, 4);
  if (version & 0x1800U) file.broken("it holds several parts, or several values at a depth each");
  const std::string head = file.up_to(0, limit::kPictureHeadBytes);
  const std::string_view text(head);
  std::size_t at = 8;
  const auto word = [&]() -> std::string_view {
    const std::size_t end = text.find('\0', at);
    if (end == std::string_view::npos || end - at > 255) file.broken("an attribute has no name");
    const std::string_view out = text.substr(at, end - at);
    at = end + 1;
    return out;
  };
  for (;;) {
    if (at >= text.size()) file.broken("its header does not end");
    if (text[at] == '\0') break;
    const std::string_view name = word();
    const std::string_view type = word();
    if (text.size() - std::min(at, text.size()) < 4) file.broken("its header does not end");
    const auto length = file.little_endian(at, 4);
    at += 4;
    if (length > text.size() - std::min(at, text.size())) file.broken("an attribute is longer than the file");
    if (!is_as_long_as_its_type(type, text.substr(at, length)))
      file.broken("an attribute has not the length of its type");
    if (name == "dataWindow" || name == "displayWindow") {
      if (length != 16) file.broken("its window is none");
      const auto v = [&](int i) { return as_signed(file.little_endian(at + 4 * static_cast<std::size_t>(i), 4)); };
      if (v(2) < v(0) || v(3) < v(1)) file.broken("its window is none");
      take(header, v(2) - v(0) + 1, v(3) - v(1) + 1);
    }
    if (name == "tiles" && length >= 8) {
      const double w = static_cast<double>(file.little_endian(at, 4)),
                   h = static_cast<double>(file.little_endian(at + 4, 4));
      if (!(w >= 1 && h >= 1 && w * h * 4 * limit::kChannels <= static_cast<double>(limit::kTileBytes)))
        file.broken("its tiles are of " + std::to_string(static_cast<std::int64_t>(w)) + " x " +
                    std::to_string(static_cast<std::int64_t>(h)) + " pixels");
    }
    at += length;
  }
}

/// "-Y 480 +X 640" behind the first empty line: whichever stands first runs slower.
void hdr_size(FileBytes& file, PictureHeader& header) {
  const std::string head = file.up_to(0, 64 * limit::kKiB);
  const std::size_t blank = head.find("\n\n");
  if (blank == std::string::npos) file.broken("its header does not end");
  const std::string line = head.substr(blank + 2, std::min<std::size_t>(head.find('\n', blank + 2) - blank - 2, 60));
  const std::size_t x = line.find('X'), y = line.find('Y');
  if (x == std::string::npos || y == std::string::npos) file.broken("it names no size");
  take(header, std::atoll(line.c_str() + x + 1), std::atoll(line.c_str() + y + 1));
}

/// Every size that the boxes of the file's "meta" name ("ispe", ISO 23008-12, 6.5.3): tiles' and the whole's.
void heif_size(FileBytes& file, PictureHeader& header) {
  std::uintmax_t at = 0;
  for (int box = 0; box < 1000 && at + 8 <= file.size(); ++box) {
    std::uint64_t length = file.big_endian(at, 4);
    const std::string type = file.at(at + 4, 4);
    std::uint64_t header_bytes = 8;
    if (length == 1) length = file.big_endian(at + 8, 8), header_bytes = 16;
    if (length == 0) length = file.size() - at;
    if (length < header_bytes || length > file.size() - at) file.broken("a box is longer than the file");
    if (type == "meta" || type == "moov") {
      if (length > limit::kPictureHeadBytes) file.broken("its description is longer than any camera writes");
      const std::string meta = file.at(at, length);
      for (std::size_t i = meta.find("ispe"); i != std::string::npos; i = meta.find("ispe", i + 4))
        if (i + 16 <= meta.size())
          take(header, as_signed(file.big_endian(at + i + 8, 4)), as_signed(file.big_endian(at + i + 12, 4)));
    }
    at += length;
  }
  if (header.width == 0) file.broken("it names no size");
}

void webp_size(FileBytes& file, PictureHeader& header) {
  const std::string kind = file.at(12, 4);
  const auto v = [&](std::uintmax_t at, int bytes) { return static_cast<std::int64_t>(file.little_endian(at, bytes)); };
  if (kind == "VP8X") return take(header, v(24, 3) + 1, v(27, 3) + 1);
  if (kind == "VP8 ") return take(header, v(26, 2) & 0x3FFF, v(28, 2) & 0x3FFF);
  if (kind == "VP8L") return take(header, (v(21, 4) & 0x3FFF) + 1, (v(21, 4) >> 14 & 0x3FFF) + 1);
  file.broken("it names no size");
}

void bmp_size(FileBytes& file, PictureHeader& header) {
  if (file.little_endian(14, 4) == 12)
    return take(header, static_cast<std::int64_t>(file.little_endian(18, 2)),
                static_cast<std::int64_t>(file.little_endian(20, 2)));
  take(header, as_signed(file.little_endian(18, 4)), std::abs(as_signed(file.little_endian(22, 4))));
}

void pnm_size(FileBytes& file, PictureHeader& header) {
  const std::string head = file.up_to(0, 4 * limit::kKiB);
  std::size_t at = 2;
  std::int64_t size[2] = {0, 0};
  for (std::int64_t& side : size) {
    while (at < head.size() && (std::isspace(static_cast<unsigned char>(head[at])) || head[at] == '#'))
      at = head[at] == '#' ? std::min(head.find('\n', at), head.size()) : at + 1;
    for (; at < head.size() && std::isdigit(static_cast<unsigned char>(head[at])) && side < 1'000'000'000; ++at)
      side = 10 * side + (head[at] - '0');
  }
  take(header, size[0], size[1]);
}

struct Kind {
  const char* name;  // OpenImageIO's
  void (*size)(FileBytes&, PictureHeader&);
};

// Chunks (PNG 1.2, 3.2): libpng takes memory for a whole note, however long it says that it is. Pixels come piece by
// piece.
void png_size(FileBytes& file, PictureHeader& header) {
  take(header, static_cast<std::int64_t>(file.big_endian(16, 4)), static_cast<std::int64_t>(file.big_endian(20, 4)));
  constexpr std::uintmax_t kFrame = 12;  // length and name before, checksum behind
  constexpr int kMostChunks = 2'000'000;
  std::uintmax_t at = 8;
  for (int chunk = 0; at + kFrame <= file.size(); ++chunk) {
    if (chunk == kMostChunks) file.broken("it has more than 2,000,000 chunks");
    const auto length = file.big_endian(at, 4);
    const std::string name = file.at(at + 4, 4);
    if (name == "IEND") return;
    if (name != "IDAT") {
      if (length > file.size() - at - kFrame) file.broken("a chunk is longer than the file");
      if (length > limit::kPictureHeadBytes) file.broken("a chunk of notes is longer than 16 MiB");
    }
    at += kFrame + length;
  }
}

void gif_size(FileBytes& file, PictureHeader& header) {
  take(header, static_cast<std::int64_t>(file.little_endian(6, 2)),
       static_cast<std::int64_t>(file.little_endian(8, 2)));
}

/// LibRaw 0.20 and 0.21 put a Hasselblad's model together from several notes, and write past its place where these are
/// long or have no end. A camera is a Hasselblad to them if its maker's note has that word, in whatever case.
void refuse_hasselblad(FileBytes& file, const std::string& name) {
  constexpr std::string_view kMaker = "hasselblad";
  constexpr std::uintmax_t kPiece = limit::kMiB;
  const auto in_lower_case = [](char a, char b) { return std::tolower(static_cast<unsigned char>(a)) == b; };
  for (std::uintmax_t at = 0; at + kMaker.size() <= file.size(); at += kPiece) {
    const std::string piece = file.up_to(at, kPiece + kMaker.size() - 1);
    if (std::search(piece.begin(), piece.end(), kMaker.begin(), kMaker.end(), in_lower_case) != piece.end())
      fail(name, "is a Hasselblad's raw file, for which the library that reads raw files cannot be trusted",
           "export it as a TIFF of 16 bits, linear, with the program that came with the camera");
  }
}

/// What a file's first bytes say that it is; nothing for what is none of ours.
Kind kind_of(std::string_view head) {
  using namespace std::string_view_literals;
  if (head.starts_with("\x89PNG\r\n\x1a\n"sv)) return {"png", png_size};
  if (head.starts_with("\xFF\xD8\xFF"sv)) return {"jpeg", jpeg_size};
  for (const std::string_view tiff : {"II*\0"sv, "MM\0*"sv, "II+\0"sv, "MM\0+"sv})
    if (head.starts_with(tiff)) return {"tiff", tiff_size};
  if (head.starts_with("\x76\x2f\x31\x01"sv)) return {"openexr", exr_size};
  if (head.starts_with("#?RADIANCE"sv) || head.starts_with("#?RGBE"sv)) return {"hdr", hdr_size};
  if (head.size() >= 12 && head.substr(4, 4) == "ftyp"sv && head.substr(8, 3) != "crx"sv) return {"heif", heif_size};
  if (head.starts_with("RIFF"sv) && head.size() >= 16 && head.substr(8, 4) == "WEBP"sv) return {"webp", webp_size};
  if (head.starts_with("BM"sv)) return {"bmp", bmp_size};
  if (head.starts_with("GIF8"sv)) return {"gif", gif_size};
  if (head.size() >= 3 && head[0] == 'P' && head[1] >= '1' && head[1] <= '6' &&
      (std::isspace(static_cast<unsigned char>(head[2])) || head[2] == '#'))
    return {"pnm", pnm_size};
  return {"", nullptr};
}

}  // namespace

PictureHeader read_picture_header(const fs::path& file, bool raw_name) {
  constexpr std::uintmax_t kMagicBytes = 32;
  const std::string head = read_head(file, kMagicBytes);
  const std::uintmax_t size = require_plain_file(file, limit::kPictureBytes, "a picture");
  if (size == 0) fail(file.string(), "is empty", "copy it again from where it came from");
  FileBytes bytes(file, size);
  PictureHeader header;
  const Kind kind = kind_of(head);
  header.kind = raw_name ? "raw" : kind.name;
  if (kind.size != nullptr) kind.size(bytes, header);
  if (raw_name) refuse_hasselblad(bytes, file.string());
  if (header.kind.empty())
    fail(file.string(), "is no picture of a kind that Burin reads",
         "use PNG, JPEG, TIFF, EXR, HDR, HEIC, WebP, BMP, GIF or PNM, or a camera's raw file under its own name");
  return header;
}

}  // namespace burin

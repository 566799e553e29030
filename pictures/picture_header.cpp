// Declared sizes of pictures, parsed by hand: a few fixed offsets, or a walk over sections whose lengths are compared
// with the file's. The parser assumes nothing and decodes nothing.
#include "burin/pictures/picture_header.h"

#include <OpenImageIO/imageio.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <string_view>

#include "burin/base/error.h"
#include "burin/base/files/file_names.h"
#include "burin/base/files/input_file.h"
#include "burin/base/limits.h"
#include "burin/pictures/heif_boxes.h"
#include "burin/pictures/picture_bytes.h"
#include "burin/pictures/tiff_directory.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

/// The larger of two sizes in one file counts.
void take(PictureHeader& header, std::int64_t width, std::int64_t height) {
  if (width <= 0 || height <= 0) return;
  if (static_cast<double>(width) * static_cast<double>(height) >
      static_cast<double>(header.width) * static_cast<double>(header.height)) {
    header.width = width;
    header.height = height;
  }
}

std::int64_t as_signed(std::uint64_t v) { return static_cast<std::int32_t>(static_cast<std::uint32_t>(v)); }

// Segments up to the frame (ITU T.81, B.2.2).
void jpeg_size(PictureBytes& file, PictureHeader& header) {
  constexpr int kMostSegments = 10'000;
  std::uintmax_t at = 2;
  for (int segment = 0; segment < kMostSegments; ++segment) {
    if (file.big_endian(at, 1) != 0xFF) file.broken("a marker is missing");
    const auto marker = file.big_endian(at + 1, 1);
    if (marker == 0xFF) {  // fill byte
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

/// True if the first bytes are those of a camera's raw file, except raw files that begin as a TIFF.
bool is_raw_head(std::string_view head) {
  using namespace std::string_view_literals;
  for (const std::string_view raw : {"FUJIFILMCCD-RAW"sv, "IIU\0"sv, "IIRO"sv, "IIRS"sv, "MMOR"sv, "FOVb"sv, "\0MRM"sv})
    if (head.starts_with(raw)) return true;
  return (head.size() >= 14 && head.substr(6, 8) == "HEAPCCDR"sv) ||
         (head.size() >= 12 && head.substr(4, 8) == "ftypcrx "sv);
}

/// True if a file that begins as a TIFF is a camera's raw file. Its directories or the bytes after its header (Canon,
/// Phase One) decide. Otherwise its name decides, because the makers' formats have no common mark.
bool is_raw_tiff(std::string_view head, const std::vector<TiffDirectory>& directories, const fs::path& file) {
  const std::string_view mark = head.size() >= 12 ? head.substr(8, 4) : std::string_view();
  return mark.starts_with("CR") || mark == "IIII" || mark == "MMMM" ||
         std::any_of(directories.begin(), directories.end(),
                     [](const TiffDirectory& d) { return d.dng || d.sensor_values(); }) ||
         has_raw_name(file);
}

bool is_jpeg_xl(const TiffDirectory& d) {
  return d.compression == 52546 || d.compression == 50002;
}  // DNG 1.7; libtiff

/// Refuses JPEG XL, which the libraries for raw files and TIFF cannot unpack.
void refuse_jpeg_xl(const std::vector<TiffDirectory>& directories, bool is_raw, const std::string& name) {
  if (!is_raw && !directories.empty() && is_jpeg_xl(directories.front()))
    fail(name, "is a TIFF compressed by JPEG XL, which Burin does not read",
         "save it as PNG, or as TIFF with another compression");
  if (is_raw && std::any_of(directories.begin(), directories.end(),
                            [](const TiffDirectory& d) { return is_jpeg_xl(d) && d.sensor_values(); }))
    fail(name, "is a raw file (DNG) compressed by JPEG XL, which Burin does not read",
         "on an iPhone choose JPEG Lossless, not JPEG-XL (Settings > Camera > Formats > ProRAW Format); or convert it "
         "with Adobe DNG Converter, compatibility Camera Raw 15.3 or older");
}

void tiff_size(PictureBytes& file, PictureHeader& header) {
  const std::vector<TiffDirectory> directories = read_tiff_directories(file);
  for (const TiffDirectory& d : directories) {
    take(header, d.width, d.height);
    if (header.iso == 0) header.iso = d.iso;
  }
  if (!directories.empty()) require_parts_within(file, directories.front());
}

/// True if the length of an EXR's attribute matches its type. OpenEXR reads by type and ignores the declared length, so
/// a wrong one displaces all following data.
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
void exr_size(PictureBytes& file, PictureHeader& header) {
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

/// "-Y 480 +X 640" after the first empty line: the first number belongs to the slower axis.
void hdr_size(PictureBytes& file, PictureHeader& header) {
  const std::string head = file.up_to(0, 64 * limit::kKiB);
  const std::size_t blank = head.find("\n\n");
  if (blank == std::string::npos) file.broken("its header does not end");
  const std::string line = head.substr(blank + 2, std::min<std::size_t>(head.find('\n', blank + 2) - blank - 2, 60));
  const std::size_t x = line.find('X'), y = line.find('Y');
  if (x == std::string::npos || y == std::string::npos) file.broken("it names no size");
  take(header, std::atoll(line.c_str() + x + 1), std::atoll(line.c_str() + y + 1));
}

void heif_size(PictureBytes& file, PictureHeader& header) {
  const HeifBoxes boxes = read_heif_boxes(file);
  take(header, boxes.width, boxes.height);
  header.moves = boxes.moves;
}

/// EXIF from its TIFF header on; empty if there is none. Some writers keep JPEG's name before it.
std::string exif_within(std::string_view bytes) {
  using namespace std::string_view_literals;
  if (bytes.starts_with("Exif\0\0"sv)) bytes.remove_prefix(6);
  return bytes.starts_with("II*\0"sv) || bytes.starts_with("MM\0*"sv) ? std::string(bytes) : std::string();
}

/// EXIF as programs wrote it before PNG had a chunk for it: a text "Raw profile type exif" (or APP1) of hexadecimal
/// numbers, after a line with its name and one with its length.
std::string exif_of_raw_profile(std::string_view chunk, bool packed) {
  using namespace std::string_view_literals;
  constexpr std::string_view kExif = "Raw profile type exif\0"sv, kApp1 = "Raw profile type APP1\0"sv;
  if (!chunk.starts_with(kExif) && !chunk.starts_with(kApp1)) return {};
  chunk.remove_prefix(kExif.size());
  std::string text(chunk);
  if (packed) {
    if (chunk.empty() || chunk[0] != '\0') return {};  // deflate is the only compression
    text.resize(limit::kMiB);
    uLongf length = static_cast<uLongf>(text.size());
    if (uncompress(reinterpret_cast<Bytef*>(text.data()), &length, reinterpret_cast<const Bytef*>(chunk.data() + 1),
                   static_cast<uLong>(chunk.size() - 1)) != Z_OK)
      return {};
    text.resize(length);
  }
  std::size_t at = text.find_first_not_of('\n');
  for (int line = 0; line < 2 && at < text.size(); ++line) at = std::min(text.find('\n', at), text.size() - 1) + 1;
  std::string bytes;
  int high = -1;
  for (; at < text.size(); ++at) {
    const char c = static_cast<char>(std::tolower(static_cast<unsigned char>(text[at])));
    if (!std::isxdigit(static_cast<unsigned char>(c))) continue;
    const int digit = c <= '9' ? c - '0' : c - 'a' + 10;
    if (high >= 0) bytes += static_cast<char>(16 * high + digit);
    high = high >= 0 ? -1 : digit;
  }
  return exif_within(bytes);
}

/// Sizes, and EXIF from a chunk after the pixels (WebP container specification).
void webp_size(PictureBytes& file, PictureHeader& header) {
  const std::string kind = file.at(12, 4);
  const auto v = [&](std::uintmax_t at, int bytes) { return static_cast<std::int64_t>(file.little_endian(at, bytes)); };
  if (kind == "VP8 ") return take(header, v(26, 2) & 0x3FFF, v(28, 2) & 0x3FFF);
  if (kind == "VP8L") return take(header, (v(21, 4) & 0x3FFF) + 1, (v(21, 4) >> 14 & 0x3FFF) + 1);
  if (kind != "VP8X") file.broken("it names no size");
  take(header, v(24, 3) + 1, v(27, 3) + 1);
  constexpr std::uint64_t kMoves = 2;
  header.moves = (file.little_endian(20, 1) & kMoves) != 0;
  constexpr int kMostChunks = 100'000;
  std::uintmax_t at = 12;
  for (int chunk = 0; at + 8 <= file.size() && chunk < kMostChunks; ++chunk) {
    const auto length = file.little_endian(at + 4, 4);
    if (file.at(at, 4) == "EXIF" && length <= limit::kMiB) header.exif = exif_within(file.up_to(at + 8, length));
    at += 8 + length + length % 2;
  }
}

void bmp_size(PictureBytes& file, PictureHeader& header) {
  if (file.little_endian(14, 4) == 12)
    return take(header, static_cast<std::int64_t>(file.little_endian(18, 2)),
                static_cast<std::int64_t>(file.little_endian(20, 2)));
  take(header, as_signed(file.little_endian(18, 4)), std::abs(as_signed(file.little_endian(22, 4))));
  const auto compression = file.little_endian(30, 4);
  header.has_runs = compression == 1 || compression == 2;
}

void pnm_size(PictureBytes& file, PictureHeader& header) {
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
  const char* name;  // OpenImageIO's name
  void (*size)(PictureBytes&, PictureHeader&);
};

// Chunks (PNG 1.2, 3.2) up to the last one: name, offset of its content, length.
template <typename Look>
void each_png_chunk(PictureBytes& file, const Look& look) {
  constexpr std::uintmax_t kFrame = 12;  // length and name before, checksum after
  constexpr int kMostChunks = 2'000'000;
  std::uintmax_t at = 8;
  for (int chunk = 0; at + kFrame <= file.size(); ++chunk) {
    if (chunk == kMostChunks) file.broken("it has more than 2,000,000 chunks");
    const std::uintmax_t length = file.big_endian(at, 4);
    const std::string name = file.at(at + 4, 4);
    if (name == "IEND") return;
    look(name, at + 8, length);
    at += kFrame + length;
  }
}

bool matches_png_checksum(PictureBytes& file, const std::string& name, std::uintmax_t place, std::uintmax_t length) {
  uLong sum = crc32(0, reinterpret_cast<const Bytef*>(name.data()), 4);
  for (std::uintmax_t done = 0; done < length; done += limit::kMiB) {
    const std::string piece = file.at(place + done, std::min<std::uintmax_t>(limit::kMiB, length - done));
    sum = crc32(sum, reinterpret_cast<const Bytef*>(piece.data()), static_cast<uInt>(piece.size()));
  }
  return sum == file.big_endian(place + length, 4);
}

// libpng allocates the declared length of a note as a whole, for any length. Pixels come piece by piece. EXIF may
// follow them, and OpenImageIO 2.4 ignores it there. libpng prints its own line to standard error before it fails, as
// it does for unusable chunks: these have a name with a capital (PNG 1.2, 3.3).
void png_size(PictureBytes& file, PictureHeader& header) {
  take(header, static_cast<std::int64_t>(file.big_endian(16, 4)), static_cast<std::int64_t>(file.big_endian(20, 4)));
  constexpr std::uintmax_t kFirst = 16;  // the place of IHDR's content
  std::string unusable;
  each_png_chunk(file, [&](const std::string& name, std::uintmax_t place, std::uintmax_t length) {
    if (name == "IDAT") return;
    if (length > file.size() - place - 4) file.broken("a chunk is longer than the file");
    if (length > limit::kPictureHeadBytes) file.broken("a chunk of notes is longer than 16 MiB");
    if (name == "eXIf") header.exif = exif_within(file.at(place, length));
    if (name == "acTL") header.moves = true;
    const bool text = name == "zTXt" || name == "tEXt";
    if (text && header.exif.empty()) header.exif = exif_of_raw_profile(file.at(place, length), name == "zTXt");
    const bool belongs_there = place == kFirst ? name == "IHDR" : name == "PLTE" || (name.front() & 0x20) != 0;
    if (unusable.empty() && !belongs_there) unusable = "its chunk " + name + " does not belong there";
    if (unusable.empty() && (name == "IHDR" || name == "PLTE") && !matches_png_checksum(file, name, place, length))
      unusable = "its chunk " + name + " does not match its checksum";
  });
  if (!unusable.empty()) file.broken(unusable);
}

/// Size, and whether a second picture follows the first (GIF89a, 18 to 23).
void gif_size(PictureBytes& file, PictureHeader& header) {
  take(header, static_cast<std::int64_t>(file.little_endian(6, 2)),
       static_cast<std::int64_t>(file.little_endian(8, 2)));
  constexpr int kMostBlocks = 100'000;
  const auto colors = [](std::uint64_t flags) {
    return (flags & 0x80U) != 0 ? 3 * (std::uintmax_t{2} << (flags & 7U)) : 0;
  };
  const auto byte = [&](std::uintmax_t at) { return at < file.size() ? file.little_endian(at, 1) : 0; };
  std::uintmax_t at = 13 + colors(byte(10));
  int pictures = 0;
  for (int block = 0; block < kMostBlocks && at < file.size() && !header.moves; ++block) {
    const auto kind = byte(at);
    if (kind != 0x2C && kind != 0x21) break;
    if (kind == 0x2C) header.moves = ++pictures > 1;
    at += kind == 0x2C ? 11 + colors(byte(at + 9)) : 2;
    for (; block < kMostBlocks && byte(at) != 0; ++block) at += 1 + byte(at);
    ++at;
  }
}

/// Refuses Hasselblad's raw files. LibRaw 0.20 and 0.21 assemble a Hasselblad's model from several notes, and write out
/// of bounds if these are long or unterminated. LibRaw detects the camera by this word in its maker's note, in any
/// case. Files with TIFF directories name the maker there; in others the word anywhere counts.
void refuse_hasselblad(PictureBytes& file, const std::vector<TiffDirectory>& directories, const std::string& name) {
  constexpr std::string_view kMaker = "hasselblad";
  constexpr std::uintmax_t kPiece = limit::kMiB;
  const auto in_lower_case = [](char a, char b) { return std::tolower(static_cast<unsigned char>(a)) == b; };
  const auto named_in = [&](std::string_view text) {
    return std::search(text.begin(), text.end(), kMaker.begin(), kMaker.end(), in_lower_case) != text.end();
  };
  bool has_maker = false, is_one = false;
  for (const TiffDirectory& d : directories) {
    has_maker = has_maker || !d.maker.empty();
    is_one = is_one || named_in(d.maker);
  }
  for (std::uintmax_t at = 0; !has_maker && !is_one && at + kMaker.size() <= file.size(); at += kPiece)
    is_one = named_in(file.up_to(at, kPiece + kMaker.size() - 1));
  if (is_one)
    fail(name, "is a Hasselblad's raw file, for which the library that reads raw files cannot be trusted",
         "export it as a TIFF of 16 bits, linear, with the program that came with the camera");
}

/// True if a file of boxes ("ftyp", ISO/IEC 14496-12, 4.3) holds pictures; video files have the same structure.
bool is_heif_head(std::string_view head) {
  using namespace std::string_view_literals;
  if (head.size() < 12 || head.substr(4, 4) != "ftyp"sv) return false;
  constexpr std::array<std::string_view, 12> kBrands{"heic", "heix", "heim", "heis", "hevc", "hevx",
                                                     "mif1", "mif2", "msf1", "avif", "avis", "miaf"};
  const std::size_t length = std::min<std::size_t>(static_cast<unsigned char>(head[3]), head.size());
  for (std::size_t at = 8; at + 4 <= length; at += at == 8 ? 8 : 4)  // skips the version
    if (std::find(kBrands.begin(), kBrands.end(), head.substr(at, 4)) != kBrands.end()) return true;
  return false;
}

/// "P6" and a number, or a comment.
bool is_pnm_head(std::string_view head) {
  if (head.size() < 4 || head[0] != 'P' || head[1] < '1' || head[1] > '6') return false;
  std::size_t at = 2;
  while (at < head.size() && std::isspace(static_cast<unsigned char>(head[at]))) ++at;
  return at > 2 && at < head.size() && (head[at] == '#' || std::isdigit(static_cast<unsigned char>(head[at])));
}

/// "BM", and a header of one of the defined lengths.
bool is_bmp_head(std::string_view head) {
  constexpr std::string_view kLengths = "\x0c\x10\x28\x34\x38\x40\x6c\x7c";
  return head.starts_with("BM") && head.size() >= 18 && kLengths.find(head[14]) != std::string_view::npos &&
         head[15] == '\0' && head[16] == '\0' && head[17] == '\0';
}

/// Kind of a file by its first bytes; empty for an unsupported one.
Kind kind_of(std::string_view head) {
  using namespace std::string_view_literals;
  if (head.starts_with("\x89PNG\r\n\x1a\n"sv)) return {"png", png_size};
  if (head.starts_with("\xFF\xD8\xFF"sv)) return {"jpeg", jpeg_size};
  for (const std::string_view tiff : {"II*\0"sv, "MM\0*"sv, "II+\0"sv, "MM\0+"sv})
    if (head.starts_with(tiff)) return {"tiff", tiff_size};
  if (head.starts_with("\x76\x2f\x31\x01"sv)) return {"openexr", exr_size};
  if (head.starts_with("#?RADIANCE"sv) || head.starts_with("#?RGBE"sv)) return {"hdr", hdr_size};
  if (is_raw_head(head)) return {"raw", nullptr};
  if (is_heif_head(head)) return {"heif", heif_size};
  if (head.starts_with("RIFF"sv) && head.size() >= 16 && head.substr(8, 4) == "WEBP"sv) return {"webp", webp_size};
  if (is_bmp_head(head)) return {"bmp", bmp_size};
  if (head.starts_with("GIF87a"sv) || head.starts_with("GIF89a"sv)) return {"gif", gif_size};
  if (is_pnm_head(head)) return {"pnm", pnm_size};
  return {"", nullptr};
}

/// Files of programs that people mistake for pictures, by their first bytes: name and remedy.
std::pair<std::string, std::string> other_kind(std::string_view head) {
  using namespace std::string_view_literals;
  constexpr const char* kExport = "export it as PNG";
  const std::size_t text = std::min(head.find_first_not_of("\xEF\xBB\xBF \t\r\n"sv), head.size());
  if (head.substr(text).starts_with("<svg"sv) ||
      (head.substr(text).starts_with("<?xml"sv) && head.find("<svg"sv) != std::string_view::npos))
    return {"is a drawing of lines (SVG), which has no pixels", kExport};
  if (head.starts_with("%PDF"sv)) return {"is a PDF, which has no pixels of its own", kExport};
  if (head.starts_with("%!PS"sv)) return {"is PostScript, which has no pixels of its own", kExport};
  if (head.starts_with("8BPS"sv)) return {"is a Photoshop document", kExport};
  if (head.starts_with("\xFF\x0A"sv) || head.starts_with("\0\0\0\x0CJXL "sv)) return {"is a JPEG XL picture", kExport};
  if (head.starts_with("\0\0\0\x0CjP  "sv) || head.starts_with("\xFF\x4F\xFF\x51"sv))
    return {"is a JPEG 2000 picture", kExport};
  if (head.size() >= 12 && head.substr(4, 4) == "ftyp"sv) return {"is a film", "take a frame of it out, as PNG"};
  return {"is no picture of a kind that Burin reads", "use PNG, JPEG, TIFF, EXR, HDR, HEIC, WebP, BMP, GIF or PNM"};
}

constexpr std::uintmax_t kMagicBytes = 512;

}  // namespace

bool has_raw_name(const fs::path& file) {
  constexpr std::array<std::string_view, 18> kRaws{".dng", ".cr2", ".cr3", ".crw", ".nef", ".nrw",
                                                   ".arw", ".sr2", ".raf", ".orf", ".rw2", ".pef",
                                                   ".srw", ".erf", ".3fr", ".iiq", ".rwl", ".x3f"};
  return std::find(kRaws.begin(), kRaws.end(), lower_extension(file)) != kRaws.end();
}

std::string picture_kind(const fs::path& file) {
  std::string kind;
  try {
    const std::string head = read_head(file, kMagicBytes);
    kind = kind_of(head).name;
    if (kind != "tiff") return kind;
    if (has_raw_name(file)) return "raw";
    PictureBytes bytes(file, require_plain_file(file, limit::kPictureBytes, "a picture"));
    return is_raw_tiff(head, read_tiff_directories(bytes), file) ? "raw" : "tiff";
  } catch (const Error&) {  // the reader reports it
    return kind;
  }
}

PictureHeader read_picture_header(const fs::path& file) {
  const std::string head = read_head(file, kMagicBytes);
  const std::uintmax_t size = require_plain_file(file, limit::kPictureBytes, "a picture");
  if (size == 0) fail(file.string(), "is empty", "copy it again from where it came from");
  PictureBytes bytes(file, size);
  PictureHeader header;
  const Kind kind = kind_of(head);
  header.kind = kind.name;
  std::vector<TiffDirectory> directories;
  if (header.kind == "tiff") {
    directories = read_tiff_directories(bytes);
    if (is_raw_tiff(head, directories, file)) header.kind = "raw";
  }
  refuse_jpeg_xl(directories, header.kind == "raw", file.string());
  if (header.kind == "raw") {
    refuse_hasselblad(bytes, directories, file.string());
    for (const TiffDirectory& d : directories) {
      take(header, d.width, d.height);
      if (d.sensor_values()) require_parts_within(bytes, d);
    }
    return header;
  }
  if (kind.size == nullptr) {
    const auto [what, remedy] = other_kind(head);
    fail(file.string(), what, remedy);
  }
  kind.size(bytes, header);
  return header;
}

namespace {

// libpng prints its own line to standard error before it fails.
void require_whole_png(PictureBytes& bytes) {
  each_png_chunk(bytes, [&](const std::string& name, std::uintmax_t place, std::uintmax_t length) {
    if (name != "IDAT") return;
    if (length > bytes.size() - place - 4) bytes.cut_short("its pixels are not all there");
    if (!matches_png_checksum(bytes, name, place, length)) bytes.broken("its pixels do not match their checksum");
  });
}

}  // namespace

void require_whole(const OIIO::ImageInput& input, const fs::path& file) {
  const std::string_view kind = input.format_name();
  if (kind != "png" && kind != "tiff") return;
  PictureBytes bytes(file, require_plain_file(file, limit::kPictureBytes, "a picture"));
  if (kind == "png") return require_whole_png(bytes);
  const std::vector<TiffDirectory> directories = read_tiff_directories(bytes);
  if (!directories.empty()) require_parts_unpack(bytes, directories.front());
}

}  // namespace burin

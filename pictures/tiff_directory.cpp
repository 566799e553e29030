#include "burin/pictures/tiff_directory.h"

#include <zlib.h>

#include <array>
#include <limits>
#include <optional>
#include <set>
#include <string_view>

#include "burin/base/limits.h"

namespace burin {
namespace {

constexpr std::int64_t kNone = 1, kLzw = 5, kAdobeDeflate = 8, kDeflate = 32946, kPackBits = 32773;
constexpr std::int64_t kYCbCr = 6;

/// Encoding of a TIFF: byte order, and words of 4 bytes or, in a BigTIFF, of 8.
struct TiffOrder {
  bool big = false, large = false;
  int word() const { return large ? 8 : 4; }
};

/// An entry's values, one by one (bytes, shorts, longs), at most `most`.
std::vector<std::uint64_t> values_of(PictureBytes& file, const TiffOrder& order, std::uint64_t entry,
                                     std::uint64_t most) {
  const auto type = file.number(entry + 2, 2, order.big);
  const std::uint64_t all = file.number(entry + 4, order.word(), order.big), count = std::min(all, most);
  const int bytes = type == 3 ? 2 : type == 16 || type == 18 ? 8 : type == 1 || type == 2 || type == 7 ? 1 : 4;
  const std::uint64_t at = entry + 4 + static_cast<std::uint64_t>(order.word());
  const bool here = all * static_cast<std::uint64_t>(bytes) <= static_cast<std::uint64_t>(order.word());
  const std::uint64_t place = here ? at : file.number(at, order.word(), order.big);
  const std::string text = file.at(place, count * static_cast<std::uint64_t>(bytes));
  std::vector<std::uint64_t> values(count);
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = PictureBytes::number_of(text, i * static_cast<std::size_t>(bytes), bytes, order.big);
  return values;
}

void read_entry(PictureBytes& file, const TiffOrder& order, std::uint64_t entry, TiffDirectory& out,
                std::vector<std::uint64_t>& more) {
  constexpr std::uint64_t kMostParts = 8'000'000, kMostText = 256, kMostBelow = 16;
  const auto first = [&] {
    const auto v = values_of(file, order, entry, 1);
    return v.empty() ? std::int64_t{0} : static_cast<std::int64_t>(std::min<std::uint64_t>(v[0], 0xFFFFFFFFU));
  };
  switch (file.number(entry, 2, order.big)) {
    case 256:
      out.width = first();
      break;
    case 257:
      out.height = first();
      break;
    case 258:
      out.bits = first();
      break;
    case 259:
      out.compression = first();
      break;
    case 262:
      out.photometric = first();
      break;
    case 266:
      out.fill_order = first();
      break;
    case 277:
      out.samples = first();
      break;
    case 278:
      out.rows_per_strip = first();
      break;
    case 284:
      out.planes = first();
      break;
    case 322:
      out.tile_width = first();
      break;
    case 323:
      out.tile_height = first();
      break;
    case 273:
    case 324:
      out.place = values_of(file, order, entry, kMostParts);
      break;
    case 279:
    case 325:
      out.bytes = values_of(file, order, entry, kMostParts);
      break;
    case 271:
    case 50708:
      for (const std::uint64_t letter : values_of(file, order, entry, kMostText))
        out.maker += static_cast<char>(letter);
      out.maker += '\n';
      break;
    case 330: {  // SubIFDs
      const auto below = values_of(file, order, entry, kMostBelow);
      more.insert(more.end(), below.begin(), below.end());
      break;
    }
    case 34665:
      out.exif = static_cast<std::uint64_t>(first());
      break;
    case 34855:
      out.iso = first();
      break;
    case 50706:
      out.dng = true;
      break;
    default:
      break;
  }
}

void require_sensible_parts(const PictureBytes& file, const TiffDirectory& d) {
  if (d.samples > limit::kChannels || d.bits > 64)
    file.broken("its pixels have " + std::to_string(d.samples) + " values of " + std::to_string(d.bits) + " bits");
  if (d.tile_width > 0 && d.tile_height > 0 &&
      (d.tile_width > (1 << 16) || d.tile_height > (1 << 16) ||
       d.tile_width * d.tile_height * d.samples * 8 > limit::kTileBytes))
    file.broken("its tiles are of " + std::to_string(d.tile_width) + " x " + std::to_string(d.tile_height) + " pixels");
  // Strips may be higher than the picture, and 2^32 - 1 means no strips. OpenImageIO allocates memory for any number
  // that fits into a signed integer.
  if (d.rows_per_strip > d.height && d.rows_per_strip <= std::numeric_limits<std::int32_t>::max() &&
      d.rows_per_strip > limit::kTileBytes / (8 * std::max<std::int64_t>(1, d.width * d.samples)))
    file.broken("its strips are of " + std::to_string(d.width) + " x " + std::to_string(d.rows_per_strip) + " pixels");
}

/// Division of a directory's pixels into parts.
struct TiffParts {
  std::int64_t across = 1, down = 1, planes = 1;
  std::int64_t width = 0, height = 0;  ///< of one part, in pixels
  std::uint64_t count() const { return static_cast<std::uint64_t>(across * down * planes); }
};

TiffParts tiff_parts_of(const TiffDirectory& d) {
  TiffParts parts;
  const bool tiled = d.tile_width > 0 && d.tile_height > 0;
  parts.width = tiled ? d.tile_width : d.width;
  parts.height =
      tiled ? d.tile_height : std::clamp<std::int64_t>(d.rows_per_strip, 1, std::max<std::int64_t>(1, d.height));
  parts.across = (d.width + parts.width - 1) / std::max<std::int64_t>(1, parts.width);
  parts.down = (d.height + parts.height - 1) / parts.height;
  parts.planes = d.planes == 2 ? d.samples : 1;
  return parts;
}

/// The bytes of a part's pixels, unpacked. The last strip has the remaining height.
std::uint64_t unpacked_bytes(const TiffDirectory& d, const TiffParts& parts, std::uint64_t part) {
  std::int64_t rows = parts.height;
  if (d.tile_width == 0) {
    const auto at = static_cast<std::int64_t>(part) % parts.down;
    rows = std::min(rows, d.height - at * parts.height);
  }
  const std::int64_t row_bits = parts.width * (d.planes == 2 ? 1 : d.samples) * d.bits;
  return static_cast<std::uint64_t>(rows) * static_cast<std::uint64_t>((row_bits + 7) / 8);
}

/// Unpacked bytes of an LZW part (TIFF 6.0, section 13); stores only the length of each code. Empty for an impossible
/// code.
std::optional<std::uint64_t> lzw_bytes(std::string_view packed) {
  constexpr std::uint32_t kClear = 256, kEnd = 257, kFirst = 258, kMost = 4096;
  std::array<std::uint64_t, kMost> length{};
  std::fill(length.begin(), length.begin() + kClear, 1);
  std::uint64_t out = 0;
  std::uint32_t next = kFirst, width = 9, bits = 0, held = 0, before = kEnd;
  for (const char c : packed) {
    held = held << 8U | static_cast<unsigned char>(c);
    bits += 8;
    if (bits < width) continue;
    bits -= width;
    const std::uint32_t code = held >> bits & ((1U << width) - 1);
    if (code == kEnd) return out;
    if (code == kClear) {
      next = kFirst;
      width = 9;
      before = kEnd;
      continue;
    }
    if (before == kEnd) {
      if (code > kClear) return std::nullopt;
    } else {
      if (code > next) return std::nullopt;
      if (next < kMost) length[next++] = length[before] + 1;
      if (code >= next) return std::nullopt;
      if (next == (1U << width) - 1 && width < 12) ++width;
    }
    out += length[code];
    before = code;
  }
  return out;
}

/// Unpacked bytes of a PackBits part (section 9), whose last bytes may be padding.
std::optional<std::uint64_t> packbits_bytes(std::string_view packed, std::uint64_t wanted) {
  constexpr std::size_t kFilling = 3;
  std::uint64_t out = 0;
  for (std::size_t i = 0; i < packed.size();) {
    if (out >= wanted && packed.size() - i <= kFilling) break;
    const auto run = static_cast<signed char>(packed[i]);
    ++i;
    if (run == -128) continue;
    out += static_cast<std::uint64_t>(run >= 0 ? run + 1 : 1 - run);
    i += static_cast<std::size_t>(run >= 0 ? run + 1 : 1);
    if (i > packed.size()) return std::nullopt;
  }
  return out;
}

/// Unpacked bytes of a Deflate part with a valid checksum.
std::optional<std::uint64_t> deflate_bytes(const std::string& packed) {
  z_stream stream{};
  if (inflateInit(&stream) != Z_OK) return std::nullopt;
  std::vector<unsigned char> out(64 * limit::kKiB);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
  stream.avail_in = static_cast<uInt>(packed.size());
  int state = Z_OK;
  std::uint64_t bytes = 0;
  while (state == Z_OK) {
    stream.next_out = out.data();
    stream.avail_out = static_cast<uInt>(out.size());
    state = inflate(&stream, Z_NO_FLUSH);
    bytes += out.size() - stream.avail_out;
  }
  inflateEnd(&stream);
  return state == Z_STREAM_END ? std::optional(bytes) : std::nullopt;
}

}  // namespace

std::vector<TiffDirectory> read_tiff_directories(PictureBytes& file) {
  constexpr std::size_t kMostDirectories = 64;
  constexpr std::uint64_t kMostEntries = 4096;
  const bool big = file.at(0, 1) == "M";
  const TiffOrder order{big, file.number(2, 2, big) == 43};
  const std::uint64_t head = order.large ? 8 : 2, entry_bytes = order.large ? 20 : 12;
  std::vector<std::uint64_t> wanted{file.number(order.large ? 8 : 4, order.word(), big)};
  std::set<std::uint64_t> seen, exif;
  std::vector<TiffDirectory> found;
  for (std::size_t i = 0; i < wanted.size() && found.size() < kMostDirectories; ++i) {
    const std::uint64_t at = wanted[i];
    if (at == 0 || !seen.insert(at).second) continue;
    const bool notes = exif.contains(at);  // an invalid offset from a program leaves the pixels intact
    if (notes && (at > file.size() || head > file.size() - at)) continue;
    const std::uint64_t count = file.number(at, static_cast<int>(head), big), first = at + head;
    if (count > kMostEntries || first + count * entry_bytes > file.size()) {
      if (notes) continue;
      file.broken("a directory is larger than the file");
    }
    TiffDirectory directory;
    for (std::uint64_t k = 0; k < count; ++k) read_entry(file, order, first + k * entry_bytes, directory, wanted);
    require_sensible_parts(file, directory);
    if (directory.exif != 0) {
      exif.insert(directory.exif);
      wanted.push_back(directory.exif);
    }
    found.push_back(std::move(directory));
    if (!notes) wanted.push_back(file.number(first + count * entry_bytes, order.word(), big));
  }
  return found;
}

void require_parts_within(PictureBytes& file, const TiffDirectory& d) {
  constexpr std::int64_t kOldJpeg = 6;  // may have none, because all data is in one stream
  if (d.width <= 0 || d.height <= 0 || d.compression == kOldJpeg) return;
  const TiffParts parts = tiff_parts_of(d);
  if (d.place.size() < parts.count())
    file.cut_short("it has " + std::to_string(d.place.size()) + " of its " + std::to_string(parts.count()) + " parts");
  for (std::size_t i = 0; i < parts.count(); ++i) {
    // Writers without compression are known to store wrong counts; the pixels' size is known.
    const std::uint64_t bytes = d.compression == kNone && d.photometric != kYCbCr ? unpacked_bytes(d, parts, i)
                                : i < d.bytes.size()                              ? d.bytes[i]
                                                                                  : 1;
    if (d.place[i] > file.size() || bytes > file.size() - d.place[i])
      file.cut_short("part " + std::to_string(i + 1) + " of its " + std::to_string(parts.count()) +
                     " lies beyond its end");
  }
}

void require_parts_unpack(PictureBytes& file, const TiffDirectory& d) {
  const bool packed = d.compression == kLzw || d.compression == kPackBits || d.compression == kDeflate ||
                      d.compression == kAdobeDeflate;
  if (!packed || d.fill_order == 2 || d.photometric == kYCbCr || d.width <= 0 || d.height <= 0) return;
  const TiffParts parts = tiff_parts_of(d);
  for (std::size_t i = 0; i < std::min<std::size_t>(parts.count(), d.place.size()); ++i) {
    const std::string bytes = file.at(d.place[i], i < d.bytes.size() ? d.bytes[i] : file.size() - d.place[i]);
    // LZW before TIFF 5 has the reverse bit order.
    if (d.compression == kLzw && bytes.size() > 1 && bytes[0] == '\0' && (bytes[1] & 1) != 0) return;
    const std::uint64_t wanted = unpacked_bytes(d, parts, i);
    const auto got = d.compression == kLzw        ? lzw_bytes(bytes)
                     : d.compression == kPackBits ? packbits_bytes(bytes, wanted)
                                                  : deflate_bytes(bytes);
    // Some writers pad the last strip.
    if (got != wanted && got != unpacked_bytes(d, parts, 0))
      file.broken("part " + std::to_string(i + 1) + " of its " + std::to_string(parts.count()) +
                  " does not unpack to its pixels");
  }
}

}  // namespace burin

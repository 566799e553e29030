#include "tools/animated_png.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "burin/base/error.h"

namespace burin {
namespace {

constexpr std::string_view kSignature("\x89PNG\r\n\x1a\n", 8);

constexpr std::array<std::uint32_t, 256> crc_table() {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t i = 0; i < 256; ++i) {
    std::uint32_t c = i;
    for (int bit = 0; bit < 8; ++bit) c = (c & 1U) != 0 ? 0xedb88320U ^ (c >> 1) : c >> 1;
    table[i] = c;
  }
  return table;
}

std::uint32_t crc_of(std::string_view bytes) {
  static constexpr auto kTable = crc_table();
  std::uint32_t c = 0xffffffffU;
  for (const char byte : bytes) c = kTable[(c ^ static_cast<unsigned char>(byte)) & 0xffU] ^ (c >> 8);
  return c ^ 0xffffffffU;
}

std::string big_endian(std::uint32_t v, int bytes = 4) {
  std::string out;
  for (int i = bytes - 1; i >= 0; --i) out.push_back(static_cast<char>((v >> (8 * i)) & 0xffU));
  return out;
}

std::uint32_t number_at(std::string_view bytes) {
  std::uint32_t v = 0;
  for (int i = 0; i < 4; ++i) v = (v << 8) | static_cast<unsigned char>(bytes[static_cast<std::size_t>(i)]);
  return v;
}

struct Chunk {
  std::string_view type, data;
};

std::vector<Chunk> chunks_of(std::string_view png) {
  std::vector<Chunk> out;
  if (!png.starts_with(kSignature)) fail("animation", "a frame is no PNG", "encode frames as PNG");
  png.remove_prefix(kSignature.size());
  constexpr std::size_t kAround = 12;  // length, type, checksum
  while (png.size() >= kAround) {
    const std::size_t length = number_at(png);
    if (length > png.size() - kAround) break;
    out.push_back({png.substr(4, 4), png.substr(8, length)});
    png.remove_prefix(kAround + length);
  }
  if (out.empty() || out.front().type != "IHDR") fail("animation", "a frame is no PNG", "encode frames as PNG");
  return out;
}

void append_chunk(std::string& to, std::string_view type, std::string_view data) {
  const std::string whole = std::string(type) + std::string(data);
  to += big_endian(static_cast<std::uint32_t>(data.size())) + whole + big_endian(crc_of(whole));
}

}  // namespace

std::string animated_png(const std::vector<std::string>& frames, double frames_per_s) {
  if (frames.empty()) fail("animation", "there are no frames", "give one at least");
  constexpr std::uint32_t kTicks = 1000;  // per second
  const auto delay = static_cast<std::uint32_t>(std::clamp(std::lround(kTicks / frames_per_s), 1L, 65535L));
  const std::vector<Chunk> first = chunks_of(frames.front());
  std::string out(kSignature);
  append_chunk(out, "IHDR", first.front().data);
  append_chunk(out, "acTL", big_endian(static_cast<std::uint32_t>(frames.size())) + big_endian(0));
  for (const Chunk& chunk : first)  // color space
    if (chunk.type == "sRGB" || chunk.type == "gAMA" || chunk.type == "cHRM") append_chunk(out, chunk.type, chunk.data);
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const std::vector<Chunk> chunks = chunks_of(frames[i]);
    if (chunks.front().data != first.front().data)
      fail("animation", "frame " + std::to_string(i) + " has another size or kind than the first", "render all alike");
    std::string control = big_endian(number++) + std::string(first.front().data.substr(0, 8));  // width, height
    control += big_endian(0) + big_endian(0) + big_endian(delay, 2) + big_endian(kTicks, 2) + std::string(2, '\0');
    append_chunk(out, "fcTL", control);
    for (const Chunk& chunk : chunks) {
      if (chunk.type != "IDAT") continue;
      if (i == 0)
        append_chunk(out, "IDAT", chunk.data);
      else
        append_chunk(out, "fdAT", big_endian(number++) + std::string(chunk.data));
    }
  }
  append_chunk(out, "IEND", "");
  return out;
}

}  // namespace burin

#include "burin/pictures/heif_boxes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include "burin/base/limits.h"

namespace burin {
namespace {

/// A number in a text by offset; 0 beyond its end.
std::uint64_t heif_number(std::string_view text, std::size_t at, int bytes) {
  if (at > text.size() || text.size() - at < static_cast<std::size_t>(bytes)) return 0;
  std::uint64_t value = 0;
  for (int i = 0; i < bytes; ++i)
    value = value << 8U | static_cast<unsigned char>(text[at + static_cast<std::size_t>(i)]);
  return value;
}

struct HeifBox {
  std::string_view type, body;
};

/// The boxes within a text that fit into it.
std::vector<HeifBox> boxes_in(std::string_view text) {
  constexpr std::size_t kMost = 100'000, kHead = 8;
  std::vector<HeifBox> boxes;
  for (std::size_t at = 0; at + kHead <= text.size() && boxes.size() < kMost;) {
    std::uint64_t length = heif_number(text, at, 4);
    std::size_t head = kHead;
    if (length == 1) length = heif_number(text, at + kHead, 8), head = 16;
    if (length == 0) length = text.size() - at;
    if (length < head || length > text.size() - at) break;
    boxes.push_back({text.substr(at + 4, 4), text.substr(at + head, length - head)});
    at += length;
  }
  return boxes;
}

std::string_view box_in(std::string_view text, std::string_view type) {
  for (const HeifBox& box : boxes_in(text))
    if (box.type == type) return box.body;
  return {};
}

/// The file's "meta" box, without its version.
std::string meta_of(PictureBytes& file) {
  std::string meta;
  std::uintmax_t at = 0;
  for (int box = 0; box < 1000 && at + 8 <= file.size() && meta.empty(); ++box) {
    std::uint64_t length = file.big_endian(at, 4), head = 8;
    if (length == 1) length = file.big_endian(at + 8, 8), head = 16;
    if (length == 0) length = file.size() - at;
    if (length < head || length > file.size() - at) break;
    if (file.at(at + 4, 4) == "meta" && length > head + 4 && length <= limit::kPictureHeadBytes)
      meta = file.at(at + head + 4, length - head - 4);
    at += length;
  }
  return meta;
}

}  // namespace

HeifBoxes read_heif_boxes(PictureBytes& file) {
  const auto is_name = [](const std::string& type) {
    return std::all_of(type.begin(), type.end(), [](char c) { return c >= ' ' && c <= '~'; });
  };
  HeifBoxes found;
  std::uintmax_t at = 0;
  for (int box = 0; box < 1000 && at + 8 <= file.size(); ++box) {
    std::uint64_t length = file.big_endian(at, 4);
    const std::string type = file.at(at + 4, 4);
    if (found.width > 0 && !is_name(type)) break;  // data that a program appended after the last box
    std::uint64_t header_bytes = 8;
    if (length == 1) length = file.big_endian(at + 8, 8), header_bytes = 16;
    if (length == 0) length = file.size() - at;
    if (length < header_bytes || length > file.size() - at) file.broken("a box is longer than the file");
    if (type == "moov") found.moves = true;
    if (type == "meta" || type == "moov") {
      if (length > limit::kPictureHeadBytes) file.broken("its description is longer than any camera writes");
      const std::string meta = file.at(at, length);
      for (std::size_t i = meta.find("ispe"); i != std::string::npos; i = meta.find("ispe", i + 4)) {
        if (i + 16 > meta.size()) continue;
        const auto width = static_cast<std::int32_t>(heif_number(meta, i + 8, 4));
        const auto height = static_cast<std::int32_t>(heif_number(meta, i + 12, 4));
        if (width > 0 && height > 0 && 1.0 * width * height > 1.0 * static_cast<double>(found.width * found.height)) {
          found.width = width;
          found.height = height;
        }
      }
    }
    at += length;
  }
  if (found.width == 0) file.broken("it names no size");
  return found;
}

HeifCrop heif_crop(PictureBytes& file, int named_width, int named_height) {
  const std::string meta = meta_of(file);
  const std::string_view pitm = box_in(meta, "pitm"), iprp = box_in(meta, "iprp");
  const auto main = heif_number(pitm, 4, heif_number(pitm, 0, 1) == 0 ? 2 : 4);
  const std::vector<HeifBox> properties = boxes_in(box_in(iprp, "ipco"));
  const std::string_view ipma = box_in(iprp, "ipma");
  const bool long_items = heif_number(ipma, 0, 1) > 0, long_properties = (heif_number(ipma, 3, 1) & 1U) != 0;
  bool size_named = false, turned_size = false;
  std::string_view crop_box;
  std::size_t at = 8;
  for (std::uint64_t i = 0; i < heif_number(ipma, 4, 4) && at < ipma.size(); ++i) {
    const auto item = heif_number(ipma, at, long_items ? 4 : 2);
    at += long_items ? 4 : 2;
    const auto count = heif_number(ipma, at, 1);
    ++at;
    for (std::uint64_t k = 0; k < count; ++k, at += long_properties ? 2 : 1) {
      const auto index = heif_number(ipma, at, long_properties ? 2 : 1) & (long_properties ? 0x7FFFU : 0x7FU);
      if (item != main || index == 0 || index > properties.size()) continue;
      const HeifBox& property = properties[index - 1];
      if (property.type == "clap") crop_box = property.body;
      size_named = size_named || property.type == "ispe";
      // libheif up to 1.15 writes rotations before the size, which then is that of the rotated picture. In the standard
      // they follow it.
      turned_size = turned_size || (property.type == "irot" && !size_named && (heif_number(property.body, 0, 1) & 1U));
    }
  }
  HeifCrop whole{0, 0, named_width, named_height};
  if (turned_size) std::swap(whole.width, whole.height);
  if (crop_box.empty()) return whole;
  std::array<double, 8> v{};
  for (std::size_t j = 0; j < v.size(); ++j) v[j] = static_cast<std::int32_t>(heif_number(crop_box, 4 * j, 4));
  if (!(v[1] > 0 && v[3] > 0 && v[5] > 0 && v[7] > 0)) file.broken("its crop is none");
  const double width = v[0] / v[1], height = v[2] / v[3];  // 14496-12, 12.1.4.1: the other values give its middle
  const double left = v[4] / v[5] + (whole.width - width) / 2, top = v[6] / v[7] + (whole.height - height) / 2;
  if (!(left >= 0 && top >= 0 && width >= 1 && height >= 1 && left + width <= whole.width &&
        top + height <= whole.height))
    file.broken("its crop is none");
  return {static_cast<int>(std::floor(left)), static_cast<int>(std::floor(top)), static_cast<int>(std::lround(width)),
          static_cast<int>(std::lround(height))};
}

}  // namespace burin

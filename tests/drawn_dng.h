// tests/drawn_dng.h - raw files made by hand, from the DNG 1.4 specification: a mosaic of red, green and blue, not
// compressed, with an exposure.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace burin {

// A little-endian TIFF of one directory, written tag by tag.
class TiffWriter {
 public:
  void shorts(int tag, const std::vector<int>& v) { add(tag, 3, 2, {v.begin(), v.end()}); }
  void longs(int tag, const std::vector<std::uint32_t>& v) { add(tag, 4, 4, v); }
  void bytes(int tag, const std::vector<std::uint32_t>& v, int type = 1) { add(tag, type, 1, v); }
  void text(int tag, const std::string& s) {
    std::vector<std::uint32_t> v(s.begin(), s.end());
    v.push_back(0);
    add(tag, 2, 1, v);
  }
  void fractions(int tag, const std::vector<std::uint32_t>& v, bool with_sign = false) {
    add(tag, with_sign ? 10 : 5, 4, v);
    tags_[tag].count = static_cast<std::uint32_t>(v.size() / 2);
  }

  /// The file: header, directory, what the directory points to, pixels (at the offset that tag 273 is given).
  std::string file(const std::vector<std::uint16_t>& pixels) {
    longs(273, {0});
    const std::uint32_t directory_end = 8 + 2 + 12 * static_cast<std::uint32_t>(tags_.size()) + 4;
    std::uint32_t extra = directory_end;
    for (const auto& [tag, field] : tags_)
      if (field.data.size() > 4) extra += static_cast<std::uint32_t>(field.data.size() + field.data.size() % 2);
    longs(273, {extra});
    std::string head("II*\0", 4), tail;
    number(head, 8, 4);
    number(head, static_cast<std::uint32_t>(tags_.size()), 2);
    for (const auto& [tag, field] : tags_) {
      number(head, static_cast<std::uint32_t>(tag), 2);
      number(head, static_cast<std::uint32_t>(field.type), 2);
      number(head, field.count, 4);
      if (field.data.size() > 4) {
        number(head, directory_end + static_cast<std::uint32_t>(tail.size()), 4);
        tail += field.data;
        if (tail.size() % 2) tail += '\0';
      } else {
        head += field.data + std::string(4 - field.data.size(), '\0');
      }
    }
    number(head, 0, 4);
    head += tail;
    for (const std::uint16_t p : pixels) number(head, p, 2);
    return head;
  }

 private:
  struct Field {
    int type;
    std::uint32_t count;
    std::string data;
  };
  std::map<int, Field> tags_;

  static void number(std::string& out, std::uint32_t v, int bytes) {
    for (int i = 0; i < bytes; ++i) out += static_cast<char>(v >> (8 * i));
  }
  void add(int tag, int type, int bytes, const std::vector<std::uint32_t>& v) {
    Field field{type, static_cast<std::uint32_t>(v.size()), {}};
    for (const std::uint32_t x : v) number(field.data, x, bytes);
    tags_[tag] = field;
  }
};

struct Dng {
  int width = 0, height = 0, black = 512, white = 15000, orientation = 1;
  std::uint32_t exposure_s[2] = {1, 50};  ///< a fraction
  std::uint32_t f_number = 8;
  std::uint32_t iso = 0;  ///< 0: not told
  std::string make = "Burin", model = "Burin Test";
  std::vector<std::uint16_t> pixels;
};

/// The file's bytes.
inline std::string dng_file(const Dng& p) {
  const auto columns = static_cast<std::uint32_t>(p.width), rows = static_cast<std::uint32_t>(p.height);
  TiffWriter tiff;
  tiff.longs(254, {0});
  tiff.longs(256, {columns});
  tiff.longs(257, {rows});
  tiff.shorts(258, {16});
  tiff.shorts(259, {1});      // not compressed
  tiff.shorts(262, {32803});  // color mosaic
  tiff.text(271, p.make);
  tiff.text(272, p.model);
  tiff.shorts(274, {p.orientation});
  tiff.shorts(277, {1});
  tiff.longs(278, {rows});
  tiff.longs(279, {columns * rows * 2});
  tiff.shorts(284, {1});
  tiff.shorts(33421, {2, 2});
  tiff.bytes(33422, {0, 1, 1, 2});  // red green / green blue
  tiff.fractions(33434, {p.exposure_s[0], p.exposure_s[1]});
  tiff.fractions(33437, {p.f_number, 1});
  if (p.iso > 0) tiff.shorts(34855, {static_cast<int>(p.iso)});
  tiff.bytes(50706, {1, 4, 0, 0});  // DNG 1.4
  tiff.text(50708, p.model);
  tiff.shorts(50714, {p.black});
  tiff.longs(50717, {static_cast<std::uint32_t>(p.white)});
  // A matrix and a neutral that would change colors a good deal if anyone applied them.
  tiff.fractions(50721,
                 {9, 10, static_cast<std::uint32_t>(-2), 10, 1, 10, static_cast<std::uint32_t>(-3), 10, 12, 10, 1, 10,
                  0, 10, 2, 10, 6, 10},
                 true);
  tiff.fractions(50728, {4, 10, 10, 10, 6, 10});
  tiff.shorts(50778, {21});
  return tiff.file(p.pixels);
}

}  // namespace burin

#include "burin/base/files/file_names.h"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <set>

namespace burin {
namespace {

constexpr std::size_t kLongestStem = 100;  // of 255 bytes: prefixes and suffixes need some

// Length in bytes of the UTF-8 character at `at`; 0 if none begins there (RFC 3629: shortest form, no surrogates).
std::size_t character_at(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t i) {
    return at + i < text.size() ? static_cast<unsigned char>(text[at + i]) : static_cast<unsigned char>(0);
  };
  const unsigned first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t length = first >= 0xC2 && first < 0xE0 ? 2 : first >= 0xE0 && first < 0xF0 ? 3 : 4;
  if (first < 0xC2 || first > 0xF4) return 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte(i) & 0xC0) != 0x80) return 0;
  const unsigned second = byte(1);
  if ((first == 0xE0 && second < 0xA0) || (first == 0xED && second > 0x9F) || (first == 0xF0 && second < 0x90) ||
      (first == 0xF4 && second > 0x8F))
    return 0;
  return length;
}

// Invisible characters and marks of the writing direction could disguise a file's name as another.
bool is_invisible(std::string_view c) {
  if (c.size() == 2) return c[0] == '\xC2' && static_cast<unsigned char>(c[1]) < 0xA1;  // controls, no-break space
  if (c.size() != 3 || c[0] != '\xE2') return c == "\xE3\x80\x80" || c == "\xEF\xBB\xBF";
  const auto second = static_cast<unsigned char>(c[1]), third = static_cast<unsigned char>(c[2]);
  return (second == 0x80 && (third < 0x90 || (third >= 0xA8 && third <= 0xAF))) || (second == 0x81 && third >= 0x9F);
}

// The code point of a complete character.
std::uint32_t code_of(std::string_view c) {
  const auto byte = [&](std::size_t i) { return static_cast<std::uint32_t>(static_cast<unsigned char>(c[i])); };
  if (c.size() == 1) return byte(0);
  std::uint32_t code = byte(0) & (0xFFU >> (c.size() + 1));
  for (std::size_t i = 1; i < c.size(); ++i) code = code << 6U | (byte(i) & 0x3FU);
  return code;
}

template <std::size_t N>
bool is_among(std::uint32_t code, const std::uint32_t (&ranges)[N][2]) {
  return std::any_of(std::begin(ranges), std::end(ranges),
                     [code](const auto& range) { return code >= range[0] && code <= range[1]; });
}

// Combining marks, which change the previous letter; Hangul's vowels and endings are encoded in this way, too.
bool is_mark(std::uint32_t code) {
  constexpr std::uint32_t kMarks[][2] = {{0x300, 0x36F},   {0x1160, 0x11FF}, {0x1AB0, 0x1AFF}, {0x1DC0, 0x1DFF},
                                         {0x20D0, 0x20FF}, {0x3099, 0x309A}, {0xFE20, 0xFE2F}};
  return is_among(code, kMarks);
}

// Letters with a second encoding as another letter and marks: Latin, Greek, Cyrillic, Hebrew, Arabic, Indic scripts,
// Kana, Hangul.
bool may_hold_marks(std::uint32_t code) {
  constexpr std::uint32_t kLetters[][2] = {{0xC0, 0x24F},    {0x370, 0x6FF},   {0x900, 0xDFF},   {0x1100, 0x115F},
                                           {0x1E00, 0x1FFF}, {0x3041, 0x30FF}, {0xAC00, 0xD7A3}, {0xFB1D, 0xFB4F}};
  return is_among(code, kLetters);
}

// A file system, or the transport to it, may encode letters and marks separately or together. This function makes such
// names equal, and a few more. `has_marks`: the name has separate marks.
std::string without_marks(std::string_view name, bool& has_marks) {
  std::string out;
  has_marks = false;
  std::size_t last = 0;  // start of the last letter
  for (std::size_t at = 0; at < name.size();) {
    const std::size_t length = std::max<std::size_t>(1, character_at(name, at));
    const std::string_view c = name.substr(at, length);
    at += length;
    const std::uint32_t code = code_of(c);
    if (is_mark(code)) {
      has_marks = true;
      out.resize(last);
      out += '?';
      continue;
    }
    last = out.size();
    out += may_hold_marks(code) ? "?" : c;
  }
  return out;
}

}  // namespace

std::string file_name_of(std::string_view name) {
  std::string out;
  for (std::size_t at = 0; at < name.size();) {
    const std::size_t length = std::max<std::size_t>(1, character_at(name, at));
    const std::string_view c = name.substr(at, length);
    const char first = c.front();
    const bool plain = (first >= 'a' && first <= 'z') || (first >= 'A' && first <= 'Z') ||
                       (first >= '0' && first <= '9') || first == '-' || first == '_' || first == '.';
    const std::string next(length > 1 ? (is_invisible(c) ? "_" : c) : plain ? c : "_");
    if (out.size() + next.size() > kLongestStem) break;
    out += next;
    at += length;
  }
  if (out.empty()) return "_";
  if (out.front() == '.' || out.front() == '-') out.front() = '_';
  return out;
}

std::vector<std::string> distinct_file_names(const std::vector<std::string>& names,
                                             const std::vector<std::string>& endings) {
  std::vector<std::string> out;
  std::set<std::string> taken, shapes, shapes_with_marks;  // shapes: names without marks
  const auto is_taken = [&](const std::string& each) {
    bool has_marks = false;
    const std::string shape = without_marks(each, has_marks);
    return taken.contains(each) || (has_marks ? shapes : shapes_with_marks).contains(shape);
  };
  const auto take = [&](const std::string& each) {
    bool has_marks = false;
    const std::string shape = without_marks(each, has_marks);
    taken.insert(each);
    shapes.insert(shape);
    if (has_marks) shapes_with_marks.insert(shape);
  };
  for (const std::string& name : names) {
    const std::string wanted = file_name_of(name);
    const auto all_of = [&](const std::string& candidate) {
      std::vector<std::string> all{lower_case(candidate)};
      for (const std::string& ending : endings) all.push_back(lower_case(candidate + ending));
      return all;
    };
    std::string candidate = wanted;
    for (int number = 2;; ++number) {
      const std::vector<std::string> all = all_of(candidate);
      if (std::none_of(all.begin(), all.end(), is_taken)) {
        std::for_each(all.begin(), all.end(), take);
        break;
      }
      candidate = wanted + "-" + std::to_string(number);
    }
    out.push_back(candidate);
  }
  return out;
}

std::string lower_case(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

std::string lower_extension(const std::filesystem::path& file) { return lower_case(file.extension().string()); }

}  // namespace burin

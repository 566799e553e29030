#include "burin/render/files/file_names.h"

#include <algorithm>
#include <set>

namespace burin {
namespace {

constexpr std::size_t kLongestStem = 100;  // of 255 bytes: what is put before and behind it needs some

// Bytes of the UTF-8 character that begins there: 0 where none does (RFC 3629: shortest form, no surrogates).
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

// Characters that no one sees or that turn the direction of a line: a file's name is not to be taken for another's.
bool is_invisible(std::string_view c) {
  if (c.size() == 2) return c[0] == '\xC2' && static_cast<unsigned char>(c[1]) < 0xA1;  // controls, no-break space
  if (c.size() != 3 || c[0] != '\xE2') return c == "\xE3\x80\x80" || c == "\xEF\xBB\xBF";
  const auto second = static_cast<unsigned char>(c[1]), third = static_cast<unsigned char>(c[2]);
  return (second == 0x80 && (third < 0x90 || (third >= 0xA8 && third <= 0xAF))) || (second == 0x81 && third >= 0x9F);
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
  std::set<std::string> taken;
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
      if (std::none_of(all.begin(), all.end(), [&](const std::string& each) { return taken.contains(each); })) {
        taken.insert(all.begin(), all.end());
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

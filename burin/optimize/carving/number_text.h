// burin/optimize/carving/number_text.h - numbers as files for machines want them: with a point, whatever the locale.
#pragma once

#include <array>
#include <charconv>
#include <string>

namespace burin {

inline std::string fixed(double value, int decimals) {
  std::array<char, 64> buffer;
  std::string text(buffer.data(),
                   std::to_chars(buffer.begin(), buffer.end(), value, std::chars_format::fixed, decimals).ptr);
  // "-0.0000" is no place of its own.
  if (text[0] == '-' && text.find_first_not_of("-0.") == std::string::npos) text.erase(0, 1);
  return text;
}

inline std::string shortest(double value) {
  std::array<char, 64> buffer;
  return {buffer.data(), std::to_chars(buffer.begin(), buffer.end(), value).ptr};
}

}  // namespace burin

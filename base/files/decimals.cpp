#include "burin/base/files/decimals.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace burin {
namespace {

constexpr std::size_t kLongest = 400;  // the largest double has 309 digits before its point

}  // namespace

std::string fixed(double value, int decimals) {
  std::array<char, kLongest> digits;
  std::string text(digits.data(),
                   std::to_chars(digits.begin(), digits.end(), value, std::chars_format::fixed, decimals).ptr);
  if (text[0] == '-' && text.find_first_not_of("-0.") == std::string::npos) text.erase(0, 1);
  return text;
}

std::string shortest(double value) {
  std::array<char, kLongest> digits;
  return {digits.data(), std::to_chars(digits.begin(), digits.end(), value, std::chars_format::fixed).ptr};
}

std::string significant(double value, int digits) {
  if (value == 0 || !std::isfinite(value)) return fixed(value, 0);
  constexpr double kAllDigits = 1e15;
  if (std::abs(value) >= kAllDigits) return general(value, digits);
  constexpr int kMostDecimals = 9;
  const int decimals = digits - 1 - static_cast<int>(std::floor(std::log10(std::abs(value))));
  std::string text = fixed(value, std::clamp(decimals, 0, kMostDecimals));
  if (text.find('.') == std::string::npos) return text;
  text.erase(text.find_last_not_of('0') + 1);
  if (text.ends_with('.')) text.pop_back();
  return text;
}

std::string general(double value, int digits) {
  std::array<char, kLongest> text;
  return {text.data(), std::to_chars(text.begin(), text.end(), value, std::chars_format::general, digits).ptr};
}

std::string counted(std::size_t count, const std::string& one) {
  const auto ends_with = [&](const char* end) { return one.ends_with(end); };
  const bool hisses = ends_with("ch") || ends_with("sh") || ends_with("s") || ends_with("x");
  return std::to_string(count) + " " + one + (count == 1 ? "" : hisses ? "es" : "s");
}

std::string coarse(double value) { return fixed(value, value < 9.95 ? 1 : 0); }

}  // namespace burin

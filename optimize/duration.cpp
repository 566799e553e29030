#include "burin/optimize/duration.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <string_view>

#include "burin/base/error.h"

namespace burin {

double duration_from_text(const std::string& text, double unit_s) {
  const auto wrong = [&] {
    fail("duration \"" + text + "\"", "is not understood", "write it like 30min, 45s, 2h or 1h30min");
  };
  double total_s = 0;
  std::string_view rest = text;
  do {
    double value = 0;
    const auto number = std::from_chars(rest.data(), rest.data() + rest.size(), value, std::chars_format::fixed);
    if (number.ec != std::errc{} || !(value >= 0) || !std::isfinite(value)) wrong();
    const bool bare = number.ptr == text.data() + text.size() && rest.size() == text.size();
    rest.remove_prefix(static_cast<std::size_t>(number.ptr - rest.data()));
    const std::string_view unit = rest.substr(0, std::min(rest.find_first_of("0123456789."), rest.size()));
    if (bare)
      total_s += unit_s * value;
    else if (unit == "s")
      total_s += value;
    else if (unit == "min" || unit == "m")
      total_s += 60 * value;
    else if (unit == "h")
      total_s += 3600 * value;
    else
      wrong();
    rest.remove_prefix(unit.size());
  } while (!rest.empty());
  if (!(total_s > 0)) wrong();
  return total_s;
}

std::string duration_text(double seconds) {
  const long long s = std::llround(seconds);
  if (s < 60) return std::to_string(s) + " s";
  const long long minutes = (s + 30) / 60;
  if (minutes < 60) return std::to_string(minutes) + " min";
  return std::to_string(minutes / 60) + " h " + std::to_string(minutes % 60) + " min";
}

}  // namespace burin

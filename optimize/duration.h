// burin/optimize/duration.h - times as people write and read them: one grammar for all of Burin's options.
#pragma once

#include <string>

namespace burin {

/// "30min", "45s", "2h", "1.5h" and "1h30min" in seconds; "m" is minutes too. A bare number counts in `unit_s` (1:
/// seconds, 3600: hours). Throws Error for anything else, for 0 and for less.
double duration_from_text(const std::string& text, double unit_s = 1);

/// "6 h 20 min", "12 min", "40 s".
std::string duration_text(double seconds);

}  // namespace burin

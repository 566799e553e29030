// burin/optimize/duration.h - durations as text: one grammar for all of Burin's options.
#pragma once

#include <string>

namespace burin {

/// The seconds of "30min", "45s", "2h", "1.5h" or "1h30min"; "m" means minutes too. A bare number counts in `unit_s`
/// (1: seconds, 3600: hours). Throws Error for any other text, and for a duration of 0 or less.
double duration_from_text(const std::string& text, double unit_s = 1);

/// "6 h 20 min", "12 min", "40 s".
std::string duration_text(double seconds);

}  // namespace burin

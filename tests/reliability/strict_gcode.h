// tests/reliability/strict_gcode.h - a second reader of G-code, written from the controllers' own descriptions and
// sharing no line with the replay: what the replay accepts, this one has to execute to the same path.
//
// Numbers are whole nanometers, read digit by digit; a line is a list of words; a controller is a table of what it
// knows. Whatever is not in that table is an alarm. It knows nothing of profiles' depth tables or of faces: its strokes
// are moves along the board with Z below zero, or with a servo's S that is not the one that lifts.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace burin::strict {

struct Controller {
  enum class Kind { grbl, linuxcnc, marlin } kind = Kind::grbl;
  std::size_t line_bytes = 79;
  bool by_s = false;           ///< the head is pressed by S, not by Z
  std::int64_t lifted_s = 0;   ///< S that lifts it, in thousandths
  bool low_s_presses = false;  ///< S that is lower than that one presses; otherwise S that is higher
  bool laser = false;          ///< the beam must be turned off first, and stay off
  bool bounded = false;        ///< by these, nanometers
  std::int64_t low[2] = {0, 0}, high[2] = {0, 0};
};

struct Stroke {
  std::int64_t x0, y0, x1, y1, z;  ///< nanometers; z: how far below zero, or S
};

struct Executed {
  std::string alarm;  ///< empty if all of it was executed
  std::size_t line = 0;
  std::vector<Stroke> strokes;
};

/// Executes a whole file, or stops at its first alarm.
Executed execute(std::string_view text, const Controller& controller);

}  // namespace burin::strict

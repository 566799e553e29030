// tests/reliability/strict_gcode.h - a second reader of G-code, written from the controllers' own descriptions and
// sharing no line with the replay: what the replay accepts, this one has to execute to the same path.
//
// Numbers are whole nanometers, read digit by digit; a line is a list of words; a controller is a table of what it
// knows. Whatever is not in that table is an alarm. It knows nothing of profiles' depth tables or of faces: its strokes
// are moves along the board with Z below zero, or with a servo's S that is not the one that lifts.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace burin::strict {

/// Something that stands on the sheet, mm: a polygon, or a circle.
struct Standing {
  std::vector<std::array<double, 2>> corners;  ///< empty for a circle
  double x = 0, y = 0, radius = 0;
  double height = 0;  ///< above the face
};

/// What the file is carved into, mm, by nobody's idea but this reader's: ways are looked at place by place.
struct Sheet {
  double width = 0, height = 0;
  double beside = 5;   ///< how far beyond its edges a tool may be sent
  double deepest = 0;  ///< below the face that Z may go
  double first = 5;    ///< above the highest place of the face: the least height of a way from nowhere
  std::vector<Standing> standing;
  std::function<double(double, double)> face;  ///< height of the face; empty: even
  double face_top = 0;                         ///< its highest place
  /// From the machine's place to the board's: x' = map[0] x + map[1] y + map[2], y' = map[3] x + ...
  std::array<double, 6> map{1, 0, 0, 0, 1, 0};
};

struct Controller {
  enum class Kind { grbl, linuxcnc, marlin } kind = Kind::grbl;
  std::size_t line_bytes = 79;
  bool by_s = false;           ///< the head is pressed by S, not by Z
  std::int64_t lifted_s = 0;   ///< S that lifts it, in thousandths
  bool low_s_presses = false;  ///< S that is lower than that one presses; otherwise S that is higher
  bool laser = false;          ///< the beam must be turned off first, and stay off
  bool bounded = false;        ///< by these, nanometers
  std::int64_t low[2] = {0, 0}, high[2] = {0, 0};
  const Sheet* sheet = nullptr;  ///< null: whatever the file does to a sheet is not looked at
  double servo_lift = 0;         ///< mm: how high S lifts the tip, of a head pressed by S
};

struct Stroke {
  std::int64_t x0, y0, x1, y1, z;  ///< nanometers; z: how far below zero, or S
};

struct Executed {
  std::string alarm;  ///< empty if all of it was executed
  std::size_t line = 0;
  std::vector<Stroke> strokes;
};

/// What is wrong with the numbers behind X, Y and Z alone, whatever the lines around them do; empty if nothing. The
/// plainest reading there is: comments away, then each number against the sheet.
std::string words_off_sheet(std::string_view text, const Sheet& sheet);

/// Executes a whole file, or stops at its first alarm.
Executed execute(std::string_view text, const Controller& controller);

}  // namespace burin::strict

// burin/optimize/toolpath/gcode_line.h - a strict parser for one line of G-code, and escaping of external text for it.
//
// The parser is as strict as the strictest controller of its dialect. It rejects:
// - bytes other than printable ASCII, and lines beyond the controller's buffer;
// - comments without an end, nested ones, and ones with an effect (LinuxCNC's LOG, PROBEOPEN, PY);
// - exponents, and numbers with more digits than the controller keeps;
// - repeated words, unknown codes, two codes of one modal group (NIST RS274/NGC, section 3.4), and words that no code
// of the line needs.
//
// The characters ! ? ~ act at once in grbl, even within comments. Marlin executes one command per line and knows no
// comments in ( ). Like grbl, the parser drops digits of a number behind the eighth. The codes M7, M62 and M67, errors
// of grbl 1.1, are rejected unless a profile names them, for grblHAL and FluidNC. So are Marlin's line numbers, which
// need a checksum. Sources: grbl 1.1 (gcode.c, protocol.c, nuts_bolts.c), LinuxCNC's G-code reference, Marlin 2
// (parser.cpp, queue.cpp).
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "burin/optimize/machine_profile.h"

namespace burin {

/// Words of one line. Codes in tenths, as 910 for G91 and 911 for G91.1.
struct GcodeLine {
  std::vector<int> g, m;
  bool percent = false;  ///< a lone %, the begin or end of LinuxCNC's program
  bool home = false;     ///< a lone $H, grbl's homing

  /// True if the line has this word.
  bool has(char letter) const { return given[static_cast<std::size_t>(letter - 'A')]; }
  /// Value of a word; meaningful only if has(letter).
  double operator[](char letter) const { return value[static_cast<std::size_t>(letter - 'A')]; }
  /// True if the line moves X, Y or Z.
  bool has_axis() const { return has('X') || has('Y') || has('Z'); }
  /// True if the line has this G code.
  bool has_g(int code) const;
  /// True if the line has this M code.
  bool has_m(int code) const;
  bool empty() const;  ///< no effect: blank, a comment, a message, a line number

  std::array<double, 26> value{};
  std::array<bool, 26> given{};
};

/// Reads a line without its line end (it may end with a carriage return). Throws Error naming `name`:`number`.
GcodeLine read_gcode_line(std::string_view text, const MachineProfile& machine, const std::string& name,
                          std::size_t number);

/// Longest line of a machine, without its end: its profile's, or its dialect's.
int longest_line(const MachineProfile& machine);

/// External text (a machine's name) for a comment of G-code. Letters, digits, blank, - _ and . stay; other characters
/// become _, and text beyond 40 characters is cut. External text enters G-code by no other function.
std::string comment_word(std::string_view text);

/// A comment as lines of the machine's dialect, each with its end: at most 70 characters long, or the controller's
/// limit. A continued line begins with "- ". No line can act on a controller or a sender program: G-code words in the
/// text are broken ("M30" becomes "M_30"), and of other characters only . , : _ + - stay.
std::string comment_lines(const MachineProfile& machine, std::string_view text);

/// Content of the comments at the head of Burin's files, numbers from 1.
struct GcodeHead {
  std::size_t part = 1, parts = 1;          ///< number of this file among the tool path's files
  std::size_t first = 0, last = 0, of = 0;  ///< carved scratches of the file, out of all
};

/// "part 1 of 3, scratches 1 to 400 of 1200": the comment for read_gcode_head().
std::string head_text(const GcodeHead& head);

/// The head of a tool path's file; nothing for other files (a frame, a probing file, another program's).
std::optional<GcodeHead> read_gcode_head(std::string_view text);

}  // namespace burin

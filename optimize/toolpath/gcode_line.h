// burin/optimize/toolpath/gcode_line.h - one line of G-code, read as strictly as the pickiest controller of its
// dialect, and words from outside made safe for it.
//
// What a controller would misread is refused here: bytes that are not printable ASCII, lines that do not fit its
// buffer, comments that are not closed, that nest or that it executes (LinuxCNC's LOG, PROBEOPEN, PY), exponents,
// numbers with more digits than it keeps, words that stand twice, codes that it does not know, two codes of one modal
// group (NIST RS274/NGC, section 3.4), words that no code of the line asks for. The characters ! ? ~ act at once in
// grbl, even within comments. Marlin executes one command a line and knows no comments in ( ). What grbl drops of a
// number (all behind its eighth digit) is dropped here as well. What grbl 1.1 answers by an error (M7, M62, M67) is
// refused unless a profile names it, for grblHAL and FluidNC; so are Marlin's line numbers, which ask for a checksum.
// Sources: grbl 1.1 (gcode.c, protocol.c, nuts_bolts.c), LinuxCNC's G-code reference, Marlin 2 (parser.cpp, queue.cpp).
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
  bool percent = false;  ///< a lone %, where LinuxCNC's program begins or ends
  bool home = false;     ///< a lone $H, grbl's way home

  bool has(char letter) const { return given[static_cast<std::size_t>(letter - 'A')]; }
  double operator[](char letter) const { return value[static_cast<std::size_t>(letter - 'A')]; }
  bool has_axis() const { return has('X') || has('Y') || has('Z'); }
  bool has_g(int code) const;
  bool has_m(int code) const;
  bool empty() const;  ///< nothing to be done: blank, a comment, a message, a line number

  std::array<double, 26> value{};
  std::array<bool, 26> given{};
};

/// Reads a line without its line end (a carriage return may stand there). Throws Error naming `name`:`number`.
GcodeLine read_gcode_line(std::string_view text, const MachineProfile& machine, const std::string& name,
                          std::size_t number);

/// The longest line that a machine reads, without its end: its profile's, or its dialect's.
int longest_line(const MachineProfile& machine);

/// Text from outside (a machine's name) as it may stand in a comment of G-code: letters, digits, blank, - _ and . stay,
/// all else becomes _, and what is longer than 40 characters is cut. No such text reaches G-code by another way.
std::string comment_word(std::string_view text);

/// A comment as lines of the machine's dialect, each with its end: at most 70 characters long, or as many as its
/// controller reads. A line that goes on begins with "- ". No line holds anything that a controller or a program that
/// sends it could act on: a word of G-code in the text is broken ("M30" becomes "M_30"), and of other characters only
/// . , : _ + - stay.
std::string comment_lines(const MachineProfile& machine, std::string_view text);

/// What the comments at the head of a file of Burin's tell of it, numbers from 1.
struct GcodeHead {
  std::size_t part = 1, parts = 1;          ///< which of the tool path's files it is
  std::size_t first = 0, last = 0, of = 0;  ///< the scratches that it carves, of all
};

/// "part 1 of 3, scratches 1 to 400 of 1200": the comment that read_gcode_head() understands.
std::string head_text(const GcodeHead& head);

/// The head of a tool path's file; nothing for other files (a frame, a probing file, another program's).
std::optional<GcodeHead> read_gcode_head(std::string_view text);

}  // namespace burin

// burin/optimize/carving/gcode_line.h - one line of G-code, read as strictly as the pickiest controller of its dialect,
// and words from outside made safe for it.
//
// What a controller would misread is refused here: bytes that are not printable ASCII, lines that do not fit its
// buffer, comments that are not closed, that nest or that it executes (LinuxCNC's LOG, PROBEOPEN, PY), exponents,
// numbers with more digits than it keeps, words that stand twice, codes that it does not know, two codes of one modal
// group (NIST RS274/NGC, section 3.4), words that no code of the line asks for. The characters ! ? ~ act at once in
// grbl, even within comments. Marlin executes one command a line and knows no comments in ( ). What grbl drops of a
// number (all behind its eighth digit) is dropped here as well. Sources: grbl 1.1 (gcode.c, protocol.c, nuts_bolts.c),
// LinuxCNC's G-code reference, Marlin 2 (parser.cpp).
#pragma once

#include <array>
#include <cstddef>
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

/// A text of ours as comments of the machine's dialect, as many lines as it takes: none is longer than the machine
/// reads.
std::string comment_lines(const MachineProfile& machine, std::string_view text);

}  // namespace burin

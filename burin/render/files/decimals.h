// burin/render/files/decimals.h - how numbers stand in files and sentences: plain decimals, whatever the locale.
#pragma once

#include <string>

namespace burin {

/// `value` with that many decimals; one that rounds to nothing has no sign ("0.000", not "-0.000").
std::string fixed(double value, int decimals);

/// The fewest digits that give `value` again when they are read; no exponent.
std::string shortest(double value);

/// To `digits` significant digits, but to no tens, and without an exponent or trailing zeros: with two digits, 0.0123
/// is "0.012", 0.5 is "0.5" and 562.4 is "562".
std::string significant(double value, int digits = 2);

}  // namespace burin

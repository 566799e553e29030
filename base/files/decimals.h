// burin/base/files/decimals.h - text of numbers in files and sentences: plain decimals, independent of the locale.
#pragma once

#include <cstddef>
#include <string>

namespace burin {

/// `value` with that many decimals; a value that rounds to zero has no sign ("0.000", not "-0.000").
std::string fixed(double value, int decimals);

/// The fewest digits that read back as exactly `value`; no exponent.
std::string shortest(double value);

/// `digits` significant digits, without rounding of the integer part, and (below 1e15) without an exponent or trailing
/// zeros: with two digits, 0.0123 is "0.012", 0.5 is "0.5" and 562.4 is "562".
std::string significant(double value, int digits = 2);

/// `digits` significant digits as printf's %g, independent of the locale: without trailing zeros, and with an exponent
/// below 1e-4 and from 10^digits on.
std::string general(double value, int digits);

/// A count and its noun: "1 scratch", "2 scratches", "0 photos". `one` is the singular.
std::string counted(std::size_t count, const std::string& one);

/// One decimal below ten, none from there on: "0.3", "9.9", "10".
std::string coarse(double value);

}  // namespace burin

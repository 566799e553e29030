// burin/base/files/printable.h - terminal-safe text from files.
//
// Terminals execute control characters. An escape character in a view's name can clear the screen, rename the window or
// hide earlier text; a change of writing direction reverses a file's name. Readers therefore reject text with such
// characters, and errors never print them.
#pragma once

#include <string>
#include <string_view>

namespace burin {

/// True for valid UTF-8 without control characters (below U+0020, U+007F to U+009F) and without marks of the writing
/// direction (U+202A to U+202E, U+2066 to U+2069).
bool is_printable(std::string_view text);

/// The text with each such byte as \xNN; other text stays unchanged.
std::string printable(std::string_view text);

}  // namespace burin

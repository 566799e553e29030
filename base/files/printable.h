// burin/base/files/printable.h - text from files, as a terminal may show it.
//
// A terminal obeys what it is told to print: an escape character in a view's name can clear the screen, rename the
// window or hide what stands before it, and a change of writing direction turns a file's name round. So no text with
// such characters is taken from a file, and none is printed in an error.
#pragma once

#include <string>
#include <string_view>

namespace burin {

/// Whether text holds a control character (below U+0020, U+007F to U+009F), one that changes the direction of writing
/// (U+202A to U+202E, U+2066 to U+2069), or bytes that are no UTF-8.
bool is_printable(std::string_view text);

/// The text with each such byte as \xNN; other text as it is.
std::string printable(std::string_view text);

}  // namespace burin

// tools/base64.h - bytes as text, for self-contained pages.
#pragma once

#include <string>
#include <string_view>

namespace burin {

/// Encodes by RFC 4648, section 4: letters, digits, + and /, padded by = to a multiple of four.
std::string base64(std::string_view bytes);

}  // namespace burin

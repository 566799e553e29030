// tools/content_policy.h - the Content-Security-Policy of a page that Burin writes: nothing from elsewhere, and only
// the scripts and styles that it was written with.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace burin {

/// What stands between <script> and </script> (or <style> and </style>), byte by byte, as a policy names it:
/// 'sha256-...', with the quotes.
std::string content_hash_source(std::string_view text);

/// The <meta> element to put first into <head>: nothing is loaded but data: pictures, nothing runs but inline scripts
/// and styles of exactly these texts. A page under it has no style="" attributes and no onclick="" either; scripts may
/// set element.style.
std::string content_policy(std::span<const std::string> scripts, std::span<const std::string> styles);

}  // namespace burin

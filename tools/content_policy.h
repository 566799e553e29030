// tools/content_policy.h - Content-Security-Policy of the pages: it blocks external content and all scripts and styles
// except the page's own.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace burin {

/// Source expression 'sha256-...', including the quotes, for the exact bytes between <script> and </script> (or <style>
/// and </style>).
std::string content_hash_source(std::string_view text);

/// Returns the <meta> element, which goes first into <head>. It admits data: pictures and inline scripts and styles
/// with exactly these texts; it blocks everything else. The page must not use style="" or onclick="" attributes;
/// scripts may set element.style.
std::string content_policy(std::span<const std::string> scripts, std::span<const std::string> styles);

}  // namespace burin

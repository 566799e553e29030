// burin/base/files/file_error.h - what the system says of a file, as a sentence with what to do about it.
#pragma once

#include <filesystem>
#include <string>

namespace burin {

/// "No space left on device", whatever the locale says of `error` (an errno).
std::string error_text(int error);

/// What a person can do where a file or folder answers with `error` (an errno).
std::string error_remedy(int error);

/// Throws Error "FILE: WHAT: No space left on device; make room on the disk". `what` is like "cannot be written".
[[noreturn]] void fail_with(const std::filesystem::path& file, const std::string& what, int error);

/// Throws Error for names that no file can have: none at all, or with a zero byte in it (the rest would be lost).
void fail_unless_name(const std::filesystem::path& file);

}  // namespace burin

// burin/base/files/file_error.h - messages with remedies for the system's file errors.
#pragma once

#include <filesystem>
#include <string>

namespace burin {

/// The text of an errno, such as "No space left on device", independent of the locale.
std::string error_text(int error);

/// The remedy for an errno of a file or folder.
std::string error_remedy(int error);

/// Throws Error "FILE: WHAT: No space left on device; make room on the disk". `what` is like "cannot be written".
[[noreturn]] void fail_with(const std::filesystem::path& file, const std::string& what, int error);

/// Throws Error for impossible file names: empty, or with a zero byte (the system would drop the rest).
void fail_unless_name(const std::filesystem::path& file);

}  // namespace burin

// burin/base/files/input_file.h - the one door through which files are read.
//
// Whatever a path names - a folder, a FIFO nobody writes to, a device, a link that leads in circles, a file of a
// hundred gigabytes - is looked at before a byte is read, and refused in a sentence.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace burin {

/// Opens the file and closes it again, for libraries that open by name: throws Error naming the file unless it is a
/// plain file (or a link to one) that may be read and has at most `most_bytes`. `kind` is what the sentence calls it
/// ("a picture"). Returns its size. Never waits: a FIFO or a device is not read.
std::uintmax_t require_plain_file(const std::filesystem::path& file, std::uintmax_t most_bytes,
                                  const std::string& kind);

/// The whole of a plain file. Throws as require_plain_file, and where the disk does not give all of it.
std::string read_bytes(const std::filesystem::path& file, std::uintmax_t most_bytes, const std::string& kind);

/// The first bytes of a plain file, at most `bytes`; all of it where it is shorter. Throws as require_plain_file, but
/// for its size.
std::string read_head(const std::filesystem::path& file, std::uintmax_t bytes);

/// Throws Error: `count` things ("tags") are more than `most`; `remedy` says how to go on.
void require_at_most(std::size_t count, std::size_t most, const std::string& where, const std::string& things,
                     const std::string& remedy);

/// 1,234,567: a number for people.
std::string with_commas(std::uintmax_t number);

/// 64 MB: so many bytes for people.
std::string bytes_text(std::uintmax_t bytes);

}  // namespace burin

// burin/base/files/input_file.h - checks of input files; all readers use them.
//
// They refuse a path to anything but a plain file of limited size: a folder, a FIFO without a writer, a device, a
// circular link, a file of a hundred gigabytes. The check precedes the first read, and the message is one sentence.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace burin {

/// Opens the file and closes it again, for libraries that open by name. Throws Error with the file unless it is a
/// readable plain file (or a link to one) with at most `most_bytes`. `kind` is its name in the message ("a picture").
/// Returns its size. Never blocks: it does not read a FIFO or a device.
std::uintmax_t require_plain_file(const std::filesystem::path& file, std::uintmax_t most_bytes,
                                  const std::string& kind);

/// The whole content of a plain file. Throws as require_plain_file, and if the disk returns only a part.
std::string read_bytes(const std::filesystem::path& file, std::uintmax_t most_bytes, const std::string& kind);

/// The first bytes of a plain file, at most `bytes`. Throws as require_plain_file, except for its size.
std::string read_head(const std::filesystem::path& file, std::uintmax_t bytes);

/// Throws Error if `count` of `things` ("tags") is more than `most`. `remedy` is the advice in the message.
void require_at_most(std::size_t count, std::size_t most, const std::string& where, const std::string& things,
                     const std::string& remedy);

/// A number for people: 1,234,567.
std::string with_commas(std::uintmax_t number);

/// A size in bytes for people: 64 MB.
std::string bytes_text(std::uintmax_t bytes);

}  // namespace burin

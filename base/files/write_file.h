// burin/base/files/write_file.h - how Burin writes a file, of whatever kind, in every room and command.
//
// What is written is made in memory, written whole beside its place, read by no one until it is checked and on the
// disk, and put there by a rename: who reads it, after whatever mishap, finds the old file or the new one. A symbolic
// link stays and is followed; permissions and owners stay; devices and FIFOs are refused; a failure leaves nothing
// behind. Files that belong together: burin/base/files/files_together.h. All of it: docs/reliability.md, "Writing".
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace burin {

/// Looks at a file before it takes its place: gets the name that it has until then, and throws Error to refuse it.
using CheckFile = std::function<void(const std::filesystem::path&)>;

/// Whether a file has to be on the disk before its command ends (fsync), or whether it can be made again in no time.
enum class Durability { on_disk, by_the_system };

/// Writes a file. Throws Error naming it where that cannot be done; what was there is then as before.
void write_file(std::string_view bytes, const std::filesystem::path& file, Durability durability = Durability::on_disk,
                const CheckFile& check = {});

/// The same where bytes are written by what takes a path: `write` gets the name that the file has until it is in its
/// place (same extension), fills it, and throws to refuse it.
void write_atomically(const std::filesystem::path& file,
                      const std::function<void(const std::filesystem::path&)>& write);

/// Where a file named "-" goes: to this open descriptor, such as standard output; -1, as in the beginning: it is a name
/// like others.
void set_result_output(int descriptor);

/// A file of text, such as CSV, G-code or HTML.
void write_text(const std::string& text, const std::filesystem::path& file);

/// Copies a file's bytes: `to` is as good as if it had been written. Throws Error where `from` cannot be read, too.
void copy_whole(const std::filesystem::path& from, const std::filesystem::path& to);

/// Removes a file that is there no more when this command has ended well. Nothing happens where there is none.
void remove_file(const std::filesystem::path& file);

}  // namespace burin

// burin/base/files/write_file.h - atomic writing of files of all kinds; all libraries and commands use it.
//
// The content is complete in memory first. A hidden file next to the final place receives it. After its check and sync
// to disk, a rename puts it there. After any mishap, readers find the old file or the new one. Symbolic links remain
// and are followed; permissions and owners remain; devices and FIFOs are errors; a failure leaves nothing behind. Files
// that belong together: burin/base/files/files_together.h. docs/reliability.md, "Writing".
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace burin {

/// Checks a file before it takes its place: receives its temporary name, and throws Error to reject it.
using CheckFile = std::function<void(const std::filesystem::path&)>;

/// on_disk: synced (fsync) before the command ends. by_the_system: not synced, because it is quickly made again.
enum class Durability { on_disk, by_the_system };

/// Writes a file. Throws Error with its name on failure; the previous file then remains.
void write_file(std::string_view bytes, const std::filesystem::path& file, Durability durability = Durability::on_disk,
                const CheckFile& check = {});

/// Writes through code that takes a path: `write` receives the temporary name (same extension), fills the file, and
/// throws to reject it.
void write_atomically(const std::filesystem::path& file,
                      const std::function<void(const std::filesystem::path&)>& write);

/// Redirects a file named "-" to this open descriptor, such as standard output. -1, the default: "-" is an ordinary
/// name.
void set_result_output(int descriptor);

/// Writes a text file, such as CSV, G-code or HTML.
void write_text(const std::string& text, const std::filesystem::path& file);

/// Copies a file's bytes to `to` with the guarantees of write_file(). Throws Error for an unreadable `from`, too.
void copy_whole(const std::filesystem::path& from, const std::filesystem::path& to);

/// Removes a file as part of this command's result. Ignores a missing file.
void remove_file(const std::filesystem::path& file);

}  // namespace burin

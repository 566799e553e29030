// burin/base/files/part_file.h - an output file during writing: written completely next to its place under a hidden
// name, ".NAME.part-PROCESS-NUMBER.EXTENSION", and then renamed. docs/reliability.md describes the method; callers use
// burin/base/files/write_file.h.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string_view>

namespace burin {

/// Place of an output: behind symbolic links, with properties of the file to be replaced.
struct FilePlace {
  std::filesystem::path named;  ///< as named by the person, for messages
  std::filesystem::path file;   ///< after resolving links
  bool there = false;           ///< a regular file exists already
  mode_t mode = 0;              ///< its permissions, which remain
  uid_t user = 0;               ///< and its owners
  gid_t group = 0;

  /// The folder of `file`.
  std::filesystem::path folder() const;
};

/// The place of an output. Throws Error for a folder, device, FIFO or socket, for a write-protected file, for a missing
/// folder, and for impossible names. Throws Error for links out of the named folder and for this command's inputs
/// (burin/base/files/named_paths.h).
FilePlace find_place(const std::filesystem::path& named);

/// Writes the part file of a place: all bytes, owners and permissions of the file to be replaced, synced to disk
/// (fsync) if `durable`. Returns its name. On failure it throws Error with the place and leaves nothing behind.
std::filesystem::path write_part(const FilePlace& place, std::string_view bytes, bool durable);

/// Copies a file into the part file of a place, block by block; otherwise like write_part.
std::filesystem::path copy_part(const std::filesystem::path& from, const FilePlace& place);

/// Syncs a part file filled by other code to disk. Throws Error with the place.
void sync_part(const FilePlace& place, const std::filesystem::path& part);

/// A new part file's name for this place; the process owns it until forget_part().
std::filesystem::path new_part_name(const FilePlace& place);

/// Ends this process's ownership of a part file that is in its place or removed.
void forget_part(const std::filesystem::path& part);

/// Removes the part file; ignores a missing one.
void remove_part(const std::filesystem::path& part);

/// True for a part file's name.
bool is_part_name(std::string_view name);

/// True for the name of a part file of this very file.
bool is_part_name_of(std::string_view name, const std::filesystem::path& file);

/// Removes the part files of dead processes in this folder alone. Ignores failures.
void clear_leftovers(const std::filesystem::path& folder);

/// Calls clear_leftovers() once per folder and process. Every write calls it first.
void clear_leftovers_once(const std::filesystem::path& folder);

/// Syncs a folder's names to disk. On a file system without this function, a power failure leaves the old or the new
/// file, each complete; this is no error.
void sync_folder(const std::filesystem::path& folder);

}  // namespace burin

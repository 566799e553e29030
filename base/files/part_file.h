// burin/base/files/part_file.h - a file on its way: written whole beside its place under a hidden name,
// ".NAME.part-PROCESS-NUMBER.EXTENSION", and put there by a rename. How Burin writes files is told in
// docs/reliability.md; who writes one calls burin/base/files/write_file.h.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string_view>

namespace burin {

/// Where a file is to be put: behind symbolic links, with what it replaces.
struct FilePlace {
  std::filesystem::path named;  ///< as the person named it, for sentences
  std::filesystem::path file;   ///< where the links lead to
  bool there = false;           ///< a regular file is there already
  mode_t mode = 0;              ///< its permissions, which stay
  uid_t user = 0;               ///< and its owners
  gid_t group = 0;

  /// The folder that it lies in.
  std::filesystem::path folder() const;
};

/// The place of an output. Throws Error for a folder, device, FIFO or socket, for a file that is write-protected, for a
/// folder that is not there, for names that no file can have, for links that lead out of the folder that was named, and
/// for this command's inputs (burin/base/files/named_paths.h).
FilePlace find_place(const std::filesystem::path& named);

/// Writes the part file of a place: all bytes, owners and permissions of what it will replace, on the disk (fsync) if
/// `durable`. Returns its name. Throws Error naming the place, and leaves nothing behind then.
std::filesystem::path write_part(const FilePlace& place, std::string_view bytes, bool durable);

/// Copies a file into the part file of a place, block by block; otherwise as write_part.
std::filesystem::path copy_part(const std::filesystem::path& from, const FilePlace& place);

/// Sees to it that a part file that something else has filled is on the disk. Throws Error naming the place.
void sync_part(const FilePlace& place, const std::filesystem::path& part);

/// A new part file's name for that place, which the process keeps for its own until forget_part().
std::filesystem::path new_part_name(const FilePlace& place);

/// The file is in its place, or removed: it is no part of this process any more.
void forget_part(const std::filesystem::path& part);

/// Removes the part file; says nothing where there is none.
void remove_part(const std::filesystem::path& part);

/// Whether this is a part file's name.
bool is_part_name(std::string_view name);

/// Whether it is the name of a part file of this very file.
bool is_part_name_of(std::string_view name, const std::filesystem::path& file);

/// Removes the part files of processes that are no more, in this folder alone. Says nothing where it cannot.
void clear_leftovers(const std::filesystem::path& folder);

/// The same once for each folder and process: what is called before every write.
void clear_leftovers_once(const std::filesystem::path& folder);

/// Tells the disk to keep a folder's names. Where a file system cannot, the old or the new name is found after a power
/// failure, each whole: that is no error.
void sync_folder(const std::filesystem::path& folder);

}  // namespace burin

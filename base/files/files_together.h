// burin/base/files/files_together.h - atomic change of several files: all of them, or none.
//
// During the lifetime of a FilesTogether, its thread writes files (burin/base/files/write_file.h) next to their final
// places. put() writes a journal, ".burin-change", into the common folder, moves every file to its place, and removes
// the journal. If a move fails, put() moves all files back. If the process dies, the next process that reads or writes
// there finds the journal and completes the change (settle_changes). Nobody ever reads a mixture of old and new files.
//
// A journal may come with a folder from a stranger. It therefore acts only within named folders or their project
// (burin/base/files/named_paths.h). It acts only on its own files on this disk, by their inode numbers.
// report_settled_changes() registers a callback for such changes.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "burin/base/files/part_file.h"

namespace burin {

/// One change of several files by this thread. Inside another change, it joins the outer one.
class FilesTogether {
 public:
  FilesTogether();
  /// Without put(), the destructor discards the change.
  ~FilesTogether();
  FilesTogether(const FilesTogether&) = delete;
  FilesTogether& operator=(const FilesTogether&) = delete;

  /// Moves all files to their places and ends the change: later files go directly to their places. Throws Error if one
  /// file cannot move; all files are then unchanged.
  void put();

  /// One file of a change.
  struct Item {
    FilePlace place;
    std::filesystem::path part;    ///< the new content; empty: the file is removed
    std::filesystem::path former;  ///< the old file's second name, until the change is complete
  };

 private:
  friend bool joins_change(const FilePlace& place, const std::filesystem::path& part);
  friend std::filesystem::path as_written(const std::filesystem::path& file);

  FilesTogether* outer_ = nullptr;
  std::vector<Item> items_;
};

/// Adds a part file (empty: a removal) to this thread's change. Returns false without a change.
bool joins_change(const FilePlace& place, const std::filesystem::path& part);

/// Path of a file's new bytes if this thread's change has written it; otherwise the file itself.
std::filesystem::path as_written(const std::filesystem::path& file);

/// Completes or reverts a dead process's change in the file's folder or the two folders above it. Waits for a change in
/// progress. Throws Error if this very file is part of a change without a possible or permitted completion: the files
/// are then a mixture. Every reader and writer of the file calls it first. Returns false if it left a change of others
/// unsettled.
bool settle_changes(const std::filesystem::path& file);

/// Registers `report`, which receives a sentence per change completed or reverted by settle_changes().
void report_settled_changes(std::function<void(const std::string&)> report);

}  // namespace burin

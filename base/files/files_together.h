// burin/base/files/files_together.h - files that belong together change together: all of them, or none.
//
// While a FilesTogether lives, what its thread writes (burin/base/files/write_file.h) stays beside its place. put()
// writes a journal, ".burin-change", into the folder that holds them all, moves every file to its place, and removes
// the journal. Where a move fails, all are moved back. Where the process dies, whoever next reads or writes there finds
// the journal and completes the change (settle_changes): nobody ever reads a mixture of old and new.
//
// A journal may come with a stranger's folder. So it acts only within what was named, or its project
// (burin/base/files/named_paths.h), only on the very files that were written for it on this disk (it holds their
// numbers, inodes), and whoever asked for it with report_settled_changes() is told.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "burin/base/files/part_file.h"

namespace burin {

/// One change of several files, by this thread. Within another one, it is part of that.
class FilesTogether {
 public:
  FilesTogether();
  /// Without put(), nothing has changed.
  ~FilesTogether();
  FilesTogether(const FilesTogether&) = delete;
  FilesTogether& operator=(const FilesTogether&) = delete;

  /// Puts all files in their places, and ends the change: what is written later goes to its place by itself. Throws
  /// Error where one cannot be put; then all are as before.
  void put();

  /// One file of a change.
  struct Item {
    FilePlace place;
    std::filesystem::path part;    ///< what becomes of it; empty: it is removed
    std::filesystem::path former;  ///< the old file's second name, until the change is complete
  };

 private:
  friend bool joins_change(const FilePlace& place, const std::filesystem::path& part);
  friend std::filesystem::path as_written(const std::filesystem::path& file);

  FilesTogether* outer_ = nullptr;
  std::vector<Item> items_;
};

/// Hands a part file (empty: a removal) to this thread's change. False where there is none.
bool joins_change(const FilePlace& place, const std::filesystem::path& part);

/// Where the bytes of a file lie that this thread's change has written; otherwise the file itself.
std::filesystem::path as_written(const std::filesystem::path& file);

/// Completes, or takes back, a change in the file's folder or the two above it whose process died. Waits for one that
/// is being made just now. Throws Error where it cannot, or may not although it changes this very file: what is there
/// is a mixture. Called before every reading and writing of the file. False: a change of others was left as it is.
bool settle_changes(const std::filesystem::path& file);

/// From now on `report` is called with a sentence about each change that settle_changes() has completed or taken back.
void report_settled_changes(std::function<void(const std::string&)> report);

}  // namespace burin

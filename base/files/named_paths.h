// burin/base/files/named_paths.h - which files and folders a person named, so that nothing within a folder, neither a
// symbolic link nor a change that was cut off (burin/base/files/files_together.h), makes Burin write out of it (a
// project may come from a stranger, docs/security.md), and no output replaces an input of the same command.
//
// A file that the command line names by its own path (`--out FILE`) is written wherever links lead. All other names are
// Burin's own (report.html, round-01/bench.json): they stay within the innermost folder that was named.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace burin {

/// While one lives, these are the words of the command line: paths among them, options and numbers, which name nothing
/// that is written. Without one (in another program) whoever writes a file has named it.
class NamedPaths {
 public:
  explicit NamedPaths(const std::vector<std::string>& words);
  ~NamedPaths();
  NamedPaths(const NamedPaths&) = delete;
  NamedPaths& operator=(const NamedPaths&) = delete;

 private:
  std::vector<std::filesystem::path> before_, outputs_before_;
};

/// A file that is read for its content, by its device and its number on it.
void note_input(std::uintmax_t device, std::uintmax_t number);

/// Throws Error where `file`, an output that is to be written (behind links), is one of this command's inputs or is
/// named a second time on its command line: by whatever name, as the value of an output option (--out, --sent,
/// --animate), beside it or within it. A file that this command has written itself may be written again.
void fail_if_input(const std::filesystem::path& named, const std::filesystem::path& file);

/// `file` is this command's to write again: it has written it, or is asked to bring it up to date.
void allow_change_of(const std::filesystem::path& file);

/// This command has written the file `named`, and it is in its place.
void note_written(const std::filesystem::path& named);

/// A folder with files that this command has written was moved.
void note_moved(const std::filesystem::path& from, const std::filesystem::path& to);

/// The files that this command has written and that are there, by the names that it gave them, in their order.
std::vector<std::filesystem::path> written_files();

/// Throws Error naming link and target where a symbolic link leads `named`, a file or folder that is to be written, out
/// of the innermost folder that was named. `real`: where it leads to, without links. Nothing is refused that was named
/// by its own path.
void fail_if_led_outside(const std::filesystem::path& named, const std::filesystem::path& real);

/// Whether something that lies in `folder` may change files there when `file` is read or written. `folder` is that
/// file's, or lies above it. Yes within a folder that was named, and within the project of whatever was named; and for
/// a file that was named by its own path, in its own folder. Where nobody has named anything, in the file's own folder
/// and within its project.
bool may_change_in(const std::filesystem::path& folder, const std::filesystem::path& file);

/// Whether a folder is a project of `burin loop`: one with a design.json and a board.json.
bool is_project(const std::filesystem::path& folder);

}  // namespace burin

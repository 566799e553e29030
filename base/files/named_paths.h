// burin/base/files/named_paths.h - files and folders that a person named. Burin writes only inside them: neither a
// symbolic link nor an interrupted change (burin/base/files/files_together.h) leads out (a project may come from a
// stranger, docs/security.md). No output replaces an input of the same command, or a file of another kind.
//
// A file with its own path on the command line (`--out FILE`) is written wherever links lead. Burin chooses all other
// names (report.html, round-01/bench.json): they stay within the innermost named folder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace burin {

/// Holds the words of the command line during its lifetime. Some are paths; options and numbers name no output. Without
/// such an object (in another program), the writer of a file counts as having named it.
class NamedPaths {
 public:
  explicit NamedPaths(const std::vector<std::string>& words);
  ~NamedPaths();
  NamedPaths(const NamedPaths&) = delete;
  NamedPaths& operator=(const NamedPaths&) = delete;

 private:
  std::vector<std::filesystem::path> before_, outputs_before_;
};

/// Records a file read for its content, by its device and its inode number.
void note_input(std::uintmax_t device, std::uintmax_t number);

/// Throws Error if the output `file` (links resolved) is one of this command's inputs, or if the command line names it
/// twice. The check covers values of output options (--out, --sent, --animate) and files next to them or within them,
/// under any name. A file written by this command itself is permitted.
void fail_if_input(const std::filesystem::path& named, const std::filesystem::path& file);

/// Throws Error if the command line names the output `file` (links resolved), and the existing file is of another kind
/// than `part`, its new content. The first bytes decide the kind. JSON files differ in kind by their "format", pages by
/// Burin's name. An empty file has no kind, and files under allow_change_of() are permitted.
void fail_if_other_kind(const std::filesystem::path& named, const std::filesystem::path& file,
                        const std::filesystem::path& part);

/// Permits this command to write `file` again: it has written it, or its task is to update it.
void allow_change_of(const std::filesystem::path& file);

/// Records that this command has written the file `named` and put it in its place.
void note_written(const std::filesystem::path& named);

/// Records that a folder with files of this command was moved.
void note_moved(const std::filesystem::path& from, const std::filesystem::path& to);

/// The existing files written by this command, under the names used then, in their order.
std::vector<std::filesystem::path> written_files();

/// Throws Error with link and target if a symbolic link leads `named`, an output file or folder, out of the innermost
/// named folder. `real` is its target without links. Paths named by a person are always permitted.
void fail_if_led_outside(const std::filesystem::path& named, const std::filesystem::path& real);

/// True if a journal or link in `folder` may change files there when the program reads or writes `file`. `folder`
/// contains `file`, directly or further down. It is true within a named folder and within the project of a named path.
/// For a file with its own path on the command line, it is true in its folder. If nobody named anything, it is true in
/// the file's folder and within its project.
bool may_change_in(const std::filesystem::path& folder, const std::filesystem::path& file);

/// True for a project of `burin loop`: a folder with a design.json and a board.json.
bool is_project(const std::filesystem::path& folder);

}  // namespace burin

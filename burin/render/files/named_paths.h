// burin/render/files/named_paths.h - which files and folders a person named, so that no symbolic link within a folder
// leads what Burin writes out of it (a project may come from a stranger, docs/security.md), and no output replaces an
// input of the same command.
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

/// Throws Error naming link and target where a symbolic link leads `named`, a file or folder that is to be written, out
/// of the innermost folder that was named. `real`: where it leads to, without links. Nothing is refused that was named
/// by its own path.
void fail_if_led_outside(const std::filesystem::path& named, const std::filesystem::path& real);

}  // namespace burin

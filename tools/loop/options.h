// tools/loop/options.h - what a project is made with: PROJECT/loop.toml (docs/file-formats.md).
//
//   format = "burin/loop"
//   version = 1
//   machine = "spring.toml"            # or grbl, ...; files are relative to the project
//   travel_mm = [[0, 0], [300, 180]]   # if the machine's own file has none; or "unknown"
//   accept_unknown = ["depth_um"]
//   [design]
//   tolerance-mm = 3                   # any option of `burin design`, by its name
//   [toolpath]
//   chunks = "30min"
//   [capture]
//   f-number = 8                       # of photos whose EXIF has none
//
// Which options there are is known to the commands alone (tools/commands.h): a table is checked by parsing it as the
// command line that it becomes.
#pragma once

#include <CLI/App.hpp>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "burin/optimize/machine_profile.h"
#include "tools/loop/record.h"

namespace burin {

/// The options of one command: the name without its dashes to its values as text; a flag has none.
using CommandOptions = std::map<std::string, std::vector<std::string>>;

struct LoopOptions {
  std::string machine;  ///< a built-in name, or a file relative to the project; empty: grbl
  CommandOptions design, toolpath, capture;
  std::vector<std::string> accept_unknown;
  std::optional<MachineBounds> travel;  ///< MachineProfile's
  bool travel_is_unknown = false;
};

/// PROJECT/loop.toml; what it leaves out, or all if it is not there, is as if never said. Throws Error naming file,
/// line and key.
LoopOptions read_loop_options(const std::filesystem::path& project);

/// The options of `burin loop` that are kept in loop.toml.
struct LoopCommandLine {
  std::shared_ptr<void> design_values, toolpath_values, capture_values;
  CLI::App* design = nullptr;
  CLI::App* toolpath = nullptr;
  CLI::App* capture = nullptr;
  std::string machine;
  std::string travel;  ///< "300x180" or "unknown"; empty: not said
};

/// Adds them to the command; `said` outlives it.
void add_loop_options(CLI::App& command, LoopCommandLine& said);

/// Writes what the command line says otherwise than loop.toml into it, all else in it staying as it is, and returns
/// what then holds. Files that were named from the working directory are named from the project. Throws Error where a
/// line cannot be changed by a program.
LoopOptions remember_options(const LoopCommandLine& said, const std::filesystem::path& project);

/// The machine's profile, with the reach that loop.toml has where the profile has none.
MachineProfile machine_of(const LoopOptions& options, const std::filesystem::path& project);

/// The machine as the commands take it, from the working directory.
std::string machine_argument(const LoopOptions& options, const std::filesystem::path& project);

/// The options as words of a command line, files usable from the working directory.
std::vector<std::string> design_arguments(const LoopOptions& options, const std::filesystem::path& project);
std::vector<std::string> toolpath_arguments(const LoopOptions& options, const std::filesystem::path& project);
std::vector<std::string> capture_arguments(const LoopOptions& options, const std::filesystem::path& project);

/// Files that the options name, and their texts for a record: "machine", and each option.
std::vector<std::filesystem::path> design_option_files(const LoopOptions& options,
                                                       const std::filesystem::path& project);
std::vector<std::filesystem::path> toolpath_option_files(const LoopOptions& options,
                                                         const std::filesystem::path& project);
OptionTexts texts_of(const CommandOptions& command);
OptionTexts option_texts(const LoopOptions& options, const CommandOptions& command);

/// "for grbl; design: tolerance-mm 3, free-width; toolpath: chunks 30min".
std::string in_words(const LoopOptions& options);

}  // namespace burin

// tools/loop/options.h - options of a project: PROJECT/loop.toml (docs/file-formats.md).
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
// Only the commands know their options (tools/commands.h). A table is therefore checked by parsing it as a command
// line.
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

struct CaptureArguments;
struct DesignArguments;
struct ToolpathArguments;

/// Options of one command: values as text by name without dashes; a flag has none.
using CommandOptions = std::map<std::string, std::vector<std::string>>;

struct LoopOptions {
  std::string machine;  ///< a built-in name, or a file relative to the project; empty: grbl
  CommandOptions design, toolpath, capture;
  std::vector<std::string> accept_unknown;
  std::optional<MachineBounds> travel;  ///< as in MachineProfile
  bool travel_is_unknown = false;
};

/// Reads PROJECT/loop.toml. Missing keys, or a missing file, count as not given. Throws Error with file, line and key.
LoopOptions read_loop_options(const std::filesystem::path& project);

/// Options of `burin loop` stored in loop.toml.
struct LoopCommandLine {
  std::shared_ptr<void> design_values, toolpath_values, capture_values;
  CLI::App* design = nullptr;
  CLI::App* toolpath = nullptr;
  CLI::App* capture = nullptr;
  std::string machine;
  std::string travel;  ///< "300x180" or "unknown"; empty: not given
};

/// Adds the options to the command; `said` must outlive it.
void add_loop_options(CLI::App& command, LoopCommandLine& said);

/// Writes differing options of the command line into loop.toml, leaves the rest unchanged, and returns the resulting
/// options. Paths relative to the working directory become relative to the project. Throws Error for a line in an
/// unsupported form.
LoopOptions remember_options(const LoopCommandLine& said, const std::filesystem::path& project);

/// Returns the machine's profile. If the profile has no reach, it gets the reach in loop.toml.
MachineProfile machine_of(const LoopOptions& options, const std::filesystem::path& project);

/// Returns the machine as an argument of commands, relative to the working directory.
std::string machine_argument(const LoopOptions& options, const std::filesystem::path& project);

/// Return the options as words of a command line, with files relative to the working directory.
std::vector<std::string> design_arguments(const LoopOptions& options, const std::filesystem::path& project);
std::vector<std::string> toolpath_arguments(const LoopOptions& options, const std::filesystem::path& project);
std::vector<std::string> capture_arguments(const LoopOptions& options, const std::filesystem::path& project);

/// Set the project's options of a command in the arguments of its function (tools/steps.h).
void give_options(const LoopOptions& options, const std::filesystem::path& project, DesignArguments& arguments);
void give_options(const LoopOptions& options, const std::filesystem::path& project, ToolpathArguments& arguments);
void give_options(const LoopOptions& options, const std::filesystem::path& project, CaptureArguments& arguments);

/// Files among the options, and texts of the options for a record: "machine", and each option.
std::vector<std::filesystem::path> design_option_files(const LoopOptions& options,
                                                       const std::filesystem::path& project);
std::vector<std::filesystem::path> toolpath_option_files(const LoopOptions& options,
                                                         const std::filesystem::path& project);
OptionTexts texts_of(const CommandOptions& command);
OptionTexts option_texts(const LoopOptions& options, const CommandOptions& command);

/// "for grbl; design: tolerance-mm 3, free-width; toolpath: chunks 30min".
std::string in_words(const LoopOptions& options);

}  // namespace burin

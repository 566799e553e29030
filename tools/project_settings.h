// tools/project_settings.h - defaults of commands inside a project: machine, board, bench and the heights for the
// depths. An explicit option has priority. Commands outside of a project get no defaults.
#pragma once

#include <CLI/App.hpp>
#include <filesystem>
#include <optional>
#include <string>

#include "burin/optimize/machine_profile.h"
#include "tools/project.h"

namespace burin {

struct ProjectSettings {
  PlaceInProject at;
  std::string machine;  ///< as commands take it; empty: not in loop.toml
  std::filesystem::path board;
  std::filesystem::path bench;      ///< for which the round is designed; outside of a round, the latest measured one
  std::filesystem::path heights;    ///< of the sheet, probed for the round; empty without a probe
  bool follow_bow = false;          ///< from loop.toml
  double f_number = 0;              ///< of photos without EXIF, from loop.toml; 0: not given
  std::filesystem::path scratches;  ///< set by the command itself, like `light`; empty: none
  std::string light;
};

/// Reads the settings of the project around `given`, or else around the working directory. Throws Error for a broken
/// loop.toml.
std::optional<ProjectSettings> settings_around(const std::filesystem::path& given);

/// Reads a command's machine. If it is the machine of the project around `given` and has no reach of its own, it gets
/// the project's reach.
MachineProfile machine_in_project(const std::string& machine, const std::filesystem::path& given);

/// Returns the project folder for a command's argument. A round's folder gives its project, and an empty argument gives
/// the project around the working directory. Another argument returns unchanged, for the reader to check. Throws
/// CLI::RequiredError, naming `argument`, if there is neither.
std::filesystem::path project_folder(const std::filesystem::path& given, const std::string& argument);

/// A command's values with defaults from the project; null for missing options of the command.
struct SettingsToTake {
  std::string* machine = nullptr;
  std::filesystem::path* scratches = nullptr;
  std::filesystem::path* board = nullptr;
  std::filesystem::path* bench = nullptr;
  std::filesystem::path* heights = nullptr;  ///< none with --follow-bow
  bool* follow_bow = nullptr;                ///< not with --heights
  std::string* light = nullptr;
  double* f_number = nullptr;
};

/// Fills each value from the project, unless its option is given or the project has no value. Prints one line: "note:
/// from the project hum: machine grbl-spring, bench hum/bench.json".
void take_from_project(const CLI::App& command, const ProjectSettings& settings, const SettingsToTake& into);

}  // namespace burin

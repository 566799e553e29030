// tools/project_settings.h - what a command takes from the project that it is given or run in, so that it asks nothing
// that the project knows: machine, board, bench and what the depths follow. An option that is said goes before it;
// outside of a project nothing is guessed.
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
  std::string machine;  ///< as commands take it; empty: loop.toml does not name one
  std::filesystem::path board;
  std::filesystem::path bench;      ///< that the round is designed for; outside of a round, the one measured last
  std::filesystem::path heights;    ///< of the sheet as it was probed for the round; empty: it was not
  bool follow_bow = false;          ///< said in loop.toml
  double f_number = 0;              ///< of photos whose EXIF has none, said in loop.toml; 0: not said
  std::filesystem::path scratches;  ///< filled in by the command that knows them, like `light`; empty: none
  std::string light;
};

/// Of the project that `given` lies in, or else the working directory. Throws Error for a broken loop.toml.
std::optional<ProjectSettings> settings_around(const std::filesystem::path& given);

/// A machine as a command was given it, with the reach that the project around `given` has kept if it is that
/// project's machine and has none of its own.
MachineProfile machine_in_project(const std::string& machine, const std::filesystem::path& given);

/// The project's folder for a command that takes one: of a round's folder the project's, and where
/// nothing is given, the one that the working directory lies in. Else what was given, for whoever reads it to
/// judge. Throws CLI::RequiredError naming `argument` where there is neither.
std::filesystem::path project_folder(const std::filesystem::path& given, const std::string& argument);

/// The values of a command that a project may fill; null where the command has no such option.
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

/// Fills each from the project, unless its option was said or the project does not know it, and says so in one line:
/// "note: from the project hum: machine grbl-spring, bench hum/bench.json".
void take_from_project(const CLI::App& command, const ProjectSettings& settings, const SettingsToTake& into);

}  // namespace burin

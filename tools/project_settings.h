// tools/project_settings.h - what a command takes from the project that it is given or run in, so that it asks nothing
// that the project knows: machine, board, bench and what the depths follow. An option that is said goes before it;
// outside of a project nothing is guessed.
#pragma once

#include <CLI/App.hpp>
#include <filesystem>
#include <optional>
#include <string>

#include "tools/project.h"

namespace burin {

struct ProjectSettings {
  PlaceInProject at;
  std::string machine;  ///< as commands take it; empty: loop.toml does not name one
  std::filesystem::path board;
  std::filesystem::path bench;    ///< that the round is designed for; outside of a round, the one measured last
  std::filesystem::path heights;  ///< of the sheet as it was probed for the round; empty: it was not
  bool follow_bow = false;        ///< said in loop.toml
};

/// Of the project that `given` lies in, or else the working directory. Throws Error for a broken loop.toml.
std::optional<ProjectSettings> settings_around(const std::filesystem::path& given);

/// The project's folder for a command that takes one: of a round's folder the project's, and where
/// nothing is given, the one that the working directory lies in. Else what was given, for whoever reads it to
/// judge. Throws CLI::RequiredError naming `argument` where there is neither.
std::filesystem::path project_folder(const std::filesystem::path& given, const std::string& argument);

/// What a command took, to be said in one line.
class TakenSettings {
 public:
  explicit TakenSettings(const CLI::App& command) : command_(command) {}

  /// Fills `into` from the project, unless `option` was said or the project does not know it.
  void take(const std::string& option, const std::filesystem::path& value, std::filesystem::path& into);
  void take(const std::string& option, const std::string& value, std::string& into);
  /// A flag that the project says.
  void take(const std::string& option, bool value, bool& into);
  /// "note: from the project hum: machine grbl-spring, bench hum/bench.json"; nothing where nothing was taken.
  void say(const ProjectSettings& settings) const;

 private:
  bool is_said(const std::string& option) const { return command_.count(option) > 0; }
  void add(const std::string& option, const std::string& value);

  const CLI::App& command_;
  std::string words_;
};

}  // namespace burin

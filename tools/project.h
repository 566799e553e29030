// tools/project.h - file layout of a loop project (docs/file-formats.md). tools/loop/stages.h describes each file.
#pragma once

#include <filesystem>
#include <optional>

namespace burin {

struct Project {
  std::filesystem::path folder;

  std::filesystem::path round(int number) const;  ///< round-01, round-02, ...
  /// The bench known before that round: the nominal bench.json, or the measurement of the round before.
  std::filesystem::path bench_before(int number) const;
  /// heights.json of the sheet, probed for that round; empty without a probe.
  std::filesystem::path heights(int number) const;
  /// Resolution of that round's design, in pixels along the longer side. Nothing for a missing design and for versions
  /// that did not record it.
  std::optional<int> pixels(int number) const;
  int rounds() const;    ///< number of round folders, counted from 1 up to the first gap
  int measured() const;  ///< number of rounds with a measured bench.json, counted likewise
};

/// A file or a folder of a loop project.
struct PlaceInProject {
  Project project;
  int round = 0;  ///< its round; 0: in no round's folder
};

/// Finds the project of a path: the nearest folder at or above it with board.json, design.json and bench.json, unless
/// it is a round. Links are taken as written first, and resolved if this fails. The project's folder is relative or
/// absolute like the path. The path need not exist.
std::optional<PlaceInProject> project_of(const std::filesystem::path& path);

/// Returns true for a path in a round's folder, whose next step is the loop's.
bool is_in_round(const std::filesystem::path& path);

}  // namespace burin

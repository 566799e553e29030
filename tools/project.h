// tools/project.h - where a loop project keeps its files. docs/file-formats.md; what each file is stands in
// tools/loop/stages.h.
#pragma once

#include <filesystem>
#include <optional>

namespace burin {

struct Project {
  std::filesystem::path folder;

  std::filesystem::path round(int number) const;  ///< round-01, round-02, ...
  /// What is known of the bench before that round: the nominal bench.json, or the one that the round before measured.
  std::filesystem::path bench_before(int number) const;
  /// heights.json of the sheet as it was probed for that round; empty: it was not.
  std::filesystem::path heights(int number) const;
  /// In how many pixels, along the longer side, that round's design looked at its pictures. None where it is not
  /// designed yet, or by a Burin that did not say.
  std::optional<int> pixels(int number) const;
  int rounds() const;    ///< how many round folders there are, counted from 1 without a gap
  int measured() const;  ///< how many of them hold a measured bench.json, counted the same way
};

/// A file or a folder of a loop project.
struct PlaceInProject {
  Project project;
  int round = 0;  ///< in whose folder it lies; 0: in no round's
};

/// The project that a path belongs to: the nearest folder above it, or itself, with board.json, design.json and
/// bench.json that is no round. Links count as they are written and, if that finds none, as they lead. The project's
/// folder is named as the path is: relative to the working directory, or from the root. The path need not exist.
std::optional<PlaceInProject> project_of(const std::filesystem::path& path);

/// Whether a path lies in a round's folder: there the loop does what comes next.
bool is_in_round(const std::filesystem::path& path);

}  // namespace burin

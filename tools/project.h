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
  /// In how many pixels, along the longer side, that round's design looked at its pictures. None where it is not
  /// designed yet, or by a Burin that did not say.
  std::optional<int> pixels(int number) const;
  int rounds() const;    ///< how many round folders there are, counted from 1 without a gap
  int measured() const;  ///< how many of them hold a measured bench.json, counted the same way
};

}  // namespace burin

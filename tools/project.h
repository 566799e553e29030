// tools/project.h - where a loop project keeps its files, and which photographed view belongs to which designed one.
// Frame: board, mm. docs/file-formats.md; what each file is stands in tools/loop_command.cpp.
#pragma once

#include <filesystem>
#include <string>

#include "burin/render/bench.h"
#include "burin/render/board.h"

namespace burin {

struct Project {
  std::filesystem::path folder;

  std::filesystem::path round(int number) const;  ///< round-01, round-02, ...
  /// What is known of the bench before that round: the nominal bench.json, or the one that the round before measured.
  std::filesystem::path bench_before(int number) const;
  int rounds() const;  ///< how many round folders there are, counted from 1 without a gap
};

/// The measured view that was taken from a designed view's place: the nearest in direction from the board's center.
/// Null if none stands within 15 degrees.
const View* measured_view(const Bench& measured, const View& designed, const Board& board);

}  // namespace burin

// burin/scene/scratches.h - rows of scratches.csv: two end points each, in carving order. What rows mean (wanted, told
// to the machine, in the metal) is said by Designed, Sent and Carved (burin/scene/carve.h).
// Frame: board, mm. docs/file-formats.md, `scratches.csv`.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

namespace burin {

/// Flat arrays, one entry a scratch. `width_um`, `depth_um` and `alpha` are empty where all scratches share the
/// tool's width and the material's depth and alpha; otherwise they have size() entries.
struct Scratches {
  std::vector<double> x0_mm, y0_mm, x1_mm, y1_mm;
  std::vector<double> width_um, depth_um, alpha;
  /// 1 for what is in the metal already, where it lies; 0 for what is still to be carved. Empty: nothing is carved.
  /// Numbers like the others, so that what goes over all columns needs no case of its own.
  std::vector<double> carved = {};
  /// How much of the groove's half-width others have left; where it is less than 1, they have taken its burrs, too
  /// (burin/scene/crossings.h). Empty: all of it. Not in files.
  std::vector<double> left = {};

  /// How many there are.
  std::size_t size() const { return x0_mm.size(); }
  /// Whether scratch i is in the metal already.
  bool is_carved(std::size_t i) const { return !carved.empty() && carved[i] != 0; }
  /// Whether others have taken the rims of scratch i.
  bool is_narrowed(std::size_t i) const { return !left.empty() && left[i] < 1; }
};

/// Reads `scratches.csv`. Throws Error naming the line for a missing column, a value that is not a finite number,
/// a scratch shorter than a nanometer, a width, depth or alpha that is not positive, or a `carved` that is not 0 or 1.
Scratches read_scratches(const std::filesystem::path& file);

/// Writes `scratches.csv` atomically, with 1e-5 mm.
void write_scratches(const Scratches& scratches, const std::filesystem::path& file);

/// These rows, in this order, with all their columns.
Scratches selected(const Scratches& scratches, std::span<const std::size_t> rows);

/// One after the other. Where only one has a column of its own, the other's rows take the shared number given here.
Scratches joined(const Scratches& first, const Scratches& second, double width_um, double depth_um, double alpha);

}  // namespace burin

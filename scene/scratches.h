// burin/scene/scratches.h - rows of scratches.csv: two end points each, in carving order. Designed, Sent and Carved
// (burin/scene/carve.h) give the meaning of rows: desired, commanded or carved positions.
// Frame: board, mm. docs/file-formats.md, `scratches.csv`.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

namespace burin {

/// Flat arrays, one entry per scratch. `width_um`, `depth_um` and `alpha` are empty if all scratches share the tool's
/// width and the material's depth and alpha; otherwise they have size() entries.
struct Scratches {
  std::vector<double> x0_mm, y0_mm, x1_mm, y1_mm;
  std::vector<double> width_um, depth_um, alpha;
  /// 1 for a scratch already in the metal, which stays fixed; 0 for a future one. Empty: nothing is carved. It is a
  /// column of doubles like the others, so loops over all columns need no special case.
  std::vector<double> carved = {};
  /// Remaining fraction of the groove's half-width after crossings. Below 1, they also remove its burrs
  /// (burin/scene/crossings.h). Empty: all of it. Not in files.
  std::vector<double> left = {};

  /// Number of scratches.
  std::size_t size() const { return x0_mm.size(); }
  /// True if scratch i is in the metal already.
  bool is_carved(std::size_t i) const { return !carved.empty() && carved[i] != 0; }
  /// True if other grooves have removed the rims of scratch i.
  bool is_narrowed(std::size_t i) const { return !left.empty() && left[i] < 1; }
};

/// Reads `scratches.csv`. Throws Error with the line for a missing column and a non-finite value. Throws it also for a
/// scratch shorter than a nanometer, a non-positive width, depth or alpha, and a `carved` other than 0 or 1.
Scratches read_scratches(const std::filesystem::path& file);

/// Writes `scratches.csv` atomically, with a resolution of 1e-5 mm.
void write_scratches(const Scratches& scratches, const std::filesystem::path& file);

/// These rows, in this order, with all their columns.
Scratches selected(const Scratches& scratches, std::span<const std::size_t> rows);

/// `first`, then `second`. If only one has a column, the other's rows take the shared number given here.
Scratches joined(const Scratches& first, const Scratches& second, double width_um, double depth_um, double alpha);

}  // namespace burin

// burin/capture/tags/edge_sharpening.h - detects a camera's sharpening from the edges of the tags' black borders.
// docs/model.md 9.23.
//
// Across a border, paper steps from black to white. A lens, a pixel and any monotonic curve keep the step monotonic. An
// unsharp mask leaves white paper brighter next to the edge than further out. This overshoot is measured per photo. It
// does not determine the mask's amount and width, which trade off with the lens's blur. A person who knows them can
// write them into session.json, and burin/scene/response.h removes the sharpening.
#pragma once

#include <span>
#include <vector>

#include "burin/capture/session.h"
#include "burin/capture/tags/tag_detector.h"

namespace burin {

/// A photo and the tags in it.
struct EdgePhoto {
  Photo photo;
  std::vector<TagDetection> tags;
};

/// Overshoot at the edges.
struct EdgeSharpening {
  bool is_seen = false;  ///< an overshoot beyond chance and above 0.6 % of the step
  /// Excess brightness of white paper next to the edge over paper further out, as a share of the stored step from black
  /// to white. Median of the photos, and its standard error from their scatter.
  double overshoot = 0, overshoot_sigma = 0;
  int photos = 0;  ///< number of usable photos: paper neither clipped nor black, cells of 4.5 pixels and more
};

/// `border_cells` is the width of a tag's black border from edge to edge, in cells (TagPattern). Photos are read with
/// their own Photo::sharpening removed.
EdgeSharpening edge_sharpening(std::span<const EdgePhoto> photos, int border_cells);

}  // namespace burin

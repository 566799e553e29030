// burin/capture/tags/edge_sharpening.h - whether a camera sharpens its pictures, from the edges of the tags' black
// borders. docs/model.md 9.23.
//
// Across a border paper steps from black to white. A lens, a pixel and any monotonic curve leave a step that rises all
// the way; an unsharp mask leaves white paper brighter beside the edge than further out. How much is seen here, photo
// by photo. Amount and width of the mask do not follow from it: they trade with the lens's own blur. Who knows them can
// write them into session.json, and they are taken back (burin/scene/response.h).
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

/// What the edges tell.
struct EdgeSharpening {
  bool is_seen = false;  ///< an overshoot beyond chance and above 0.6 % of the step
  /// How much brighter white paper is beside the edge than further out, of the stored step from black to white: median
  /// of the photos, and its standard error from their scatter.
  double overshoot = 0, overshoot_sigma = 0;
  int photos = 0;  ///< whose edges served: paper neither clipped nor black, cells of 4.5 pixels and more
};

/// `border_cells`: how many cells a tag's black border is wide from edge to edge (TagPattern). Photos are looked at
/// with the sharpening that they have taken back (Photo::sharpening).
EdgeSharpening edge_sharpening(std::span<const EdgePhoto> photos, int border_cells);

}  // namespace burin

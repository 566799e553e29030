// burin/calib/camera_look.h - estimates the camera's part of a session's photos: its response function, sharpening and
// color filter array, and each photo's own white balance. docs/model.md 9.22 to 9.24a.
//
// Values in session.json are taken as given. Brackets (burin/capture/bracket_response.h), the tags' edges
// (burin/capture/tags/edge_sharpening.h) and the color of the tags' white paper give the others. That color is the same
// in all views under one lamp.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "burin/base/finding.h"
#include "burin/capture/photo.h"
#include "burin/capture/session.h"
#include "burin/capture/tags/tag_detector.h"
#include "burin/scene/sensor.h"

namespace burin {

/// Source of the camera response function.
enum class CurveFrom {
  as_told,   ///< session.json; without one there, brackets if they show one
  brackets,  ///< brackets, even against session.json; an error without brackets
  none       ///< the plain encoding; curve, sharpening, mosaic and balance are not sought
};

/// Puts response, sharpening and balance, from session.json and from brackets, into `sensor`, and the pixels that
/// measured green. Throws Error if a curve from brackets is requested and no view has two exposures, or their curve is
/// not monotonic.
void look_at_brackets(const Session& session, CurveFrom from, Sensor& sensor, std::vector<Finding>& findings);

/// Seeks sharpening at the tags found in `session`'s photos, one entry per bracket, and reports it. Skips linear and
/// raw files.
void look_at_edges(const Session& session, std::span<const Bracket> brackets, std::span<const TagsInPhoto> tags,
                   int border_cells, const Sensor& sensor, std::vector<Finding>& findings);

/// The color of each tag's white paper in one merged view, which may be binned: log(R / G) and log(B / G).
struct PaperColor {
  int tag = 0;
  Eigen::Vector2d log_ratio{0, 0};
};
std::vector<PaperColor> paper_colors(const MergedView& view, const TagsInPhoto& tags);

/// Puts the white balance of whole brackets into `sensor`, from their papers' colors (one entry per bracket). Returns
/// true if it changed: if views differ beyond the scatter of their tags.
bool look_at_paper_colors(const Session& session, std::span<const Bracket> brackets,
                          std::span<const std::vector<PaperColor>> colors, Sensor& sensor,
                          std::vector<Finding>& findings);

}  // namespace burin

// burin/calib/camera_look.h - what a session's photos tell of the camera that took them: its curve, its sharpening, its
// mosaic, and each photo's own white balance. docs/model.md 9.22 to 9.24a.
//
// What is told (session.json) is believed; what is not told is taken from brackets (burin/capture/bracket_response.h),
// from the tags' edges (burin/capture/tags/edge_sharpening.h), and from the color of the tags' white paper, which is
// the same in all views under one lamp.
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

/// Where the camera's curve comes from.
enum class CurveFrom {
  as_told,   ///< session.json, or else brackets that ask for one
  brackets,  ///< brackets, whatever session.json says; an error where there are none
  none       ///< the plain encoding: no curve, no sharpening, no mosaic, no balance is looked for
};

/// Response, sharpening and balance from what is told and from brackets, and which pixels measured green, into
/// `sensor`. Throws Error where a curve from brackets is asked for and no view has two exposures, or their curve is not
/// monotonic.
void look_at_brackets(const Session& session, CurveFrom from, Sensor& sensor, std::vector<Finding>& findings);

/// Looks for sharpening at tags that were found in `session`'s photos, a bracket's in one entry, and names it. Linear
/// and raw files are not looked at.
void look_at_edges(const Session& session, std::span<const Bracket> brackets, std::span<const TagsInPhoto> tags,
                   int border_cells, const Sensor& sensor, std::vector<Finding>& findings);

/// The color of each tag's white paper in one merged view: log(R / G) and log(B / G). `bin` pixels of the photo are one
/// of the view's.
struct PaperColor {
  int tag = 0;
  Eigen::Vector2d log_ratio{0, 0};
};
std::vector<PaperColor> paper_colors(const MergedView& view, const TagsInPhoto& tags);

/// White balance of whole brackets, from their papers' colors (an entry a bracket), into `sensor`. True where it has
/// changed: where views differ beyond the scatter of their tags.
bool look_at_paper_colors(const Session& session, std::span<const Bracket> brackets,
                          std::span<const std::vector<PaperColor>> colors, Sensor& sensor,
                          std::vector<Finding>& findings);

}  // namespace burin

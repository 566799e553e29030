// burin/optimize/design/color_views.h - pictures in color: the light of each channel, the white reference, and the
// lights' mixable colors. docs/model.md 6.6, 6.7. Frame: board, mm. Channels: 0 red, 1 green, 2 blue.
//
// A view in color is three pictures of one channel with the same eye and pixels. Channel c is lit by the same channel
// of every light. A scratch glints under the light in its mirror direction, and reflects its color.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "burin/base/finding.h"
#include "burin/base/image.h"
#include "burin/optimize/design/glint.h"
#include "burin/optimize/design_file.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"

namespace burin {

/// A part of a view's light.
struct LightPart {
  int channel = -1;  ///< the only channel; -1: all of them, as gray
  double gain = 1;   ///< factor on its light
  std::string only;  ///< id of the only light; empty: all
};

/// The lights of a part: a gray picture under them is the picture of the channel. Lights without the channel are left
/// out, but at least one remains, dark if need be. `ambient` becomes the channel's as well.
Light part_of(const Light& light, const LightPart& part, Eigen::Vector3d& ambient);

/// The lights for which a view's scratches are made: each light of a view in color; all lights of a gray view together,
/// as its one light.
std::vector<std::string> lights_served(const DesignView& view);

/// The glint of each of them, named "v00 under red" in color. Throws Error for missing entries of the bench.
std::vector<GlintView> glints_served(const DesignView& view, const Bench& bench);

/// Throws Error if a view in color uses a light without color: no scratch for it would show.
void require_light(const DesignView& view, const Bench& bench);

/// Irradiance, R G B, of white paper at the carve area's middle under a light (with its simultaneous lights).
Eigen::Vector3d paper_light(const Light& light, const Board& board);

/// Factors on the channels that make the white reference white (DesignView::white). They give white paper the same
/// luminance as in gray, so gray and color views may share an exposure. Throws Error if none of the view's lights has
/// one of the colors, or for an impossible white (can_be_white).
Eigen::Vector3d white_gains(const DesignView& view, const Board& board, const Bench& bench);

/// Colors (R G B, of any length) of the lights for a view's scratches.
using LampColors = std::vector<Eigen::Vector3d>;

/// The pictures, one per channel, gamma-encoded, whose light is closest (sum of squares) to the light of `target`,
/// among sums of the colors with non-negative weights.
std::vector<Image> nearest_mixed(const std::vector<const Image*>& target, const LampColors& colors);

/// Throws Error for lights of a single color. Warns of a target with unmixable colors, and reports their distance.
/// `nearest` is its nearest_mixed().
std::vector<Finding> check_colors(const DesignView& view, const LampColors& colors,
                                  const std::vector<const Image*>& target, const Image& mask,
                                  const std::vector<Image>& nearest);

/// Notes a view whose lights differ in color although its target is shown in gray.
std::vector<Finding> check_gray(const DesignView& view, const Bench& bench);

}  // namespace burin

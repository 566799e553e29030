// burin/optimize/design/color_views.h - pictures in color: what of a view's lights each channel is made of, what looks
// white, and which colors the lights can mix. docs/model.md 6.6, 6.7. Frame: board, mm. Channels: 0 red, 1 green, 2
// blue.
//
// A view in color is three pictures of one channel that share eye and pixels; channel c is lit by that channel of every
// light. A scratch glints in the light that stands in its mirror direction, and throws that light's color.
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

/// A part of what shines on a view.
struct LightPart {
  int channel = -1;  ///< the only one that is seen; -1: all of them, as gray
  double gain = 1;   ///< on its light
  std::string only;  ///< the only one of the lights that shines (id); empty: all
};

/// Those lights, so that a gray picture under them is that channel's; lights that bring nothing to it are left out. At
/// least one is left, dark if need be. `ambient` becomes that channel's as well.
Light part_of(const Light& light, const LightPart& part, Eigen::Vector3d& ambient);

/// The lights that a view's scratches are made for, one by one: each light of a view in color; of a view in gray all
/// at once, as its one light.
std::vector<std::string> lights_served(const DesignView& view);

/// The glint of each of them; in color they are called "v00 under red". Throws Error for what the bench lacks.
std::vector<GlintView> glints_served(const DesignView& view, const Bench& bench);

/// Throws Error where a view in color is to be shown under a light that has none: nothing that is made for it shows.
void require_light(const DesignView& view, const Bench& bench);

/// Irradiance, R G B, of white paper at the carve area's middle under a light (with what shines beside it).
Eigen::Vector3d paper_light(const Light& light, const Board& board);

/// Factors on the channels that make white of what is to look white (DesignView::white). White paper has with them the
/// luminance that it has in gray, so that views in gray and in color may share an exposure. Throws Error where none of
/// the view's lights has one of the colors, or the white asked for is none (can_be_white).
Eigen::Vector3d white_gains(const DesignView& view, const Board& board, const Bench& bench);

/// Colors (R G B, of any length) of the lights that scratches of a view can throw.
using LampColors = std::vector<Eigen::Vector3d>;

/// The pictures, one a channel, gamma-encoded, whose light comes closest (sum of squares) to that of `target` among
/// those that are sums of the colors, none taken away.
std::vector<Image> nearest_mixed(const std::vector<const Image*>& target, const LampColors& colors);

/// Throws Error for lights of one color alone; warns of a target whose colors they cannot mix, with how near they come.
/// `nearest`: nearest_mixed() of it.
std::vector<Finding> check_colors(const DesignView& view, const LampColors& colors,
                                  const std::vector<const Image*>& target, const Image& mask,
                                  const std::vector<Image>& nearest);

/// Notes a view whose lights differ in color, and whose target is shown in gray all the same.
std::vector<Finding> check_gray(const DesignView& view, const Bench& bench);

}  // namespace burin

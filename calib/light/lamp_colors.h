// burin/calib/light/lamp_colors.h - estimates the lamps' colors (white balance) from the tags' white paper, which is
// the same under all of them. docs/model.md 9, 'Lamp'. Ambient light is gray here; refine also estimates its color,
// from all pixels.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "burin/capture/photo.h"
#include "burin/capture/session.h"
#include "burin/capture/tags/tag_detector.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"

namespace burin {

/// Selection of white paper away from edges among a tag's pixels, two fifths of which are white. `green` takes the
/// brightest fifth by green. `mean`, for lamps without green, takes the middle fifth of the two by the mean of the
/// channels, which noise does not brighten.
enum class WhiteBy { green, mean };

/// R, G, B summed over these pixels. Empty for a view in gray, or a tag of too few pixels. `view` may be binned.
std::optional<Eigen::Vector3d> white_paper(const MergedView& view, const TagDetection& tag, WhiteBy by);

/// The light of each tag's white paper in one merged view, R, G, B over their mean.
std::vector<Eigen::Vector3d> paper_light(const MergedView& view, const TagsInPhoto& tags);

/// Gives each lamp, whose intensity is the same in all channels, its color: the median over the papers seen under it
/// (one entry per bracket). The share of ambient light on paper in the board's middle is removed, and negative channels
/// become 0. The mean of the channels is kept. Lamps without a view in color keep theirs.
void color_lamps(std::span<const Bracket> brackets, std::span<const std::vector<Eigen::Vector3d>> paper,
                 const Board& board, Bench& bench);

}  // namespace burin

// burin/optimize/design/stroke_field.h - one view's pictures while strokes are moved about: their light, what they
// show, and by how much a stroke that comes or goes lowers their squared error. The light of a stroke: stroke_search.h,
// docs/model.md 6.5. Frames: board, mm; pixels of the picture, y down.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "burin/optimize/design/stroke_kernel.h"
#include "burin/optimize/design/stroke_tiles.h"
#include "burin/optimize/design/stroke_types.h"

namespace burin {

/// Pixels as they were before strokes came and went, in the order of the changes.
struct StrokePixelsBefore {
  struct Pixel {
    std::size_t at;
    std::uint32_t place;
    float light, shown;
  };
  std::vector<Pixel> pixels;

  void clear() { pixels.clear(); }
};

/// Squared errors of the pixels of a box that are too dark, row by row.
struct MissingLight {
  static constexpr std::size_t kBlock = 16;
  std::vector<float> of_pixel;  ///< then zeros up to a whole block
  std::vector<double> upto;     ///< running sums, a block of pixels each
  std::size_t pixels = 0;       ///< in the box

  double all() const { return upto.empty() ? 0 : upto.back(); }
  /// The pixel up to which this part of all is missing: pixels drawn evenly over 0..1 are those that miss most.
  std::size_t pixel_at(double part) const;
};

/// Work in boxes that do not overlap may go on at the same time.
class StrokeField {
 public:
  /// `rules` must outlive it. Throws Error for a view with too many asides.
  StrokeField(const StrokeView& view, const StrokeRules& rules);

  /// From now on what one of both changes in a picture that they share (StrokeView::picture) changes in the other. They
  /// must not be worked on at the same time then.
  void share_pictures_with(StrokeField& other);

  /// Whether they show the same picture.
  bool shares_pictures_with(const StrokeField& other) const;

  /// Writes the light back into the view that it was made of.
  void write_light(StrokeView& view) const;

  PixelBox whole() const { return {0, 0, width_, height_}; }
  double pitch_mm() const { return pitch_x_; }
  double longest_px() const { return rules_.longest_mm / pitch_x_; }
  Eigen::Vector2d pixel(const Eigen::Vector2d& p_mm) const {
    return {(p_mm.x() - rules_.min_mm.x()) / pitch_x_, (rules_.max_mm.y() - p_mm.y()) / pitch_y_};
  }
  Eigen::Vector2d board(const Eigen::Vector2d& p) const {
    return {rules_.min_mm.x() + p.x() * pitch_x_, rules_.max_mm.y() - p.y() * pitch_y_};
  }

  const GlintView& glint() const { return glints_.front(); }

  /// h . u / alpha of the view's own place, for a scratch of direction u (of length 1) at p: 0 where it glints best.
  double lobe_place(const Eigen::Vector2d& p_mm, const Eigen::Vector2d& u) const {
    return lobe_place(glints_.front(), p_mm, u);
  }

  /// Adds (times = 1) or takes away (-1) a stroke, as far as it lies in the box; returns by how much the squared error
  /// fell. With `before`, put_back() can undo it.
  double add(const Eigen::Vector2d& a_mm, const Eigen::Vector2d& b_mm, float times, const PixelBox& box,
             StrokePixelsBefore* before = nullptr);
  /// The same of a part of a stroke that no other cuts, whatever crossings take from strokes there on average.
  double add_uncut(const Eigen::Vector2d& a_mm, const Eigen::Vector2d& b_mm, float times, const PixelBox& box,
                   StrokePixelsBefore& before);
  /// Undoes what `before` has seen, but for its first `kept` pixels, and forgets it.
  void put_back(StrokePixelsBefore& before, std::size_t kept = 0);
  /// By how much the error would fall, nothing being changed.
  double fall(const Eigen::Vector2d& a_mm, const Eigen::Vector2d& b_mm, float times) const;

  /// What the picture lacks of light in a box: the squared errors of pixels that are too dark.
  void survey(const PixelBox& box, MissingLight& missing) const;
  /// Their sum.
  double missing_in(const PixelBox& box) const;

  /// A box as the kernel sees it.
  StrokeWindow window(const PixelBox& box) const;

 private:
  static constexpr int kPart = 64, kPacket = 16;

  struct Lobe {
    float start = 0, slope = 0;  // h . u / alpha at s = 0 and its change a pixel
  };
  // Pixels that a stroke crosses, where and how far.
  struct StrokePart {
    int count = 0;
    std::size_t at[kPart];
    float middle[kPart], length[kPart];
  };
  struct PartPixels {
    float light[kPart], unit[kPart], target[kPart], shown[kPart], after[kPart], fall[kPart];
  };

  double lobe_place(const GlintView& glint, const Eigen::Vector2d& p_mm, const Eigen::Vector2d& u) const;
  const std::vector<float>& matters_at(std::size_t place) const {
    return matters_of_.empty() ? matters_ : matters_of_[place];
  }
  std::vector<StrokeHalfVector> listed_half_vectors(const GlintView& glint) const;
  void with_part(const StrokePart& part, std::size_t k, const Lobe& lobe, bool uncut, PartPixels& out) const;
  double change(const StrokePart& part, const Lobe* lobes, bool uncut, StrokePixelsBefore* before);
  double cost_of(const StrokePart& part) const;  // below 0 for a part that is taken away
  void tell_twins(std::size_t k, std::size_t at) const {
    for (StrokePixel* twin : twins_[k]) {
      twin[at].light = pixels_[k][at].light;
      twin[at].shown = pixels_[k][at].shown;
    }
  }
  template <typename Visit>
  void each_part(const Eigen::Vector2d& a_mm, const Eigen::Vector2d& b_mm, float times, const PixelBox& box,
                 const Visit& visit) const;

  const StrokeRules& rules_;
  int width_, height_;
  double pitch_x_, pitch_y_;
  std::vector<GlintView> glints_;  // the view's own first
  std::vector<float> weights_;
  std::vector<std::vector<StrokePixel>> pixels_;
  std::vector<int> pictures_;                     // StrokeView::picture of each place
  std::vector<std::vector<StrokePixel*>> twins_;  // of each place: the same picture's pixels in other fields
  bool has_twins_ = false;
  std::vector<std::vector<StrokeHalfVector>> half_vectors_;  // none where eye and lamp say them
  std::vector<float> cost_;                                  // StrokeView::cost
  std::vector<std::vector<float>> by_kept_;                  // of each place 1 / StrokeView::kept; empty: 1
  std::vector<float> matters_;                               // the mask squared; empty: all alike
  std::vector<std::vector<float>> matters_of_;               // each place's, where a mask is not the view's; else none
};

}  // namespace burin

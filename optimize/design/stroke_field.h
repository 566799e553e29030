// burin/optimize/design/stroke_field.h - one view's pictures during the search: their light, their shown values, and
// the change of their squared error by a stroke. stroke_search.h and docs/model.md 6.5 define a stroke's light. Frames:
// board, mm; pixels of the picture, y down.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "burin/optimize/design/stroke_kernel.h"
#include "burin/optimize/design/stroke_tiles.h"
#include "burin/optimize/design/stroke_types.h"

namespace burin {

/// Pixels before strokes changed them, in the order of the changes.
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
  std::vector<float> of_pixel;  ///< padded with zeros to a whole block
  std::vector<double> upto;     ///< running sums, one per block of pixels
  std::size_t pixels = 0;       ///< in the box

  double all() const { return upto.empty() ? 0 : upto.back(); }
  /// The pixel at which the running sum reaches this part of the total. Parts drawn evenly over 0..1 give pixels in
  /// proportion to their missing light.
  std::size_t pixel_at(double part) const;
};

/// A view's pictures in the search. Threads may work in disjoint boxes at the same time.
class StrokeField {
 public:
  /// `rules` must outlive this object. Throws Error for a view with too many asides.
  StrokeField(const StrokeView& view, const StrokeRules& rules);

  /// Links this field with another: a change of a shared picture (StrokeView::picture) in one then changes the other.
  /// Linked fields must not be changed at the same time.
  void share_pictures_with(StrokeField& other);

  /// Whether both show the same picture.
  bool shares_pictures_with(const StrokeField& other) const;

  /// Writes the light back into the view from which it was made.
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

  /// h . u / alpha of the view's intended position, for a scratch of direction u (of length 1) at p: 0 in its best
  /// direction.
  double lobe_place(const Eigen::Vector2d& p_mm, const Eigen::Vector2d& u) const {
    return lobe_place(glints_.front(), p_mm, u);
  }

  /// Adds (times = 1) or removes (-1) a stroke inside the box; returns the decrease of the squared error. With
  /// `before`, put_back() can undo it.
  double add(const Eigen::Vector2d& a_mm, const Eigen::Vector2d& b_mm, float times, const PixelBox& box,
             StrokePixelsBefore* before = nullptr);
  /// add() for an uncut part of a stroke, independent of the mean loss by crossings there.
  double add_uncut(const Eigen::Vector2d& a_mm, const Eigen::Vector2d& b_mm, float times, const PixelBox& box,
                   StrokePixelsBefore& before);
  /// Undoes all changes in `before` except its first `kept` pixels, and removes them from it.
  void put_back(StrokePixelsBefore& before, std::size_t kept = 0);
  /// The decrease of the error by a stroke, without any change.
  double fall(const Eigen::Vector2d& a_mm, const Eigen::Vector2d& b_mm, float times) const;

  /// Missing light of a box: the squared errors of pixels that are too dark.
  void survey(const PixelBox& box, MissingLight& missing) const;
  /// Their sum.
  double missing_in(const PixelBox& box) const;

  /// A box as the kernel's input.
  StrokeWindow window(const PixelBox& box) const;

 private:
  static constexpr int kPart = 64, kPacket = 16;

  struct Lobe {
    float start = 0, slope = 0;  // h . u / alpha at s = 0, and its change per pixel
  };
  // Pixels that a stroke crosses: index, position along it and length inside.
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
  double cost_of(const StrokePart& part) const;  // negative for a removed part
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
  std::vector<std::vector<StrokePixel*>> twins_;  // for each place: the pixels of the same picture in other fields
  bool has_twins_ = false;
  std::vector<std::vector<StrokeHalfVector>> half_vectors_;  // none if eye and lamp define them
  std::vector<float> cost_;                                  // StrokeView::cost
  std::vector<std::vector<float>> by_kept_;                  // 1 / StrokeView::kept of each place; empty: 1
  std::vector<float> matters_;                               // the mask squared; empty: all equal
  std::vector<std::vector<float>> matters_of_;               // each place's, if a mask is not the view's; else none
};

}  // namespace burin

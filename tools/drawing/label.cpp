#include "tools/drawing/label.h"

#include "tools/drawing/drawing.h"
#include "tools/drawing/pdf.h"

namespace burin {

Image label(const std::string& words, int width_px) {
  constexpr double kSize = 15;  // of the font, pixels
  Drawing drawing;
  drawing.size_mm = {static_cast<double>(width_px), static_cast<double>(kLabelPx)};
  add_rectangle(drawing, {0, 0}, drawing.size_mm, Tint::ink);
  add_words(
      drawing,
      {{2, kLabelPx / 2.0}, shortened(words, kSize, width_px - 4.0), kSize, Tint::white, Anchor::start, false, true});
  return drawn(drawing, 1);
}

}  // namespace burin

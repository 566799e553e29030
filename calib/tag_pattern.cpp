#include "calib/tag_pattern.h"

#include <apriltag/apriltag.h>
#include <apriltag/tag16h5.h>
#include <apriltag/tag25h9.h>
#include <apriltag/tag36h10.h>
#include <apriltag/tag36h11.h>
#include <apriltag/tagCircle21h7.h>
#include <apriltag/tagCircle49h12.h>
#include <apriltag/tagCustom48h12.h>
#include <apriltag/tagStandard41h12.h>
#include <apriltag/tagStandard52h13.h>

#include <cmath>
#include <cstdlib>
#include <memory>

#include "render/error.h"

namespace burin {
namespace {

struct Maker {
  const char* name;
  apriltag_family_t* (*create)();
  void (*destroy)(apriltag_family_t*);
};

constexpr Maker kMakers[] = {
    {"tag16h5", tag16h5_create, tag16h5_destroy},
    {"tag25h9", tag25h9_create, tag25h9_destroy},
    {"tag36h10", tag36h10_create, tag36h10_destroy},
    {"tag36h11", tag36h11_create, tag36h11_destroy},
    {"tagCircle21h7", tagCircle21h7_create, tagCircle21h7_destroy},
    {"tagCircle49h12", tagCircle49h12_create, tagCircle49h12_destroy},
    {"tagCustom48h12", tagCustom48h12_create, tagCustom48h12_destroy},
    {"tagStandard41h12", tagStandard41h12_create, tagStandard41h12_destroy},
    {"tagStandard52h13", tagStandard52h13_create, tagStandard52h13_destroy},
};

}  // namespace

int TagPattern::color_at(double x_cells, double y_cells) const {
  const int column = static_cast<int>(std::floor(x_cells + 0.5 * total_cells));
  const int row = static_cast<int>(std::floor(0.5 * total_cells - y_cells));
  if (column < 0 || row < 0 || column >= total_cells || row >= total_cells) return -1;
  return white[static_cast<std::size_t>(row) * total_cells + column];
}

TagPattern tag_pattern(const std::string& family, int id) {
  for (const Maker& maker : kMakers) {
    if (family != maker.name) continue;
    const std::unique_ptr<apriltag_family_t, void (*)(apriltag_family_t*)> f(maker.create(), maker.destroy);
    if (id < 0 || static_cast<std::uint32_t>(id) >= f->ncodes)
      fail("tags.list", "tag id " + std::to_string(id) + " does not exist in family " + family,
           "give an id from 0 to " + std::to_string(f->ncodes - 1));
    // The library does not export image_u8_destroy: this is what it does.
    const auto release = [](image_u8_t* image) {
      std::free(image->buf);
      std::free(image);
    };
    const std::unique_ptr<image_u8_t, decltype(release)> drawing(apriltag_to_image(f.get(), id), release);
    TagPattern pattern;
    pattern.total_cells = f->total_width;
    pattern.border_cells = f->width_at_border;
    for (int y = 0; y < f->total_width; ++y)
      for (int x = 0; x < f->total_width; ++x)
        pattern.white.push_back(drawing->buf[y * drawing->stride + x] > 127 ? 1 : 0);
    return pattern;
  }
  fail("tags.family", "the tag family \"" + family + "\" is not known",
       "use one of AprilTag's, for example tagStandard41h12 or tag36h11");
}

}  // namespace burin

#include "burin/capture/tags/tag_family.h"

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

#include <array>
#include <cmath>
#include <cstdlib>

#include "burin/base/error.h"

namespace burin {
namespace {

struct FamilyMaker {
  const char* name;
  apriltag_family_t* (*create)();
  void (*destroy)(apriltag_family_t*);
};

constexpr FamilyMaker kFamilies[] = {
    {"tagStandard41h12", tagStandard41h12_create, tagStandard41h12_destroy},
    {"tag36h11", tag36h11_create, tag36h11_destroy},
    {"tag25h9", tag25h9_create, tag25h9_destroy},
    {"tag16h5", tag16h5_create, tag16h5_destroy},
    {"tag36h10", tag36h10_create, tag36h10_destroy},
    {"tagStandard52h13", tagStandard52h13_create, tagStandard52h13_destroy},
    {"tagCircle21h7", tagCircle21h7_create, tagCircle21h7_destroy},
    {"tagCircle49h12", tagCircle49h12_create, tagCircle49h12_destroy},
    {"tagCustom48h12", tagCustom48h12_create, tagCustom48h12_destroy},
};

}  // namespace

std::span<const char* const> tag_families() {
  static constexpr auto names = [] {
    std::array<const char*, std::size(kFamilies)> n{};
    for (std::size_t i = 0; i < n.size(); ++i) n[i] = kFamilies[i].name;
    return n;
  }();
  return names;
}

TagFamily make_tag_family(const std::string& name, const std::string& where) {
  std::string known;
  for (const FamilyMaker& f : kFamilies) {
    if (name == f.name) return {f.create(), f.destroy};
    known += (known.empty() ? "" : ", ") + std::string(f.name);
  }
  fail(where, "\"" + name + "\" is no AprilTag family that Burin knows", "use one of " + known);
}

int TagPattern::color_at(double x_cells, double y_cells) const {
  const int column = static_cast<int>(std::floor(x_cells + 0.5 * total_cells));
  const int row = static_cast<int>(std::floor(0.5 * total_cells - y_cells));
  if (column < 0 || row < 0 || column >= total_cells || row >= total_cells) return -1;
  return white[static_cast<std::size_t>(row) * total_cells + column];
}

TagPattern tag_pattern(const apriltag_family& family, int id, const std::string& where) {
  if (id < 0 || static_cast<std::uint32_t>(id) >= family.ncodes)
    fail(where, std::string(family.name) + " has no tag " + std::to_string(id),
         "give an id from 0 to " + std::to_string(family.ncodes - 1));
  // Debian's library does not export image_u8_destroy; these are its steps.
  const auto release = [](image_u8_t* image) {
    std::free(image->buf);
    std::free(image);
  };
  // AprilTag only reads the family; its function has no const.
  const std::unique_ptr<image_u8_t, decltype(release)> drawing(
      apriltag_to_image(const_cast<apriltag_family*>(&family), static_cast<std::uint32_t>(id)), release);
  TagPattern pattern;
  pattern.total_cells = family.total_width;
  pattern.border_cells = family.width_at_border;
  for (int y = 0; y < family.total_width; ++y)
    for (int x = 0; x < family.total_width; ++x)
      pattern.white.push_back(drawing->buf[y * drawing->stride + x] > 127 ? 1 : 0);
  return pattern;
}

TagPattern tag_pattern(const std::string& family, int id) {
  return tag_pattern(*make_tag_family(family, "tags.family"), id, "tags.list");
}

}  // namespace burin

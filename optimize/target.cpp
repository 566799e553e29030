#include "burin/optimize/target.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "burin/base/degrees.h"
#include "burin/base/error.h"
#include "burin/pictures/linear_picture.h"

namespace burin {
namespace {

// An image in memory as linear light. `name` is its name in errors.
Image linear_picture(const Image& in_memory, const std::string& name) {
  Image picture = in_memory;
  if (picture.height < 1) fail(name, "holds no pixels", "give another picture");
  const std::size_t values =
      static_cast<std::size_t>(picture.width) * picture.height * static_cast<std::size_t>(picture.channels);
  if ((picture.channels != 1 && picture.channels != 3) || picture.data.size() != values)
    fail(name,
         "has " + std::to_string(picture.channels) + " channels and " + std::to_string(picture.data.size()) + " values",
         "give width x height values for one channel or three");
  for (float& v : picture.data) {
    if (!std::isfinite(v)) fail(name, "holds values that are not finite", "repair the picture");
    v = srgb_to_linear(std::clamp(v, 0.0F, 1.0F));
  }
  return picture;
}

// Linear luminance of an image in memory (if it has pixels) or of a file.
Image linear_luminance(const Image& in_memory, const std::filesystem::path& file, const std::string& name) {
  return in_memory.width <= 0 ? read_linear_luminance(file) : luminance(linear_picture(in_memory, name));
}

// Linear red, green and blue of an image in memory or of a file, separately.
std::vector<Image> linear_channels(const Image& in_memory, const std::filesystem::path& file, const std::string& name) {
  const Image picture = in_memory.width <= 0 ? read_linear_picture(file) : linear_picture(in_memory, name);
  std::vector<Image> out(3, Image(picture.width, picture.height, 1));
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < out[c].data.size(); ++i)
      out[c].data[i] = picture.channels == 3 ? picture.data[3 * i + c] : picture.data[i];
  return out;
}

std::string name_of(const TargetSpec& spec) {
  if (spec.image.width == 0) return spec.picture.string();
  return spec.picture.empty() ? "the target in memory" : spec.picture.string() + " (in memory)";
}

// Bilinear interpolation, clamped at the picture's edge, `outside` beyond half a pixel from it.
float sample(const Image& image, double x, double y, float outside) {
  if (x < -0.5 || y < -0.5 || x > image.width - 0.5 || y > image.height - 0.5) return outside;
  x = std::clamp(x, 0.0, image.width - 1.0);
  y = std::clamp(y, 0.0, image.height - 1.0);
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const int x1 = std::min(x0 + 1, image.width - 1), y1 = std::min(y0 + 1, image.height - 1);
  const auto fx = static_cast<float>(x - x0), fy = static_cast<float>(y - y0);
  return (1 - fy) * ((1 - fx) * image.at(x0, y0) + fx * image.at(x1, y0)) +
         fy * ((1 - fx) * image.at(x0, y1) + fx * image.at(x1, y1));
}

// A linear picture on the area's grid. `scale_used`: grid pixels per picture pixel.
Image lay_on_area(const Image& picture, double rotation_deg, const TargetSpec& spec, const Eigen::Vector2d& area_mm,
                  int width, int height, float outside, double& scale_used) {
  const double c = std::cos(rotation_deg * kDegree_rad), s = std::sin(rotation_deg * kDegree_rad);
  const LaidPicture laid =
      laid_picture(picture.width, picture.height, spec.fit, spec.keep.value_or(Keep::middle), rotation_deg, area_mm);
  const double mm = laid.mm_per_px;
  const double grid_mm = area_mm.x() / width;
  scale_used = mm / grid_mm;
  // If the picture is finer than the grid, area averaging comes first to avoid aliasing.
  Image fine;
  const Image* source = &picture;
  double shrink_x = 1, shrink_y = 1;
  if (scale_used < 1) {
    const int w = std::max(1, static_cast<int>(std::lround(picture.width * scale_used)));
    const int h = std::max(1, static_cast<int>(std::lround(picture.height * scale_used)));
    if (w != picture.width || h != picture.height) {
      fine = resized(picture, w, h);
      source = &fine;
      shrink_x = static_cast<double>(w) / picture.width;
      shrink_y = static_cast<double>(h) / picture.height;
    }
  }
  Image out(width, height, 1);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double bx = ((x + 0.5) / width - 0.5) * area_mm.x(), by = (0.5 - (y + 0.5) / height) * area_mm.y();
      const double px = (c * bx + s * by) / mm, py = -(-s * bx + c * by) / mm;  // picture pixels from laid.center_px
      out.at(x, y) = sample(*source, (px + laid.center_px.x()) * shrink_x - 0.5,
                            (py + laid.center_px.y()) * shrink_y - 0.5, outside);
    }
  return out;
}

// The part of a picture outside of the carve area, in words; empty if it is negligible.
std::string cropped(const Image& picture, const TargetSpec& spec, double rotation_deg, const Eigen::Vector2d& area_mm) {
  if (spec.fit != Fit::cover || spec.keep) return "";
  const double c = std::abs(std::cos(rotation_deg * kDegree_rad)), s = std::abs(std::sin(rotation_deg * kDegree_rad));
  const LaidPicture laid =
      laid_picture(picture.width, picture.height, spec.fit, spec.keep.value_or(Keep::middle), rotation_deg, area_mm);
  const double width_lost = laid.width_lost, height_lost = laid.height_lost;
  const double lost = std::max(width_lost, height_lost);
  constexpr double kHardly = 0.02;
  if (lost < kHardly) return "";
  const bool upright = std::min(c, s) < 1e-6;
  const auto percent = [](double share) { return std::to_string(static_cast<int>(std::lround(100 * share))) + " %"; };
  return percent(lost) + " of its " + (width_lost > height_lost ? "width" : "height") +
         " are cropped, half on either side, " + (upright ? "" : "and its corners, ") +
         "since the carve area has another shape (\"keep\": \"top\" and the like choose the part that stays, \"fit\": "
         "\"contain\" "
         "shows all of it)";
}

}  // namespace

LaidPicture laid_picture(int width, int height, Fit fit, Keep keep, double rotation_deg,
                         const Eigen::Vector2d& area_mm) {
  const double c = std::abs(std::cos(rotation_deg * kDegree_rad)), s = std::abs(std::sin(rotation_deg * kDegree_rad));
  // The turned area's bounding box in the picture's axes determines the size, in mm per picture pixel.
  const double box_x = c * area_mm.x() + s * area_mm.y(), box_y = s * area_mm.x() + c * area_mm.y();
  // "contain" needs the turned picture inside the area: the same with the roles exchanged.
  const double turned_w = c * width + s * height, turned_h = s * width + c * height;
  LaidPicture laid;
  laid.center_px = {width / 2.0, height / 2.0};
  laid.mm_per_px = fit == Fit::cover ? std::max(box_x / width, box_y / height)
                                     : std::min(area_mm.x() / turned_w, area_mm.y() / turned_h);
  if (fit != Fit::cover) return laid;
  const double seen_w = box_x / laid.mm_per_px, seen_h = box_y / laid.mm_per_px;
  laid.width_lost = std::max(0.0, 1 - seen_w / width);
  laid.height_lost = std::max(0.0, 1 - seen_h / height);
  if (keep == Keep::left) laid.center_px.x() = seen_w / 2;
  if (keep == Keep::right) laid.center_px.x() = width - seen_w / 2;
  if (keep == Keep::top) laid.center_px.y() = seen_h / 2;
  if (keep == Keep::bottom) laid.center_px.y() = height - seen_h / 2;
  return laid;
}

namespace {

// The channels of a linear picture on the area. The first target holds the findings and the mask.
std::vector<Target> laid_targets(const std::vector<Image>& channels, const TargetSpec& spec, double rotation_deg,
                                 const Eigen::Vector2d& area_mm, int width, int height) {
  constexpr double kDark = 0.08, kWhite = 0.85, kHardlyAny = 0.01;  // tones as shown, then a share of the pixels
  constexpr float kBright = 0.4F;
  const std::string where = name_of(spec);
  std::vector<Target> all(channels.size());
  Target& target = all.front();
  double scale = 1;
  const Image& picture = channels.front();
  for (std::size_t c = 0; c < all.size(); ++c)
    all[c].picture = lay_on_area(channels[c], rotation_deg, spec, area_mm, width, height, 0.0F, scale);
  const auto warn = [&](std::string what, std::string remedy) {
    target.findings.push_back(
        {FindingCode::picture, Finding::Severity::warning, where, std::move(what), std::move(remedy)});
  };
  if (std::string lost = cropped(picture, spec, rotation_deg, area_mm); !lost.empty()) warn(std::move(lost), "");
  if (scale > 4)
    warn("one of its pixels covers " + std::to_string(static_cast<int>(scale)) + " of the design's",
         "give a larger picture");
  float most = 0;  // largest contrast of a channel
  double mean = 0, bright = 0;
  for (Target& one : all) {
    float low = 1, high = 0;
    for (float& v : one.picture.data) {
      v = std::pow(std::clamp(v, 0.0F, 1.0F), 1 / 2.2F);
      if (spec.levels)
        v = static_cast<float>(std::clamp((v - (*spec.levels)[0]) / ((*spec.levels)[1] - (*spec.levels)[0]), 0.0, 1.0));
      low = std::min(low, v);
      high = std::max(high, v);
      mean += v;
      bright += v > kBright ? 1 : 0;
    }
    most = std::max(most, high - low);
  }
  mean /= static_cast<double>(target.picture.data.size() * all.size());
  bright /= static_cast<double>(target.picture.data.size() * all.size());
  if (most < 0.02F && !spec.may_be_even)
    fail(where, "is of one tone on the carve area, so there is nothing to show",
         "choose another picture, crop or \"levels\"");
  // White letters on black are few and show best of all; a dark photo has nothing bright.
  if (mean < kDark && bright < kHardlyAny && !spec.may_be_even)
    warn("is nearly black", "the plain face will outshine it (\"levels\" can lift it)");
  if (mean > kWhite && !spec.may_be_even)
    warn("is nearly white: almost all of the board would shine, and its dark parts hardly show",
         "shapes should be lighter than their ground: invert the picture, or choose another");
  if (!spec.mask.empty() || spec.mask_image.width > 0) {
    const std::string mask = spec.mask_image.width > 0 ? "the mask in memory of " + where : spec.mask.string();
    double unused = 1;
    target.mask = lay_on_area(linear_luminance(spec.mask_image, spec.mask, mask), rotation_deg, spec, area_mm, width,
                              height, 0.0F, unused);
    double weight = 0;
    for (float& v : target.mask.data) {
      v = std::clamp(v, 0.0F, 1.0F);
      weight += v;
    }
    if (weight < 1) fail(mask, "masks everything", "paint white what matters");
  }
  for (std::size_t c = 1; c < all.size(); ++c) all[c].mask = target.mask;
  return all;
}

}  // namespace

Target load_target(const TargetSpec& spec, double rotation_deg, const Eigen::Vector2d& area_mm, int width, int height) {
  return std::move(laid_targets({linear_luminance(spec.image, spec.picture, name_of(spec))}, spec, rotation_deg,
                                area_mm, width, height)
                       .front());
}

std::vector<Target> load_color_target(const TargetSpec& spec, double rotation_deg, const Eigen::Vector2d& area_mm,
                                      int width, int height) {
  return laid_targets(linear_channels(spec.image, spec.picture, name_of(spec)), spec, rotation_deg, area_mm, width,
                      height);
}

double viewer_rotation_deg(const View& view, const Eigen::Vector2d& p_board_mm) {
  const Eigen::Matrix3d R = view.T_camera_board.linear();
  const Eigen::Vector3d p = view.T_camera_board * Eigen::Vector3d(p_board_mm.x(), p_board_mm.y(), 0);
  // u = x / z, v = y / z: the board direction that moves straight up in the photo (u stays, v falls).
  Eigen::Matrix2d duv_dxy;
  for (int axis = 0; axis < 2; ++axis) {
    duv_dxy(0, axis) = R(0, axis) * p.z() - p.x() * R(2, axis);
    duv_dxy(1, axis) = R(1, axis) * p.z() - p.y() * R(2, axis);
  }
  const double side = duv_dxy.determinant() * (p.z() > 0 ? 1 : -1);
  if (!(std::abs(side) > 1e-9 * p.squaredNorm()))
    fail("view " + view.name, "looks along the board's face", "move the camera above the board");
  const Eigen::Vector2d up = duv_dxy.inverse() * Eigen::Vector2d(0, -1);
  return std::atan2(-up.x(), up.y()) / kDegree_rad;
}

Image within_contrast(const Image& target, const Image& floor) {
  if (floor.data.size() != target.data.size()) fail("within_contrast", "sizes differ", "give a floor a pixel");
  Image out = target;
  for (std::size_t i = 0; i < out.data.size(); ++i) {
    const float light = std::pow(target.data[i], 2.2F), dark = std::clamp(floor.data[i], 0.0F, 1.0F);
    out.data[i] = std::pow(std::max(light, dark), 1 / 2.2F);
  }
  return out;
}

}  // namespace burin

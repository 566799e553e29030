#include "burin/calib/light/light_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "burin/base/error.h"
#include "burin/base/median.h"
#include "burin/capture/tags/tag_family.h"
#include "burin/render/pixel_shading.h"
#include "burin/render/surroundings/seen_sources.h"
#include "burin/render/view_renderer.h"
#include "burin/scene/board_face.h"
#include "burin/scene/far_light.h"
#include "burin/scene/groove.h"
#include "burin/scene/keep_out.h"

namespace burin {
namespace {

const std::vector<Tag>& tags_of(const Board& board, const Bench& bench) {
  return bench.tags.empty() ? board.tags.list : bench.tags;
}

// Largest size of a pixel on the board, mm: it converts distances in pixels to board distances.
double pixel_size_mm(const FootprintGrid& grid, int x, int y) {
  const std::size_t row = static_cast<std::size_t>(grid.width()) + 1;
  const std::size_t c = y * row + x;
  const double ux = grid.corner_x_mm[c + 1] - grid.corner_x_mm[c], uy = grid.corner_y_mm[c + 1] - grid.corner_y_mm[c];
  const double vx = grid.corner_x_mm[c + row] - grid.corner_x_mm[c],
               vy = grid.corner_y_mm[c + row] - grid.corner_y_mm[c];
  return std::max(std::hypot(ux, uy), std::hypot(vx, vy));
}

struct PlacedTag {
  Tag tag;
  TagPattern pattern;
  double cell_mm = 0;
  double cos_rotation = 1, sin_rotation = 0;

  Eigen::Vector2d in_cells(double x_mm, double y_mm) const {
    const double dx = x_mm - tag.center_mm.x(), dy = y_mm - tag.center_mm.y();
    return Eigen::Vector2d(cos_rotation * dx + sin_rotation * dy, -sin_rotation * dx + cos_rotation * dy) / cell_mm;
  }
};

std::vector<PlacedTag> place_tags(const Board& board, const Bench& bench) {
  std::vector<PlacedTag> placed;
  for (const Tag& tag : tags_of(board, bench)) {
    PlacedTag p;
    p.tag = tag;
    p.pattern = tag_pattern(board.tags.family, tag.id);
    p.cell_mm = tag.size_mm / p.pattern.border_cells;
    p.cos_rotation = std::cos(tag.rotation_deg * std::numbers::pi / 180);
    p.sin_rotation = std::sin(tag.rotation_deg * std::numbers::pi / 180);
    placed.push_back(std::move(p));
  }
  return placed;
}

// Color of the paper if it is the same within `margin_cells` around a point of the tag, else -1.
int uniform_color(const TagPattern& pattern, const Eigen::Vector2d& at_cells, double margin_cells) {
  const int color = pattern.color_at(at_cells.x(), at_cells.y());
  if (color < 0) return -1;
  for (int j = -2; j <= 2; ++j)
    for (int i = -2; i <= 2; ++i)
      if (pattern.color_at(at_cells.x() + 0.5 * i * margin_cells, at_cells.y() + 0.5 * j * margin_cells) != color)
        return -1;
  return color;
}

struct PaperPixels {
  std::vector<double> values;
  double variance_sum = 0, radius2 = 0;
  Eigen::Vector3d p{0, 0, 0};
  Eigen::Vector2d flat{0, 0};
  int lost = 0;  // clipped
};

// Makes a sample from the pixels of one color of one tag: their median, robust to dust and a lifted corner.
bool finish_paper(PaperPixels& pixels, const Surface& surface, LightSample& sample) {
  constexpr int kFewest = 6;
  const int count = static_cast<int>(pixels.values.size());
  if (count < kFewest || pixels.lost > count / 4) return false;
  sample.p_board = pixels.p / count;
  sample.normal = face_normal(surface, pixels.flat.x() / count, pixels.flat.y() / count);
  sample.radius2 = pixels.radius2 / count;
  sample.value = median_of(pixels.values);
  std::vector<double> deviations;
  for (const double v : pixels.values) deviations.push_back(std::abs(v - sample.value));
  // The larger of the photo's predicted noise and the observed scatter; a median costs a factor sqrt(pi / 2).
  const double scatter = std::max(1.4826 * median_of(deviations), std::sqrt(pixels.variance_sum / count));
  sample.sigma = 1.2533 * scatter / std::sqrt(static_cast<double>(count));
  return true;
}

// Lights of a photo, as indices into bench.lights.
struct PhotoLights {
  std::size_t lamp = 0;
  std::optional<std::size_t> surroundings;
};

// Finds the lights by the name of a photo's light. Appends missing lamps.
PhotoLights lights_of(const std::string& joined, Bench& bench, std::vector<Finding>& findings) {
  const auto refuse = [&] {
    fail("photos under \"" + joined + "\"",
         "show the board under the sun or several lights, and a bench is measured under one near lamp, alone or with "
         "surroundings that bench.json names",
         "take photos under a lamp of its own, and leave these out of session.json");
  };
  PhotoLights out;
  bool has_lamp = false;
  for (const std::string& name : light_names(joined)) {
    const auto found =
        std::find_if(bench.lights.begin(), bench.lights.end(), [&](const Light& l) { return l.id == name; });
    const auto at = static_cast<std::size_t>(found - bench.lights.begin());
    if (found == bench.lights.end() && has_lamp) {
      std::string what = "photos under \"";
      what.append(joined).append("\": bench.json has no light called ").append(name);
      const Finding told = make_warning(
          FindingCode::value_assumed, what.append(", so what comes from around is taken as even"),
          "put the surroundings that `burin probe` made of the room into bench.json's \"lights\" under that name");
      if (std::none_of(findings.begin(), findings.end(), [&](const Finding& f) { return f.what == told.what; }))
        findings.push_back(told);
    } else if (found != bench.lights.end() && !found->is_near()) {
      if (found->far->is_sun() || out.surroundings) refuse();
      out.surroundings = at;
    } else {
      if (has_lamp) refuse();
      has_lamp = true;
      out.lamp = at;
      if (found == bench.lights.end()) {
        Light added;
        added.id = name;
        bench.lights.push_back(added);
      }
    }
  }
  if (!has_lamp) refuse();
  return out;
}

// The scale of surroundings is one number, and a room is either dark or not.
void require_one_room(std::span<const LightView> views, std::span<const MergedView> merged, const Bench& bench) {
  for (const LightView& v : views) {
    if (v.surroundings == views.front().surroundings) continue;
    const bool here = v.surroundings.has_value();
    const MergedView &with = merged[here ? v.merged : views.front().merged],
                     &other = merged[here ? views.front().merged : v.merged];
    fail("photos under \"" + with.light + "\"",
         "show " + bench.lights[here ? *v.surroundings : *views.front().surroundings].id + ", and view " + other.view +
             " under \"" + other.light + "\" does not",
         "measure from photos that were all taken in one room's light, or all in the dark: leave the others out of "
         "session.json");
  }
}

// A merged photo's part of a window of the whole photo.
PixelWindow held_window(const MergedView& photo, const PixelWindow& window) {
  const int x0 = std::max(window.x0, photo.x0), y0 = std::max(window.y0, photo.y0);
  const int x1 = std::min(window.x0 + window.width, photo.x0 + photo.value.width),
            y1 = std::min(window.y0 + window.height, photo.y0 + photo.value.height);
  return {x0, y0, std::max(0, x1 - x0), std::max(0, y1 - y0)};
}

// The view's own lens, in pixels that are bin x bin of the photo's.
void set_lens(const Bench& bench, int bin, LightView& out) {
  const Lens of_all = binned_lens(bench.lens, bin);
  OwnLens own = bench.views[out.view].own_lens.value_or(OwnLens{});
  own.shift_px /= bin;
  out.lens = with_own(of_all, own);
  out.focal_ratio = own.focal_ratio;
  const Eigen::Vector2d center(of_all.intrinsics[2], of_all.intrinsics[3]);
  out.ray_shift_px = (1 - own.focal_ratio) * center + own.shift_px;
}

// The window of the lens of all views that corresponds to the view's window.
PixelWindow window_of_all(const LightView& v) {
  if (v.focal_ratio == 1 && v.ray_shift_px.isZero(0)) return v.window;
  const Eigen::Vector2d first = (Eigen::Vector2d(v.window.x0, v.window.y0) - v.ray_shift_px) / v.focal_ratio,
                        size = Eigen::Vector2d(v.window.width, v.window.height) / v.focal_ratio;
  constexpr int kAround = 1;
  const int x0 = static_cast<int>(std::floor(first.x())) - kAround,
            y0 = static_cast<int>(std::floor(first.y())) - kAround;
  return {x0, y0, static_cast<int>(std::ceil(first.x() + size.x())) + kAround - x0,
          static_cast<int>(std::ceil(first.y() + size.y())) + kAround - y0};
}

void share_rays(std::span<LightView> views) {
  for (LightView& v : views) v.rays = nullptr;
  // Views of one size share their lens.
  for (std::size_t first = 0; first < views.size(); ++first) {
    if (views[first].rays != nullptr) continue;
    Lens lens = views[first].lens;  // of all views
    for (std::size_t i = 0; i < 2; ++i) {
      lens.intrinsics[i] /= views[first].focal_ratio;
      lens.intrinsics[2 + i] =
          (lens.intrinsics[2 + i] - views[first].ray_shift_px[static_cast<Eigen::Index>(i)]) / views[first].focal_ratio;
    }
    const auto same = [&](const LightView& v) { return v.lens.width == lens.width && v.lens.height == lens.height; };
    int x0 = lens.width, y0 = lens.height, x1 = 0, y1 = 0;
    for (const LightView& v : views) {
      if (!same(v)) continue;
      const PixelWindow window = window_of_all(v);
      x0 = std::min(x0, window.x0);
      y0 = std::min(y0, window.y0);
      x1 = std::max(x1, window.x0 + window.width);
      y1 = std::max(y1, window.y0 + window.height);
    }
    const auto rays = std::make_shared<const CornerRays>(corner_rays(lens, {x0, y0, x1 - x0, y1 - y0}));
    for (LightView& v : views)
      if (same(v)) v.rays = rays;
  }
}

}  // namespace

PixelWindow board_window(const Board& board, const Bench& bench, const View& view, int bin, int margin_px) {
  return window_of(binned_lens(lens_of(bench, view), bin), view.T_camera_board, surface_of(board, bench),
                   Eigen::Vector2d::Zero(), board.size_mm, margin_px);
}

std::vector<LightView> make_light_views(std::span<const MergedView> merged, const Board& board, Bench& bench,
                                        std::vector<Finding>& findings) {
  std::vector<LightView> views;
  for (std::size_t m = 0; m < merged.size(); ++m) {
    const MergedView& photo = merged[m];
    const auto view =
        std::find_if(bench.views.begin(), bench.views.end(), [&](const View& v) { return v.name == photo.view; });
    if (view == bench.views.end()) {
      findings.push_back(
          make_warning(FindingCode::photo_omitted, "view " + photo.view + " has no camera pose and is left out"));
      continue;
    }
    const PhotoLights lights = lights_of(photo.light, bench, findings);
    LightView v;
    v.merged = m;
    v.view = static_cast<std::size_t>(view - bench.views.begin());
    v.light = lights.lamp;
    v.surroundings = lights.surroundings;
    set_lens(bench, photo.bin, v);
    constexpr int kMarginPx = 4;
    v.window = held_window(photo, board_window(board, bench, *view, photo.bin, kMarginPx));
    if (v.window.width < 16 || v.window.height < 16) {
      findings.push_back(
          make_warning(FindingCode::photo_omitted, "view " + photo.view + " does not show the board and is left out"));
      continue;
    }
    v.value = Image(v.window.width, v.window.height, 1);
    v.sigma = Image(v.window.width, v.window.height, 1);
    v.valid.assign(v.value.data.size(), 0);
    const int channels = photo.value.channels;
    for (int y = 0; y < v.window.height; ++y)
      for (int x = 0; x < v.window.width; ++x) {
        const int px = x + v.window.x0 - photo.x0, py = y + v.window.y0 - photo.y0;
        double value = 0, variance = 0;
        for (int c = 0; c < channels; ++c) {
          value += photo.value.at(px, py, c);
          variance += static_cast<double>(photo.sigma.at(px, py, c)) * photo.sigma.at(px, py, c);
        }
        v.value.at(x, y) = static_cast<float>(value / channels);
        v.sigma.at(x, y) = static_cast<float>(std::sqrt(variance) / channels);
        v.valid[static_cast<std::size_t>(y) * v.window.width + x] =
            photo.valid[static_cast<std::size_t>(py) * photo.value.width + px] && variance > 0 && std::isfinite(value);
      }
    views.push_back(std::move(v));
  }
  require_one_room(views, merged, bench);
  share_rays(views);
  return views;
}

void take_lenses(const Bench& bench, int bin, std::span<LightView> views) {
  for (LightView& view : views) set_lens(bench, bin, view);
  share_rays(views);
}

FootprintGrid grid_of(const LightView& view, const Eigen::Isometry3d& T_camera_board, const Surface& surface) {
  // A lens without distortion costs nothing. Its grid is a homography, which the renderer can use.
  if (view.rays == nullptr || view.rays->undistorted)
    return camera_grid(view.lens, T_camera_board, surface, view.window);
  const CornerRays& all = *view.rays;
  CornerRays rays;
  rays.window = view.window;
  const std::size_t row = static_cast<std::size_t>(all.window.width) + 1;
  rays.slope.reserve((static_cast<std::size_t>(view.window.width) + 1) * (view.window.height + 1));
  if (view.focal_ratio != 1 || !view.ray_shift_px.isZero(0)) {
    // Interpolates between four rays of the lens of all views: a derivative varies by less than 1e-9 of itself over a
    // pixel.
    for (int r = 0; r <= view.window.height; ++r)
      for (int c = 0; c <= view.window.width; ++c) {
        const Eigen::Vector2d corner((c + view.window.x0) * view.bin - 0.5, (r + view.window.y0) * view.bin - 0.5);
        const Eigen::Vector2d at = ((corner - view.ray_shift_px) / view.focal_ratio).array() + 0.5;
        const double x = at.x() - all.window.x0, y = at.y() - all.window.y0;
        const auto i = static_cast<std::size_t>(std::clamp(x, 0.0, all.window.width - 1.0)),
                   j = static_cast<std::size_t>(std::clamp(y, 0.0, all.window.height - 1.0));
        const double u = x - static_cast<double>(i), v = y - static_cast<double>(j);
        const Eigen::Vector2d* const above = all.slope.data() + j * row + i;
        rays.slope.push_back((1 - v) * ((1 - u) * above[0] + u * above[1]) +
                             v * ((1 - u) * above[row] + u * above[row + 1]));
      }
    return camera_grid(rays, T_camera_board, surface);
  }
  for (int r = 0; r <= view.window.height; ++r)
    for (int c = 0; c <= view.window.width; ++c) {
      const int x = (c + view.window.x0) * view.bin - all.window.x0,
                y = (r + view.window.y0) * view.bin - all.window.y0;
      rays.slope.push_back(all.slope.at(static_cast<std::size_t>(y) * row + x));
    }
  return camera_grid(rays, T_camera_board, surface);
}

Lens binned_lens(const Lens& lens, int bin) {
  Lens out = lens;
  // Focal lengths and center, with pixel (0, 0) at the center of the top-left pixel; distortion does not involve
  // pixels.
  for (int i = 0; i < 4; ++i) out.intrinsics[i] = lens.intrinsics[i] / bin;
  for (int i = 2; i < 4; ++i) out.intrinsics[i] += 0.5 / bin - 0.5;
  out.width = lens.width / bin;
  out.height = lens.height / bin;
  return out;
}

int light_bin(int width, int height, double tag_side_px) {
  constexpr double kEnough_px = 4e6, kSmallTag_px = 30;
  const double by_size = std::sqrt(1.0 * width * height / kEnough_px), by_tags = tag_side_px / kSmallTag_px;
  return std::max(1, static_cast<int>(std::floor(std::min(by_size, by_tags))));
}

LightView binned(const LightView& view, int bin) {
  if (bin <= 1) return view;
  LightView out;
  out.merged = view.merged;
  out.view = view.view;
  out.light = view.light;
  out.surroundings = view.surroundings;
  out.bin = view.bin * bin;
  out.rays = view.rays;
  out.lens = binned_lens(view.lens, bin);
  out.focal_ratio = view.focal_ratio;
  out.ray_shift_px = view.ray_shift_px;
  // Binned pixels start at multiples of `bin` of the whole photo, so that all of a photo's windows share one grid.
  const int x0 = (view.window.x0 + bin - 1) / bin, y0 = (view.window.y0 + bin - 1) / bin;
  const int x1 = (view.window.x0 + view.window.width) / bin, y1 = (view.window.y0 + view.window.height) / bin;
  out.window = {x0, y0, std::max(0, x1 - x0), std::max(0, y1 - y0)};
  out.value = Image(out.window.width, out.window.height, 1);
  out.sigma = Image(out.window.width, out.window.height, 1);
  out.valid.assign(out.value.data.size(), 0);
  if (!view.scattered.data.empty()) out.scattered = Image(out.window.width, out.window.height, 1);
  for (int y = 0; y < out.window.height; ++y)
    for (int x = 0; x < out.window.width; ++x) {
      double value = 0, variance = 0, scattered = 0;
      bool valid = true;
      for (int j = 0; j < bin; ++j)
        for (int i = 0; i < bin; ++i) {
          const int px = (x + x0) * bin + i - view.window.x0, py = (y + y0) * bin + j - view.window.y0;
          value += view.value.at(px, py);
          if (!view.scattered.data.empty()) scattered += view.scattered.at(px, py);
          variance += static_cast<double>(view.sigma.at(px, py)) * view.sigma.at(px, py);
          valid = valid && view.valid[static_cast<std::size_t>(py) * view.window.width + px];
        }
      out.value.at(x, y) = static_cast<float>(value / (bin * bin));
      if (!out.scattered.data.empty()) out.scattered.at(x, y) = static_cast<float>(scattered / (bin * bin));
      out.sigma.at(x, y) = static_cast<float>(std::sqrt(variance) / (bin * bin));
      out.valid[static_cast<std::size_t>(y) * out.window.width + x] = valid;
    }
  return out;
}

bool BoardMask::is_free(double x_mm, double y_mm) const {
  const int column = static_cast<int>(std::floor(x_mm / cell_mm)), row = static_cast<int>(std::floor(y_mm / cell_mm));
  if (column < 0 || row < 0 || column >= width || row >= height) return false;
  return free[static_cast<std::size_t>(row) * width + column] != 0;
}

BoardMask metal_mask(const Board& board, const Bench& bench, double margin_mm) {
  BoardMask mask;
  constexpr double kMostCells = 16e6;  // a board of a meter; larger ones in coarser cells
  mask.cell_mm = std::max(mask.cell_mm, std::sqrt(board.size_mm.prod() / kMostCells));
  mask.width = static_cast<int>(std::ceil(board.size_mm.x() / mask.cell_mm));
  mask.height = static_cast<int>(std::ceil(board.size_mm.y() / mask.cell_mm));
  mask.free.assign(static_cast<std::size_t>(mask.width) * mask.height, 0);
  const std::vector<PlacedTag> tags = place_tags(board, bench);
  for (int row = 0; row < mask.height; ++row)
    for (int column = 0; column < mask.width; ++column) {
      const double x = (column + 0.5) * mask.cell_mm, y = (row + 0.5) * mask.cell_mm;
      bool free =
          x > margin_mm && y > margin_mm && x < board.size_mm.x() - margin_mm && y < board.size_mm.y() - margin_mm;
      for (const PlacedTag& tag : tags) {
        if (!free) break;
        const Eigen::Vector2d at = tag.in_cells(x, y);
        const double half_cells = 0.5 * tag.pattern.total_cells + margin_mm / tag.cell_mm;
        free = std::abs(at.x()) > half_cells || std::abs(at.y()) > half_cells;
      }
      for (const KeepOut& place : board.keep_out) free = free && distance_mm({x, y}, place) > margin_mm;
      mask.free[static_cast<std::size_t>(row) * mask.width + column] = free;
    }
  return mask;
}

namespace {

// Paper needs the light of a whole hemisphere: sources a degree apart give the result of a panorama's pixels.
constexpr double kPaperFine_rad = 0.01;

// One view during sampling.
struct SampledView {
  const LightView& view;
  std::size_t index;
  const Board& board;
  const LightSampleOptions& options;
  Surface surface;
  FootprintGrid grid;
  Eigen::Vector3d camera;
  const Light* surroundings;    // or null
  const LightSources& sources;  // of these
  Image around_face;            // reflection of these by the plain face / F0, with the prior's roughness

  double around_paper(const Eigen::Vector3d& normal) const {
    if (surroundings == nullptr) return 1;
    return irradiance(sources, normal).cwiseProduct(surroundings->intensity).mean() / std::numbers::pi;
  }
  int width() const { return view.window.width; }
  int height() const { return view.window.height; }
  double radius2_at(double x, double y) const {
    return vignette_radius2(view.lens.width, view.lens.height, x + view.window.x0, y + view.window.y0);
  }
  LightSample start(SampleKind kind) const {
    LightSample sample;
    sample.kind = kind;
    sample.light_view = index;
    sample.light = view.light;
    return sample;
  }
};

// Mask of plain face only, without paper, edges and a wide strip around every designed scratch.
BoardMask plain_face(const SampledView& v, const Bench& bench, const Scratches& carved) {
  const double pixel_mm = pixel_size_mm(v.grid, v.width() / 2, v.height() / 2);
  BoardMask plain = metal_mask(v.board, bench, 1 + v.options.edge_margin_px * pixel_mm);
  cv::Mat plain_image(plain.height, plain.width, CV_8U, plain.free.data());
  const double half_strip_mm = v.options.scratch_margin_mm + v.options.edge_margin_px * pixel_mm +
                               1e-3 * half_width_um(v.board.tool_width_um, v.board.material.depth_um);
  constexpr int kFraction = 4;  // bits of sub-cell positions
  const auto cell = [&](double mm) {
    return static_cast<int>(std::lround((mm / plain.cell_mm - 0.5) * (1 << kFraction)));
  };
  for (std::size_t i = 0; i < carved.size(); ++i)
    cv::line(plain_image, {cell(carved.x0_mm[i]), cell(carved.y0_mm[i])},
             {cell(carved.x1_mm[i]), cell(carved.y1_mm[i])}, cv::Scalar(0),
             static_cast<int>(std::ceil(2 * half_strip_mm / plain.cell_mm)), cv::LINE_8, kFraction);
  return plain;
}

// Blocks of `block` x `block` pixels of the plain face.
std::vector<LightSample> face_blocks(const SampledView& v, const BoardMask& plain, int block) {
  std::vector<LightSample> face;
  std::vector<double> values;
  for (int y0 = 0; y0 + block <= v.height(); y0 += block)
    for (int x0 = 0; x0 + block <= v.width(); x0 += block) {
      values.clear();
      double variance = 0, radius2 = 0, around = 0;
      Eigen::Vector3d p = Eigen::Vector3d::Zero();
      Eigen::Vector2d flat = Eigen::Vector2d::Zero();
      for (int y = y0; y < y0 + block; ++y)
        for (int x = x0; x < x0 + block; ++x) {
          const std::size_t i = static_cast<std::size_t>(y) * v.width() + x;
          const Eigen::Vector3d& q = v.grid.center_mm[i];
          const Eigen::Vector2d at = footprint_middle_mm(v.grid, i);
          if (!v.view.valid[i] || !std::isfinite(q.x()) || !plain.is_free(at.x(), at.y())) continue;
          values.push_back(v.view.value.data[i]);
          variance += static_cast<double>(v.view.sigma.data[i]) * v.view.sigma.data[i];
          radius2 += v.radius2_at(x, y);
          around += v.surroundings != nullptr ? v.around_face.data[i] : 1;
          p += q;
          flat += at;
        }
      const int count = static_cast<int>(values.size());
      // An incomplete block would bias the median towards one side.
      if (count < block * block) continue;
      LightSample sample = v.start(SampleKind::face);
      sample.p_board = p / count;
      sample.normal = face_normal(v.surface, flat.x() / count, flat.y() / count);
      sample.radius2 = radius2 / count;
      sample.around = around / count;
      sample.value = median_in_place(values);
      sample.sigma = 1.2533 * std::sqrt(variance) / count;
      sample.to_camera = (v.camera - sample.p_board).normalized();
      face.push_back(sample);
    }
  return face;
}

// Blocks of the plain face, up to the limit of a view. In coarse photos of dense grooves, hardly any large block is
// free of them. Without any, the face has no information on the lamp, or on a brushed face. A few small blocks suffice.
void add_face_samples(const SampledView& v, const BoardMask& plain, std::vector<LightSample>& samples) {
  constexpr std::size_t kFewest = 60, kMostSmall = 60;
  int block = v.options.block_px;
  std::vector<LightSample> face = face_blocks(v, plain, block);
  std::size_t most = static_cast<std::size_t>(std::max(1, v.options.max_face_per_view));
  while (face.size() < kFewest && block > 1) {
    face = face_blocks(v, plain, block /= 2);
    most = std::min(most, kMostSmall);
  }
  const std::size_t step = 1 + face.size() / most;
  for (std::size_t i = 0; i < face.size(); i += step) samples.push_back(face[i]);
}

// Pixels well inside cells of one color, seen at the paper's own height: [tag][black, white].
std::vector<std::array<PaperPixels, 2>> paper_pixels(const SampledView& v, const std::vector<PlacedTag>& tags) {
  std::vector<std::array<PaperPixels, 2>> paper(tags.size());
  for (int y = 0; y < v.height(); ++y)
    for (int x = 0; x < v.width(); ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * v.width() + x;
      const Eigen::Vector3d& q = v.grid.center_mm[i];
      if (!std::isfinite(q.x())) continue;
      Eigen::Vector3d p = q + (v.camera - q) * (v.board.tags.z_mm / (v.camera.z() - q.z()));
      Eigen::Vector2d flat = p.head<2>();
      if (v.surface.bend) {
        // Moves along the view ray to the paper's height over the sheet; `flat` is the flattened position.
        const Eigen::Vector3d n = v.grid.normal[i], way = (v.camera - q) * (v.board.tags.z_mm / (v.camera - q).dot(n));
        p = q + way;
        flat = footprint_middle_mm(v.grid, i) + (R_face_board(n) * way).head<2>();
      }
      for (std::size_t t = 0; t < tags.size(); ++t) {
        const double reach = tags[t].pattern.total_cells * tags[t].cell_mm;
        if (std::abs(flat.x() - tags[t].tag.center_mm.x()) > reach ||
            std::abs(flat.y() - tags[t].tag.center_mm.y()) > reach)
          continue;
        const Eigen::Vector2d at = tags[t].in_cells(flat.x(), flat.y());
        const double margin = v.options.edge_margin_px * pixel_size_mm(v.grid, x, y) / tags[t].cell_mm;
        const int color = uniform_color(tags[t].pattern, at, margin);
        if (color < 0) continue;
        PaperPixels& pixels = paper[t][color];
        if (!v.view.valid[i]) {
          ++pixels.lost;
          break;
        }
        pixels.values.push_back(v.view.value.data[i]);
        pixels.variance_sum += static_cast<double>(v.view.sigma.data[i]) * v.view.sigma.data[i];
        pixels.radius2 += v.radius2_at(x, y);
        pixels.p += p;
        pixels.flat += flat;
        break;
      }
    }
  return paper;
}

void add_paper_samples(const SampledView& v, const std::vector<PlacedTag>& tags, std::vector<LightSample>& samples) {
  std::vector<std::array<PaperPixels, 2>> paper = paper_pixels(v, tags);
  for (std::size_t t = 0; t < tags.size(); ++t)
    for (const int color : {0, 1}) {
      LightSample sample = v.start(color ? SampleKind::white_paper : SampleKind::black_paper);
      sample.tag = tags[t].tag.id;
      if (!finish_paper(paper[t][color], v.surface, sample)) continue;
      sample.to_camera = (v.camera - sample.p_board).normalized();
      sample.around = v.around_paper(sample.normal);
      samples.push_back(sample);
    }
}

// See SampledView::around_face.
Image around_face(const SampledView& v, const Bench& bench) {
  ViewScene scene = make_scene(bench, v.board, share(v.grid), v.camera, *v.surroundings);
  scene.ambient.setZero();
  scene.material.profile = {};  // grooves are not in view
  RenderOptions options;
  options.material_gradients = false;
  Image face;
  ViewRenderer(std::move(scene), options).forward(Carved{}, face);
  for (float& value : face.data) value /= static_cast<float>(v.board.material.f0.mean());
  return face;
}

}  // namespace

std::vector<LightSample> gather_light_samples(std::span<const LightView> views, const Board& board, const Bench& bench,
                                              const Sent& sent, const LightSampleOptions& options) {
  const Surface surface = surface_of(board, bench);
  const std::vector<PlacedTag> tags = place_tags(board, bench);
  const Scratches carved = carve(sent, bench, board).scratches;
  // All photos have one set of surroundings (require_one_room).
  const LightSources sources = !views.empty() && views.front().surroundings
                                   ? light_sources(bench.lights[*views.front().surroundings], kPaperFine_rad)
                                   : LightSources{};
  std::vector<LightSample> samples;
  for (std::size_t k = 0; k < views.size(); ++k) {
    const Eigen::Isometry3d& T_camera_board = bench.views[views[k].view].T_camera_board;
    SampledView view{views[k],
                     k,
                     board,
                     options,
                     surface,
                     grid_of(views[k], T_camera_board, surface),
                     T_camera_board.inverse().translation(),
                     views[k].surroundings ? &bench.lights[*views[k].surroundings] : nullptr,
                     sources,
                     {}};
    if (view.surroundings != nullptr) view.around_face = around_face(view, bench);
    add_face_samples(view, plain_face(view, bench, carved), samples);
    add_paper_samples(view, tags, samples);
  }
  return samples;
}

}  // namespace burin

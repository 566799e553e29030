#include "burin/optimize/design/stroke_field.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include "burin/base/error.h"
#include "burin/base/machine_clones.h"
#include "burin/optimize/design/shown_light.h"

namespace burin {
namespace {

constexpr int kRows = 32;  // rows per task

BURIN_MACHINE_CLONES void show_row(std::size_t n, const float* __restrict light, float* __restrict shown) {
  for (std::size_t i = 0; i < n; ++i) shown[i] = shown_light(light[i]);
}

// Light, shown value and decrease of the error if a stroke crosses pixels over these lengths around these middles.
BURIN_MACHINE_CLONES void light_with(int n, const float* __restrict middle, const float* __restrict length, float start,
                                     float slope, float weight, const float* __restrict unit,
                                     const float* __restrict target, const float* __restrict shown,
                                     float* __restrict light, float* __restrict after, float* __restrict fall) {
  for (int i = 0; i < n; ++i) {
    const float q = start + slope * middle[i], x = 1 + q * q;
    light[i] += length[i] * (1 / (x * std::sqrt(x))) * unit[i];
    after[i] = shown_light(light[i]);
    fall[i] = weight * ((shown[i] - after[i]) * ((shown[i] - target[i]) + (after[i] - target[i])));
  }
}

// Squared errors of pixels that are too dark.
BURIN_MACHINE_CLONES void missing_of_row(std::size_t n, const StrokePixel* __restrict pixels,
                                         const float* __restrict matters, float* __restrict missing) {
  for (std::size_t i = 0; i < n; ++i) {
    const float d = std::max(0.0F, pixels[i].target - pixels[i].shown);
    missing[i] = d * d;
  }
  if (matters == nullptr) return;
  for (std::size_t i = 0; i < n; ++i) missing[i] *= matters[i];
}

BURIN_MACHINE_CLONES void block_sums(std::size_t blocks, const float* __restrict values, double* __restrict sums) {
  static_assert(MissingLight::kBlock == 16);
  for (std::size_t b = 0; b < blocks; ++b) {
    const float* v = values + 16 * b;
    float part[8];
    for (int i = 0; i < 8; ++i) part[i] = v[i] + v[i + 8];
    for (int i = 0; i < 4; ++i) part[i] += part[i + 4];
    sums[b] = static_cast<double>((part[0] + part[2]) + (part[1] + part[3]));
  }
}

std::vector<float> squared(const Image& mask) {
  std::vector<float> out(mask.data.size());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = mask.data[i] * mask.data[i];
  return out;
}

// A straight path over pixels: at s along a line (in pixels) it passes from one pixel to the next.
struct Line {
  Eigen::Vector2d at, along;  // in pixels of the grid, y down; `along` has length 1
};

// Calls visit(column, row, s at the line's entry, length inside) from the line's point on, for `most` pixels of length
// (Amanatides & Woo, Eurographics 1987). The choice of the next border is no branch, because it would be unpredictable.
template <typename Visit>
void walk(const Line& line, double most, const Visit& visit) {
  // A small offset decides the pixel of a start on a border.
  const Eigen::Vector2d inside = line.at + 1e-7 * line.along;
  const auto start = [&](int c, int cell, double& next, double& each, int& sign) {
    sign = line.along[c] > 0 ? 1 : -1;
    const bool moves = std::abs(line.along[c]) > 1e-12;
    each = moves ? 1 / std::abs(line.along[c]) : std::numeric_limits<double>::infinity();
    next = moves ? ((cell + (sign > 0 ? 1 : 0)) - line.at[c]) / line.along[c] : each;
  };
  int column = static_cast<int>(std::floor(inside.x())), row = static_cast<int>(std::floor(inside.y()));
  double next_x, each_x, next_y, each_y;
  int sign_x, sign_y;
  start(0, column, next_x, each_x, sign_x);
  start(1, row, next_y, each_y, sign_y);
  double gone = 0;
  while (gone < most) {
    const bool across_x = next_x < next_y;
    const double until = std::min(std::min(next_x, next_y), most);
    visit(column, row, gone, std::max(0.0, until - gone));
    gone = until;
    column += across_x ? sign_x : 0;
    row += across_x ? 0 : sign_y;
    const double after_x = next_x + each_x, after_y = next_y + each_y;
    next_x = across_x ? after_x : next_x;
    next_y = across_x ? next_y : after_y;
  }
}

using Four = float __attribute__((vector_size(16)));

// to[c][i] is number c of pixels[at[i]], for i = 0 .. 3. (packet::four_columns() is for files of one instruction set.)
inline void four_pixels(const StrokePixel* pixels, const std::size_t* at, float* const (&to)[4]) {
  Four pixel[4];
  for (int i = 0; i < 4; ++i) std::memcpy(&pixel[i], &pixels[at[i]], sizeof(Four));
  const Four low01 = __builtin_shufflevector(pixel[0], pixel[1], 0, 4, 1, 5),
             low23 = __builtin_shufflevector(pixel[2], pixel[3], 0, 4, 1, 5),
             high01 = __builtin_shufflevector(pixel[0], pixel[1], 2, 6, 3, 7),
             high23 = __builtin_shufflevector(pixel[2], pixel[3], 2, 6, 3, 7);
  const Four out[4] = {
      __builtin_shufflevector(low01, low23, 0, 1, 4, 5), __builtin_shufflevector(low01, low23, 2, 3, 6, 7),
      __builtin_shufflevector(high01, high23, 0, 1, 4, 5), __builtin_shufflevector(high01, high23, 2, 3, 6, 7)};
  for (int c = 0; c < 4; ++c) std::memcpy(to[c], &out[c], sizeof(Four));
}

}  // namespace

StrokeField::StrokeField(const StrokeView& view, const StrokeRules& rules)
    : rules_(rules),
      width_(view.light.width),
      height_(view.light.height),
      pitch_x_((rules.max_mm.x() - rules.min_mm.x()) / width_),
      pitch_y_((rules.max_mm.y() - rules.min_mm.y()) / height_) {
  if (view.asides.size() > kMostAsides)
    fail("stroke search", "a view has " + std::to_string(view.asides.size()) + " asides",
         "give at most " + std::to_string(kMostAsides));
  std::vector<const Image*> lights{&view.light}, units{&view.unit}, targets{&view.target};
  glints_.push_back(view.glint);
  weights_.push_back(static_cast<float>(view.weight));
  pictures_.push_back(view.picture);
  for (const StrokeAside& aside : view.asides) {
    lights.push_back(&aside.light);
    units.push_back(&aside.unit);
    targets.push_back(aside.target.data.empty() ? &view.target : &aside.target);
    pictures_.push_back(aside.picture);
    glints_.push_back(aside.glint);
    weights_.push_back(static_cast<float>(aside.weight));
  }
  twins_.resize(lights.size());
  pixels_.resize(lights.size());
  for (auto& pixels : pixels_) pixels.resize(view.light.data.size());
  matters_ = squared(view.mask);
  cost_ = view.cost.data;
  by_kept_.resize(lights.size());
  for (std::size_t k = 0; k < lights.size(); ++k)
    for (const float kept : (k == 0 ? view.kept : view.asides[k - 1].kept).data) by_kept_[k].push_back(1 / kept);
  if (std::any_of(view.asides.begin(), view.asides.end(), [](const StrokeAside& a) { return a.mask.has_value(); })) {
    matters_of_.push_back(matters_);
    for (const StrokeAside& aside : view.asides) matters_of_.push_back(aside.mask ? squared(*aside.mask) : matters_);
  }
  half_vectors_.resize(lights.size());
  for (std::size_t k = 0; k < glints_.size(); ++k)
    if (!glints_[k].of_one_lamp_on_a_flat_face()) half_vectors_[k] = listed_half_vectors(glints_[k]);
  tbb::parallel_for(tbb::blocked_range<int>(0, height_, kRows), [&](const auto& range) {
    std::vector<float> shown(static_cast<std::size_t>(width_));
    for (int y = range.begin(); y < range.end(); ++y) {
      const std::size_t row = static_cast<std::size_t>(y) * width_;
      for (std::size_t k = 0; k < lights.size(); ++k) {
        const float* light = &lights[k]->data[row];
        show_row(shown.size(), light, shown.data());
        for (std::size_t x = 0; x < shown.size(); ++x)
          pixels_[k][row + x] = {light[x], units[k]->data[row + x], targets[k]->data[row + x], shown[x]};
      }
    }
  });
}

std::vector<StrokeHalfVector> StrokeField::listed_half_vectors(const GlintView& glint) const {
  std::vector<StrokeHalfVector> list(static_cast<std::size_t>(width_) * height_);
  tbb::parallel_for(tbb::blocked_range<int>(0, height_, kRows), [&](const auto& range) {
    for (int y = range.begin(); y < range.end(); ++y)
      for (int x = 0; x < width_; ++x) {
        const Eigen::Vector2d p = board({x + 0.5, y + 0.5});
        const Eigen::Vector3f h = half_vector_at(glint, {p.x(), p.y(), 0}).cast<float>();
        list[static_cast<std::size_t>(y) * width_ + x] = {h.x(), h.y(), h.z(), 0};
      }
  });
  return list;
}

void StrokeField::share_pictures_with(StrokeField& other) {
  for (std::size_t i = 0; i < pictures_.size(); ++i)
    for (std::size_t j = 0; j < other.pictures_.size(); ++j) {
      if (pictures_[i] < 0 || pictures_[i] != other.pictures_[j]) continue;
      twins_[i].push_back(other.pixels_[j].data());
      other.twins_[j].push_back(pixels_[i].data());
      has_twins_ = other.has_twins_ = true;
    }
}

bool StrokeField::shares_pictures_with(const StrokeField& other) const {
  for (const int mine : pictures_)
    for (const int theirs : other.pictures_)
      if (mine >= 0 && mine == theirs) return true;
  return false;
}

void StrokeField::write_light(StrokeView& view) const {
  for (std::size_t k = 0; k < pixels_.size(); ++k) {
    Image& light = k == 0 ? view.light : view.asides[k - 1].light;
    for (std::size_t i = 0; i < pixels_[k].size(); ++i) light.data[i] = pixels_[k][i].light;
  }
}

double StrokeField::lobe_place(const GlintView& glint, const Eigen::Vector2d& p_mm, const Eigen::Vector2d& u) const {
  return burin::lobe_place(glint, p_mm, u, rules_.alpha_at(p_mm));
}

// Calls visit(part) for parts of at most kPart pixels.
template <typename Visit>
void StrokeField::each_part(const Eigen::Vector2d& a_mm, const Eigen::Vector2d& b_mm, float times, const PixelBox& box,
                            const Visit& visit) const {
  const Eigen::Vector2d a = pixel(a_mm), b = pixel(b_mm);
  const double length = (b - a).norm(), length_mm = (b_mm - a_mm).norm();
  if (!(length > 1e-9)) return;
  const Eigen::Vector2d u = (b_mm - a_mm) / length_mm;
  std::array<Lobe, kMostPlaces> lobes{};
  for (std::size_t k = 0; k < pixels_.size(); ++k) {
    const double first = lobe_place(glints_[k], a_mm, u), last = lobe_place(glints_[k], b_mm, u);
    lobes[k] = {static_cast<float>(first), static_cast<float>((last - first) / length)};
  }
  StrokePart part{};
  const auto done = [&] {
    if (part.count > 0) visit(part, lobes.data());
    part.count = 0;
  };
  walk({a, (b - a) / length}, length, [&](int x, int y, double s, double inside) {
    part.at[part.count] = static_cast<std::size_t>(y) * width_ + x;
    part.middle[part.count] = static_cast<float>(s + inside / 2);
    part.length[part.count] = times * static_cast<float>(inside);
    part.count += box.contains(x, y) ? 1 : 0;  // else the next replaces it
    if (part.count == kPart) done();
  });
  done();
}

// Light and shown value of a part's pixels with the stroke, seen from one place, and the decrease of their errors.
void StrokeField::with_part(const StrokePart& part, std::size_t k, const Lobe& lobe, bool uncut,
                            PartPixels& out) const {
  const StrokePixel* const pixels = pixels_[k].data();
  int i = 0;
  for (; i + 4 <= part.count; i += 4)
    four_pixels(pixels, part.at + i, {out.light + i, out.unit + i, out.target + i, out.shown + i});
  for (; i < part.count; ++i) {
    const StrokePixel& p = pixels[part.at[i]];
    out.light[i] = p.light;
    out.unit[i] = p.unit;
    out.target[i] = p.target;
    out.shown[i] = p.shown;
  }
  if (uncut && !by_kept_[k].empty())
    for (int n = 0; n < part.count; ++n) out.unit[n] *= by_kept_[k][part.at[n]];
  // Whole SIMD vectors: entries beyond the last have no light.
  const int packets = (part.count + kPacket - 1) / kPacket * kPacket;
  for (; i < packets; ++i) out.light[i] = out.unit[i] = out.target[i] = out.shown[i] = 0;
  light_with(packets, part.middle, part.length, lobe.start, lobe.slope, weights_[k], out.unit, out.target, out.shown,
             out.light, out.after, out.fall);
}

double StrokeField::cost_of(const StrokePart& part) const {
  double cost = 0;
  if (!cost_.empty())
    for (int i = 0; i < part.count; ++i) cost += cost_[part.at[i]] * part.length[i];
  return cost;
}

// Decrease of the squared error over all places, without costs.
double StrokeField::change(const StrokePart& part, const Lobe* lobes, bool uncut, StrokePixelsBefore* before) {
  double fell = 0;
  for (std::size_t k = 0; k < pixels_.size(); ++k) {
    PartPixels out;
    with_part(part, k, lobes[k], uncut, out);
    const std::vector<float>& matters = matters_at(k);
    StrokePixel* const pixels = pixels_[k].data();
    for (int i = 0; i < part.count; ++i) {
      StrokePixel& p = pixels[part.at[i]];
      if (before != nullptr) before->pixels.push_back({part.at[i], static_cast<std::uint32_t>(k), p.light, p.shown});
      p.light = out.light[i];
      p.shown = out.after[i];
      fell += matters.empty() ? out.fall[i] : matters[part.at[i]] * out.fall[i];
    }
    if (has_twins_)
      for (int i = 0; i < part.count; ++i) tell_twins(k, part.at[i]);
  }
  return fell;
}

double StrokeField::add(const Eigen::Vector2d& a_mm, const Eigen::Vector2d& b_mm, float times, const PixelBox& box,
                        StrokePixelsBefore* before) {
  double fell = 0;
  each_part(a_mm, b_mm, times, box, [&](const StrokePart& part, const Lobe* lobes) {
    fell += change(part, lobes, false, before) - cost_of(part);
  });
  return fell;
}

double StrokeField::add_uncut(const Eigen::Vector2d& a_mm, const Eigen::Vector2d& b_mm, float times,
                              const PixelBox& box, StrokePixelsBefore& before) {
  double fell = 0;
  each_part(a_mm, b_mm, times, box,
            [&](const StrokePart& part, const Lobe* lobes) { fell += change(part, lobes, true, &before); });
  return fell;
}

void StrokeField::put_back(StrokePixelsBefore& before, std::size_t kept) {
  for (std::size_t n = before.pixels.size(); n > kept; --n) {
    const StrokePixelsBefore::Pixel& was = before.pixels[n - 1];
    StrokePixel& p = pixels_[was.place][was.at];
    p.light = was.light;
    p.shown = was.shown;
    if (has_twins_) tell_twins(was.place, was.at);
  }
  before.pixels.resize(std::min(kept, before.pixels.size()));
}

double StrokeField::fall(const Eigen::Vector2d& a_mm, const Eigen::Vector2d& b_mm, float times) const {
  double fell = 0;
  each_part(a_mm, b_mm, times, whole(), [&](const StrokePart& part, const Lobe* lobes) {
    fell -= cost_of(part);
    for (std::size_t k = 0; k < pixels_.size(); ++k) {
      PartPixels out;
      with_part(part, k, lobes[k], false, out);
      const std::vector<float>& matters = matters_at(k);
      for (int i = 0; i < part.count; ++i) fell += matters.empty() ? out.fall[i] : matters[part.at[i]] * out.fall[i];
    }
  });
  return fell;
}

std::size_t MissingLight::pixel_at(double part) const {
  const double at = part * all();
  const auto found = static_cast<std::size_t>(std::upper_bound(upto.begin(), upto.end(), at) - upto.begin());
  const std::size_t block = std::min(found, upto.size() - 1), last = std::min((block + 1) * kBlock, pixels) - 1;
  double left = at - (block > 0 ? upto[block - 1] : 0);
  std::size_t i = block * kBlock;
  for (; i < last && left >= static_cast<double>(of_pixel[i]); ++i) left -= static_cast<double>(of_pixel[i]);
  return i;
}

void StrokeField::survey(const PixelBox& box, MissingLight& missing) const {
  const auto columns = static_cast<std::size_t>(box.x1 - box.x0), rows = static_cast<std::size_t>(box.y1 - box.y0);
  missing.pixels = columns * rows;
  const std::size_t blocks = (missing.pixels + MissingLight::kBlock - 1) / MissingLight::kBlock;
  missing.of_pixel.resize(blocks * MissingLight::kBlock);
  std::fill(missing.of_pixel.begin() + static_cast<std::ptrdiff_t>(missing.pixels), missing.of_pixel.end(), 0.0F);
  missing.upto.resize(blocks);
  for (std::size_t row = 0; row < rows; ++row) {
    const std::size_t first = (static_cast<std::size_t>(box.y0) + row) * width_ + box.x0;
    missing_of_row(columns, &pixels_[0][first], matters_.empty() ? nullptr : &matters_[first],
                   &missing.of_pixel[row * columns]);
  }
  block_sums(blocks, missing.of_pixel.data(), missing.upto.data());
  double sum = 0;
  for (double& upto : missing.upto) upto = sum += upto;
}

double StrokeField::missing_in(const PixelBox& box) const {
  MissingLight missing;
  survey(box, missing);
  return missing.all();
}

StrokeWindow StrokeField::window(const PixelBox& box) const {
  const std::size_t corner = static_cast<std::size_t>(box.y0) * width_ + box.x0;
  const Eigen::Vector2d corner_mm = board({static_cast<double>(box.x0), static_cast<double>(box.y0)});
  StrokeWindow w;
  w.places = static_cast<int>(pixels_.size());
  for (std::size_t k = 0; k < pixels_.size(); ++k) {
    StrokePlace& place = w.place[k];
    place.pixels = &pixels_[k][corner];
    place.weight = weights_[k];
    if (!matters_of_.empty() && !matters_of_[k].empty()) place.matters = &matters_of_[k][corner];
    place.half_vectors = half_vectors_[k].empty() ? nullptr : half_vectors_[k].data();
    for (int c = 0; c < 3; ++c) {
      place.camera_mm[c] = static_cast<float>(glints_[k].camera_mm[c]);
      place.lamp_mm[c] = static_cast<float>(glints_[k].light_mm[c]);
    }
  }
  w.matters = matters_.empty() || !matters_of_.empty() ? nullptr : &matters_[corner];
  w.cost = cost_.empty() ? nullptr : &cost_[corner];
  w.stride = width_;
  w.column = box.x0;
  w.row = box.y0;
  w.picture_height = height_;
  w.width = box.x1 - box.x0;
  w.height = box.y1 - box.y0;
  w.left_mm = static_cast<float>(corner_mm.x());
  w.top_mm = static_cast<float>(corner_mm.y());
  w.pitch_x_mm = static_cast<float>(pitch_x_);
  w.pitch_y_mm = static_cast<float>(pitch_y_);
  constexpr double kHair = 1e-5;  // keeps floats' rounding within a machine's limits
  w.shortest = static_cast<float>(rules_.shortest_mm / pitch_x_ * (1 + kHair));
  w.longest = static_cast<float>(rules_.longest_mm / pitch_x_ * (1 - kHair));
  w.dimmest = static_cast<float>(rules_.dimmest);
  return w;
}

}  // namespace burin

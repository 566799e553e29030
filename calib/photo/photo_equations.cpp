#include "burin/calib/photo/photo_equations.h"

#include <ceres/jet.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>
#include <utility>

#include "burin/base/error.h"
#include "burin/calib/light/lamp_model.h"
#include "burin/calib/photo/carved_states.h"
#include "burin/calib/photo/cauchy_loss.h"
#include "burin/calib/photo/effect_unknowns.h"
#include "burin/calib/photo/lamp_unknowns.h"
#include "burin/calib/photo/machine_map.h"
#include "burin/calib/photo/stray_light.h"
#include "burin/render/parts_derivatives.h"
#include "burin/scene/board_face.h"
#include "burin/scene/lamp_size.h"

namespace burin {
namespace {

std::shared_ptr<RenderWorkspace> workspace_of(const PhotoData& photo) {
  return photo.workspaces->borrow(photo.scene.grid.get());
}

// Puts the unknowns into a photo's scene. A point spotlight is rendered as a bare lamp: its smooth falloff is
// multiplied later. Each point of an area light has its own falloff.
const ViewScene& scene_at(const PhotoData& photo, const Unknowns& x) {
  ViewScene& scene = photo.scene;
  scene.material.alpha = std::exp(x[unknown::log_alpha]);
  scene.material.depth_um = std::exp(x[unknown::log_depth]);
  scene.material.base_alpha = std::exp(x[unknown::log_base_alpha]);
  scene.material.grain = grain_of(x);
  scene.material.profile = profile_of(photo.profile, x);
  scene.light.intensity.setConstant(std::exp(x[unknown::log_intensity]));
  put_lamp(x, photo.lamp_size, photo.size_unit_mm, scene.light);
  if (scene.light.size.is_point()) scene.light.falloff_exponent = 0;
  scene.ambient.setZero();
  return scene;
}

bool has_area(const PhotoData& photo, const Unknowns& x) {
  return !photo.lamp_size.is_point() || x[unknown::size2] > 0;
}

// log of the falloff at a point of a spotlight with this position, aim on the board, and exponent.
template <typename T>
T log_falloff(const std::array<T, 6>& spot, const Eigen::Vector3d& p) {
  using std::log;
  using std::sqrt;
  const Eigen::Matrix<T, 3, 1> axis(spot[3] - spot[0], spot[4] - spot[1], -spot[2]),
      from(T(p.x()) - spot[0], T(p.y()) - spot[1], T(p.z()) - spot[2]);
  const auto dot = [](const Eigen::Matrix<T, 3, 1>& a, const Eigen::Matrix<T, 3, 1>& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  };
  constexpr double kLeastCosine = 1e-6;
  T cosine = dot(axis, from) / sqrt(dot(axis, axis) * dot(from, from));
  if (!(cosine >= T(kLeastCosine))) cosine = T(kLeastCosine);
  return spot[5] * log(cosine);
}

// The lamp's position, aim and exponent.
std::array<double, 6> placed_spot(const Unknowns& x) {
  std::array<double, 6> out;
  for (int i = 0; i < 3; ++i) {
    out[i] = x[unknown::lamp_position + i];
    out[3 + i] = x[unknown::spot + i];
  }
  return out;
}

void multiply(Image& image, const std::vector<float>& by) {
  for (std::size_t i = 0; i < by.size(); ++i) image.data[i] *= by[i];
}

// Falloff at each pixel's place; empty for a bare lamp, and for an area light, whose rendering includes it.
std::vector<float> falloff_image(const PhotoData& photo, const Unknowns& x) {
  if (!(x[unknown::spot + 2] > 0) || has_area(photo, x)) return {};
  const std::array<double, 6> spot = placed_spot(x);
  std::vector<float> out(photo.weight.size(), 0);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const Eigen::Vector3d& p = photo.scene.grid->center_mm[i];
    if (std::isfinite(p.x())) out[i] = static_cast<float>(std::exp(log_falloff(spot, p)));
  }
  return out;
}

// Factor of vignetting and glare on the light of a pixel.
double vignette_of(const PhotoData& photo, const Unknowns& x, std::size_t i) {
  return (1 - x[unknown::glare_share]) *
         vignette_at(x.data() + unknown::vignette, static_cast<double>(photo.radius2[i]));
}

// Glare on a pixel from all over the photo.
double scattered_to(const PhotoData& photo, const Unknowns& x, std::size_t i) {
  return photo.photo.scattered.data.empty() ? 0 : x[unknown::glare_share] * photo.photo.scattered.data[i];
}

// The board under the unmodeled light.
ViewScene under_stray(const PhotoData& photo, const Unknowns& x, ViewScene scene) {
  scene.light = stray_light(x, photo.camera.surface.size_mm);
  scene.hidden_from_light.clear();
  return scene;
}

ViewScene stray_scene(const PhotoData& photo, const Unknowns& x) { return under_stray(photo, x, scene_at(photo, x)); }

// Light of one source, by the fast path. A point's view omits derivatives by the face's roughness, which cost as much
// as all else on a brushed face. An area light keeps them: without, it would be tabulated for a single picture.
Image light_of_scene(const PhotoData& photo, const ViewScene& scene, const Carved& carved) {
  RenderOptions options;
  options.material_gradients = !scene.light.size.is_point();
  Image light;
  ViewRenderer(scene, options, workspace_of(photo)).forward(carved, light);
  return light;
}

Image rendered_stray(const PhotoData& photo, const Unknowns& x, const Carved& carved) {
  return light_of_scene(photo, stray_scene(photo, x), carved);
}

// Light before blur: the lamp's, as rendered radiance times the spotlight's falloff, and an unmodeled light's. Without
// derivatives it uses the fast path, accurate to 1e-6 of the peak (1e-4 for groove profiles other than the paper's).
Image rendered_light(const PhotoData& photo, const Unknowns& x, const Carved& carved,
                     const std::vector<float>& falloff) {
  Image light = light_of_scene(photo, scene_at(photo, x), carved);
  if (!falloff.empty()) multiply(light, falloff);
  if (has_stray(x)) add_share(rendered_stray(photo, x, carved), 1, light);
  return light;
}

// Light with all grooves exp(step) times as rough (index log_alpha) or as deep (log_depth); the visible groove at each
// crossing stays the same.
Image light_of_changed(const PhotoData& photo, const Unknowns& x, const Carved& carved, int index, double step,
                       const std::vector<float>& falloff) {
  const bool roughness = index == unknown::log_alpha;
  const double most = roughness ? 1 : std::numeric_limits<double>::infinity();  // upper limit of roughness
  Unknowns other = x;
  other[index] = std::min(other[index] + step, std::log(most));
  Carved changed = carved;
  for (double& own : roughness ? changed.scratches.alpha : changed.scratches.depth_um)
    own = std::min(own * std::exp(step), most);
  return rendered_light(photo, other, changed, falloff);
}

// A photo's grid and camera, with all weights 0.
PhotoData photo_without_weights(const LightView& binned_view, int bin, const Board& board, const Bench& bench) {
  PhotoData data;
  data.photo = binned_view;
  data.bin = bin;
  data.camera.lens = binned_view.lens;
  data.camera.T_camera_board = bench.views[binned_view.view].T_camera_board;
  data.camera.surface = surface_of(board, bench);
  data.camera.window = binned_view.window;
  data.workspaces = std::make_shared<WorkspacePool>();
  // Lamp, material and ambient light are unknowns.
  if (board.mesh.empty()) {
    data.scene.grid = share(grid_of(binned_view, data.camera.T_camera_board, data.camera.surface));
    data.scene.camera_center_mm = data.camera.T_camera_board.inverse().translation();
    if (data.camera.surface.bend && !bench.lights.empty())  // the edge of a lamp's shadow hardly moves during a fit
      data.scene.hidden_from_light = hidden_pixels(*data.scene.grid, BoardFace{data.camera.surface, nullptr},
                                                   bench.lights[binned_view.light].position_mm);
  } else {
    data.scene = make_scene(bench, board, data.camera, {});
    data.scene.ambient.setZero();
  }
  data.scene.material.f0 = board.material.f0;
  data.profile = bench.material.profile;
  data.size_unit_mm = size_unit_mm(board);
  if (binned_view.light < bench.lights.size()) {  // size of an area light: given, or sought (size2)
    if (!bench.lights[binned_view.light].is_lamp())
      fail("light " + bench.lights[binned_view.light].id, "is no near lamp, and photos are fitted under one alone",
           "take photos under a lamp of its own in a dark room, and leave these out of session.json");
    const LampSize& size = bench.lights[binned_view.light].size;
    if (!size.is_measured()) data.scene.light.size = data.lamp_size = size;
    data.scene.light.axis = bench.lights[binned_view.light].axis;
  }
  if (binned_view.surroundings) {
    data.surroundings = std::make_shared<const Light>(bench.lights[*binned_view.surroundings]);
    data.around = Image(data.scene.grid->width(), data.scene.grid->height(), 1);  // until light_around()
  }
  data.scene.tool_width_um = board.tool_width_um;
  const PixelWindow& window = data.scene.grid->window;
  data.radius2.resize(static_cast<std::size_t>(window.width) * window.height);
  data.weight.assign(data.radius2.size(), 0);
  for (int y = 0; y < window.height; ++y)
    for (int x = 0; x < window.width; ++x)
      data.radius2[static_cast<std::size_t>(y) * window.width + x] = static_cast<float>(
          vignette_radius2(binned_view.lens.width, binned_view.lens.height, x + window.x0, y + window.y0));
  return data;
}

// Sigma of the Gaussian blur of the prediction on these pixels.
double blur_sigma_px(const PhotoData& photo, const Unknowns& x) {
  return std::exp(photo.correction.empty() ? x[unknown::log_blur] : photo.log_blur_at);
}

// Sum of glare from elsewhere, groove-to-groove variation and correct_binning() for pixel i.
double corrected_by(const PhotoData& photo, const Unknowns& x, std::size_t i) {
  const double shift =
      scattered_to(photo, x, i) + (photo.groove_shift.empty() ? 0 : static_cast<double>(photo.groove_shift[i]));
  if (photo.correction.empty()) return shift;
  return shift + photo.correction[i] + (x[unknown::log_blur] - photo.log_blur_at) * photo.blur_slope[i];
}

// The lamp's light, plus ambient light on the face.
Image with_ambient(const ModelData& model, const PhotoData& photo, const Unknowns& x, Image light) {
  for (std::size_t i = 0; i < light.data.size(); ++i)
    if (std::isfinite(photo.scene.grid->center_mm[i].x()))
      light.data[i] += static_cast<float>(x[unknown::ambient] * ambient_unit(model, photo, i));
  return light;
}

// Converts the lamp's light to the sensor's: adds ambient light and blurs.
Image at_sensor(const ModelData& model, const PhotoData& photo, const Unknowns& x, Image light) {
  return blurred(with_ambient(model, photo, x, std::move(light)), blur_taps(blur_sigma_px(photo, x), photo.bin));
}

// Converts it further to the photo's value by vignetting.
Image value_of_light(const ModelData& model, const PhotoData& photo, const Unknowns& x, Image light) {
  Image value = at_sensor(model, photo, x, std::move(light));
  for (std::size_t i = 0; i < value.data.size(); ++i) value.data[i] *= static_cast<float>(vignette_of(photo, x, i));
  return value;
}

// Residual of the photo for the light image of `seen`, in expected errors.
double residual_at(const PhotoData& photo, std::size_t i, const PixelSeen& seen) {
  return photo.weight[i] * (seen.value - photo.photo.value.data[i]);
}

}  // namespace

PhotoData make_photo_data(const LightView& binned_view, int bin, const Board& board, const Bench& bench,
                          double margin_px) {
  PhotoData data = photo_without_weights(binned_view, bin, board, bench);
  const FootprintGrid& grid = *data.scene.grid;
  const int width = grid.width(), height = grid.height();
  // One margin for the whole photo, from the pixel's size at the board's center.
  const std::size_t middle = static_cast<std::size_t>(height / 2) * (width + 1) + width / 2;
  const double pixel_mm = std::max(std::hypot(grid.corner_x_mm[middle + 1] - grid.corner_x_mm[middle],
                                              grid.corner_y_mm[middle + 1] - grid.corner_y_mm[middle]),
                                   std::hypot(grid.corner_x_mm[middle + width + 1] - grid.corner_x_mm[middle],
                                              grid.corner_y_mm[middle + width + 1] - grid.corner_y_mm[middle]));
  constexpr double kPaperRimMm = 0.8;  // paper is cut larger than its print, and is slightly displaced
  const BoardMask metal = metal_mask(board, bench, kPaperRimMm + margin_px * (std::isfinite(pixel_mm) ? pixel_mm : 1));
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * width + x;
      const Eigen::Vector2d p = footprint_middle_mm(grid, i);
      if (!binned_view.valid[i] || !std::isfinite(p.x()) || !metal.is_free(p.x(), p.y())) continue;
      data.weight[i] = 1 / binned_view.sigma.data[i];
    }
  return data;
}

void show_only(const BoardSample& sample, PhotoData& photo) {
  if (sample.is_whole()) return;
  photo.scene.grid = share(footprints_of(sample, *photo.scene.grid));
  for (std::size_t i = 0; i < photo.weight.size(); ++i)
    if (photo.weight[i] > 0 && !sample.holds(footprint_middle_mm(*photo.scene.grid, i))) photo.weight[i] = 0;
}

void light_around(const Unknowns& x, const Carved& carved, PhotoData& photo) {
  if (photo.surroundings == nullptr) return;
  ViewScene scene = scene_at(photo, x);
  scene.light = *photo.surroundings;
  scene.hidden_from_light.clear();
  RenderOptions options;
  options.material_gradients = false;  // a third of the tables
  ViewRenderer(std::move(scene), options, workspace_of(photo)).forward(carved, photo.around);
}

Image predict(const ModelData& model, const PhotoData& photo, const Unknowns& x, const Carved& carved) {
  Image value = value_of_light(model, photo, x, rendered_light(photo, x, carved, falloff_image(photo, x)));
  for (std::size_t i = 0; i < value.data.size(); ++i) value.data[i] += static_cast<float>(corrected_by(photo, x, i));
  return value;
}

GrooveSlopes predict_with_slopes(const ModelData& model, const PhotoData& photo, const Unknowns& x,
                                 const Carved& carved) {
  const std::vector<float> falloff = falloff_image(photo, x);
  const std::vector<float> kernel = blur_taps(blur_sigma_px(photo, x), photo.bin);
  constexpr double kStep = 0.02;
  const auto slope = [&](int index) {
    Image above = light_of_changed(photo, x, carved, index, kStep, falloff);
    const Image below = light_of_changed(photo, x, carved, index, -kStep, falloff);
    for (std::size_t i = 0; i < above.data.size(); ++i)
      above.data[i] = (above.data[i] - below.data[i]) / static_cast<float>(2 * kStep);
    Image out = blurred(above, kernel);
    for (std::size_t i = 0; i < out.data.size(); ++i) out.data[i] *= static_cast<float>(vignette_of(photo, x, i));
    return out;
  };
  return {predict(model, photo, x, carved), slope(unknown::log_alpha), slope(unknown::log_depth)};
}

std::vector<GrooveGradients> groove_gradients(const PhotoData& photo, const Unknowns& x, const Carved& carved,
                                              std::span<const Image> dE_dvalue) {
  if (carved.scratches.depth_um.empty() || carved.scratches.alpha.empty())
    fail("groove_gradients", "scratches without depth and roughness of their own", "use carved_pieces()");
  const std::vector<float> kernel = blur_taps(blur_sigma_px(photo, x), photo.bin);
  std::vector<ScratchGradients> sums(dE_dvalue.size());
  for (ScratchGradients& sum : sums) sum.resize(carved.size());
  const auto add = [&](const ViewScene& scene, const std::vector<float>& falloff) {
    ViewRenderer renderer(scene, {}, workspace_of(photo));
    Image radiance;
    renderer.forward_with_jacobian(carved, radiance);
    for (std::size_t e = 0; e < dE_dvalue.size(); ++e) {
      Image back = dE_dvalue[e];
      for (std::size_t i = 0; i < back.data.size(); ++i) back.data[i] *= static_cast<float>(vignette_of(photo, x, i));
      back = blurred(back, kernel);  // a symmetric kernel is its own adjoint, except at the rim, which is unused
      if (!falloff.empty()) multiply(back, falloff);
      renderer.backward(back, sums[e]);
    }
  };
  add(scene_at(photo, x), falloff_image(photo, x));
  if (has_stray(x)) add(stray_scene(photo, x), {});
  std::vector<GrooveGradients> out;
  for (ScratchGradients& gradients : sums) {
    for (std::size_t i = 0; i < carved.size(); ++i) {
      gradients.alpha[i] *= carved.scratches.alpha[i];
      gradients.depth_um[i] *= carved.scratches.depth_um[i];
    }
    for (std::size_t i = 0; i < carved.size(); ++i) {
      gradients.x0_mm[i] += gradients.x1_mm[i];
      gradients.y0_mm[i] += gradients.y1_mm[i];
    }
    out.push_back({std::move(gradients.alpha), std::move(gradients.depth_um), std::move(gradients.x0_mm),
                   std::move(gradients.y0_mm)});
  }
  return out;
}

void shift_by_grooves(const ModelData& model, const Unknowns& x, const Carved& carved, PhotoData& photo) {
  photo.groove_shift.clear();
  if (!(model.alpha_jitter > 0) && !(model.depth_jitter > 0)) return;
  const std::vector<float> falloff = falloff_image(photo, x);
  const auto seen = [&](Image light) { return value_of_light(model, photo, x, std::move(light)); };
  const Image middle = seen(rendered_light(photo, x, carved, falloff));
  std::vector<float> shift(middle.data.size(), 0);
  for (const auto& [index, jitter] :
       {std::pair(unknown::log_alpha, model.alpha_jitter), std::pair(unknown::log_depth, model.depth_jitter)}) {
    if (!(jitter > 0)) continue;
    const double node = std::sqrt(3.0) * jitter;  // of weight 1/6 on either side
    const Image above = seen(light_of_changed(photo, x, carved, index, node, falloff)),
                below = seen(light_of_changed(photo, x, carved, index, -node, falloff));
    for (std::size_t i = 0; i < shift.size(); ++i) shift[i] += (above.data[i] + below.data[i] - 2 * middle.data[i]) / 6;
  }
  photo.groove_shift = std::move(shift);
}

void correct_binning(const ModelData& model, const LightView& whole, const Board& board, const Bench& bench,
                     const Unknowns& x, const Carved& carved, std::size_t max_pixels, PhotoData& photo) {
  photo.correction.clear();
  photo.groove_shift.clear();  // recomputed later: fine and binned pixels are compared without it
  int divisor = 1;
  const auto fits = [&](int d) {
    return photo.bin % d == 0 && whole.value.data.size() / (static_cast<std::size_t>(d) * d) <= max_pixels;
  };
  while (divisor < photo.bin && !fits(divisor)) ++divisor;
  if (divisor >= photo.bin) return;
  const int parts = photo.bin / divisor;
  PhotoData fine = photo_without_weights(binned(whole, divisor), divisor, board, bench);
  show_only(model.sample, fine);
  light_around(x, carved, fine);
  const Image light = rendered_light(fine, x, carved, falloff_image(fine, x));
  const Image on_binned = value_of_light(model, photo, x, rendered_light(photo, x, carved, falloff_image(photo, x)));
  constexpr double kStep = 0.02;
  Unknowns wider = x, narrower = x;
  wider[unknown::log_blur] += kStep;
  narrower[unknown::log_blur] -= kStep;
  const Image on_fine = value_of_light(model, fine, x, light), on_wider = value_of_light(model, fine, wider, light),
              on_narrower = value_of_light(model, fine, narrower, light);
  const PixelWindow &f = fine.photo.window, &c = photo.photo.window;
  std::vector<float> correction(on_binned.data.size(), 0), slope(on_binned.data.size(), 0);
  for (int y = 0; y < c.height; ++y)
    for (int px = 0; px < c.width; ++px) {
      double sum = 0, change = 0;
      bool inside = true;
      for (int v = 0; v < parts; ++v)
        for (int u = 0; u < parts; ++u) {
          const int fx = (px + c.x0) * parts + u - f.x0, fy = (y + c.y0) * parts + v - f.y0;
          inside = inside && fx >= 0 && fy >= 0 && fx < f.width && fy < f.height;
          if (!inside) continue;
          sum += on_fine.at(fx, fy);
          change += static_cast<double>(on_wider.at(fx, fy)) - on_narrower.at(fx, fy);
        }
      if (!inside) continue;
      const std::size_t i = static_cast<std::size_t>(y) * c.width + px;
      correction[i] = static_cast<float>(sum / (parts * parts) - on_binned.at(px, y));
      slope[i] = static_cast<float>(change / (2 * kStep * parts * parts));
    }
  photo.correction = std::move(correction);
  photo.blur_slope = std::move(slope);
  photo.log_blur_at = x[unknown::log_blur];
}

namespace {

// The picture's derivatives by the lens, in the units of moved_lens(). Rotation of the camera about x or y moves the
// content over the picture and changes nothing else. The lens does the same. G dq/d(rx, ry) = dI/d(rx, ry) therefore
// gives the change G of the picture by motion of its content, and dI/dlens = G dq/dlens. The slight change of scale of
// the content is neglected.
std::vector<Image> lens_slopes(const PhotoData& photo, const Image& by_rx, const Image& by_ry) {
  const Lens& lens = photo.camera.lens;
  const std::size_t parameters = free_lens_parameters(lens);
  const int width = by_rx.width, height = by_rx.height;
  std::vector<Image> out(parameters, Image(width, height, 1));
  if (parameters == 0) return out;
  std::vector<Eigen::Vector3d> points;
  std::vector<std::size_t> pixels;
  std::vector<Eigen::Vector2d> q;
  std::vector<PixelByPoint> dq_dp;
  std::vector<double> dq_dlens;
  for (int y = 0; y < height; ++y) {
    points.clear();
    pixels.clear();
    for (int px = 0; px < width; ++px) {
      const std::size_t i = static_cast<std::size_t>(y) * width + px;
      const Eigen::Vector3d& p = photo.scene.grid->center_mm[i];
      if (!std::isfinite(p.x())) continue;
      points.emplace_back(photo.camera.T_camera_board * p);
      pixels.push_back(i);
    }
    q.resize(points.size());
    project(lens, points, q, &dq_dp, &dq_dlens);
    for (std::size_t k = 0; k < points.size(); ++k) {
      Eigen::Matrix2d by_turn;  // of q, by rx and ry
      by_turn << dq_dp[k] * Eigen::Vector3d::UnitX().cross(points[k]),
          dq_dp[k] * Eigen::Vector3d::UnitY().cross(points[k]);
      const std::size_t i = pixels[k];
      const Eigen::Vector2d G = by_turn.transpose().inverse() * Eigen::Vector2d(by_rx.data[i], by_ry.data[i]);
      const double* by_lens = &dq_dlens[k * 2 * parameters];
      for (std::size_t j = 0; j < parameters; ++j) {
        out[j].data[i] =
            static_cast<float>(lens_unit(lens, j) * (G.x() * by_lens[j] + G.y() * by_lens[parameters + j]));
      }
    }
  }
  return out;
}

}  // namespace

Image stray_seen(const PhotoData& photo, const Unknowns& x, const Carved& carved) {
  if (!has_stray(x)) return {photo.scene.grid->width(), photo.scene.grid->height(), 1};
  return blurred(rendered_stray(photo, x, carved), blur_taps(blur_sigma_px(photo, x), photo.bin));
}

Image seen_light(const ModelData& model, const PhotoData& photo, const Unknowns& x, const Carved& carved) {
  return at_sensor(model, photo, x, rendered_light(photo, x, carved, falloff_image(photo, x)));
}

PixelSeen pixel_seen(const PhotoData& photo, const Unknowns& x, std::size_t i, const Image& light) {
  const double factor = vignette_of(photo, x, i);
  const double kept = 1 - x[unknown::glare_share];
  return {factor * light.data[i] + corrected_by(photo, x, i), factor,
          photo.photo.scattered.data.empty() ? 0 : photo.photo.scattered.data[i] - factor / kept * light.data[i]};
}

double photo_cost(const ModelData& model, const PhotoData& photo, const Unknowns& x, const Carved& carved) {
  return photo_cost(model, photo, x, seen_light(model, photo, x, carved));
}

double photo_cost(const ModelData& model, const PhotoData& photo, const Unknowns& x, const Image& light) {
  double cost = 0;
  for (std::size_t i = 0; i < light.data.size(); ++i) {
    if (!(photo.weight[i] > 0)) continue;
    const double r = residual_at(photo, i, pixel_seen(photo, x, i, light));
    cost += 0.5 * cauchy_loss(r * r, model.cauchy).rho;
  }
  return cost;
}

namespace {

// True if values use more points of an area light than derivatives do.
bool by_more_points(const Light& lamp) { return lamp_points(lamp).size() > lamp_points(lamp, true).size(); }

// Light of an area light by few points.
Image light_by_few(const PhotoData& photo, const ViewScene& scene, const Carved& carved) {
  if (!by_more_points(scene.light)) return light_of_scene(photo, scene, carved);
  Image sum;
  for (const ScenePart& part : scene_parts(scene, true))
    add_share(light_of_scene(photo, part.scene, carved), part.share, sum);
  return sum;
}

bool is_small(const Light& lamp, const Material& material, const Eigen::Vector2d& board_mm) {
  const double reach_mm = std::max(lamp.size.disk_mm, 0.5 * lamp.size.panel_mm.norm());
  const double distance_mm = (lamp.position_mm - Eigen::Vector3d(board_mm.x() / 2, board_mm.y() / 2, 0)).norm();
  const double least = std::min(material.alpha * std::min(1.0, material.profile.across), material.base_alpha);
  return is_small_lamp(reach_mm, distance_mm, least);
}

// Light with derivatives, by few points: derivatives only determine the direction and length of a step. The light
// itself is compared with other states' light, so a small area light's is not taken at its middle.
RadianceDerivatives light_with_slopes(const PhotoData& photo, const ViewScene& scene, const Carved& carved,
                                      std::span<const SceneParameter> parameters) {
  const bool by_middle =
      !scene.light.size.is_point() && is_small(scene.light, scene.material, photo.camera.surface.size_mm);
  ViewScene middle = scene;
  if (by_middle) middle.light.size = {};
  RadianceDerivatives out =
      mean_with_derivatives(scene_parts(middle, true), photo.camera, carved, parameters, {}, workspace_of(photo));
  if (by_middle) out.radiance = light_by_few(photo, scene, carved);
  return out;
}

// Light at the other end of a finite difference.
Image light_for_slope(const PhotoData& photo, const Unknowns& x, const ViewScene& scene, const Carved& carved) {
  Image sum = light_by_few(photo, scene, carved);
  const std::vector<float> falloff = falloff_image(photo, x);
  if (!falloff.empty()) multiply(sum, falloff);
  if (has_stray(x)) add_share(light_by_few(photo, under_stray(photo, x, scene), carved), 1, sum);
  return sum;
}

// The renderer's derivatives for some free unknowns, with the index of each in its answer.
struct Wanted {
  std::vector<SceneParameter> parameters;
  // -1: not requested
  int alpha = -1, depth = -1, base = -1, grain = -1, lamp = -1, spot = -1, machine = -1, bow = -1, pose = -1;

  // `area_spot`: an area light, each of whose points has the spotlight's falloff.
  Wanted(const FreeUnknowns& free, bool area_spot) {
    using P = SceneParameter;
    const auto any = [&](int first, int count) {
      return std::any_of(free.begin() + first, free.begin() + first + count, [](bool f) { return f; });
    };
    const auto ask = [&](bool want, std::initializer_list<P> of) {
      if (!want) return -1;
      const int at = static_cast<int>(parameters.size());
      parameters.insert(parameters.end(), of);
      return at;
    };
    alpha = ask(free[unknown::log_alpha], {P::alpha});
    // A field over the board multiplies the derivative by a common factor of all depths.
    depth = ask(free[unknown::log_depth] || any(unknown::depth_field, unknown::depth_wear - unknown::depth_field),
                {P::depth_um});
    base = ask(free[unknown::log_base_alpha], {P::base_alpha});
    grain = ask(any(unknown::grain, 2), {P::grain_c, P::grain_s});
    lamp = ask(any(unknown::lamp_position, 3), {P::light_x_mm, P::light_y_mm, P::light_z_mm});
    spot = ask(area_spot && any(unknown::lamp_position, unknown::spot + 3 - unknown::lamp_position),
               {P::light_axis_x, P::light_axis_y, P::light_axis_z, P::falloff_exponent});
    machine = ask(any(unknown::machine, 6),
                  {P::machine_00, P::machine_01, P::machine_02, P::machine_10, P::machine_11, P::machine_12});
    bow = ask(any(unknown::bow, 3), {P::bow_0_mm, P::bow_1_mm, P::bow_2_mm});
    // The lens' derivatives follow from these by rotations of the camera (lens_slopes).
    pose = ask(any(unknown::pose, 6) || any(unknown::lens, kMostLensParameters),
               {P::pose_rx, P::pose_ry, P::pose_rz, P::pose_tx_mm, P::pose_ty_mm, P::pose_tz_mm});
  }
};

// The spotlight's falloff, a factor on all of the lamp's light: at each pixel (as falloff_image()). Also the light's
// derivatives by it: by lamp position (3; for an area light only by rotation of the axis) and spotlight (3).
struct SpotSlopes {
  bool is_spot = false;
  std::vector<float> falloff;
  std::array<Image, 6> by;
};

SpotSlopes apply_spot(const PhotoData& photo, const Unknowns& x, RadianceDerivatives& rendered) {
  SpotSlopes out;
  if (!(x[unknown::spot + 2] > 0)) return out;
  out.is_spot = true;
  const std::size_t pixels = photo.weight.size();
  out.falloff.assign(pixels, 0);
  for (Image& image : out.by) image = Image(photo.scene.grid->width(), photo.scene.grid->height(), 1);
  using SpotJet = ceres::Jet<double, 6>;
  const std::array<double, 6> placed = placed_spot(x);
  std::array<SpotJet, 6> spot;
  for (int k = 0; k < 6; ++k) spot[k] = SpotJet(placed[k], k);
  for (std::size_t i = 0; i < pixels; ++i) {
    const Eigen::Vector3d& p = photo.scene.grid->center_mm[i];
    if (!std::isfinite(p.x())) continue;
    const SpotJet log_f = log_falloff(spot, p);
    out.falloff[i] = static_cast<float>(std::exp(log_f.a));
    for (int k = 0; k < 6; ++k)
      out.by[k].data[i] = rendered.radiance.data[i] * out.falloff[i] * static_cast<float>(log_f.v[k]);
  }
  multiply(rendered.radiance, out.falloff);
  for (Image& image : rendered.d_radiance) multiply(image, out.falloff);
  return out;
}

// From the renderer's derivatives by the axis (3) and the exponent, for an axis from the lamp to its aim: axis = (aim -
// position) / |aim - position|.
SpotSlopes spot_of_area(const Unknowns& x, const Image* by_axis) {
  const Eigen::Vector3d to_aim =
      Eigen::Vector3d(x[unknown::spot], x[unknown::spot + 1], 0) - x.segment<3>(unknown::lamp_position);
  const Eigen::Vector3d axis = to_aim.normalized();
  const Eigen::Matrix3d by_aim = (Eigen::Matrix3d::Identity() - axis * axis.transpose()) / to_aim.norm();
  SpotSlopes out;
  out.is_spot = true;
  for (int k = 0; k < 3; ++k)
    for (int row = 0; row < 3; ++row) {
      add_share(by_axis[row], -by_aim(row, k), out.by[k]);
      if (k < 2) add_share(by_axis[row], by_aim(row, k), out.by[3 + k]);
    }
  out.by[5] = by_axis[3];
  return out;
}

Image scaled(Image image, double by) {
  for (float& v : image.data) v *= static_cast<float>(by);
  return image;
}

// Adds an unmodeled light, and its derivatives by all unknowns shared with the lamp.
Image add_stray(const PhotoData& photo, const Unknowns& x, const Carved& carved, const FreeUnknowns& free,
                const Wanted& of_lamp, RadianceDerivatives& rendered) {
  FreeUnknowns shared = free;
  std::fill(shared.begin() + unknown::lamp_position, shared.begin() + unknown::pose, false);
  const Wanted wanted(shared, false);
  RadianceDerivatives stray = light_with_slopes(photo, stray_scene(photo, x), carved, wanted.parameters);
  scene_at(photo, x);
  add_share(stray.radiance, 1, rendered.radiance);
  for (std::size_t i = 0; i < wanted.parameters.size(); ++i) {
    const auto at = std::find(of_lamp.parameters.begin(), of_lamp.parameters.end(), wanted.parameters[i]);
    add_share(stray.d_radiance[i], 1, rendered.d_radiance[static_cast<std::size_t>(at - of_lamp.parameters.begin())]);
  }
  return std::move(stray.radiance);
}

// Collects columns, with the photo's blur.
struct ColumnWriter {
  PhotoSlopes& out;
  const std::vector<float>& kernel;

  bool wants(int at) const { return out.free[at]; }
  void add(int at, const Image& image) {
    if (wants(at)) add_as_seen(at, blurred(image, kernel));
  }
  void add_as_seen(int at, Image image) {
    out.index.push_back(at);
    out.columns.push_back(std::move(image));
  }
};

// By depth and by its field over the board, which multiplies the derivative by a common factor of all depths.
void add_depth(const ModelData& model, const PhotoData& photo, const Unknowns& x, const Image& by_depth_um,
               ColumnWriter& columns) {
  const Image by_factor = scaled(by_depth_um, std::exp(x[unknown::log_depth]));
  const auto terms = depth_field_of(x);
  for (int term = 0; unknown::depth_field + term < unknown::depth_wear; ++term) {
    if (!columns.wants(unknown::depth_field + term)) continue;
    Image by_term = by_factor;
    for (std::size_t i = 0; i < by_term.data.size(); ++i) {
      const Eigen::Vector2d p = footprint_middle_mm(*photo.scene.grid, i);
      if (!std::isfinite(p.x())) continue;
      const double u = p.x() / model.board->size_mm.x(), v = p.y() / model.board->size_mm.y();
      by_term.data[i] *= static_cast<float>(field_terms_at(u, v)[term] / field_over_board(terms, u, v));
    }
    columns.add(unknown::depth_field + term, by_term);
  }
  columns.add(unknown::log_depth, by_factor);
}

// By one more rendering, for unknowns without a derivative in the renderer. An example is wear, which depends on the
// carving order.
void add_by_difference(int at, const PhotoData& photo, const Unknowns& x, const Image& light,
                       const CarvedStates& grooves, ColumnWriter& columns) {
  if (!columns.wants(at)) return;
  const double step = difference_step(at, x[at]);
  Unknowns moved = x;
  moved[at] += step;
  Image change = light_for_slope(photo, moved, scene_at(photo, moved), *grooves.at(moved));
  scene_at(photo, x);
  for (std::size_t i = 0; i < change.data.size(); ++i)
    change.data[i] = (change.data[i] - light.data[i]) / static_cast<float>(step);
  columns.add(at, change);
}

// By the numbers of an unmodeled light, whose own `light` it is. Position and size by finite differences.
void add_stray_slopes(const PhotoData& photo, const Unknowns& x, const Carved& carved, const Image& light,
                      ColumnWriter& columns) {
  for (int at = unknown::stray; at < unknown::stray + kStrayNumbers; ++at) {
    if (!columns.wants(at)) continue;
    if (at == unknown::stray_light) {
      columns.add(at, scaled(light, 1 / x[unknown::stray_light]));
      continue;
    }
    const double step = difference_step(at, x[at]);
    Unknowns moved = x;
    moved[at] += step;
    Image change = light_by_few(photo, stray_scene(photo, moved), carved);
    for (std::size_t i = 0; i < change.data.size(); ++i)
      change.data[i] = (change.data[i] - light.data[i]) / static_cast<float>(step);
    columns.add(at, change);
  }
  scene_at(photo, x);
}

// By the difference of a lamp's sides, with central differences. For a disk, which no panel equals, they cancel the
// difference between disk and panels.
void add_sides(const PhotoData& photo, const Unknowns& x, const Carved& carved, ColumnWriter& columns) {
  for (int at = unknown::sides2; at < unknown::sides2 + 2; ++at) {
    if (!columns.wants(at)) continue;
    const double step = 0.1 * std::max(x[unknown::size2], 1e-3);
    const auto light_at = [&](double by) {
      Unknowns moved = x;
      moved[at] += by;
      return light_for_slope(photo, moved, scene_at(photo, moved), carved);
    };
    Image change = light_at(step);
    const Image below = light_at(-step);
    scene_at(photo, x);
    for (std::size_t i = 0; i < change.data.size(); ++i)
      change.data[i] = (change.data[i] - below.data[i]) / static_cast<float>(2 * step);
    columns.add(at, change);
  }
}

// For grooves with the paper's profile, tests flanks of x[flank] degrees as a whole: the prediction with them less the
// one without, for effect_choice.h.
void add_flanks(const PhotoData& photo, const Unknowns& x, const Carved& carved, const Image& light,
                ColumnWriter& columns) {
  if (!columns.wants(unknown::flank)) return;
  scene_at(photo, x);
  photo.scene.material.profile.kind = GrooveProfile::Kind::rounded_v;
  Image change = light_for_slope(photo, x, photo.scene, carved);
  scene_at(photo, x);
  for (std::size_t i = 0; i < change.data.size(); ++i) change.data[i] -= light.data[i];
  columns.add(unknown::flank, change);
}

// The renderer moves the carved ends q: dq = M q + m. Here q = c + A (p - c) + t, so dq = dA A^-1 (q - c - t) + dt.
void add_machine(const ModelData& model, const Unknowns& x, const Image* by_machine, ColumnWriter& columns) {
  const MachineMap map = machine_map(x);
  const Eigen::Matrix2d A_inverse = map.A.inverse();
  const Eigen::Vector2d fixed = model.center_mm + map.shift_mm;
  for (int row = 0; row < 2; ++row) {
    const Image* by_row = by_machine + static_cast<std::ptrdiff_t>(3) * row;  // m00 m01 m02, or m10 m11 m12
    for (int column = 0; column < 2; ++column) {
      const int at = machine_index(row, column);
      if (!columns.wants(at)) continue;
      const Eigen::RowVector2d M = A_inverse.row(column);  // dA = e_row e_column^T
      const double m = -(M * fixed)(0);
      Image image(by_row->width, by_row->height, 1);
      for (std::size_t i = 0; i < image.data.size(); ++i)
        image.data[i] = static_cast<float>(M[0] * by_row[0].data[i] + M[1] * by_row[1].data[i] + m * by_row[2].data[i]);
      columns.add(at, image);
    }
    columns.add(machine_index(row, 2), by_row[2]);
  }
}

// By the blur's logarithm: by finite differences, or from correct_binning().
void add_blur(const PhotoData& photo, const Unknowns& x, const Image& total, ColumnWriter& columns) {
  if (!columns.wants(unknown::log_blur)) return;
  Image slope(total.width, total.height, 1);
  if (photo.correction.empty()) {
    constexpr double kStep = 0.02;
    const double sigma = blur_sigma_px(photo, x);
    slope = blurred(total, blur_taps(sigma * (1 + kStep), photo.bin));
    const Image narrower = blurred(total, blur_taps(sigma * (1 - kStep), photo.bin));
    for (std::size_t i = 0; i < slope.data.size(); ++i)
      slope.data[i] = (slope.data[i] - narrower.data[i]) / static_cast<float>(2 * kStep);
  } else {
    for (std::size_t i = 0; i < slope.data.size(); ++i)
      slope.data[i] = photo.blur_slope[i] / static_cast<float>(vignette_of(photo, x, i));
  }
  columns.add_as_seen(unknown::log_blur, std::move(slope));
}

}  // namespace

PhotoSlopes photo_slopes(const ModelData& model, const PhotoData& photo, const Unknowns& x, const Carved& carved,
                         const CarvedStates& grooves, const FreeUnknowns& free) {
  const ViewScene& scene = scene_at(photo, x);
  const bool area_spot = has_area(photo, x) && x[unknown::spot + 2] > 0;
  const Wanted wanted(free, area_spot);
  RadianceDerivatives rendered = light_with_slopes(photo, scene, carved, wanted.parameters);
  SpotSlopes spot = area_spot && wanted.spot >= 0 ? spot_of_area(x, &rendered.d_radiance[wanted.spot])
                    : area_spot                   ? SpotSlopes{}
                                                  : apply_spot(photo, x, rendered);
  const Image of_lamp = rendered.radiance,
              of_stray = has_stray(x) ? add_stray(photo, x, carved, free, wanted, rendered) : Image();
  const std::vector<float> kernel = blur_taps(blur_sigma_px(photo, x), photo.bin);
  const Image light = std::move(rendered.radiance), total = with_ambient(model, photo, x, light);
  std::optional<Image> whole_lamp;
  if (by_more_points(scene.light) || (has_stray(x) && by_more_points(stray_light(x, photo.camera.surface.size_mm))))
    whole_lamp = rendered_light(photo, x, carved, spot.falloff);
  std::vector<Image>& by = rendered.d_radiance;

  PhotoSlopes out;
  out.at = x;
  out.free = free;
  ColumnWriter columns{out, kernel};
  if (wanted.alpha >= 0) columns.add(unknown::log_alpha, scaled(by[wanted.alpha], scene.material.alpha));
  if (wanted.depth >= 0) add_depth(model, photo, x, by[wanted.depth], columns);
  add_by_difference(unknown::size2, photo, x, light, grooves, columns);
  add_sides(photo, x, carved, columns);
  add_by_difference(unknown::depth_wear, photo, x, light, grooves, columns);
  if (wanted.base >= 0) columns.add(unknown::log_base_alpha, scaled(by[wanted.base], scene.material.base_alpha));
  for (int k = 0; k < 2 && wanted.grain >= 0; ++k) columns.add(unknown::grain + k, by[wanted.grain + k]);
  const bool flanks_as_a_whole = model.profile.kind == GrooveProfile::Kind::paper;
  if (flanks_as_a_whole) add_flanks(photo, x, carved, light, columns);
  for (int at = unknown::backlash; at <= unknown::log_across; ++at) {
    if (at == unknown::grain || at == unknown::grain + 1 || (at == unknown::flank && flanks_as_a_whole)) continue;
    add_by_difference(at, photo, x, light, grooves, columns);
  }
  for (int k = 0; k < 3 && wanted.lamp >= 0; ++k) {
    Image image = std::move(by[wanted.lamp + k]);
    if (spot.is_spot)
      for (std::size_t i = 0; i < image.data.size(); ++i) image.data[i] += spot.by[k].data[i];
    columns.add(unknown::lamp_position + k, image);
  }
  for (int k = 0; k < 3 && spot.is_spot; ++k) columns.add(unknown::spot + k, spot.by[3 + k]);
  columns.add(unknown::log_intensity, of_lamp);
  if (has_stray(x)) add_stray_slopes(photo, x, carved, of_stray, columns);
  if (photo.surroundings != nullptr) columns.add(unknown::ambient, photo.around);
  if (wanted.machine >= 0) add_machine(model, x, &by[wanted.machine], columns);
  if (wanted.pose >= 0) {
    // Before the poses' own columns move these derivatives away.
    const auto lens_free = free.begin() + unknown::lens;
    if (std::any_of(lens_free, lens_free + kMostLensParameters, [](bool f) { return f; })) {
      std::vector<Image> by_lens = lens_slopes(photo, by[wanted.pose], by[wanted.pose + 1]);
      for (std::size_t k = 0; k < by_lens.size(); ++k) columns.add(unknown::lens + static_cast<int>(k), by_lens[k]);
    }
    for (int k = 0; k < 6; ++k) columns.add(unknown::pose + k, by[wanted.pose + k]);
  }
  for (int k = 0; k < 3 && wanted.bow >= 0; ++k) columns.add(unknown::bow + k, by[wanted.bow + k]);
  add_blur(photo, x, total, columns);
  out.light = blurred(whole_lamp ? with_ambient(model, photo, x, *whole_lamp) : total, kernel);
  return out;
}

bool slopes_hold(const ModelData& model, const PhotoData& photo, const PhotoSlopes& slopes, const Unknowns& x,
                 const Image& light) {
  const Unknowns step = x - slopes.at;
  double missed = 0, changed = 0;
  for (std::size_t i = 0; i < light.data.size(); ++i) {
    if (!(photo.weight[i] > 0)) continue;
    double foretold = photo.surroundings == nullptr ? model.f0 * step[unknown::ambient] : 0;
    for (std::size_t k = 0; k < slopes.columns.size(); ++k) {
      const bool of_the_light = slopes.index[k] != unknown::log_blur || photo.correction.empty();
      if (of_the_light) foretold += step[slopes.index[k]] * slopes.columns[k].data[i];
    }
    const double change = static_cast<double>(light.data[i]) - slopes.light.data[i];
    const double scale = photo.weight[i] * vignette_of(photo, x, i);
    missed += std::pow(scale * (change - foretold), 2);
    changed += std::pow(scale * change, 2);
  }
  constexpr double kTenth = 0.1;
  return changed < 1 || missed < kTenth * kTenth * changed;
}

PhotoEquations photo_equations(const ModelData& model, const PhotoData& photo, const Unknowns& x,
                               const CarvedStates& grooves, const FreeUnknowns& free, const CellGrid* tiles) {
  const PhotoSlopes slopes = photo_slopes(model, photo, x, *grooves.at(x), grooves, free);
  return photo_equations(model, photo, x, slopes.light, slopes, tiles);
}

PhotoEquations photo_equations(const ModelData& model, const PhotoData& photo, const Unknowns& x, const Image& light,
                               const PhotoSlopes& slopes, const CellGrid* tiles) {
  const FreeUnknowns& free = slopes.free;
  const std::vector<Image>& columns = slopes.columns;
  const std::size_t rendered_columns = columns.size();
  const int width = photo.scene.grid->width(), height = photo.scene.grid->height();
  std::vector<int> index = slopes.index;
  const bool even = free[unknown::ambient] && photo.surroundings == nullptr;
  if (even) index.push_back(unknown::ambient);
  for (int k = 0; k < 3; ++k)
    if (free[unknown::vignette + k]) index.push_back(unknown::vignette + k);
  const bool glares = free[unknown::glare_share] && !photo.photo.scattered.data.empty();
  if (glares) index.push_back(unknown::glare_share);

  PhotoEquations out;
  const auto n = static_cast<Eigen::Index>(index.size());
  Eigen::MatrixXd JtJ = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd Jtr = Eigen::VectorXd::Zero(n);
  Eigen::MatrixXd tile_scores = Eigen::MatrixXd::Zero(n, tiles ? static_cast<Eigen::Index>(tiles->cells()) : 0);
  Eigen::MatrixXd rows(n, width);  // one row of the photo at a time: one column per pixel
  Eigen::VectorXd r(width), to_noise(width), to_curvature(width);
  Eigen::MatrixXd noise_JtJ = Eigen::MatrixXd::Zero(n, n), curvature_JtJ = noise_JtJ, other_rows;
  for (int y = 0; y < height; ++y) {
    Eigen::Index used = 0;
    for (int px = 0; px < width; ++px) {
      const std::size_t i = static_cast<std::size_t>(y) * width + px;
      if (!(photo.weight[i] > 0)) continue;
      const PixelSeen seen = pixel_seen(photo, x, i, light);
      const double residual = residual_at(photo, i, seen);
      const Loss loss = cauchy_loss(residual * residual, model.cauchy);
      out.cost += 0.5 * loss.rho;
      const double root = std::sqrt(loss.weight), scale = root * photo.weight[i] * seen.factor;
      r[used] = root * residual;
      std::size_t k = 0;
      for (; k < rendered_columns; ++k) rows(static_cast<Eigen::Index>(k), used) = scale * columns[k].data[i];
      auto row = static_cast<Eigen::Index>(k);
      if (even) rows(row++, used) = scale * model.f0;
      double radius_power = photo.radius2[i];
      for (int v = 0; v < 3; ++v, radius_power *= photo.radius2[i])
        if (free[unknown::vignette + v])
          rows(row++, used) = (1 - x[unknown::glare_share]) * root * photo.weight[i] * radius_power * light.data[i];
      if (glares) rows(row++, used) = root * photo.weight[i] * seen.by_glare;
      if (tiles) {
        to_noise[used] = 1 / (root * photo.weight[i] * photo.photo.sigma.data[i]);
        to_curvature[used] = std::sqrt(loss.curvature / loss.weight);
        const Eigen::Vector2d p = footprint_middle_mm(*photo.scene.grid, i);
        const std::size_t tile = tiles->cell(tiles->column(p.x()), tiles->row(p.y()));
        tile_scores.col(static_cast<Eigen::Index>(tile)) += r[used] * rows.col(used);
      }
      ++used;
    }
    if (used == 0) continue;
    JtJ.selfadjointView<Eigen::Lower>().rankUpdate(rows.leftCols(used));
    Jtr.noalias() += rows.leftCols(used) * r.head(used);
    if (tiles) {
      other_rows = rows.leftCols(used) * to_noise.head(used).asDiagonal();
      noise_JtJ.selfadjointView<Eigen::Lower>().rankUpdate(other_rows);
      other_rows = rows.leftCols(used) * to_curvature.head(used).asDiagonal();
      curvature_JtJ.selfadjointView<Eigen::Lower>().rankUpdate(other_rows);
    }
  }
  noise_JtJ.triangularView<Eigen::StrictlyUpper>() = noise_JtJ.transpose();
  curvature_JtJ.triangularView<Eigen::StrictlyUpper>() = curvature_JtJ.transpose();
  JtJ.triangularView<Eigen::StrictlyUpper>() = JtJ.transpose();

  out.JtJ = Eigen::MatrixXd::Zero(unknown::count, unknown::count);
  out.Jtr = Eigen::VectorXd::Zero(unknown::count);
  if (tiles) {
    out.tile_scores = Eigen::MatrixXd::Zero(unknown::count, tile_scores.cols());
    out.noise_JtJ = Eigen::MatrixXd::Zero(unknown::count, unknown::count);
    out.curvature_JtJ = Eigen::MatrixXd::Zero(unknown::count, unknown::count);
  }
  for (Eigen::Index a = 0; a < n; ++a) {
    out.Jtr[index[a]] = Jtr[a];
    if (tiles) out.tile_scores.row(index[a]) = tile_scores.row(a);
    for (Eigen::Index b = 0; b < n; ++b) {
      out.JtJ(index[a], index[b]) = JtJ(a, b);
      if (tiles) {
        out.noise_JtJ(index[a], index[b]) = noise_JtJ(a, b);
        out.curvature_JtJ(index[a], index[b]) = curvature_JtJ(a, b);
      }
    }
  }
  return out;
}

}  // namespace burin

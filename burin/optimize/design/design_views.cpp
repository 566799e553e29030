#include "burin/optimize/design/design_views.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <numeric>
#include <utility>

#include "burin/optimize/design/curved_views.h"
#include "burin/optimize/design/direction_light.h"
#include "burin/optimize/design/glint.h"
#include "burin/optimize/design/to_metal.h"
#include "burin/optimize/loss/picture_metrics.h"
#include "burin/render/error.h"
#include "burin/render/files/input_file.h"
#include "burin/render/groove.h"
#include "burin/render/keep_out.h"
#include "burin/render/limits.h"

namespace burin {
namespace {

std::pair<int, int> grid_size(const Board& board, int pixels) {
  const Eigen::Vector2d area = board.carve_max_mm - board.carve_min_mm;
  const double longer = area.maxCoeff();
  return {std::max(1, static_cast<int>(std::lround(pixels * area.x() / longer))),
          std::max(1, static_cast<int>(std::lround(pixels * area.y() / longer)))};
}

// 1 where a groove's middle may lie, 0 on keep-outs and tags; no pixels if all is free.
Image carvable(const CarvingLimits& limits, double clearance_mm, int width, int height) {
  Image mask;
  for (const KeepOut& place : limits.keep_out)
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const Eigen::Vector2d p(limits.min_mm.x() + (x + 0.5) / width * (limits.max_mm.x() - limits.min_mm.x()),
                                limits.max_mm.y() - (y + 0.5) / height * (limits.max_mm.y() - limits.min_mm.y()));
        if (distance_mm(p, place) >= clearance_mm) continue;
        if (mask.data.empty()) mask = Image(width, height, 1, 1.0F);
        mask.at(x, y) = 0;
      }
  return mask;
}

// The mean over its views of what `of` says of each, a group; `groups` in all.
template <typename Of>
std::vector<double> means_of_groups(const std::vector<WorkView>& views, std::size_t groups, const Of& of) {
  std::vector<double> sum(groups, 0.0), members(groups, 0.0);
  for (const WorkView& v : views) {
    sum[v.exposure_group] += of(v);
    members[v.exposure_group] += 1;
  }
  for (std::size_t g = 0; g < groups; ++g) sum[g] /= members[g];
  return sum;
}

// Gives views that are not seen under one lamp the field that a search rests on, and says what pictures can hope for.
void measure_lights(std::vector<WorkView>& views, const Board& board, const Bench& bench,
                    std::vector<Finding>& findings) {
  std::vector<MeasuredView> measured;
  const bool any = std::any_of(views.begin(), views.end(),
                               [&](const WorkView& v) { return !find_light(bench, v.spec.light, "design").is_lamp(); });
  if (!any) return;
  for (WorkView& v : views) {
    MeasuredView one{v.spec.view, v.spec.light,
                     measure_directions(v.renderer, board.carve_min_mm, board.carve_max_mm, bench.material.alpha,
                                        [&](const Scratches& tests) {
                                          return Metal{bench, board}.carved_alone(tests);
                                        })};
    if (!find_light(bench, v.spec.light, "design").is_lamp())
      v.glint.field = std::make_shared<const GlintField>(one.directions.field);
    if (v.share == 1 || measured.size() <= v.of) measured.push_back(std::move(one));
  }
  append(findings, check_directions(measured));
}

std::string percent_text(double share) {
  const std::string text = std::to_string(std::round(1000 * share) / 10);
  return text.substr(0, text.find('.') + 2);
}

}  // namespace

double mean_light(const Image& encoded) {
  double sum = 0;
  for (const float v : encoded.data) sum += std::pow(static_cast<double>(v), 2.2);
  return sum / static_cast<double>(encoded.data.size());
}

double mean_value(const Image& image) {
  double sum = 0;
  for (const float v : image.data) sum += v;
  return sum / static_cast<double>(image.data.size());
}

std::shared_ptr<const FootprintGrid> design_grid(const Board& board, const Bench& bench, int pixels) {
  const auto [width, height] = grid_size(board, pixels);
  return share(board_grid(board.carve_min_mm, board.carve_max_mm, width, height, face_of(board, bench)));
}

ViewScene design_scene(const DesignSpec& spec, std::size_t index, const Board& board, const Bench& bench,
                       std::shared_ptr<const FootprintGrid> grid, const Eigen::Vector3d& eye_moved_mm,
                       const Eigen::Vector3d& lamp_moved_mm) {
  const DesignView& v = spec.views[index];
  ViewScene scene;
  scene.grid = std::move(grid);
  scene.camera_center_mm = glint_of(v, bench).camera_mm + eye_moved_mm;
  scene.light = find_light(bench, v.light, "design");
  scene.light.position_mm += lamp_moved_mm;
  scene.material = bench.material;
  scene.tool_width_um = board.tool_width_um;
  scene.ambient = bench.ambient;
  if (const auto face = curved_face(board, bench))
    scene.hidden_from_light = hidden_on_the_way(*scene.grid, *face, scene.camera_center_mm, scene.light.position_mm);
  return scene;
}

std::vector<WorkView> prepare_views(const DesignSpec& spec, const Board& board, const Bench& bench,
                                    const DesignOptions& options, const CarvingLimits& limits,
                                    std::vector<Finding>& findings) {
  const Eigen::Vector2d area = board.carve_max_mm - board.carve_min_mm;
  const Eigen::Vector2d middle = (board.carve_min_mm + board.carve_max_mm) / 2;
  const auto [width, height] = grid_size(board, options.pixels);
  const double pixels = 1.0 * width * height * static_cast<double>(spec.views.size());
  if (pixels > static_cast<double>(limit::kDesignPixels))
    fail("design",
         std::to_string(spec.views.size()) + " views of " + std::to_string(width) + " x " + std::to_string(height) +
             " pixels are more than the " + with_commas(limit::kDesignPixels) + " that a design takes in all",
         "ask for fewer with --pixels, or for fewer views (docs/limits.md)");
  std::vector<GlintView> glints;
  const std::shared_ptr<const BoardFace> curved = curved_face(board, bench);
  const std::shared_ptr<const FootprintGrid> grid = design_grid(board, bench, options.pixels);
  if (curved) append(findings, check_stretch(*curved, board.mesh.string()));
  for (const DesignView& v : spec.views) {
    glints.push_back(glint_of(v, bench));
    glints.back().face = curved;
    if (curved) append(findings, check_seen(v.view, *grid, *curved, glints.back().camera_mm, glints.back().light_mm));
  }
  // Before any picture is loaded: a bench that cannot work is the first thing to know.
  const auto groove_at = [&](const Eigen::Vector2d& p_mm) {
    return GrooveShape{at_place(bench.depth_field, bench.material.depth_um, board.size_mm, p_mm),
                       std::min(1.0, at_place(bench.alpha_field, bench.material.alpha, board.size_mm, p_mm)),
                       bench.material.profile};
  };
  std::vector<GlintView> of_lamps;  // what other lights do is measured below
  for (std::size_t k = 0; k < glints.size(); ++k)
    if (find_light(bench, spec.views[k].light, "design").is_lamp()) of_lamps.push_back(glints[k]);
  append(findings, check_glints(of_lamps, board.carve_min_mm, board.carve_max_mm, board.tool_width_um, groove_at));
  const Image free =
      carvable(limits, 1e-3 * half_width_um(bench.material.profile, board.tool_width_um, bench.material.depth_um),
               width, height);
  if (!free.data.empty())
    findings.push_back(
        make_warning(percent_text(1 - mean_value(free)) +
                     " % of the carve area lie under keep-outs or tags: nothing is carved there, and the pictures "
                     "are not compared there"));
  std::vector<WorkView> views;
  const std::shared_ptr<RenderWorkspace> workspace =
      make_render_workspace();  // one view's memory: they are worked on in turn
  std::map<std::string, int> groups;
  const std::vector<double> sides = options.tolerance_mm > 0 ? std::vector<double>{0, 1, -1} : std::vector<double>{0};
  for (const double side : sides)
    for (std::size_t k = 0; k < spec.views.size(); ++k) {
      const DesignView& v = spec.views[k];
      Target target;
      double rotation = 0;
      if (side == 0) {
        rotation = v.target.upright_in_view ? viewer_rotation_deg(find_view(bench, v.view, "design"), middle)
                                            : v.target.rotation_deg;
        target = load_target(v.target, rotation, area, width, height);
        append(findings, target.findings);
        const Image seen = curved ? seen_from(*grid, *curved, glints[k].camera_mm) : Image{};
        for (const Image* part : {&free, &seen}) {
          if (part->data.empty()) continue;
          if (target.mask.data.empty()) target.mask = Image(width, height, 1, 1.0F);
          for (std::size_t i = 0; i < part->data.size(); ++i) target.mask.data[i] *= part->data[i];
        }
      } else {
        rotation = views[k].rotation_deg;
        target = views[k].target;
      }
      const double along = lean_at(glints[k], {middle.x(), middle.y(), 0}).scratch_direction();
      const Eigen::Vector3d moved =
          side * options.tolerance_mm / std::numbers::sqrt2 * Eigen::Vector3d(std::cos(along), std::sin(along), 0);
      GlintView glint = glints[k];
      glint.camera_mm += moved;
      glint.light_mm += moved;
      const std::string group = options.exposure_of == ExposureOf::light ? v.light : v.view + " under " + v.light;
      const int index = groups.emplace(group, static_cast<int>(groups.size())).first->second;
      const double share = 1 / static_cast<double>(sides.size());
      LossWeights weights = options.loss;
      weights.perceptual *= v.weight * share;
      weights.l2 *= v.weight * share;
      weights.gram *= v.weight * share;
      PictureLoss loss(with_gamma_offset(target.picture), target.mask, weights);
      RenderOptions render;
      // Where depth or roughness vary over the board, a scratch's place moves them.
      render.material_gradients = options.optimize_width || options.optimize_depth || options.optimize_alpha ||
                                  !bench.depth_field.is_constant() || !bench.alpha_field.is_constant();
      views.push_back({v, std::move(glint), std::move(target), rotation, index, area.x() / width, k, share,
                       ViewRenderer(design_scene(spec, k, board, bench, grid, moved, moved), render, workspace),
                       std::move(loss)});
    }
  measure_lights(views, board, bench, findings);
  for (WorkView& v : views) {
    v.renderer.forward({}, v.face);
    v.unit = measure_units(v.renderer, v.glint, board.carve_min_mm, board.carve_max_mm, [&](const Scratches& tests) {
      return Metal{bench, board}.carved_alone(tests);
    });
  }
  return views;
}

std::vector<StrokeView> stroke_views(const std::vector<WorkView>& views, const std::vector<double>& log_exposure,
                                     bool from_face) {
  std::vector<StrokeView> out;
  for (const WorkView& v : views) {
    const auto e = static_cast<float>(std::exp(log_exposure[v.exposure_group]));
    Image light = from_face ? v.face : v.radiance, unit = v.unit;
    for (float& l : light.data) l *= e;
    for (float& u : unit.data) u *= e * static_cast<float>(v.pitch_mm);
    const double weight = v.spec.weight * v.share * v.balance;
    if (v.of < out.size())
      out[v.of].asides.push_back({v.glint, std::move(light), std::move(unit), weight});
    else
      out.push_back({v.glint, std::move(light), v.target.picture, v.target.mask, std::move(unit), weight, {}});
  }
  return out;
}

std::vector<double> fitting_exposures(const std::vector<WorkView>& views, const std::vector<double>& log_exposure) {
  return means_of_groups(views, log_exposure.size(), [&](const WorkView& v) {
    return std::log(
        best_exposure(v.radiance, v.target.picture, std::exp(log_exposure[v.exposure_group]), v.target.mask));
  });
}

std::vector<double> starting_exposures(const std::vector<WorkView>& views, std::size_t groups, double start_light) {
  std::vector<double> crossing =
      means_of_groups(views, groups, [](const WorkView& v) { return std::log(mean_value(v.unit) * v.pitch_mm); });
  for (double& c : crossing) c = std::log(start_light) - c;
  return crossing;
}

void balance_views(std::vector<WorkView>& views, const std::vector<double>& log_exposure, double exponent) {
  constexpr double kMost = 8;  // no view is given up for another
  for (WorkView& v : views) v.balance = 1;
  if (exponent == 0) return;
  const std::vector<StrokeView> seen = stroke_views(views, log_exposure, false);
  std::vector<double> log_error;
  log_error.reserve(seen.size());
  for (const StrokeView& v : seen) log_error.push_back(std::log(std::max(squared_error(v), 1e-12)));
  const double mean = std::accumulate(log_error.begin(), log_error.end(), 0.0) / static_cast<double>(log_error.size());
  for (WorkView& v : views) v.balance = std::clamp(std::exp(exponent * (log_error[v.of] - mean)), 1 / kMost, kMost);
}

void render_all(std::vector<WorkView>& views, const Carved& carved) {
  for (WorkView& v : views) v.renderer.forward(carved, v.radiance);
}

}  // namespace burin

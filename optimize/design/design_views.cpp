#include "burin/optimize/design/design_views.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <numeric>
#include <set>
#include <utility>

#include "burin/base/error.h"
#include "burin/base/files/input_file.h"
#include "burin/base/limits.h"
#include "burin/optimize/design/curved_views.h"
#include "burin/optimize/design/direction_light.h"
#include "burin/optimize/design/glint.h"
#include "burin/optimize/design/glint_check.h"
#include "burin/optimize/design/lamp_places.h"
#include "burin/optimize/design/to_metal.h"
#include "burin/optimize/loss/color_metrics.h"
#include "burin/optimize/loss/picture_metrics.h"
#include "burin/optimize/toolpath/ends.h"
#include "burin/scene/bench_of_board.h"
#include "burin/scene/groove.h"
#include "burin/scene/keep_out.h"

namespace burin {
namespace {

std::pair<int, int> grid_size(const Board& board, int pixels) {
  const Eigen::Vector2d area = board.carve_max_mm - board.carve_min_mm;
  const double longer = area.maxCoeff();
  return {std::max(1, static_cast<int>(std::lround(pixels * area.x() / longer))),
          std::max(1, static_cast<int>(std::lround(pixels * area.y() / longer)))};
}

// 1 at possible pixels of a groove's middle, 0 on keep-outs and tags; no pixels if all is free.
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

// Whether the light is one lamp, whose half vectors need no measurement.
bool is_one_lamp(const WorkView& v, const WorkLamp& lamp, const Bench& bench) {
  return find_lit(bench, lights_served(v.spec)[lamp.light], "design").is_lamp();
}

// The views under one of their lights alone.
class LampRenderers {
 public:
  LampRenderers(const DesignSpec& spec, const Board& board, const Bench& bench,
                std::shared_ptr<const FootprintGrid> grid, const RenderOptions& render,
                std::shared_ptr<RenderWorkspace> workspace)
      : spec_(spec),
        board_(board),
        bench_(bench),
        grid_(std::move(grid)),
        render_(render),
        workspace_(std::move(workspace)) {}

  // The view's own renderer if it has no other light.
  ViewRenderer& under(WorkView& v, const WorkLamp& lamp) {
    if (v.lamps.size() == 1) return v.renderer;
    const Eigen::Vector3d moved = lamp.glint.camera_mm - glint_of(v.spec, bench_).camera_mm;
    alone_.emplace(design_scene(spec_, v.of, board_, bench_, grid_, moved, moved,
                                {v.channel, v.gains[v.channel], lights_served(v.spec)[lamp.light]}),
                   render_, workspace_);
    return *alone_;
  }

 private:
  const DesignSpec& spec_;
  const Board& board_;
  const Bench& bench_;
  std::shared_ptr<const FootprintGrid> grid_;
  RenderOptions render_;
  std::shared_ptr<RenderWorkspace> workspace_;
  std::optional<ViewRenderer> alone_;
};

// Finds the leading channel of each light in a view: the one with the strongest light of a scratch.
void choose_leading(std::vector<WorkView>& views) {
  std::map<std::pair<std::size_t, std::size_t>, std::pair<double, WorkLamp*>> leading;
  for (WorkView& v : views)
    for (WorkLamp& lamp : v.lamps) {
      lamp.leads = false;
      if (v.aside) continue;
      const double mean = mean_value(lamp.unit);
      auto& [most, leader] = leading[std::pair{v.of, lamp.light}];
      if (leader != nullptr && mean <= most) continue;
      most = mean;
      leader = &lamp;
    }
  for (auto& [which, lead] : leading) lead.second->leads = true;
}

// Measures faces, and the light of a scratch of the best direction for every light served. Views under other lights
// than one lamp get the field for the search, and findings about possible pictures. One renderer per light does both,
// because tables of surroundings take seconds to make.
void measure_lights(std::vector<WorkView>& views, LampRenderers& renderers, const Board& board, const Bench& bench,
                    std::vector<Finding>& findings) {
  const auto carve = [&](const Scratches& tests) { return Metal{bench, board}.carved_alone(tests); };
  const bool any = std::any_of(views.begin(), views.end(), [&](const WorkView& v) {
    return std::any_of(v.lamps.begin(), v.lamps.end(), [&](const WorkLamp& l) { return !is_one_lamp(v, l, bench); });
  });
  std::vector<MeasuredView> measured;
  std::set<std::pair<std::size_t, std::size_t>> told;
  for (WorkView& v : views) {
    v.renderer.forward({}, v.face);
    for (WorkLamp& lamp : v.lamps) {
      ViewRenderer& renderer = renderers.under(v, lamp);
      const bool one_lamp = is_one_lamp(v, lamp, bench), first = told.insert({v.of, lamp.light}).second;
      if (any && (first || !one_lamp)) {
        MeasuredView one{
            v.spec.view, lights_served(v.spec)[lamp.light],
            measure_directions(renderer, board.carve_min_mm, board.carve_max_mm, bench.material.alpha, carve),
            v.channels > 1 && one_lamp};
        if (!one_lamp && v.lamps.size() == 1) v.contrast = one.directions.contrast();
        if (!one_lamp) lamp.glint.field = std::make_shared<const GlintField>(one.directions.field);
        if (first) measured.push_back(std::move(one));
      }
      lamp.unit = measure_units(renderer, lamp.glint, board.carve_min_mm, board.carve_max_mm, carve);
    }
  }
  choose_leading(views);
  append(findings, check_directions(measured));
}

// Finds the closest mixable colors for each picture in color.
void mix_colors(std::vector<WorkView>& views, std::vector<Finding>& findings) {
  for (const std::span<WorkView> of : shown_channels(views)) {
    if (of.size() != 3) continue;
    LampColors colors(lights_served(of[0].spec).size(), Eigen::Vector3d::Zero());
    std::vector<const Image*> target;
    bool pure = true;  // every light has one channel
    for (WorkView& v : of) {
      pure = pure && v.lamps.size() == 1;
      target.push_back(&v.target.picture);
      for (const WorkLamp& lamp : v.lamps) colors[lamp.light][v.channel] = mean_value(lamp.unit);
    }
    for (const Eigen::Vector3d& color : colors) pure = pure && color.maxCoeff() == color.sum();
    std::vector<Image> nearest;
    if (pure)
      for (const Image* one : target) nearest.push_back(*one);
    else
      nearest = nearest_mixed(target, colors);
    append(findings, check_colors(of[0].spec, colors, target, of[0].target.mask, nearest));
    for (std::size_t c = 0; c < 3; ++c) of[c].mixable = std::move(nearest[c]);
  }
}

// The pictures of a view on the board's pixels, and their rotation.
struct LaidView {
  double rotation_deg = 0;
  std::vector<Target> targets;
  Eigen::Vector3d gains{1, 1, 1};
};

LaidView lay(const DesignView& v, const Board& board, const Bench& bench, int width, int height) {
  LaidView out;
  const Eigen::Vector2d area = board.carve_max_mm - board.carve_min_mm;
  const Eigen::Vector2d middle = (board.carve_min_mm + board.carve_max_mm) / 2;
  out.rotation_deg = v.target.upright_in_view ? viewer_rotation_deg(find_view(bench, v.view, "design"), middle)
                                              : v.target.rotation_deg;
  if (v.color) {
    out.gains = white_gains(v, board, bench);
    out.targets = load_color_target(v.target, out.rotation_deg, area, width, height);
  } else {
    out.targets.push_back(load_target(v.target, out.rotation_deg, area, width, height));
  }
  return out;
}

// Restricts the mask to the pixels with 1 in `part`.
void restrict_mask(Target& target, const Image& part) {
  if (part.data.empty()) return;
  if (target.mask.data.empty()) target.mask = Image(part.width, part.height, 1, 1.0F);
  for (std::size_t i = 0; i < part.data.size(); ++i) target.mask.data[i] *= part.data[i];
}

// The lights for which a view's scratches are made, without lights that are dark in the channel.
std::vector<WorkLamp> lamps_of(const DesignView& v, const std::vector<GlintView>& glints, int channel,
                               const Eigen::Vector3d& moved, const Bench& bench) {
  std::vector<WorkLamp> out;
  const std::vector<std::string> ids = lights_served(v);
  for (std::size_t l = 0; l < ids.size(); ++l) {
    if (v.color && !(find_light(bench, ids[l], "design").intensity[channel] > 0)) continue;
    out.push_back({l, glints[l], {}, true});
    out.back().glint.camera_mm += moved;
    out.back().glint.light_mm += moved;
  }
  return out;
}

// Light of a target under its mask.
double light_that_matters(const Target& target) {
  double sum = 0;
  for (std::size_t i = 0; i < target.picture.data.size(); ++i)
    sum += (target.mask.data.empty() ? 1.0 : target.mask.data[i]) *
           std::pow(static_cast<double>(target.picture.data[i]), 2.2);
  return sum;
}

// The channel whose picture sets each channel's exposure: its own, or the brightest one's for a (nearly) black channel.
std::vector<int> exposing_channels(const DesignView& v, const std::vector<Target>& targets,
                                   std::vector<Finding>& findings) {
  constexpr double kBlack = 1e-3;
  std::vector<double> light;
  light.reserve(targets.size());
  for (const Target& target : targets) light.push_back(light_that_matters(target));
  const auto brightest = static_cast<int>(std::max_element(light.begin(), light.end()) - light.begin());
  std::vector<int> out;
  for (int c = 0; c < static_cast<int>(targets.size()); ++c) {
    const bool black = v.color && v.white.kind == White::Kind::each &&
                       light[static_cast<std::size_t>(c)] < kBlack * light[static_cast<std::size_t>(brightest)];
    out.push_back(black ? brightest : c);
    if (!black) continue;
    const auto name = [](int channel) { return std::string(kChannelNames[static_cast<std::size_t>(channel)]); };
    findings.push_back({FindingCode::colors_mixed, Finding::Severity::note, "design",
                        "view " + v.view + ": its picture has hardly any " + name(c) +
                            " to set a brightness by; it is shown as bright as " + name(brightest),
                        ""});
  }
  return out;
}

// Throws Error for more pixels than a design can have.
void require_size(const DesignSpec& spec, int width, int height) {
  std::size_t pictures = 0;
  for (const DesignView& v : spec.views) pictures += v.color ? 3 : 1;
  const double pixels = 1.0 * width * height * static_cast<double>(pictures);
  if (pixels > static_cast<double>(limit::kDesignPixels))
    fail("design",
         std::to_string(spec.views.size()) + " views of " + std::to_string(width) + " x " + std::to_string(height) +
             (pictures > spec.views.size() ? " pixels (three times over in color)" : " pixels") +
             " are more than the " + with_commas(limit::kDesignPixels) + " that a design takes in all",
         "ask for fewer with --pixels, or for fewer views (docs/limits.md)");
}

// Shape of a board's grooves at a place.
GrooveShape groove_of(const Board& board, const Bench& bench, const Eigen::Vector2d& p_mm) {
  return {at_place(bench.depth_field, bench.material.depth_um, board.size_mm, p_mm),
          std::min(1.0, at_place(bench.alpha_field, bench.material.alpha, board.size_mm, p_mm)),
          bench.material.profile};
}

// Checks the bench before any picture is loaded: an impossible bench is reported first.
void check_bench(const DesignSpec& spec, const std::vector<std::vector<GlintView>>& glints, const Board& board,
                 const Bench& bench, std::vector<Finding>& findings) {
  for (const DesignView& v : spec.views) fail_unless_sees(find_view(bench, v.view, "design"), board);
  std::vector<GlintView> of_lamps;  // other lights are measured later
  for (std::size_t k = 0; k < glints.size(); ++k)
    for (std::size_t l = 0; l < glints[k].size(); ++l)
      if (find_light(bench, lights_served(spec.views[k])[l], "design").is_lamp()) of_lamps.push_back(glints[k][l]);
  append(findings, check_glints(of_lamps, board.carve_min_mm, board.carve_max_mm, board.tool_width_um,
                                [&](const Eigen::Vector2d& p_mm) { return groove_of(board, bench, p_mm); }));
  append(findings, lamps_in_color(spec, board, bench));
}

// Pixels, options and memory of the views' renderers.
struct Rendering {
  std::shared_ptr<const FootprintGrid> grid;
  RenderOptions render;
  std::shared_ptr<RenderWorkspace> workspace;
};

// The spec's views and their pictures, without measurements. As prepare_views().
std::vector<WorkView> lay_views(const DesignSpec& spec, const Board& board, const Bench& bench,
                                const DesignOptions& options, int pixels, const CarvingLimits& limits,
                                const Rendering& by, std::vector<Finding>& findings);

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
                       const Eigen::Vector3d& lamp_moved_mm, const LightPart& part) {
  const DesignView& v = spec.views[index];
  ViewScene scene = make_scene(bench, board, std::move(grid), glint_of(v, bench).camera_mm + eye_moved_mm, {});
  // In color each lamp makes a picture by itself, and additional lights would count in each of them.
  scene.light = part_of((v.color ? find_light : find_lit)(bench, v.light, "design"), part, scene.ambient);
  scene.light.position_mm += lamp_moved_mm;
  for (Light& beside : scene.light.also) beside.position_mm += lamp_moved_mm;
  if (const auto face = curved_face(board, bench)) {
    const auto hidden_from = [&](const Light& light) {
      return hidden_on_the_way(*scene.grid, *face, scene.camera_center_mm, light.position_mm);
    };
    scene.hidden_from_light = hidden_from(scene.light);
    if (v.color)  // each lamp by itself: a channel is independent of the number of lamps with some of its light
      for (const Light& beside : scene.light.also) {
        const std::vector<std::uint8_t> more = hidden_from(beside);
        scene.hidden_from_light.insert(scene.hidden_from_light.end(), more.begin(), more.end());
      }
  }
  return scene;
}

std::vector<WorkView> prepare_views(const DesignSpec& spec, const Board& board, const Bench& bench,
                                    const DesignOptions& options, int pixels, const CarvingLimits& limits,
                                    std::vector<Finding>& findings) {
  RenderOptions render;
  // If depth or roughness vary over the board, they depend on a scratch's place.
  render.material_gradients = options.optimize_width || options.optimize_depth || options.optimize_alpha ||
                              !bench.depth_field.is_constant() || !bench.alpha_field.is_constant();
  // Memory for one view: they are processed in turn.
  const std::shared_ptr<RenderWorkspace> workspace = make_render_workspace();
  const std::shared_ptr<const FootprintGrid> grid = design_grid(board, bench, pixels);
  std::vector<WorkView> views =
      lay_views(spec, board, bench, options, pixels, limits, {grid, render, workspace}, findings);
  LampRenderers renderers(spec, board, bench, grid, render, workspace);
  measure_lights(views, renderers, board, bench, findings);
  mix_colors(views, findings);
  const Eigen::Vector2d middle = (board.carve_min_mm + board.carve_max_mm) / 2;
  find_ghosts(views, groove_of(board, bench, middle).alpha, middle);
  return views;
}

std::vector<WorkView> views_to_look_at(const DesignSpec& spec, const Board& board, const Bench& bench,
                                       const DesignOptions& options, int pixels, const CarvingLimits& limits) {
  DesignOptions in_place = options;
  in_place.tolerance_mm = 0;
  std::vector<Finding> known;
  return lay_views(spec, board, bench, in_place, pixels, limits,
                   {design_grid(board, bench, pixels), {}, make_render_workspace()}, known);
}

namespace {

std::vector<WorkView> lay_views(const DesignSpec& spec, const Board& board, const Bench& bench,
                                const DesignOptions& options, int pixels, const CarvingLimits& limits,
                                const Rendering& by, std::vector<Finding>& findings) {
  const Eigen::Vector2d area = board.carve_max_mm - board.carve_min_mm;
  const Eigen::Vector2d middle = (board.carve_min_mm + board.carve_max_mm) / 2;
  const auto [width, height] = grid_size(board, pixels);
  require_size(spec, width, height);
  std::vector<std::vector<GlintView>> glints;  // index: view of the spec, then light served
  const std::shared_ptr<const BoardFace> curved = curved_face(board, bench);
  if (curved) append(findings, check_stretch(*curved, board.mesh.string()));
  for (const DesignView& v : spec.views) {
    require_light(v, bench);
    glints.push_back(glints_served(v, bench));
    for (GlintView& glint : glints.back()) {
      glint.face = curved;
      if (curved) append(findings, check_seen(glint.name, *by.grid, *curved, glint.camera_mm, glint.light_mm));
    }
    append(findings, check_gray(v, bench));
  }
  check_bench(spec, glints, board, bench, findings);
  const Image free =
      carvable(limits, 1e-3 * half_width_um(bench.material.profile, board.tool_width_um, bench.material.depth_um),
               width, height);
  if (!free.data.empty())
    findings.push_back(
        make_warning(FindingCode::area_covered,
                     percent_text(1 - mean_value(free)) +
                         " % of the carve area lie under keep-outs or tags: nothing is carved there, and the pictures "
                         "are not compared there"));
  std::vector<LaidView> laid;
  for (std::size_t k = 0; k < spec.views.size(); ++k) {
    laid.push_back(lay(spec.views[k], board, bench, width, height));
    append(findings, laid.back().targets.front().findings);
    const Image seen = curved ? seen_from(*by.grid, *curved, glints[k].front().camera_mm) : Image{};
    for (Target& target : laid.back().targets)
      for (const Image* part : {&free, &seen}) restrict_mask(target, *part);
  }
  std::vector<WorkView> views;
  std::vector<std::vector<int>> exposed_by;
  for (std::size_t k = 0; k < spec.views.size(); ++k)
    exposed_by.push_back(exposing_channels(spec.views[k], laid[k].targets, findings));
  std::map<std::string, int> groups;
  const std::vector<double> sides = options.tolerance_mm > 0 ? std::vector<double>{0, 1, -1} : std::vector<double>{0};
  for (const double side : sides)
    for (std::size_t k = 0; k < spec.views.size(); ++k) {
      const DesignView& v = spec.views[k];
      const auto channels = static_cast<int>(laid[k].targets.size());
      const double along = lean_at(glints[k].front(), {middle.x(), middle.y(), 0}).scratch_direction();
      const Eigen::Vector3d moved =
          side * options.tolerance_mm / std::numbers::sqrt2 * Eigen::Vector3d(std::cos(along), std::sin(along), 0);
      const double share = 1 / static_cast<double>(sides.size() * laid[k].targets.size());
      const LossWeights weights = times(v.weight * share, options.loss);
      for (int c = 0; c < channels; ++c) {
        std::string group = options.exposure_of == ExposureOf::light ? v.light : v.view + " under " + v.light;
        if (v.color && v.white.kind == White::Kind::each)
          group +=
              std::string(" in ") + kChannelNames[static_cast<std::size_t>(exposed_by[k][static_cast<std::size_t>(c)])];
        const int index = groups.emplace(group, static_cast<int>(groups.size())).first->second;
        for (const WorkView& other : views)
          if (other.exposure_group == index && other.spec.exposure != v.exposure)
            fail("view " + v.view, "has another exposure than view " + other.spec.view + " under the same light",
                 "give both one \"exposure\", or each view its own (--exposure-of view)");
        const Target& target = laid[k].targets[static_cast<std::size_t>(c)];
        const LightPart part{v.color ? c : -1, laid[k].gains[c], ""};
        WorkView view{
            v,
            lamps_of(v, glints[k], c, moved, bench),
            target,
            laid[k].rotation_deg,
            index,
            area.x() / width,
            k,
            share,
            c,
            channels,
            side != 0,
            exposed_by[k][static_cast<std::size_t>(c)],
            ViewRenderer(design_scene(spec, k, board, bench, by.grid, moved, moved, part), by.render, by.workspace),
            PictureLoss(with_gamma_offset(target.picture), target.mask, weights)};
        view.gains = laid[k].gains;
        views.push_back(std::move(view));
      }
    }
  return views;
}

}  // namespace

std::vector<std::span<WorkView>> shown_channels(std::vector<WorkView>& views) {
  std::vector<std::span<WorkView>> out;
  for (std::size_t i = 0; i < views.size() && !views[i].aside; i += static_cast<std::size_t>(views[i].channels))
    out.emplace_back(&views[i], static_cast<std::size_t>(views[i].channels));
  return out;
}

LyingGrooves grooves_in(const Scratches& designed, const Metal& metal, const std::vector<WorkView>& views) {
  if (metal.bench.crossings != Crossings::deepest) return metal.carved(designed);
  LyingGrooves out(carve(Designed(designed), adding_rims(metal.bench), metal.board));
  out.cuts.emplace(out.whole.scratches, metal.bench, metal.board);
  if (!std::all_of(views.begin(), views.end(), [](const WorkView& v) { return v.sees_lines; }))
    out.in_steps = metal.carved(designed);
  return out;
}

Carved seen_by(const WorkView& view, const LyingGrooves& grooves, std::span<const std::size_t> rows) {
  if (!grooves.cuts) {
    Carved out;
    out.scratches = selected(grooves.whole.scratches, rows);
    return out;
  }
  // The lamp for which a groove glints most.
  std::vector<const GlintView*> glints(rows.size(), &view.lamps.front().glint);
  if (view.lamps.size() > 1)
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const Ends e = ends_of(grooves.whole.scratches, rows[k]);
      const Eigen::Vector2d middle = (e.a + e.b) / 2, u = (e.b - e.a).normalized();
      double least = std::numeric_limits<double>::infinity();
      for (const WorkLamp& lamp : view.lamps) {
        const double q = std::abs(lobe_place(lamp.glint, middle, u, 1));
        if (q >= least) continue;
        least = q;
        glints[k] = &lamp.glint;
      }
    }
  return grooves.cuts->left_of(rows, glints);
}

Carved seen_by(const WorkView& view, const LyingGrooves& grooves) {
  if (!grooves.cuts) return grooves.whole;
  if (!view.sees_lines) return *grooves.in_steps;
  std::vector<std::size_t> rows(grooves.whole.size());
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  return seen_by(view, grooves, rows);
}

void render_all(std::vector<WorkView>& views, const LyingGrooves& grooves) {
  for (WorkView& v : views) {
    if (grooves.cuts)
      v.renderer.forward(seen_by(v, grooves), v.radiance);
    else
      v.renderer.forward(grooves.whole, v.radiance);
  }
}

}  // namespace burin

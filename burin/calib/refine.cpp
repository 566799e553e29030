#include "burin/calib/refine.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "burin/calib/light/lamp.h"
#include "burin/calib/light/light_samples.h"
#include "burin/calib/photo/field_choice.h"
#include "burin/calib/photo/photo_problem.h"
#include "burin/calib/photo/refine_result.h"
#include "burin/calib/photo/strange_regions.h"
#include "burin/calib/verdict/next_photo.h"
#include "burin/calib/verdict/photo_uncertainty.h"
#include "burin/render/error.h"

namespace burin {

Refinement refine(std::span<const MergedView> merged, const Board& board, const Sent& sent, const Bench& measured,
                  const RefineOptions& options, const Progress& progress) {
  if (sent.size() == 0)
    fail("scratches", "there is no scratch to refine against", "name the designed scratches in board.json");
  Refinement out;
  out.bench = measured;
  std::vector<LightView> views = make_light_views(merged, board, out.bench, out.findings);
  if (views.empty())
    fail("session", "no photo has both a camera pose and the board in it", "run burin calibrate on this session first");

  if (progress) progress("finding the lamp", 0);
  const std::vector<LightSample> samples = gather_light_samples(views, board, out.bench, sent);
  const LampSeed seed = fit_lamps(samples, board, out.bench);
  out.findings.insert(out.findings.end(), seed.findings.begin(), seed.findings.end());

  Problem data;
  data.model.board = &board;
  data.model.sent = &sent;
  data.model.center_mm = 0.5 * (board.carve_min_mm + board.carve_max_mm);
  data.model.f0 = board.material.f0.mean();
  data.is_spot.assign(out.bench.lights.size(), false);
  for (const LightSample& sample : samples)
    if (sample.kind != SampleKind::face && sample.value > 0) data.paper.push_back(sample);

  State state;
  state.lamps.resize(out.bench.lights.size());
  state.shared[unknown::log_alpha] = std::log(board.material.alpha);
  state.shared[unknown::log_depth] = std::log(board.material.depth_um);
  state.shared[unknown::log_base_alpha] = std::log(seed.found ? seed.base_alpha : board.material.base_alpha);
  const Affine2& affine = out.bench.machine_affine;
  const Eigen::Vector2d shift = affine.leftCols<2>() * data.model.center_mm + affine.col(2) - data.model.center_mm;
  for (int row = 0; row < 2; ++row) {
    for (int column = 0; column < 2; ++column) state.shared[unknown::machine + 2 * row + column] = affine(row, column);
    state.shared[unknown::machine + 4 + row] = shift[row];
  }
  state.shared[unknown::ambient] = seed.found ? seed.ambient : out.bench.ambient.mean();
  for (int i = 0; i < 3; ++i) state.shared[unknown::vignette + i] = seed.found ? seed.vignette[i] : 0;
  constexpr double kBlurAtFirstPx = 0.6;
  const int merged_bin = merged.front().bin;  // the blur is in pixels of `merged`, the bench's in the photos'
  state.shared[unknown::log_blur] =
      std::log(out.bench.sensor.psf_sigma_px > 0 ? out.bench.sensor.psf_sigma_px / merged_bin : kBlurAtFirstPx);
  for (std::size_t i = 0; i < state.lamps.size(); ++i) {
    const Light& light = seed.found && options.fit_lamp ? seed.lights[i] : out.bench.lights[i];
    const Eigen::Vector2d aim = seed.found ? seed.aim_mm[i] : Eigen::Vector2d(0.5 * board.size_mm);
    data.is_spot[i] = light.falloff_exponent > 0;
    const double intensity = (seed.found ? seed.lights[i] : light).intensity.mean();
    state.lamps[i] = {light.position_mm.x(),
                      light.position_mm.y(),
                      light.position_mm.z(),
                      std::log(std::max(1e-12, intensity)),
                      aim.x(),
                      aim.y(),
                      light.falloff_exponent};
  }

  std::vector<double> sizes;
  double total_pixels = 0;
  for (const LightView& view : views) {
    sizes.push_back(pixel_mm(view, out.bench));
    total_pixels += static_cast<double>(view.value.data.size());
  }
  const double size = median_of(sizes);
  const int finest = std::max({1, static_cast<int>(std::ceil(options.finest_pixel_mm / size - 1e-9)),
                               static_cast<int>(std::ceil(std::sqrt(total_pixels / options.max_pixels) - 1e-9))});
  constexpr double kCoarsePixelMm = 1.6, kMiddlePixelMm = 0.8;
  const int coarse = std::max(finest, static_cast<int>(std::lround(kCoarsePixelMm / size)));
  const int middle = std::max(finest, static_cast<int>(std::lround(kMiddlePixelMm / size)));

  const auto blur = [&] { return std::exp(state.shared[unknown::log_blur]); };
  data.photos = photos_at(views, coarse, board, out.bench, blur());
  const auto check_pixels = [&] {
    std::size_t used = 0;
    for (const PhotoData& photo : data.photos)
      used += std::count_if(photo.weight.begin(), photo.weight.end(), [](float w) { return w > 0; });
    if (used < 1000)
      fail("session", "hardly a pixel of bare metal is seen unclipped",
           "add shorter exposures, or photos nearer to the board and in focus");
  };
  check_pixels();

  // A grid of starts over alpha and depth: what is believed of them may be off by factors.
  for (PhotoData& photo : data.photos)
    for (std::size_t i = 0; i < photo.weight.size(); ++i)
      if (photo.weight[i] > 0)
        photo.weight[i] = 1 / std::hypot(photo.photo.sigma.data[i], 0.2F * photo.photo.value.data[i]);
  const std::size_t stride = 1 + (data.photos.size() - 1) / 5;
  State best = state;
  double best_cost = -1;
  const std::array<double, 5> alphas{0.02, 0.04, 0.08, 0.15, 0.3};
  const std::array<double, 4> depth_factors{0.4, 0.8, 1.5, 3};
  int tried = 0;
  for (const double alpha : alphas)
    for (const double factor : depth_factors) {
      State candidate = state;
      candidate.shared[unknown::log_alpha] = std::log(alpha);
      candidate.shared[unknown::log_depth] = std::log(factor * board.material.depth_um);
      const double cost = cost_of(data, candidate, stride);
      if (best_cost < 0 || cost < best_cost) {
        best_cost = cost;
        best = candidate;
      }
      if (progress)
        progress("trying roughness and depth", static_cast<double>(++tried) / (alphas.size() * depth_factors.size()));
    }
  state = best;

  Stage stage;
  stage.lamp = options.fit_lamp;
  stage.machine = false;
  weigh_photos(data, state);
  solve(data, stage, 6, 1e-3, state, progress, "fitting coarse photos");
  stage.machine = true;
  weigh_photos(data, state);
  solve(data, stage, options.max_iterations, 1e-4, state, progress, "fitting coarse photos and the machine");
  data.model.crossings = options.crossings.value_or(Crossings::add);
  if (!options.crossings) {
    weigh_photos(data, state);
    State adding = state, last = state;
    const double cost_adding = solve(data, stage, 2, 1e-4, adding, progress, "crossing scratches as a sum");
    data.model.crossings = Crossings::last;
    const double cost_last = solve(data, stage, 2, 1e-4, last, progress, "crossing scratches, the last one rules");
    data.model.crossings = cost_last < cost_adding ? Crossings::last : Crossings::add;
    state = cost_last < cost_adding ? last : adding;
  }
  out.bench.crossings = data.model.crossings;

  if (middle < coarse) data.photos = photos_at(views, middle, board, out.bench, blur());
  stage.blur = true;
  weigh_photos(data, state);
  solve(data, stage, options.max_iterations, 1e-5, state, progress, "fitting binned photos");
  // A spot whose fall-off the photos do not show is a bare lamp: its aim and exponent would only trade with each other.
  for (std::size_t light = 0; light < state.lamps.size(); ++light) {
    double* spot = state.block(unknown::spot, light);
    if (!data.is_spot[light]) continue;
    constexpr double kLeastExponent = 0.3;
    if (spot[2] > kLeastExponent) continue;
    data.is_spot[light] = false;
    spot[2] = 0;
    weigh_photos(data, state);
    solve(data, stage, options.max_iterations, 1e-5, state, progress, "fitting a bare lamp");
  }
  if (finest < middle) {
    data.photos = photos_at(views, finest, board, out.bench, blur());
    weigh_photos(data, state);
    solve(data, stage, options.max_iterations, 1e-5, state, progress, "fitting photos");
  }
  // Binned pixels are quick but not quite what the camera saw: the difference to the photo's own pixels is taken at the
  // solution and held while the fit goes on.
  const auto solve_corrected = [&](const std::string& name) {
    check_pixels();
    correct_binning(data, views, board, out.bench, state);
    weigh_photos_and_grooves(data, state);
    solve(data, stage, options.max_iterations, 3e-6, state, progress, name);
  };
  solve_corrected("fitting photos with their own errors");
  const std::vector<StrangeRegion> strange = strange_regions(data, state);
  if (!strange.empty()) {
    for (const StrangeRegion& region : strange) out.findings.push_back(told(region));
    leave_out(strange, data, views);
    data.photos = photos_at(views, finest, board, out.bench, blur());
    solve_corrected("fitting photos without what lies on the board");
  }
  const auto move_geometry = [&] {
    const Eigen::VectorXd lens = joint_step(data, stage, state, out.bench);
    for (LightView& view : views) view.lens = moved_lens(view.lens, lens);
    share_rays(views);
    data.photos = photos_at(views, finest, board, out.bench, blur());
    solve_corrected("fitting photos, cameras, lens and bow");
  };
  if (options.fit_geometry) {
    data.geometry = geometry_prior(board, out.bench);
    move_geometry();
  }
  if (options.fit_fields) {
    // Only now: what cameras, bow or lamp still had wrong would look like grooves that vary.
    if (progress) progress("asking whether depth varies", 0);
    stage.depth_field = choose_depth_field(data, stage, state);
    out.bench.verdict["depth_field"] = {
        true, field_name(stage.depth_field) +
                  ", chosen by predicting each view from the others, accidents of single grooves counted"};
    if (terms_of(stage.depth_field) > 0) {
      solve_corrected("fitting photos and how grooves vary");
      if (options.fit_geometry) move_geometry();
    }
  }
  if (progress) progress("judging the result", 0);
  const Uncertainty uncertainty = uncertainty_of(data, stage, state);

  const Combinations judged = fill_bench(data, state, uncertainty, stage, out);
  advise_light(data, state, uncertainty, judged, out.bench, progress);
  out.bench.sensor.psf_sigma_px *= merged_bin;
  fit_colors(data, merged, state, out.bench);
  out.alpha_jitter = data.model.alpha_jitter;
  out.depth_jitter = data.model.depth_jitter;
  const auto scatter = [](double value, double square_sigma) {
    // The sigma of a square root, where it is not near zero.
    return Scatter{value, value > 0 ? std::optional(square_sigma / (2 * value)) : std::nullopt};
  };
  out.bench.alpha_scatter = scatter(data.model.alpha_jitter, data.model.alpha_jitter2_sigma);
  out.bench.depth_scatter = scatter(data.model.depth_jitter, data.model.depth_jitter2_sigma);
  out.slope_error = data.slope_error;
  out.model_error = median_of(data.photo_model_error);
  const Carved carved = carved_at(data.model, state.of(0));
  for (std::size_t k = 0; k < data.photos.size(); ++k)
    out.photos.push_back(photo_fit(data, k, state, carved, out.bench));
  return out;
}

std::vector<MergedView> photos_for_refine(const Session& session, const Board& board, const Bench& measured) {
  // Photos of many megapixels resolve far more than the fit uses, and would not fit into memory together.
  std::vector<double> tag_sides_px;
  for (const View& view : measured.views)
    for (const Tag& tag : board.tags.list)
      tag_sides_px.push_back(tag.size_mm * measured.lens.intrinsics[0] / view.T_camera_board.translation().norm());
  return merge_session(session, light_bin(measured.lens.width, measured.lens.height, median_of(tag_sides_px)));
}

Refinement refine(const Session& session, const Board& board, const Sent& sent, const Bench& measured,
                  const RefineOptions& options, const Progress& progress) {
  if (progress) progress("reading photos", 0);
  return refine(photos_for_refine(session, board, measured), board, sent, measured, options, progress);
}

}  // namespace burin

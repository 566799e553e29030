#include "burin/calib/photo/photo_problem.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <tuple>

#include "burin/base/median.h"

namespace burin {
namespace {

// True if at least a twentieth of the grooves go the other way along an axis.
bool go_both_ways(const Scratches& sent, int axis) {
  const std::vector<double>&from = axis == 0 ? sent.x0_mm : sent.y0_mm, &to = axis == 0 ? sent.x1_mm : sent.y1_mm;
  std::size_t up = 0, down = 0;
  for (std::size_t i = 0; i < sent.size(); ++i) {
    up += to[i] > from[i] ? 1 : 0;
    down += to[i] < from[i] ? 1 : 0;
  }
  constexpr double kFewest = 0.05;
  return static_cast<double>(std::min(up, down)) > kFewest * static_cast<double>(up + down);
}

}  // namespace

Problem make_problem(const Board& board, const Sent& sent, const Bench& bench) {
  Problem out;
  out.model.board = &board;
  out.model.sent = &sent;
  out.model.center_mm = 0.5 * (board.carve_min_mm + board.carve_max_mm);
  out.model.f0 = board.material.f0.mean();
  out.model.alpha_field = bench.alpha_field.terms;
  out.model.profile = bench.material.profile;
  out.coat = bench.paper;
  out.has_stray = bench.stray.has_value();
  for (int axis = 0; axis < 2; ++axis) {
    out.both_ways[axis] = go_both_ways(sent.scratches, axis);
    out.uneven[axis] = bench.machine_errors.screw_mm()[axis] > 0;
  }
  for (const Light& light : bench.lights) {
    out.is_spot.push_back(light.falloff_exponent > 0);
    out.spot_held.push_back(false);
    out.given_size.push_back(light.size.is_measured() ? LampSize() : light.size);
    out.size_sought.push_back(!light.size.is_point() && light.size.is_measured());
  }
  return out;
}

bool seeks_size(const Problem& problem, std::size_t light) {
  return light < problem.size_sought.size() && problem.size_sought[light];
}

bool has_unknown(const Problem& problem, const UnknownRow& row, std::size_t light) {
  const bool spot_held = light < problem.spot_held.size() && problem.spot_held[light];
  return (!row.of_spot || (problem.is_spot[light] && !spot_held)) && (!row.of_size || seeks_size(problem, light)) &&
         (!row.of_stray || problem.has_stray) && (row.both_ways < 0 || problem.both_ways[row.both_ways]) &&
         (row.uneven < 0 || problem.uneven[row.uneven]);
}

std::vector<bool> free_unknowns(const Problem& data, const Stage& stage, std::size_t lights) {
  std::vector<bool> free(static_cast<std::size_t>(global_count(lights)), false);
  free[kPaperIndex] = true;
  for_each_unknown([&](const UnknownRow& row, int first) {
    if ((row.scope != Scope::shared && row.scope != Scope::lamp) || !stage.frees(row.group)) return;
    for (int i = 0; i < row.size; ++i)
      for (std::size_t light = 0; light < lights; ++light)
        if (has_unknown(data, row, light)) free[global_index(first + i, light)] = true;
  });
  return free;
}

bool bounds_of(const Problem& problem, const UnknownRow& row, double& low, double& high) {
  low = row.bounds.low;
  high = row.bounds.high;
  double by = 1;
  switch (row.bounds.kind) {
    case Bounds::Kind::none:
      return false;
    case Bounds::Kind::plain:
      return true;
    case Bounds::Kind::per_board_diagonal:
      by = problem.model.board->size_mm.norm();
      low *= by;
      high *= by;
      return true;
    case Bounds::Kind::of_log_per_tool_width:
      by = problem.model.board->tool_width_um;
      [[fallthrough]];
    case Bounds::Kind::of_log:
      low = std::log(by * low);
      high = std::log(by * high);
      return true;
  }
  return false;
}

State moved_state(const State& state, const Eigen::VectorXd& step) {
  State out = state;
  for (int i = 0; i < kSharedUnknowns; ++i) out.shared[i] += step[i];
  out.log_paper[0] += step[kPaperIndex];
  for (std::size_t light = 0; light < out.lamps.size(); ++light)
    for (int i = 0; i < kLampUnknowns; ++i) out.lamps[light][i] += step[global_index(kSharedUnknowns + i, light)];
  return out;
}

Eigen::VectorXd step_between(const State& from, const State& to) {
  Eigen::VectorXd step = Eigen::VectorXd::Zero(global_count(from.lamps.size()));
  for (int i = 0; i < kSharedUnknowns; ++i) step[i] = to.shared[i] - from.shared[i];
  step[kPaperIndex] = to.log_paper[0] - from.log_paper[0];
  for (std::size_t light = 0; light < from.lamps.size(); ++light)
    for (int i = 0; i < kLampUnknowns; ++i)
      step[global_index(kSharedUnknowns + i, light)] = to.lamps[light][i] - from.lamps[light][i];
  return step;
}

std::pair<double, double> log_blur_range(const Problem& data) {
  for (const PhotoData& photo : data.photos) {
    constexpr double kHolds = 0.3;
    if (!photo.correction.empty()) return {photo.log_blur_at - kHolds, photo.log_blur_at + kHolds};
  }
  for (const UnknownRow& row : kUnknownRows)
    if (double low = 0, high = 0; row.group == Group::blur && bounds_of(data, row, low, high)) return {low, high};
  return {};
}

void keep_within_bounds(const Problem& problem, State& state) {
  for_each_unknown([&](const UnknownRow& row, int first) {
    double low = 0, high = 0;
    if (row.scope != Scope::shared && row.scope != Scope::lamp) return;
    if (!bounds_of(problem, row, low, high)) return;
    if (row.group == Group::blur) std::tie(low, high) = log_blur_range(problem);
    for (std::size_t light = 0; light < (row.scope == Scope::lamp ? state.lamps.size() : 1); ++light) {
      if (!has_unknown(problem, row, light)) continue;
      for (int i = row.bounds.at; i < row.bounds.at + row.bounds.count; ++i) {
        double& value = state.block(first, light)[i];
        // A non-finite value carries no information: use the lower bound.
        value = std::isfinite(value) ? std::clamp(value, low, high) : low;
      }
    }
  });
}

Bins bins_for(const std::vector<LightView>& views, const Bench& bench, double finest_pixel_mm, std::size_t max_pixels) {
  std::vector<double> sizes;
  double total_pixels = 0;
  for (const LightView& view : views) {
    sizes.push_back(pixel_mm(view, bench));
    total_pixels += static_cast<double>(view.value.data.size());
  }
  const double size = median_of(std::move(sizes));
  if (!(size > 0)) return {};
  constexpr double kCoarsePixelMm = 1.6, kMiddlePixelMm = 0.8;
  Bins out;
  out.finest =
      std::max({1, static_cast<int>(std::ceil(finest_pixel_mm / size - 1e-9)),
                static_cast<int>(std::ceil(std::sqrt(total_pixels / static_cast<double>(max_pixels)) - 1e-9))});
  out.coarse = std::max(out.finest, static_cast<int>(std::lround(kCoarsePixelMm / size)));
  out.middle = std::max(out.finest, static_cast<int>(std::lround(kMiddlePixelMm / size)));
  return out;
}

void light_around(const State& state, Problem& data) {
  if (!data.surroundings) return;
  const Carved carved = carved_at(data.model, state.of(0));
  each_photo(data, [&](std::size_t k) { light_around(state.of(data.photos[k].photo.light), carved, data.photos[k]); });
}

int photos_at_once(const ModelData& model) {
  constexpr double kMany = 800'000;
  if (model.crossings == Crossings::add || model.cut.lanes > 0) return 4;
  return expected_pieces(model) > kMany ? 1 : 4;
}

void each_photo(std::size_t count, int at_once, const std::function<void(std::size_t)>& body) {
  std::atomic<std::size_t> next{0};
  tbb::parallel_for(0, std::max(1, at_once), [&](int) {
    // Isolated: a thread waiting for its own photo's rendering must not begin another photo.
    for (std::size_t k = next++; k < count; k = next++) tbb::this_task_arena::isolate([&] { body(k); });
  });
}

void each_photo(const Problem& data, const std::function<void(std::size_t)>& body) {
  each_photo(data.photos.size(), photos_at_once(data.model), body);
}

double pixel_mm(const LightView& view, const Bench& bench) {
  const Eigen::Isometry3d& T = bench.views[view.view].T_camera_board;
  return T.translation().norm() / view.lens.intrinsics[0];
}

std::vector<PhotoData> photos_at(const std::vector<LightView>& views, int bin, const Board& board, const Bench& bench,
                                 double blur_px) {
  std::vector<PhotoData> photos;
  photos.reserve(views.size());
  for (const LightView& view : views) {
    PhotoData& photo =
        photos.emplace_back(make_photo_data(binned(view, bin), bin, board, bench, 0.8 + 3 * blur_px / bin));
    photo.workspaces = photos.front().workspaces;
  }
  return photos;
}

namespace {

// The longest side of a footprint with nonzero weight.
double largest_footprint_mm(const PhotoData& photo) {
  const FootprintGrid& grid = *photo.scene.grid;
  const auto row = static_cast<std::size_t>(grid.width()) + 1;
  double longest = 0;
  for (std::size_t i = 0; i < photo.weight.size(); ++i) {
    if (!(photo.weight[i] > 0)) continue;
    const std::size_t corner = i / grid.width() * row + i % grid.width();
    for (const std::size_t next : {corner + 1, corner + row})
      longest = std::max(longest, std::hypot(grid.corner_x_mm[next] - grid.corner_x_mm[corner],
                                             grid.corner_y_mm[next] - grid.corner_y_mm[corner]));
  }
  return longest;
}

}  // namespace

bool look_at_sample(double most_pieces, const State& state, Problem& data) {
  const Board& board = *data.model.board;
  BoardSample sample = sample_of(data.model.sent->scratches, board, most_pieces);
  if (sample.is_whole()) return false;
  const double blur_px = std::exp(state.shared[unknown::log_blur]);
  double reach_mm = 0;
  for (const PhotoData& photo : data.photos)
    reach_mm = std::max(reach_mm, (1.5 + 3 * blur_px / photo.bin) * largest_footprint_mm(photo));
  reach_mm += 1e-3 * board.tool_width_um;
  for (const Eigen::AlignedBox2d& square : sample.squares)
    sample.surroundings.emplace_back((square.min().array() - reach_mm).matrix(),
                                     (square.max().array() + reach_mm).matrix());
  for (PhotoData& photo : data.photos) show_only(sample, photo);
  data.model.sample = std::move(sample);
  return true;
}

Stage stage_of_sample(Stage stage) {
  stage.hold({Group::base, Group::machine, Group::lamp, Group::vignette, Group::stray, Group::stray_size});
  return stage;
}

void correct_binning(Problem& data, const std::vector<LightView>& views, const Board& board, const Bench& bench,
                     const State& state, std::size_t max_pixels) {
  const Carved carved = carved_at(data.model, state.of(0));
  each_photo(data, [&](std::size_t k) {
    const Unknowns x = state.of(views[k].light);
    correct_binning(data.model, views[k], board, bench, x, carved, max_pixels, data.photos[k]);
    shift_by_grooves(data.model, x, carved, data.photos[k]);
  });
}

double cost_of(const Problem& data, const State& state, std::size_t stride) {
  double cost = 0;
  const Carved carved = carved_at(data.model, state.of(0));  // the same for all lamps
  for (std::size_t k = 0; k < data.photos.size(); k += stride)
    cost += photo_cost(data.model, data.photos[k], state.of(data.photos[k].photo.light), carved);
  return cost;
}

std::vector<double> costs_of_photos(const Problem& data, const State& state) {
  std::vector<double> out(data.photos.size());
  const Carved carved = carved_at(data.model, state.of(0));
  each_photo(data, [&](std::size_t k) {
    out[k] = photo_cost(data.model, data.photos[k], state.of(data.photos[k].photo.light), carved);
  });
  return out;
}

}  // namespace burin

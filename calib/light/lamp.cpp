#include "burin/calib/light/lamp.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "burin/base/files/decimals.h"
#include "burin/base/median.h"
#include "burin/calib/light/lamp_area.h"
#include "burin/calib/light/lamp_fit.h"
#include "burin/calib/light/lamp_shapes.h"
#include "burin/scene/parameter_name.h"

namespace burin {
namespace {

// Intensity of a lamp at `position` that gives the white paper its brightness: the samples' median.
double log_intensity_for(const LampData& data, std::size_t light, const Eigen::Vector3d& position, double& log_spread) {
  std::vector<double> ratios;
  LampModel<double> lamp{position, 0, {0, 0}, 0};
  for (const LightSample& sample : data.samples) {
    if (sample.light != light || sample.kind != SampleKind::white_paper || !(sample.value > 0)) continue;
    const double unit = paper_radiance(lamp, 0.0, data.board->tags.white_albedo, sample);
    if (unit > 0) ratios.push_back(std::log(sample.value / unit));
  }
  if (ratios.empty()) {
    log_spread = 0;
    return 0;
  }
  const auto [least, most] = std::minmax_element(ratios.begin(), ratios.end());
  log_spread = *most - *least;
  return median_of(ratios);
}

// Initial guesses of positions: shading's closed form, and a ring around the board at two heights and distances.
std::vector<Eigen::Vector3d> starts_for(const LampData& data, std::size_t light) {
  std::map<int, std::vector<double>> white, black;
  std::map<int, Eigen::Vector3d> where;
  for (const LightSample& sample : data.samples) {
    if (sample.light != light || sample.kind == SampleKind::face) continue;
    (sample.kind == SampleKind::white_paper ? white : black)[sample.tag].push_back(sample.value);
    where[sample.tag] = sample.p_board;
  }
  std::vector<Eigen::Vector3d> p;
  std::vector<double> shading;
  for (auto& [tag, values] : white) {
    if (!black.count(tag)) continue;
    const double s = median_of(values) - median_of(black[tag]);
    if (!(s > 0)) continue;
    p.push_back(where[tag]);
    shading.push_back(s);
  }
  std::vector<Eigen::Vector3d> starts;
  if (const auto seed = lamp_from_shading(p, shading)) starts.push_back(*seed);
  for (const double elevation_deg : {30., 60.})
    for (int i = 0; i < 8; ++i) {
      const double azimuth = 2 * std::numbers::pi * i / 8, elevation = elevation_deg * std::numbers::pi / 180;
      const Eigen::Vector3d direction(std::cos(azimuth) * std::cos(elevation), std::sin(azimuth) * std::cos(elevation),
                                      std::sin(elevation));
      starts.push_back(Eigen::Vector3d(data.center_mm.x(), data.center_mm.y(), 0) + 2 * data.reach_mm * direction);
    }
  return starts;
}

}  // namespace

std::optional<Eigen::Vector3d> lamp_from_shading(std::span<const Eigen::Vector3d> p_board,
                                                 std::span<const double> shading) {
  const auto count = static_cast<Eigen::Index>(p_board.size());
  if (count < 5) return std::nullopt;
  // s^(-2/3) = K (|p|^2 - 2 p.L + |L|^2) on a plane z = const, unknowns K, K Lx, K Ly, K |L|^2 (Lz above that plane).
  Eigen::MatrixXd A(count, 4);
  Eigen::VectorXd b(count);
  const double unit = p_board[0].norm() + 1;
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Vector2d p = p_board[i].head<2>() / unit;
    b[i] = std::pow(shading[i], -2. / 3);
    A.row(i) = Eigen::Vector4d(p.squaredNorm(), -2 * p.x(), -2 * p.y(), 1).transpose() / b[i];
    b[i] = 1;  // rows are relative errors
  }
  const Eigen::Vector4d x = A.colPivHouseholderQr().solve(b);
  if (!(x[0] > 0)) return std::nullopt;
  const Eigen::Vector2d lateral(x[1] / x[0], x[2] / x[0]);
  const double height2 = x[3] / x[0] - lateral.squaredNorm();
  if (!(height2 > 0)) return std::nullopt;
  return Eigen::Vector3d(unit * lateral.x(), unit * lateral.y(), unit * std::sqrt(height2) + p_board[0].z());
}

namespace {

// Initial ambient light. Places of a bent board may face away from a start; only ambient light explains their
// brightness.
double ambient_to_start(const LampData& data, std::size_t light, const Eigen::Vector3d& start) {
  constexpr double kLittle = 0.02;  // of the values of paper and face
  std::vector<double> values;
  bool turns_away = false;
  for (const LightSample& sample : data.samples) {
    if (sample.light != light || !(sample.value > 0)) continue;
    values.push_back(sample.value);
    turns_away = turns_away || (start - sample.p_board).dot(sample.normal) <= 0;
  }
  return turns_away ? kLittle * median_of(std::move(values)) : 0;
}

// Fits a bare lamp from each start to its own samples, and returns the best. Not usable, with a finding, if there are
// too few samples or no lamp explains them.
LampFit fit_from_starts(const LampData& data, const LampParameters& blocks, std::size_t light, const std::string& id,
                        std::vector<Finding>& findings) {
  // A few hundred samples of the face choose the best start; more samples then refine it.
  constexpr std::size_t kFewestSamples = 8, kToChoose = 400, kMostSamples = 1500;
  std::size_t count = 0, white = 0;
  for (const LightSample& s : data.samples) {
    count += s.light == light;
    white += s.light == light && s.kind == SampleKind::white_paper;
  }
  if (white < kFewestSamples) {
    findings.push_back(
        make_warning(FindingCode::exposure,
                     "light " + id + ": only " + std::to_string(white) + " unclipped pieces of white tag paper",
                     "add a shorter exposure"));
    if (count < kFewestSamples) return {};
  }
  const std::vector<bool> no_spot(blocks.lamps.size(), false);
  LampFitOptions options{
      .only_light = static_cast<int>(light), .stride = 1 + count / kToChoose, .fit_vignette = false, .iterations = 40};
  std::vector<LampParameters> starts;
  for (const Eigen::Vector3d& start : starts_for(data, light)) {
    LampParameters& from = starts.emplace_back(blocks);
    LampBlocks& lamp = from.lamps[light];
    Eigen::Vector3d::Map(lamp.position) = start;
    double spread = 0;
    lamp.log_intensity[0] = log_intensity_for(data, light, start, spread);
    lamp.spot[0] = data.center_mm.x();
    lamp.spot[1] = data.center_mm.y();
    from.shared[1] = ambient_to_start(data, light, start);
  }
  LampFit best = best_lamp_fit(data, starts, no_spot, options);
  if (best.usable) {
    options.stride = 1 + count / kMostSamples;
    best = fit_lamp_parameters(data, best.blocks, no_spot, options);
  }
  if (!best.usable)
    findings.push_back(make_warning(FindingCode::lamp_unexplained,
                                    "light " + id + ": no lamp explains the brightness of paper and face"));
  return best;
}

// The ellipse with the second moments of a given area (9.15b): the root of their matrix.
void put_area(const LampSize& size, LampBlocks& lamp) {
  const LampArea area = lamp_area(size, 1);
  const double xx = area.size2 + area.sides2[0], yy = area.size2 - area.sides2[0], xy = area.sides2[1];
  const double root = std::sqrt(std::max(0.0, xx * yy - xy * xy)), by = 1 / std::sqrt(xx + yy + 2 * root);
  lamp.area[0] = by * (xx + root);
  lamp.area[1] = by * xy;
  lamp.area[2] = by * (yy + root);
}

// Bare lamps from paper alone.
LampParameters lamps_by_paper(const LampData& data, const std::vector<bool>& usable, const Board& board,
                              const Bench& bench) {
  std::vector<LightSample> paper;
  for (const LightSample& sample : data.samples)
    if (sample.kind != SampleKind::face) paper.push_back(sample);
  LampData of_paper = data;
  of_paper.samples = paper;
  LampParameters out;
  out.lamps.resize(usable.size());
  out.shared[0] = std::log(board.material.base_alpha);
  std::vector<Finding> told;  // findings repeated from before
  for (std::size_t light = 0; light < usable.size(); ++light) {
    if (!usable[light]) continue;
    if (data.given_area[light]) put_area(bench.lights[light].size, out.lamps[light]);
    const LampFit fit = fit_from_starts(of_paper, out, light, "", told);
    if (fit.usable) out = fit.blocks;
  }
  return out;
}

LampArea moments_of_area(const LampBlocks& lamp) {
  const auto& [xx, xy, yy] = lamp.area;
  return {0.5 * (xx * xx + 2 * xy * xy + yy * yy), {0.5 * (xx * xx - yy * yy), xy * (xx + yy)}};
}

// Residuals in the robust loss's core: their RMS, and the factor by which they exceed their expectation.
std::pair<double, double> core_residuals(const LampData& data, const std::vector<bool>& usable, const LampFit& fit) {
  double sum = 0, sum_weighted = 0;
  std::size_t core = 0;
  for (const LightSample& sample : data.samples) {
    if (!usable[sample.light] || !(sample.value > 0)) continue;
    const double relative = sample.sigma / sample.value;
    const std::optional<double> r = log_residual(data, fit.blocks, sample);
    if (!r) continue;
    const double expected2 = relative * relative + data.model_error * data.model_error, r2 = *r * *r;
    if (r2 > 9 * expected2) continue;
    sum += r2;
    sum_weighted += r2 / expected2;
    ++core;
  }
  if (core == 0) return {0, 1};
  return {std::sqrt(sum / static_cast<double>(core)),
          std::max(1.0, std::sqrt(sum_weighted / static_cast<double>(core)))};
}

// Replaces sigmas of base_alpha, ambient light and vignetting by these if larger.
void take_larger_sigmas(const SharedSigma& sigma, LampSeed& seed) {
  seed.base_alpha_sigma = std::max(seed.base_alpha_sigma, seed.base_alpha * sigma[0]);
  seed.ambient_sigma = std::max(seed.ambient_sigma, sigma[1]);
  seed.vignette_sigma = seed.vignette_sigma.cwiseMax(sigma.tail<3>());
}

void fill_seed(const LampData& data, const std::vector<bool>& usable, const std::vector<bool>& spot, const LampFit& fit,
               LampSeed& seed) {
  const auto [rms, inflation] = core_residuals(data, usable, fit);
  seed.found = true;
  seed.residual_rms = rms;
  seed.base_alpha = std::exp(fit.blocks.shared[0]);
  take_larger_sigmas(inflation * fit.shared_sigma, seed);
  seed.grain = {fit.blocks.grain[0], fit.blocks.grain[1]};
  if (fit.blocks.gloss[0] > 0) seed.paper = {fit.blocks.gloss[0], fit.blocks.gloss[1]};
  seed.ambient = fit.blocks.shared[1];
  seed.vignette = Eigen::Vector3d::Map(fit.blocks.shared + 2);
  if (fit.blocks.stray_distance_mm > 0) {
    const LampModel<double> stray = stray_of(fit.blocks.stray, fit.blocks.stray_distance_mm, data.center_mm);
    Light& light = seed.stray.emplace();
    light.id = "stray";
    light.position_mm = stray.position_mm;
    light.axis = (Eigen::Vector3d(data.center_mm.x(), data.center_mm.y(), 0) - stray.position_mm).normalized();
    light.intensity.setConstant(std::exp(stray.log_intensity));
  }
  seed.aim_mm.assign(usable.size(), data.center_mm);
  seed.sizes.assign(usable.size(), {});
  for (std::size_t light = 0; light < usable.size(); ++light) {
    if (!usable[light]) continue;
    const LampBlocks& b = fit.blocks.lamps[light];
    Light& l = seed.lights[light];
    l.position_mm = Eigen::Vector3d::Map(b.position);
    l.intensity.setConstant(std::exp(b.log_intensity[0]));
    l.falloff_exponent = spot[light] ? b.spot[2] : 0;
    if (b.has_area() && !data.given_area[light])
      seed.sizes[light] = lamp_size(moments_of_area(b), 1, distance_mm(data, b));
    if (spot[light]) seed.aim_mm[light] = Eigen::Vector2d(b.spot[0], b.spot[1]);
    l.axis = (Eigen::Vector3d(seed.aim_mm[light].x(), seed.aim_mm[light].y(), 0) - l.position_mm).normalized();
    if (!fit.position_covariance.empty() && fit.position_covariance[light](0, 0) >= 0)
      l.position_sigma_mm = inflation * fit.position_covariance[light].diagonal().cwiseSqrt();
  }
}

// Scatter of a fit, as standard deviations, with groups of samples left out in turn (the jackknife).
struct GroupScatter {
  std::vector<Eigen::Vector3d> position_mm;  // of each lamp, per axis
  SharedSigma shared = SharedSigma::Zero();
};

// The jackknife's standard deviation of each row; 0 with too few groups. Each column is a fit without one group.
Eigen::VectorXd jackknife_sigma(const Eigen::MatrixXd& answers) {
  const auto n = static_cast<double>(answers.cols());
  if (n < 3) return Eigen::VectorXd::Zero(answers.rows());
  const Eigen::VectorXd mean = answers.rowwise().mean();
  return ((n - 1) / n * (answers.colwise() - mean).rowwise().squaredNorm()).cwiseSqrt();
}

// A left-out group decides nothing, so a group without samples of a lamp adds nothing to its scatter. `group_of`: from
// 0 to `groups` - 1, or -1 for samples never left out. One in `thin` of the face's samples counts, which suffices.
template <typename GroupOf>
GroupScatter scatter_by_groups(const LampData& data, const LampFit& fit, const std::vector<bool>& spot, int groups,
                               std::size_t thin, GroupOf group_of) {
  const std::size_t lamps = fit.blocks.lamps.size();
  std::vector<std::optional<LampFit>> without(static_cast<std::size_t>(groups));
  tbb::parallel_for(0, groups, [&](int g) {
    std::vector<LightSample> kept;
    for (const LightSample& sample : data.samples)
      if (group_of(sample) != g) kept.push_back(sample);
    if (kept.size() == data.samples.size() || kept.empty()) return;
    LampData part = data;
    part.samples = std::move(kept);
    without[static_cast<std::size_t>(g)] =
        fit_lamp_parameters(part, fit.blocks, spot, {.stride = thin, .iterations = 30});
  });
  constexpr Eigen::Index kShared = SharedSigma::RowsAtCompileTime;
  const auto rows = static_cast<Eigen::Index>(3 * lamps) + kShared;
  Eigen::MatrixXd answers(rows, groups);
  Eigen::Index count = 0;
  for (const std::optional<LampFit>& f : without) {
    if (!f || !f->usable) continue;
    for (std::size_t i = 0; i < lamps; ++i)
      answers.block<3, 1>(static_cast<Eigen::Index>(3 * i), count) = Eigen::Vector3d::Map(f->blocks.lamps[i].position);
    answers.col(count++).tail<kShared>() = SharedSigma::Map(f->blocks.shared);
  }
  const Eigen::VectorXd sigma = jackknife_sigma(answers.leftCols(count));
  GroupScatter out;
  for (std::size_t i = 0; i < lamps; ++i) out.position_mm.push_back(sigma.segment<3>(static_cast<Eigen::Index>(3 * i)));
  out.shared = sigma.tail<kShared>();
  return out;
}

// Distance of a sample of the face from the lamp's mirror image: the tangent of the half vector's lean.
double lean_of(const LightSample& sample, const LampFit& fit) {
  const Eigen::Vector3d lamp = Eigen::Vector3d::Map(fit.blocks.lamps[sample.light].position);
  const Eigen::Vector3d h = (lamp - sample.p_board).normalized() + sample.to_camera;
  return h.cross(sample.normal).norm() / std::max(1e-9, h.dot(sample.normal));
}

// Three edges between four groups of the face's samples by lean, of equal size.
std::array<double, 3> lean_edges(const LampData& data, const LampFit& fit) {
  std::vector<double> leans;
  for (const LightSample& sample : data.samples)
    if (sample.kind == SampleKind::face) leans.push_back(lean_of(sample, fit));
  std::sort(leans.begin(), leans.end());
  std::array<double, 3> out{};
  for (std::size_t i = 0; i < out.size() && !leans.empty(); ++i) out[i] = leans[(i + 1) * leans.size() / 4];
  return out;
}

// Increases sigmas if groups contradict each other more than independent errors would. Groups are photos, places on the
// board, and the highlight's middle and wings. Streaks of a brushed face, or an unmodeled lobe, are not noise.
void widen_by_groups(const LampData& data, const LampFit& fit, const std::vector<bool>& spot, LampSeed& seed) {
  constexpr int kGroups = 8, kAcross = 3;
  constexpr std::size_t kThin = 4;
  std::map<std::size_t, int> rank;  // of the photos
  for (const LightSample& sample : data.samples) rank.emplace(sample.light_view, 0);
  int next = 0;
  for (auto& [view, number] : rank) number = next++;
  const int photos = std::min(kGroups, next);
  const auto photo_of = [&](const LightSample& s) { return rank[s.light_view] % photos; };
  const Eigen::Vector2d size = data.board->size_mm;
  const auto place_of = [&](const LightSample& s) {
    const auto cell = [&](int axis) {
      return std::clamp(static_cast<int>(kAcross * s.p_board[axis] / size[axis]), 0, kAcross - 1);
    };
    return cell(0) + kAcross * cell(1);
  };
  const std::array<double, 3> edges = lean_edges(data, fit);
  const auto lean_group_of = [&](const LightSample& s) {
    if (s.kind != SampleKind::face) return -1;
    return static_cast<int>(std::upper_bound(edges.begin(), edges.end(), lean_of(s, fit)) - edges.begin());
  };
  for (const GroupScatter& by : {scatter_by_groups(data, fit, spot, 4, 2 * kThin, lean_group_of),
                                 scatter_by_groups(data, fit, spot, photos, kThin, photo_of),
                                 scatter_by_groups(data, fit, spot, kAcross * kAcross, kThin, place_of)}) {
    for (std::size_t i = 0; i < seed.lights.size(); ++i)
      if (auto& sigma = seed.lights[i].position_sigma_mm) *sigma = sigma->cwiseMax(by.position_mm[i]);
    take_larger_sigmas(by.shared, seed);
  }
}

}  // namespace

LampSeed fit_lamps(std::span<const LightSample> samples, const Board& board, const Bench& bench,
                   const LampOptions& options) {
  LampData data;
  data.samples = samples;
  data.board = &board;
  data.f0 = board.material.f0.mean();
  data.reach_mm = board.size_mm.norm();
  data.center_mm = 0.5 * board.size_mm;
  data.model_error = options.model_error;
  data.given_area.assign(bench.lights.size(), false);

  LampSeed seed;
  seed.lights = bench.lights;
  LampParameters blocks;
  blocks.lamps.resize(bench.lights.size());
  blocks.shared[0] = std::log(board.material.base_alpha);
  std::vector<bool> usable(bench.lights.size(), false), point(bench.lights.size(), false);
  for (std::size_t light = 0; light < bench.lights.size(); ++light) {
    if (!bench.lights[light].is_near()) continue;  // given, with a scale as the only unknown
    data.given_area[light] = !bench.lights[light].size.is_point();
    if (data.given_area[light]) put_area(bench.lights[light].size, blocks.lamps[light]);
    const LampFit best = fit_from_starts(data, blocks, light, bench.lights[light].id, seed.findings);
    usable[light] = best.usable;
    point[light] = best.usable && !data.given_area[light];
    if (best.usable) blocks = best.blocks;
  }
  if (std::none_of(usable.begin(), usable.end(), [](bool u) { return u; })) return seed;
  LampShapes shapes;
  shapes.spot.resize(usable.size(), false);
  shapes.moved_mm.resize(usable.size(), Eigen::Vector3d::Zero());
  // A face with little light beyond the surroundings' pulls lamps far off if they are fitted one by one; paper does
  // not.
  const LampParameters by_paper = lamps_by_paper(data, usable, board, bench);
  shapes.fit = best_lamp_fit(data, std::array{blocks, by_paper}, shapes.spot);
  if (!shapes.fit.usable) return seed;
  if (options.fit_spot) try_spots(data, usable, shapes);
  // A brushed face, or a highlight stretched by a large lamp, masks a spotlight's falloff until it is modeled.
  if (try_areas_and_coats(data, point, shapes) && options.fit_spot) try_spots(data, usable, shapes);
  // If residuals of paper and face are within some expected errors, no evidence is left for another lamp.
  constexpr double kWellExplained = 0.2;
  const bool doubtful = shapes.fit.cost > kWellExplained * static_cast<double>(samples.size());
  if (doubtful && usable == point && try_stray(data, by_paper, shapes)) {
    if (options.fit_spot) try_spots(data, usable, shapes);
    try_areas_and_coats(data, point, shapes);
  }
  const LampFit fit = fit_lamp_parameters(data, shapes.fit.blocks, shapes.spot, {.covariance = true});
  if (fit.usable) fill_seed(data, usable, shapes.spot, fit, seed);
  if (fit.usable && options.jackknife) widen_by_groups(data, fit, shapes.spot, seed);
  for (std::size_t light = 0; light < usable.size(); ++light)
    if (auto& sigma = seed.lights[light].position_sigma_mm)
      *sigma = (sigma->cwiseAbs2() + shapes.moved_mm[light].cwiseAbs2()).cwiseSqrt();
  return seed;
}

std::vector<Finding> paper_findings(const PaperCoat& paper) {
  if (!(paper.f0 > 0)) return {};
  return {{FindingCode::glossy_paper,
           Finding::Severity::note,
           {},
           "the tags' paper shines: a coat that sends back " + significant(100 * paper.f0, 2) +
               " % straight on, of roughness " + significant(paper.alpha, 2) + ", is part of the paper's model",
           "matte paper needs no such guess"}};
}

Bench with_lamps(std::span<const MergedView> photos, const Board& board, const Sent& sent, const Bench& measured,
                 std::vector<Finding>& findings) {
  Bench bench = measured;
  const std::vector<LightView> views = make_light_views(photos, board, bench, findings);
  return with_lamps(gather_light_samples(views, board, bench, sent), board, bench, findings);
}

Bench with_lamps(std::span<const LightSample> samples, const Board& board, const Bench& measured,
                 std::vector<Finding>& findings) {
  Bench bench = measured;
  LampOptions options;
  options.jackknife = true;
  const LampSeed seed = fit_lamps(samples, board, bench, options);
  append(findings, seed.findings);
  for (const Light& light : bench.lights)
    bench.verdict[parameter::light_position(light.id)] = {
        Source::assumed, Degree::not_determined, {}, Unit::none, {{Cause::Kind::no_paper}}};
  if (!seed.found) return bench;
  bench.lights = seed.lights;
  bench.material.base_alpha = seed.base_alpha;
  bench.material.grain = seed.grain;
  bench.paper = seed.paper;
  bench.stray = seed.stray;
  if (bench.stray)
    findings.push_back(
        {FindingCode::stray_light,
         Finding::Severity::warning,
         {},
         "another light shines, which no file names",
         "burin refine measures it; better switch it off, or close the curtain, and take the photos again"});
  append(findings, paper_findings(bench.paper));
  for (std::size_t i = 0; i < bench.lights.size(); ++i)
    if (!seed.sizes[i].is_point())
      findings.push_back({FindingCode::area_lamp,
                          Finding::Severity::note,
                          {},
                          "light " + bench.lights[i].id + " is no point: it looks some " +
                              significant(seed.sizes[i].panel_mm.x(), 2) + " x " +
                              significant(seed.sizes[i].panel_mm.y(), 2) + " mm large from the board",
                          "burin refine measures it"});
  bench.material_sigma.base_alpha = seed.base_alpha_sigma;
  bench.ambient.setConstant(seed.ambient);
  bench.sensor.vignette = seed.vignette;
  if (seed.ambient_sigma > 0) bench.ambient_sigma = Eigen::Vector3d::Constant(seed.ambient_sigma);
  if (seed.vignette_sigma.norm() > 0) bench.sensor.vignette_sigma = seed.vignette_sigma;
  for (const Light& light : bench.lights) {
    if (!light.position_sigma_mm) continue;
    const double sigma = light.position_sigma_mm->norm();
    bench.verdict[parameter::light_position(light.id)] = {
        Source::measured,
        sigma < 0.2 * light.position_mm.norm() ? Degree::determined : Degree::not_determined,
        sigma,
        Unit::mm,
        {{Cause::Kind::paper_and_face}}};
  }
  return bench;
}

}  // namespace burin

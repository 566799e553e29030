#include "burin/calib/verdict/refine_result.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "burin/base/files/decimals.h"
#include "burin/base/median.h"
#include "burin/calib/change_in_time.h"
#include "burin/calib/light/lamp_area.h"
#include "burin/calib/photo/bench_unknowns.h"
#include "burin/calib/photo/machine_map.h"
#include "burin/calib/photo/stray_light.h"
#include "burin/calib/verdict/odd_photos.h"
#include "burin/scene/parameter_name.h"

namespace burin {

PhotoFit photo_fit(const Problem& data, std::size_t k, const State& state, const Carved& carved, const Bench& bench) {
  const PhotoData& photo = data.photos[k];
  const Unknowns x = state.of(photo.photo.light);
  const Image predicted = predict(data.model, photo, x, carved);
  PhotoFit fit;
  fit.view = bench.views[photo.photo.view].name;
  fit.light = bench.lights[photo.photo.light].id;
  std::vector<double> to_noise;
  double residual2 = 0, value2 = 0;
  std::size_t inliers = 0;
  constexpr double kOutlier = 4;
  for (std::size_t i = 0; i < predicted.data.size(); ++i) {
    if (!(photo.weight[i] > 0)) continue;
    ++fit.pixels;
    const double r = static_cast<double>(predicted.data[i]) - photo.photo.value.data[i];
    to_noise.push_back(std::abs(r) / photo.photo.sigma.data[i]);
    if (std::abs(r) * photo.weight[i] > kOutlier) continue;
    ++inliers;
    residual2 += r * r;
    value2 += static_cast<double>(photo.photo.value.data[i]) * photo.photo.value.data[i];
  }
  if (fit.pixels == 0) return fit;
  fit.residual_rms = value2 > 0 ? std::sqrt(residual2 / value2) : 0;
  fit.residual_to_noise = median_of(std::move(to_noise)) / 0.6745;
  fit.outliers = 1 - static_cast<double>(inliers) / static_cast<double>(fit.pixels);
  return fit;
}

std::set<std::size_t> fit_colors(const Problem& data, std::span<const MergedView> merged, const State& state,
                                 Bench& bench) {
  const std::size_t lights = bench.lights.size();
  const Eigen::Vector3d f0 = bench.material.f0;
  const auto n = static_cast<Eigen::Index>(lights + 1);
  std::array<Eigen::MatrixXd, 3> H;
  std::array<Eigen::VectorXd, 3> g;
  for (int c = 0; c < 3; ++c) {
    H[c] = Eigen::MatrixXd::Zero(n, n);
    g[c] = Eigen::VectorXd::Zero(n);
  }
  bool colored = false;
  const Carved carved = carved_at(data.model, state.of(0));
  for (const PhotoData& photo : data.photos) {
    const MergedView& source = merged[photo.photo.merged];
    if (source.value.channels != 3) continue;
    colored = true;
    const Unknowns x = state.of(photo.photo.light);
    const Image both = predict(data.model, photo, x, carved);
    for (int y = 0; y < both.height; ++y)
      for (int px = 0; px < both.width; ++px) {
        const std::size_t i = static_cast<std::size_t>(y) * both.width + px;
        if (!(photo.weight[i] > 0)) continue;
        const double r = photo.weight[i] * (static_cast<double>(both.data[i]) - photo.photo.value.data[i]);
        const double ambient = vignette_at(x.data() + unknown::vignette, static_cast<double>(photo.radius2[i])) *
                               ambient_unit(data.model, photo, i);
        const double lamp = both.data[i] - x[unknown::ambient] * ambient;
        const double weight = photo.weight[i] * photo.weight[i] / (1 + r * r / (data.model.cauchy * data.model.cauchy));
        for (int c = 0; c < 3; ++c) {
          double value = 0;
          for (int v = 0; v < photo.bin; ++v)
            for (int u = 0; u < photo.bin; ++u)
              value += source.value.at((px + photo.photo.window.x0) * photo.bin + u - source.x0,
                                       (y + photo.photo.window.y0) * photo.bin + v - source.y0, c);
          value /= photo.bin * photo.bin;
          Eigen::VectorXd row = Eigen::VectorXd::Zero(n);
          row[static_cast<Eigen::Index>(photo.photo.light)] = lamp * f0[c] / data.model.f0;
          row[n - 1] = ambient * f0[c] / data.model.f0;
          H[c].noalias() += weight * row * row.transpose();
          g[c] += weight * value * row;
        }
      }
  }
  std::set<std::size_t> told;
  if (!colored) return told;
  for (int c = 0; c < 3; ++c) {
    const Eigen::VectorXd factor = H[c].ldlt().solve(g[c]);
    if (!factor.allFinite()) continue;
    for (std::size_t light = 0; light < lights; ++light)
      if (H[c](static_cast<Eigen::Index>(light), static_cast<Eigen::Index>(light)) > 0) {
        bench.lights[light].intensity[c] *= std::max(0.0, factor[static_cast<Eigen::Index>(light)]);  // a pure red lamp
        told.insert(light);
      }
    if (!data.surroundings) bench.ambient[c] = std::max(0.0, factor[n - 1]);  // the surroundings' colors are given
  }
  return told;
}

std::vector<Finding> keep_colors(std::span<const Light> given, const std::set<std::size_t>& told, Bench& bench) {
  constexpr double kGray = 1e-9;
  std::string kept;
  for (std::size_t i = 0; i < bench.lights.size(); ++i) {
    Light& light = bench.lights[i];
    const auto known = std::find_if(given.begin(), given.end(), [&](const Light& l) { return l.id == light.id; });
    if (told.count(i) > 0 || known == given.end() || !(known->intensity.mean() > 0)) continue;
    const Eigen::Vector3d color = known->intensity / known->intensity.mean();
    if ((color.array() - 1).abs().maxCoeff() < kGray) continue;
    const double mean = light.intensity.mean();
    if (light.intensity_sigma) light.intensity_sigma = light.intensity_sigma->mean() * color;
    light.intensity = mean * color;
    kept += (kept.empty() ? "" : ", ") + light.id;
  }
  if (kept.empty()) return {};
  return {{FindingCode::color_unmeasured,
           Finding::Severity::note,
           {},
           "no photo in color shows " + kept + ": brightness is measured, color is as in the bench",
           "take photos in color under each lamp alone"}};
}

namespace {

// Photos show the scratches relative to the tags. The frame itself is therefore only as accurate as the prior of all
// tags together. This error is not due to the photos and must not appear as an error of the machine.
Affine2 machine_sigma(const Problem& data, const Uncertainty& uncertainty) {
  const Eigen::Vector2d c = data.model.center_mm;
  const Eigen::Matrix3d frame = tag_frame_covariance(*data.model.board);
  const auto sigma_of = [&](int row, const Eigen::Vector3d& a_center) {  // of a00 a1 + a01 a2 + t a3, about the center
    const Eigen::VectorXd a = machine_combination(uncertainty.covariances.front().rows(), row, a_center);
    // The frame's covariance is about the board's origin: x = c + (x - c).
    const Eigen::Vector3d a_origin(a_center[0] + a_center[2] * c.x(), a_center[1] + a_center[2] * c.y(), a_center[2]);
    return std::hypot(uncertainty.sigma(a), std::sqrt(a_origin.dot(frame * a_origin)));
  };
  Affine2 sigma;
  for (int row = 0; row < 2; ++row) {
    sigma(row, 0) = sigma_of(row, {1, 0, 0});
    sigma(row, 1) = sigma_of(row, {0, 1, 0});
    sigma(row, 2) = sigma_of(row, {-c.x(), -c.y(), 1});
  }
  return sigma;
}

// Sigmas of effects in only some setups.
void fill_effect_sigmas(const Uncertainty& uncertainty, const Stage& stage, Bench& bench) {
  const auto two = [&](int first) { return Eigen::Vector2d(uncertainty.sigma(first), uncertainty.sigma(first + 1)); };
  MachineErrors& errors = bench.machine_errors;
  MaterialSigma& sigma = bench.material_sigma;
  const GrooveProfile& profile = bench.material.profile;
  if (stage.frees(Group::backlash)) errors.backlash_sigma_mm = two(unknown::backlash);
  if (stage.frees(Group::screw)) {
    Eigen::Vector2d amplitude_sigma(0, 0);
    const Eigen::Vector2d amplitude = errors.screw_mm();
    for (int axis = 0; axis < 2; ++axis) {
      if (!(amplitude[axis] > 0)) continue;
      Eigen::VectorXd a = Eigen::VectorXd::Zero(uncertainty.covariances.front().rows());
      a[unknown::screw + 2 * axis] = errors.screw_sin_mm[axis] / amplitude[axis];
      a[unknown::screw + 2 * axis + 1] = errors.screw_cos_mm[axis] / amplitude[axis];
      amplitude_sigma[axis] = uncertainty.sigma(a);
    }
    errors.screw_sigma_mm = amplitude_sigma;
  }
  if (stage.frees(Group::grain)) sigma.grain = two(unknown::grain);
  if (stage.frees(Group::flank)) sigma.flank_deg = uncertainty.sigma(unknown::flank);
  if (stage.frees(Group::burrs)) {
    sigma.burr_left_um = uncertainty.sigma(unknown::burrs);
    sigma.burr_right_um = uncertainty.sigma(unknown::burrs + 1);
    sigma.burr_width_um = profile.burr_width_um * uncertainty.sigma(unknown::burr_width);
  }
  if (stage.frees(Group::across)) sigma.across = profile.across * uncertainty.sigma(unknown::log_across);
}

// Sigmas of an area from photos: its radius, or its sides and their direction.
void put_size_sigmas(const Problem& data, const State& state, const Uncertainty& uncertainty, std::size_t light,
                     LampSize& size) {
  if (size.is_point()) return;
  const double unit = size_unit_mm(*data.model.board);
  const auto at = [&](int k) { return global_index(unknown::size2 + k, light); };
  if (size.disk_mm > 0) {
    size.disk_sigma_mm = uncertainty.sigma(at(0)) * unit * unit / (2 * size.disk_mm);
    return;
  }
  const double* numbers = state.block(unknown::size2, light);
  const auto slopes = panel_slopes({numbers[0], {numbers[1], numbers[2]}}, unit);
  std::array<double, 3> sigma{};
  for (std::size_t row = 0; row < 3; ++row) {
    Eigen::VectorXd a = Eigen::VectorXd::Zero(global_count(state.lamps.size()));
    for (int k = 0; k < 3; ++k) a[at(k)] = slopes[row][static_cast<std::size_t>(k)];
    sigma[row] = uncertainty.sigma(a);
  }
  size.panel_sigma_mm = Eigen::Vector2d(sigma[0], sigma[1]);
  size.turn_sigma_deg = sigma[2];
}

// Sigmas of an unmodeled light. Its distance may be almost unknown; then both are large.
void put_stray_sigmas(const Problem& data, const State& state, const Uncertainty& uncertainty, Light& stray) {
  const auto slopes = stray_slopes(stray_numbers(state.block(unknown::stray)), data.model.board->size_mm);
  std::array<double, 4> sigma{};
  for (int row = 0; row < 4; ++row) {
    Eigen::VectorXd a = Eigen::VectorXd::Zero(global_count(state.lamps.size()));
    a.segment<kStrayNumbers>(unknown::stray) = slopes.row(row);
    sigma[static_cast<std::size_t>(row)] = uncertainty.sigma(a);
  }
  stray.position_sigma_mm = Eigen::Vector3d(sigma[0], sigma[1], sigma[2]);
  stray.intensity_sigma = stray.intensity * sigma[3];
}

// Sigmas of the numbers from put_state(); judge_light() increases sigmas contradicted by halves of the photos.
void fill_sigmas(const Problem& data, const State& state, const Uncertainty& uncertainty, const Stage& stage,
                 Bench& bench) {
  bench.material_sigma.alpha = bench.material.alpha * uncertainty.sigma(unknown::log_alpha);
  bench.material_sigma.depth_um = bench.material.depth_um * uncertainty.sigma(unknown::log_depth);
  bench.material_sigma.base_alpha = bench.material.base_alpha * uncertainty.sigma(unknown::log_base_alpha);
  fill_effect_sigmas(uncertainty, stage, bench);
  bench.sensor.glare_share_sigma.reset();
  bench.sensor.vignette_sigma.reset();
  bench.sensor.psf_sigma_sigma_px.reset();
  bench.ambient_sigma.reset();
  if (stage.frees(Group::glare)) bench.sensor.glare_share_sigma = uncertainty.sigma(unknown::glare_share);
  if (bench.stray) put_stray_sigmas(data, state, uncertainty, *bench.stray);
  bench.depth_field.sigma.reset();
  if (!bench.depth_field.is_constant()) {
    bench.depth_field.sigma.emplace();
    for (int i = 0; i < GrooveField::kTerms; ++i)
      (*bench.depth_field.sigma)[i] = uncertainty.sigma(unknown::depth_field + i);
  }
  bench.machine_affine_sigma = machine_sigma(data, uncertainty);
  for (std::size_t light = 0; light < bench.lights.size(); ++light) {
    Light& l = bench.lights[light];
    const auto at = [&](int index) { return global_index(index, light); };
    const bool seen =
        std::any_of(data.photos.begin(), data.photos.end(), [&](const PhotoData& p) { return p.photo.light == light; });
    if (!seen) continue;
    if (stage.frees(Group::lamp)) {
      Eigen::Vector3d position_sigma;
      for (int i = 0; i < 3; ++i) position_sigma[i] = uncertainty.sigma(at(unknown::lamp_position + i));
      l.position_sigma_mm = position_sigma;
      if (seeks_size(data, light)) put_size_sigmas(data, state, uncertainty, light, l.size);
      if (data.is_spot[light]) l.falloff_exponent_sigma = uncertainty.sigma(at(unknown::spot + 2));
    }
    l.intensity_sigma = l.intensity * uncertainty.sigma(at(unknown::log_intensity));
  }
  for (std::size_t view = 0; view < uncertainty.center_sigma_mm.size(); ++view)
    if (uncertainty.center_sigma_mm[view] != Eigen::Vector3d::Zero())
      bench.views[view].center_sigma_mm = uncertainty.center_sigma_mm[view];
}

// Excess of the sigmas over the bound from the camera's noise alone: it is due to model error.
void compare_with_noise(const Uncertainty& uncertainty, const Stage& stage, Refinement& out) {
  Bench& bench = out.bench;
  const auto beside_noise = [&](const std::string& name, double sigma, double bound, Unit unit) {
    const auto verdict = bench.verdict.find(name);
    if (verdict == bench.verdict.end() || !verdict->second.determined() || !(bound > 0)) return;
    out.noise_bounds.push_back({name, sigma, bound, unit});
    verdict->second.causes.push_back({Cause::Kind::above_noise, {sigma / bound}});
  };
  for (const auto& [name, index] :
       {std::pair(parameter::kAlpha, unknown::log_alpha), std::pair(parameter::kDepth, unknown::log_depth),
        std::pair(parameter::kBaseAlpha, unknown::log_base_alpha)})
    beside_noise(name, 100 * uncertainty.sigma(index), 100 * uncertainty.bound(index), Unit::percent);
  for (std::size_t light = 0; light < bench.lights.size() && stage.frees(Group::lamp); ++light) {
    Eigen::Vector3d sigma_mm, bound_mm;
    for (int i = 0; i < 3; ++i) {
      sigma_mm[i] = uncertainty.sigma(global_index(unknown::lamp_position + i, light));
      bound_mm[i] = uncertainty.bound(global_index(unknown::lamp_position + i, light));
    }
    beside_noise(parameter::light_position(bench.lights[light].id), sigma_mm.norm(), bound_mm.norm(), Unit::mm);
  }
}

// Reports views with other grooves, unless a lamp's move explains them. They were compared before the fit's end: photos
// that it finally predicts as well as the others show these grooves.
void tell_other_grooves(const Board& board, const std::vector<std::string>& explained, Refinement& out) {
  std::erase_if(out.other_grooves, [&](const std::string& view) {
    return std::find(explained.begin(), explained.end(), view) != explained.end() || fits_as_usual(out.photos, view);
  });
  const bool several = out.other_grooves.size() > 1;
  std::string list;
  for (const std::string& view : out.other_grooves) list += (list.empty() ? "" : ", ") + view;
  if (list.empty()) return;
  out.findings.push_back(make_warning(FindingCode::wrong_grooves,
                                      "view" + std::string(several ? "s " : " ") + list + " show" +
                                          (several ? "" : "s") + " other grooves than " +
                                          (board.scratches.empty() ? "the scratches" : board.scratches.string()) +
                                          " lists: photos of another board or round, or under a lamp that was moved?",
                                      "take these photos out, and run burin capture and burin calibrate again"));
}

// Reports model errors, in the verdicts of the affected parameters and as findings. Returns the views whose oddness a
// moved lamp explains.
std::vector<std::string> tell_misfits(const Uncertainty& uncertainty, const Session* session, Refinement& out) {
  Bench& bench = out.bench;
  bench.misfits = uncertainty.misfits;
  if (bench.misfits.empty()) return {};
  std::string tests;
  double most = 0;
  for (const Misfit& m : bench.misfits) {
    tests += (tests.empty() ? "" : ", ") + m.test;
    if (!is_of_photo(m)) most = std::max(most, m.sigmas);  // a photo's is a ratio of residuals
  }
  const auto count = static_cast<double>(bench.misfits.size());
  std::vector<std::string> touched{parameter::kAlpha, parameter::kDepth, parameter::kBaseAlpha};
  for (const Light& light : bench.lights) touched.push_back(parameter::light_position(light.id));
  for (const std::string& name : touched)
    if (const auto verdict = bench.verdict.find(name); verdict != bench.verdict.end() && verdict->second.sigma)
      verdict->second.causes.push_back({Cause::Kind::model_misses, {most, count}, tests});
  // Odd photos form one finding if all precede, or all follow, one moment.
  std::vector<std::string> odd;
  for (const Misfit& m : bench.misfits)
    if (is_of_photo(m)) odd.push_back(m.test.substr(std::string_view("photo ").size()));
  std::vector<std::pair<std::string, double>> residuals;
  for (const PhotoFit& photo : out.photos)
    if (photo.pixels > 0) residuals.emplace_back(photo.view, photo.residual_to_noise);
  const auto change = session == nullptr ? std::nullopt : change_of_lamp(*session, residuals, odd);
  std::string odd_list;
  for (const std::string& view : odd) odd_list += (odd_list.empty() ? "" : ", ") + view;
  if (change)
    out.findings.push_back(make_warning(
        FindingCode::lamp_moved,
        "the lamp was moved between " + change->photo_before + " and " + change->photo_after + ": views " + odd_list +
            ", all taken " + (change->odd_after ? "after" : "before") +
            " it, are lit otherwise than the rest; sigmas count that",
        "leave the lamp where it stands, and take these photos again; or give them a light of their own in "
        "session.json; photos of another board are to be taken out"));
  for (const Misfit& m : bench.misfits) {
    const bool of_photo = is_of_photo(m);
    if (of_photo && change) continue;
    const std::string off = "alpha by " + significant(std::abs(m.alpha_percent)) + " %, depth by " +
                            significant(std::abs(m.depth_percent)) + " %, base_alpha by " +
                            significant(std::abs(m.base_alpha_percent)) + " %";
    out.findings.push_back(make_warning(
        FindingCode::model_misfit,
        of_photo
            ? "the model is not enough: its residuals in " + m.test + " are " + significant(m.sigmas) +
                  " times those in the others, and without it the answer moves, " + off + "; sigmas count that"
            : "the model is not enough: pixels set apart by " + quantity_in_words(m) + " ask for different benches (" +
                  significant(m.sigmas) + " sigmas), so the answer may be off, " + off + "; sigmas count that",
        remedy_in_words(m)));
  }
  return change ? odd : std::vector<std::string>();
}

}  // namespace

Combinations fill_bench(const Problem& data, const State& state, const Uncertainty& uncertainty, const Stage& stage,
                        const Session* session, Refinement& out) {
  Bench& bench = out.bench;
  put_state(state, data, bench);
  bench.material.f0 = data.model.board->material.f0;
  bench.sensor.gain = 1;
  bench.alpha_field = {};
  fill_sigmas(data, state, uncertainty, stage, bench);
  Combinations judged = judge_light(data, state, uncertainty, stage, bench);
  compare_with_noise(uncertainty, stage, out);
  tell_other_grooves(*data.model.board, tell_misfits(uncertainty, session, out), out);
  return judged;
}

Correlations correlations_of(const Problem& data, const Uncertainty& uncertainty, const Bench& bench) {
  const Eigen::Index n = uncertainty.covariances.front().rows();
  Correlations out;
  std::vector<Eigen::VectorXd> slopes;  // of each number, by all unknowns, up to a factor
  const auto is_known = [&](const std::string& name) {
    const auto verdict = bench.verdict.find(name);
    return verdict != bench.verdict.end() && verdict->second.known();
  };
  const auto add = [&](const std::string& name, const char* unit, double sigma, Eigen::VectorXd slope) {
    out.numbers.push_back({name, unit, sigma});
    slopes.push_back(std::move(slope));
  };
  const MaterialSigma& material = bench.material_sigma;
  for (const auto& [name, unit, sigma, index] :
       {std::tuple(parameter::kAlpha, "", &material.alpha, unknown::log_alpha),
        std::tuple(parameter::kDepth, "um", &material.depth_um, unknown::log_depth),
        std::tuple(parameter::kBaseAlpha, "", &material.base_alpha, unknown::log_base_alpha)})
    if (*sigma && is_known(name)) add(name, unit, **sigma, Eigen::VectorXd::Unit(n, index));
  const Eigen::Vector2d c = data.model.center_mm;
  const auto first_of_map = static_cast<Eigen::Index>(slopes.size());
  const bool has_map = bench.machine_affine_sigma && is_known(parameter::kMachine);
  for (int i = 0; has_map && i < 6; ++i) {
    const int row = i / 3, column = i % 3;
    const Eigen::Vector3d about_center =
        column < 2 ? Eigen::Vector3d::Unit(column) : Eigen::Vector3d(-c.x(), -c.y(), 1);
    add(std::string(parameter::kMachine) + "[" + std::to_string(row) + "][" + std::to_string(column) + "]",
        column < 2 ? "" : "mm", (*bench.machine_affine_sigma)(row, column), machine_combination(n, row, about_center));
  }
  for (std::size_t light = 0; light < bench.lights.size(); ++light) {
    const std::string name = parameter::light_position(bench.lights[light].id);
    for (int i = 0; bench.lights[light].position_sigma_mm && is_known(name) && i < 3; ++i)
      add(name + "[" + std::to_string(i) + "]", "mm", (*bench.lights[light].position_sigma_mm)[i],
          Eigen::VectorXd::Unit(n, global_index(unknown::lamp_position + i, light)));
  }
  const auto count = static_cast<Eigen::Index>(slopes.size());
  Eigen::MatrixXd J(count, n);
  for (Eigen::Index i = 0; i < count; ++i) J.row(i) = slopes[static_cast<std::size_t>(i)];
  std::vector<Eigen::MatrixXd> of_numbers;
  Eigen::VectorXd largest = Eigen::VectorXd::Zero(count);
  for (const Eigen::MatrixXd& covariance : uncertainty.covariances) {
    of_numbers.emplace_back(J * covariance * J.transpose());
    largest = largest.cwiseMax(of_numbers.back().diagonal());
  }
  Eigen::MatrixXd chosen = Eigen::MatrixXd::Zero(count, count);
  double most = -1;
  for (const Eigen::MatrixXd& one : of_numbers) {
    const double share = one.diagonal().cwiseQuotient(largest.cwiseMax(1e-300)).sum();
    if (share > most) most = share, chosen = one;
  }
  for (const Eigen::VectorXd& shift : uncertainty.shifts) chosen += (J * shift) * (J * shift).transpose();
  if (has_map) {  // the tags' frame moves each row of the map (machine_sigma)
    const Eigen::Matrix3d frame = tag_frame_covariance(*data.model.board);
    for (const Eigen::Index row : {0, 3}) chosen.block<3, 3>(first_of_map + row, first_of_map + row) += frame;
  }
  const Eigen::VectorXd scale = chosen.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  out.values = scale.asDiagonal() * chosen * scale.asDiagonal();
  return out;
}

void keep_believed(const Board& board, State& state, Bench& bench) {
  const auto keep = [&](const char* name, int index, double believed, double& value, std::optional<double>& sigma) {
    const auto verdict = bench.verdict.find(name);
    if (verdict == bench.verdict.end() || verdict->second.known()) return;
    if (rests_on(verdict->second, Cause::Kind::believed_refuted)) return;
    verdict->second.source = Source::assumed;
    value = believed;
    sigma.reset();
    state.shared[index] = std::log(believed);
  };
  Material& m = bench.material;
  MaterialSigma& sigma = bench.material_sigma;
  keep(parameter::kAlpha, unknown::log_alpha, board.material.alpha, m.alpha, sigma.alpha);
  keep(parameter::kDepth, unknown::log_depth, board.material.depth_um, m.depth_um, sigma.depth_um);
  keep(parameter::kBaseAlpha, unknown::log_base_alpha, board.material.base_alpha, m.base_alpha, sigma.base_alpha);
  bench.told = {board.material.alpha, board.material.depth_um, board.tool_width_um};
}

}  // namespace burin

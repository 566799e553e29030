#include "burin/calib/verdict/identifiability.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "burin/calib/light/lamp_model.h"
#include "burin/calib/photo/effect_unknowns.h"
#include "burin/calib/photo/machine_map.h"
#include "burin/calib/verdict/half_samples.h"
#include "burin/render/pixel_shading.h"
#include "burin/scene/groove.h"
#include "burin/scene/parameter_name.h"
#include "burin/scene/steepest_lean.h"
#include "burin/scene/surface.h"

namespace burin {
namespace {

// Limits of the sigma for each status, in the parameter's unit.
struct Limits {
  double determined, weakly;
};
constexpr Limits kRelative{20, 60};     // %: roughness, depth, intensity
constexpr Limits kLampPosition{5, 20};  // % of the distance
constexpr Limits kAxis{5, 20};          // degrees
constexpr Limits kExponent{50, 150};    // %
constexpr Limits kMachine{0.1, 0.3};    // mm over the carve area
constexpr Limits kVignette{2, 10};      // % of a pixel's value, half way to the picture's corners
constexpr Limits kAmbient{2, 10};       // % of white paper's reflection of the lamp's light
constexpr Limits kFocal{0.5, 2};        // % of the focal length; for the center: of the picture's longer side
constexpr Limits kCenter{1, 5};         // %
constexpr Limits kPose{0.3, 2};         // % of the camera's distance
constexpr Limits kBow{0.02, 0.2};       // mm; 0.1 mm moves a lamp by 12 to 18 mm (docs/model.md 9)
constexpr double kTagsLearnt = 0.5;     // of the prior sigma: a larger sigma means little information
constexpr double kTagsNotLearnt = 0.95;

// Comparison of the halves for several combinations that form one parameter.
HalvesVerdict pooled(const HalfSamples& halves, const std::vector<Eigen::VectorXd>& combinations,
                     const std::vector<double>& sigmas) {
  HalvesVerdict out;
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < combinations.size(); ++i) {
    const HalvesVerdict one = compare_halves(halves, combinations[i], sigmas[i]);
    if (one.degrees == 0) continue;
    sum += one.ratio * one.ratio;
    ++count;
    out.degrees = one.degrees;
    out.limit = std::max(out.limit, one.limit);
    out.half_to_whole = std::max(out.half_to_whole, one.half_to_whole);
  }
  if (count > 0) out.ratio = std::sqrt(sum / count);
  return out;
}

double widening(const HalvesVerdict& halves) { return halves.contradict() ? halves.ratio : 1; }

Cause by_halves(const HalvesVerdict& h, Cause::Kind kind = Cause::Kind::halves_of_photos) {
  return {kind, {h.ratio, h.limit, h.degrees, h.half_to_whole}};
}

Degree degree_of(double sigma, const Limits& limits) {
  return sigma < limits.determined ? Degree::determined
         : sigma < limits.weakly   ? Degree::weakly
                                   : Degree::not_determined;
}

// `sigma` in `unit`, already increased.
Verdict judged(double sigma, const Limits& limits, Unit unit, std::vector<Cause> causes) {
  return {Source::measured, degree_of(sigma, limits), sigma, unit, std::move(causes)};
}

// Sort key of views: the cosine of a direction's tilt from the board's normal.
double lean_key(const Eigen::Vector3d& direction) { return direction.z(); }

}  // namespace

Eigen::Matrix3d tag_frame_covariance(const Board& board) {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  for (const Tag& tag : board.tags.list) {
    const Eigen::Vector3d x(tag.center_mm.x(), tag.center_mm.y(), 1);
    information += x * x.transpose();
  }
  const double sigma = board.tags.sigma_mm;
  if (board.tags.list.size() < 3) return Eigen::Matrix3d::Identity() * sigma * sigma;
  return sigma * sigma * information.inverse();
}

// --- lens, poses, tags, bow ------------------------------------------------------------------------------------------

namespace {

// Each view's pose from halves of its tags, with all else fixed: the ratio by view (1 for too few tags).
std::vector<HalvesVerdict> pose_halves(const BoardSolution& geometry, const std::vector<std::size_t>& solved,
                                       const std::vector<BundleEquations::OfView>& whole) {
  const Bundle& bundle = geometry.bundle;
  const std::size_t tags = bundle.tags.size();
  std::vector<EquationsInParts> parts(solved.size());
  std::vector<std::vector<double>> angle(solved.size());
  const Eigen::Vector2d middle = 0.5 * bundle.surface.size_mm;
  for (std::size_t tag = 0; tag < tags; ++tag) {
    Bundle one = bundle;
    Eigen::Vector2d center(0, 0);
    for (BundleCorner& c : one.corners) {
      c.used = c.used && c.tag == static_cast<int>(tag);
      if (c.used) center = c.center_mm;
    }
    for (ViewLens& lens : one.view_lenses) lens.prior = without_prior(lens.prior);  // counted once, below
    BundleOptions options = geometry.options;
    options.fix_lens = options.fix_bow = options.fix_tags = true;
    const BundleEquations equations = bundle_equations(one, options);
    for (std::size_t i = 0; i < solved.size(); ++i) {
      const auto& view = equations.views[solved[i]];
      if (!view.used) continue;
      parts[i].information.emplace_back(view.H);
      parts[i].gradient.emplace_back(view.g);
      angle[i].push_back(std::atan2(center.y() - middle.y(), center.x() - middle.x()));
    }
  }
  std::vector<HalvesVerdict> out;
  for (std::size_t i = 0; i < solved.size(); ++i) {
    const int of_own = own_count(bundle, solved[i]);
    parts[i].prior = Eigen::MatrixXd::Zero(of_own, of_own);
    parts[i].prior_gradient = Eigen::VectorXd::Zero(of_own);
    if (of_own > 6) {
      const ViewLens& lens = bundle.view_lenses[solved[i]];
      const Eigen::Vector3d known(std::pow(lens.prior.shift_px, -2), std::pow(lens.prior.shift_px, -2),
                                  std::pow(lens.prior.focal, -2));
      parts[i].prior.diagonal().tail<3>() = known;
      parts[i].prior_gradient.tail<3>() = known.cwiseProduct(
          Eigen::Vector3d(lens.own.shift_px.x(), lens.own.shift_px.y(), std::log(lens.own.focal_ratio)));
    }
    parts[i].pairs = pair_neighbors(angle[i], std::vector<std::size_t>(angle[i].size(), 0));
    const Eigen::MatrixXd D = center_by_own(bundle, solved[i]);
    const Eigen::Matrix3d own = D * whole[solved[i]].H.ldlt().solve(D.transpose());
    std::vector<Eigen::VectorXd> rows;
    std::vector<double> sigmas;
    for (int axis = 0; axis < 3; ++axis) {
      rows.emplace_back(D.row(axis).transpose());
      sigmas.push_back(std::sqrt(own(axis, axis)));
    }
    out.push_back(pooled(half_samples(parts[i]), rows, sigmas));
  }
  return out;
}

}  // namespace

namespace {

// Inputs of the judgment, and its destination.
struct GeometryJudge {
  const BoardSolution& geometry;
  const Board& board;
  const BundleEquations equations;
  const std::vector<std::size_t> solved;  // indices into the bundle's views of geometry.views, in their order
  const HalfSamples halves;
  Bench& bench;
  Combinations judged_here{};

  // The columns from `at`, and the sigma of each.
  struct Columns {
    std::vector<Eigen::VectorXd> rows;
    std::vector<double> sigmas;
  };
  Columns columns(int at, int count) const {
    Columns out;
    for (int i = at; i < at + count; ++i) {
      out.rows.emplace_back(Eigen::VectorXd::Unit(equations.columns, i));
      out.sigmas.push_back(std::sqrt(std::max(0.0, halves.inverse(i, i))));
    }
    return out;
  }
};

std::vector<std::size_t> solved_views(const BundleEquations& equations) {
  std::vector<std::size_t> out;
  for (std::size_t v = 0; v < equations.views.size(); ++v)
    if (equations.views[v].used) out.push_back(v);
  return out;
}

HalfSamples geometry_halves(const BoardSolution& geometry, const Board& board, const BundleEquations& equations,
                            const std::vector<std::size_t>& solved) {
  EquationsInParts parts;
  std::vector<double> keys;
  const Eigen::Vector3d middle(0.5 * board.size_mm.x(), 0.5 * board.size_mm.y(), 0);
  for (const std::size_t v : solved) {
    parts.information.push_back(equations.views[v].information);
    parts.gradient.push_back(equations.views[v].gradient);
    const Eigen::Vector3d eye = geometry.bundle.views[v].inverse().translation();
    keys.push_back(lean_key((eye - middle).normalized()));
  }
  parts.prior = equations.prior;
  parts.prior_gradient = equations.prior_gradient;
  parts.pairs = pair_neighbors(keys, std::vector<std::size_t>(keys.size(), 0));
  return half_samples(parts);
}

void judge_lens(GeometryJudge& j) {
  const Lens& lens = j.geometry.lens;
  const auto [rows, sigmas] = j.columns(j.equations.lens_at, 4);
  const HalvesVerdict check = pooled(j.halves, rows, sigmas);
  const double grow = widening(check), longer = std::max(lens.width, lens.height);
  const double focal = 100 * grow * std::max(sigmas[0] / lens.intrinsics[0], sigmas[1] / lens.intrinsics[1]);
  const double center = 100 * grow * std::max(sigmas[2], sigmas[3]) / longer;
  // One number for both: relative sigma of the focal length, or the equivalent sigma of the center.
  const double share = std::max(focal, center * kFocal.determined / kCenter.determined);
  j.bench.verdict[parameter::kLens] =
      judged(share, kFocal, Unit::percent,
             {{Cause::Kind::of_focal_length,
               {lens.intrinsics[0], grow * sigmas[0], grow * std::max(sigmas[2], sigmas[3]), j.geometry.rms_px},
               lens.model},
              by_halves(check)});
  j.judged_here[parameter::kLens] = rows;
}

// The worst camera, and by name the cameras that are worse than determined.
void judge_poses(GeometryJudge& j) {
  const std::vector<HalvesVerdict> poses = pose_halves(j.geometry, j.solved, j.equations.views);
  double worst = 0;
  int contradicting = 0;
  std::string worst_view;
  for (std::size_t i = 0; i < j.solved.size() && i < j.bench.views.size(); ++i) {
    View& view = j.bench.views[i];
    const Eigen::MatrixXd D = center_by_own(j.geometry.bundle, j.solved[i]);
    const Eigen::Matrix3d own = D * j.equations.views[j.solved[i]].H.ldlt().solve(D.transpose());
    const double grow = widening(poses[i]);
    contradicting += poses[i].contradict();
    Eigen::Vector3d sigma = view.center_sigma_mm.value_or(Eigen::Vector3d::Zero());
    for (int axis = 0; axis < 3; ++axis)
      sigma[axis] = std::sqrt(sigma[axis] * sigma[axis] + (grow * grow - 1) * own(axis, axis));
    view.center_sigma_mm = sigma;
    const double distance = view.T_camera_board.translation().norm(), share = 100 * sigma.norm() / distance;
    if (share >= kPose.determined || poses[i].contradict()) {
      Verdict& verdict = j.bench.verdict[parameter::pose(view.name)] =
          judged(share, kPose, Unit::percent,
                 {{Cause::Kind::of_camera_distance}, by_halves(poses[i], Cause::Kind::halves_of_tags)});
      if (!verdict.determined())
        verdict.next_photo =
            NextPhoto{own.trace() > 0.5 * sigma.squaredNorm() ? NextPhoto::Kind::same_view_with_more_tags
                                                              : NextPhoto::Kind::any_for_the_lens};
    }
    if (share >= worst) {
      worst = share;
      worst_view = view.name;
    }
  }
  j.bench.verdict[parameter::kPoses] = judged(
      worst, kPose, Unit::percent,
      {{Cause::Kind::of_camera_distance, {}, worst_view},
       {Cause::Kind::poses_by_halves, {static_cast<double>(contradicting), static_cast<double>(j.solved.size())}}});
}

// Tags as a group: root mean square.
void judge_tags(GeometryJudge& j) {
  GeometryJudge::Columns tags;
  double sum2 = 0;
  for (const int at : j.equations.tag_at) {
    if (at < 0) continue;
    const GeometryJudge::Columns one = j.columns(at, 2);
    for (int i = 0; i < 2; ++i) {
      tags.rows.push_back(one.rows[i]);
      tags.sigmas.push_back(one.sigmas[i]);
      sum2 += one.sigmas[i] * one.sigmas[i];
    }
  }
  if (tags.rows.empty()) return;
  const HalvesVerdict check = pooled(j.halves, tags.rows, tags.sigmas);
  for (Tag& tag : j.bench.tags) {
    if (tag.center_sigma_mm) *tag.center_sigma_mm *= widening(check);
    if (tag.rotation_sigma_deg) *tag.rotation_sigma_deg *= widening(check);
  }
  const double sigma = widening(check) * std::sqrt(sum2 / static_cast<double>(tags.rows.size()));
  const double believed = std::max(j.board.tags.sigma_mm, 1e-9);
  j.bench.verdict[parameter::kTags] = judged(sigma, {kTagsLearnt * believed, kTagsNotLearnt * believed}, Unit::mm,
                                             {{Cause::Kind::of_tag_place, {believed}}, by_halves(check)});
  j.judged_here[parameter::kTags] = std::move(tags.rows);
}

void judge_bow(GeometryJudge& j) {
  // For a bent sheet, the bow's first two numbers describe its bend: the sigma belongs to its rim.
  const bool bent = j.geometry.bundle.surface.bend.has_value();
  const char* const name = bent ? parameter::kBend : parameter::kBow;
  const auto [rows, sigmas] = j.columns(j.equations.shared_at + 1, bent ? 2 : 3);
  const HalvesVerdict check = pooled(j.halves, rows, sigmas);
  if (j.bench.bow_sigma_mm) *j.bench.bow_sigma_mm *= widening(check);
  j.bench.verdict[name] = judged(widening(check) * *std::max_element(sigmas.begin(), sigmas.end()), kBow, Unit::mm,
                                 {{Cause::Kind::of_bow}, by_halves(check)});
  j.judged_here[name] = rows;
}

}  // namespace

Combinations judge_geometry(const BoardSolution& geometry, const Board& board, bool fixed_lens, Bench& bench) {
  const BundleEquations equations = bundle_equations(geometry.bundle, geometry.options);
  const std::vector<std::size_t> solved = solved_views(equations);
  GeometryJudge j{geometry, board, equations, solved, geometry_halves(geometry, board, equations, solved), bench};
  if (fixed_lens)
    bench.verdict[parameter::kLens] = given_verdict();
  else
    judge_lens(j);
  judge_poses(j);
  judge_tags(j);
  if (equations.shared_at >= 0 && !equations.bow_held) judge_bow(j);
  return std::move(j.judged_here);
}

// --- light, grooves, machine -----------------------------------------------------------------------------------------

Straddle straddle_of(const Carved& grooves, const Surface& surface, double alpha, double depth_um, double tool_width_um,
                     const Eigen::Vector3d& lamp, const Eigen::Vector3d& camera, const GrooveProfile& profile) {
  const Scratches& carved = grooves.scratches;
  Straddle out;
  for (std::size_t i = 0; i < carved.size(); ++i) {
    const Eigen::Vector3d a(carved.x0_mm[i], carved.y0_mm[i], 0), b(carved.x1_mm[i], carved.y1_mm[i], 0);
    Eigen::Vector3d p = 0.5 * (a + b);
    const Eigen::Vector3d n = face_normal(surface, p.x(), p.y());
    Eigen::Vector3d along = (b - a).normalized();
    if (surface.bend) {
      along = R_face_board(n).transpose() * along;
      p = face_point(surface, p.x(), p.y());
    }
    const Eigen::Vector3d across = along.cross(n);
    const Eigen::Vector3d h = ((lamp - p).normalized() + (camera - p).normalized()).normalized();
    if (std::abs(std::asin(std::clamp(h.dot(along), -1.0, 1.0))) > 2 * alpha) continue;
    const double width = carved.width_um.empty() ? tool_width_um : carved.width_um[i];
    const double cutoff = steepest_lean(profile, width, carved.depth_um.empty() ? depth_um : carved.depth_um[i]);
    const double beyond = std::atan2(std::abs(h.dot(across)), h.dot(n)) - cutoff;
    const double band = 0.05 + 4 * alpha, softness = 0.5 * alpha;
    if (std::abs(beyond) > band || std::abs(beyond) < softness) continue;
    ++(beyond > 0 ? out.outside : out.inside);
  }
  return out;
}

EquationsInParts light_in_parts(const Problem& data, const State& state, const Uncertainty& u) {
  EquationsInParts parts;
  parts.information = u.part_information;
  parts.gradient = u.part_gradient;
  parts.prior = u.prior_information.asDiagonal();
  parts.prior_gradient = u.prior_gradient;
  std::vector<double> keys;
  std::vector<std::size_t> lamps;
  const Eigen::Vector3d center(data.model.center_mm.x(), data.model.center_mm.y(), 0);
  for (const std::size_t k : u.part_photo) {
    const PhotoData& photo = data.photos[k];
    const Eigen::Vector3d lamp = state.of(photo.photo.light).segment<3>(unknown::lamp_position);
    const Eigen::Vector3d to_camera = (photo.scene.camera_center_mm - center).normalized();
    keys.push_back(lean_key(((lamp - center).normalized() + to_camera).normalized()));
    lamps.push_back(photo.photo.light);
  }
  parts.pairs = pair_neighbors(keys, lamps);
  return parts;
}

Straddle straddle_of(const Problem& data, const State& state) {
  ModelData whole = data.model;
  whole.crossings = Crossings::add;
  const Unknowns shared = state.of(0);
  const Carved carved = carved_at(whole, shared);
  Straddle out;
  for (const PhotoData& photo : data.photos) {
    const Straddle one = straddle_of(carved, photo.camera.surface, std::exp(shared[unknown::log_alpha]),
                                     std::exp(shared[unknown::log_depth]), data.model.board->tool_width_um,
                                     state.of(photo.photo.light).segment<3>(unknown::lamp_position),
                                     photo.scene.camera_center_mm, profile_of(data.model.profile, shared));
    out.inside += one.inside;
    out.outside += one.outside;
  }
  return out;
}

namespace {

// Inputs of the judgment, and its destination.
struct LightJudge {
  const Problem& data;
  const State& state;
  const Uncertainty& u;
  const Stage& stage;
  const HalfSamples halves;
  Bench& bench;
  Combinations judged_here{};

  Eigen::Index size() const { return u.covariances.front().rows(); }
  Eigen::VectorXd unit(int at) const { return Eigen::VectorXd::Unit(size(), at); }
  Eigen::Vector3d center() const { return {data.model.center_mm.x(), data.model.center_mm.y(), 0}; }

  // Keeps a parameter's combinations, and compares halves of the photos by them.
  HalvesVerdict check(const std::string& name, const std::vector<Eigen::VectorXd>& rows) {
    judged_here[name] = rows;
    std::vector<double> sigmas;
    sigmas.reserve(rows.size());
    for (const Eigen::VectorXd& row : rows) sigmas.push_back(u.sigma(row));
    return pooled(halves, rows, sigmas);
  }

  // Judges a parameter that is one combination of unknowns; its sigma is `scale` times theirs. Returns the factor by
  // which the sigma increased.
  double judge_one(const std::string& name, const Eigen::VectorXd& row, double scale, const Limits& limits,
                   std::vector<Cause> causes = {}) {
    const HalvesVerdict halves_say = check(name, {row});
    causes.push_back(by_halves(halves_say));
    bench.verdict[name] =
        judged(100 * widening(halves_say) * u.sigma(row) / scale, limits, Unit::percent, std::move(causes));
    return widening(halves_say);
  }

  // Judges roughness and depth, whose unknowns are logarithms: their sigmas are relative.
  void judge_material(const char* name, int at, double value, std::optional<double>& sigma) {
    judge_one(name, unit(at), 1, kRelative);
    const Verdict& verdict = bench.verdict[name];
    if (verdict.known())
      sigma = value * *verdict.sigma / 100;
    else
      sigma.reset();
  }
};

void judge_grooves(LightJudge& j) {
  Bench& bench = j.bench;
  j.judge_material(parameter::kAlpha, unknown::log_alpha, bench.material.alpha, bench.material_sigma.alpha);
  j.judge_material(parameter::kDepth, unknown::log_depth, bench.material.depth_um, bench.material_sigma.depth_um);
  const Straddle straddle = straddle_of(j.data, j.state);
  const std::array<double, 4> counts{static_cast<double>(straddle.inside), static_cast<double>(straddle.outside)};
  Verdict& depth = bench.verdict[parameter::kDepth];
  if (straddle.both()) {
    depth.causes.push_back({Cause::Kind::cutoff_seen, counts});
  } else {
    depth = {};
    depth.causes.push_back({Cause::Kind::cutoff_not_seen, counts});
    bench.material_sigma.depth_um.reset();
  }
}

void judge_machine(LightJudge& j) {
  const Board& board = *j.data.model.board;
  const Eigen::Vector2d c = j.data.model.center_mm;
  const Eigen::Matrix3d frame = tag_frame_covariance(board);
  std::vector<Eigen::VectorXd> rows;
  double photos = 0, whole = 0;  // the worst over the carve area's corners
  for (const double x : {board.carve_min_mm.x(), board.carve_max_mm.x()})
    for (const double y : {board.carve_min_mm.y(), board.carve_max_mm.y()})
      for (int row = 0; row < 2; ++row) {
        rows.push_back(machine_combination(j.size(), row, {x - c.x(), y - c.y(), 1}));
        photos = std::max(photos, j.u.sigma(rows.back()));
        const Eigen::Vector3d at(x, y, 1);
        whole = std::max(whole, std::hypot(j.u.sigma(rows.back()), std::sqrt(at.dot(frame * at))));
      }
  const HalvesVerdict check = j.check(parameter::kMachine, rows);
  const double grow = widening(check);
  j.bench.verdict[parameter::kMachine] =
      judged(std::hypot(whole, std::sqrt(grow * grow - 1) * photos), kMachine, Unit::mm,
             {{Cause::Kind::of_carve_area, {grow * photos}}, by_halves(check)});
  if (j.bench.machine_affine_sigma) *j.bench.machine_affine_sigma *= grow;
}

// Reflection of the brightest lamp's light by white paper in the middle: the scale for ambient light.
double light_on_paper(const LightJudge& j) {
  double paper = 0;
  for (const Light& light : j.bench.lights) {
    const Eigen::Vector3d d = light.position_mm - j.center();
    paper = std::max(paper,
                     light.intensity.mean() * std::max(0.0, d.normalized().z()) / d.squaredNorm() / std::numbers::pi);
  }
  return paper;
}

void judge_vignette(LightJudge& j) {
  constexpr double kRadius2 = 0.5;
  Eigen::VectorXd at = Eigen::VectorXd::Zero(j.size());
  double power = 1;
  for (int i = 0; i < 3; ++i) at[unknown::vignette + i] = power *= kRadius2;
  const double grow = j.judge_one(parameter::kVignette, at, 1, kVignette, {{Cause::Kind::of_picture_corner}});
  Eigen::Vector3d& sigma = j.bench.sensor.vignette_sigma.emplace();
  for (int i = 0; i < 3; ++i) sigma[i] = grow * j.u.sigma(unknown::vignette + i);
}

void judge_position(LightJudge& j, std::size_t i) {
  Light& light = j.bench.lights[i];
  const std::string name = parameter::light_position(light.id);
  std::vector<Eigen::VectorXd> rows;
  rows.reserve(3);
  for (int k = 0; k < 3; ++k) rows.push_back(j.unit(global_index(unknown::lamp_position + k, i)));
  const HalvesVerdict check = j.check(name, rows);
  Eigen::Vector3d sigma;
  for (int k = 0; k < 3; ++k) sigma[k] = widening(check) * j.u.sigma(rows[k]);
  light.position_sigma_mm = sigma;
  const double share = 100 * sigma.norm() / (light.position_mm - j.center()).norm();
  j.bench.verdict[name] = {Source::measured,
                           degree_of(share, kLampPosition),
                           sigma.norm(),
                           Unit::mm,
                           {{Cause::Kind::of_lamp_distance, {share}}, by_halves(check)}};
}

void judge_spot(LightJudge& j, std::size_t i) {
  Light& light = j.bench.lights[i];
  const std::string axis = parameter::light_axis(light.id), falloff = parameter::light_falloff(light.id);
  if (!j.data.is_spot[i]) {
    for (const std::string& name : {falloff, axis})
      j.bench.verdict[name] = {Source::measured, Degree::determined, {}, Unit::none, {{Cause::Kind::bare_lamp}}};
    return;
  }
  if (j.data.spot_held[i]) {
    for (const std::string& name : {falloff, axis})
      j.bench.verdict[name] = {Source::assumed,
                               Degree::weakly,
                               {},
                               Unit::none,
                               {{Cause::Kind::shines_as_a_plane, {kPlaneExponent, kPlaneExponentSigma}}}};
    return;
  }
  const int spot = global_index(unknown::spot, i);
  const HalvesVerdict exponent = j.check(falloff, {j.unit(spot + 2)});
  light.falloff_exponent_sigma = widening(exponent) * j.u.sigma(spot + 2);
  j.bench.verdict[falloff] = judged(100 * *light.falloff_exponent_sigma / std::max(1e-9, light.falloff_exponent),
                                    kExponent, Unit::percent, {by_halves(exponent)});
  const HalvesVerdict aim = j.check(axis, {j.unit(spot), j.unit(spot + 1)});
  const double across = widening(aim) * std::hypot(j.u.sigma(spot), j.u.sigma(spot + 1)),
               distance = (light.position_mm - j.center()).norm();
  j.bench.verdict[axis] =
      judged(std::atan(across / distance) * 180 / std::numbers::pi, kAxis, Unit::degrees, {by_halves(aim)});
}

// Judges a size from photos; a size from a ruler stays fixed; a point has no verdict.
void judge_size(LightJudge& j, std::size_t i) {
  Light& light = j.bench.lights[i];
  const std::string size = parameter::light_size(light.id);
  j.bench.verdict.erase(size);
  if (!seeks_size(j.data, i)) {
    if (!light.size.is_point()) j.bench.verdict[size] = given_verdict();
    return;
  }
  if (!light.size.is_measured()) return;
  const int first = global_index(unknown::size2, i);
  if (light.size.disk_mm > 0) {
    const HalvesVerdict check = j.check(size, {j.unit(first)});
    *light.size.disk_sigma_mm *= widening(check);
    j.bench.verdict[size] =
        judged(100 * *light.size.disk_sigma_mm / light.size.disk_mm, kRelative, Unit::percent, {by_halves(check)});
    return;
  }
  const HalvesVerdict check = j.check(size, {j.unit(first), j.unit(first + 1), j.unit(first + 2)});
  *light.size.panel_sigma_mm *= widening(check);
  *light.size.turn_sigma_deg *= widening(check);
  j.bench.verdict[size] = judged(100 * light.size.panel_sigma_mm->cwiseQuotient(light.size.panel_mm).maxCoeff(),
                                 kRelative, Unit::percent, {by_halves(check)});
}

// Judges an unmodeled light by its direction.
void judge_stray(LightJudge& j) {
  j.bench.verdict.erase(parameter::kStray);
  if (!j.bench.stray) return;
  const HalvesVerdict check = j.check(parameter::kStray, {j.unit(unknown::stray), j.unit(unknown::stray + 1)});
  const double across = widening(check) * std::hypot(j.u.sigma(unknown::stray), j.u.sigma(unknown::stray + 1));
  j.bench.verdict[parameter::kStray] =
      judged(std::atan(across) * 180 / std::numbers::pi, kAxis, Unit::degrees, {by_halves(check)});
}

// Surroundings: given except for their scale.
void judge_surroundings(LightJudge& j, std::size_t i) {
  Light& light = j.bench.lights[i];
  const std::string intensity = parameter::light_intensity(light.id);
  j.judge_one(intensity, j.unit(unknown::ambient), std::max(j.state.shared[unknown::ambient], 1e-300), kRelative);
  constexpr double kTables = 0.2;  // percent: approximate error of the surroundings' tables (model.md 10.7)
  double& percent = *j.bench.verdict[intensity].sigma;
  percent = std::hypot(percent, kTables);
  light.intensity_sigma = light.intensity * (percent / 100);
}

void judge_lamp(LightJudge& j, std::size_t i) {
  Light& light = j.bench.lights[i];
  if (!light.is_near()) return;  // photos are measured under lamps
  const std::string position = parameter::light_position(light.id);
  const auto& photos = j.data.photos;
  if (std::none_of(photos.begin(), photos.end(), [&](const PhotoData& p) { return p.photo.light == i; })) {
    j.bench.verdict[position] = {
        Source::assumed, Degree::not_determined, {}, Unit::none, {{Cause::Kind::no_photo_under_lamp}}};
    return;
  }
  if (!j.stage.frees(Group::lamp)) {
    j.bench.verdict[position] = given_verdict();
  } else {
    judge_position(j, i);
    judge_spot(j, i);
    judge_size(j, i);
  }
  if (!j.stage.frees(Group::intensity)) return;
  const std::string intensity = parameter::light_intensity(light.id);
  j.judge_one(intensity, j.unit(global_index(unknown::log_intensity, i)), 1, kRelative);
  constexpr double kTables = 0.2;  // percent: approximate error of the surroundings' tables (model.md 10.7)
  double& percent = *j.bench.verdict[intensity].sigma;
  percent = std::hypot(percent, kTables);
  light.intensity_sigma = light.intensity * (percent / 100);
}

}  // namespace

Combinations judge_light(const Problem& data, const State& state, const Uncertainty& u, const Stage& stage,
                         Bench& bench) {
  LightJudge j{data, state, u, stage, half_samples(light_in_parts(data, state, u)), bench};
  if (stage.frees(Group::groove)) judge_grooves(j);
  if (stage.frees(Group::base))
    j.judge_material(parameter::kBaseAlpha, unknown::log_base_alpha, bench.material.base_alpha,
                     bench.material_sigma.base_alpha);
  if (stage.frees(Group::machine)) judge_machine(j);
  if (stage.frees(Group::ambient) && data.surroundings)
    judge_surroundings(j, *data.surroundings);
  else if (stage.frees(Group::ambient))
    bench.ambient_sigma =
        Eigen::Vector3d::Constant(u.sigma(unknown::ambient) * j.judge_one(parameter::kAmbient, j.unit(unknown::ambient),
                                                                          std::max(light_on_paper(j), 1e-300), kAmbient,
                                                                          {{Cause::Kind::of_paper_light}}));
  if (stage.frees(Group::vignette)) judge_vignette(j);
  if (stage.frees(Group::blur))
    bench.sensor.psf_sigma_sigma_px = bench.sensor.psf_sigma_px * u.sigma(unknown::log_blur) *
                                      j.judge_one(parameter::kBlur, j.unit(unknown::log_blur), 1, kRelative,
                                                  {{Cause::Kind::of_blur, {bench.sensor.psf_sigma_px}}});
  if (stage.frees(Group::glare))
    j.judge_one(parameter::kGlare, j.unit(unknown::glare_share), std::max(bench.sensor.glare.share, 1e-6), kRelative);
  judge_stray(j);
  for (std::size_t i = 0; i < bench.lights.size(); ++i) judge_lamp(j, i);
  return std::move(j.judged_here);
}

}  // namespace burin

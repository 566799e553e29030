#include "burin/calib/verdict/identifiability.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

#include "burin/calib/verdict/half_samples.h"
#include "burin/render/groove.h"
#include "burin/render/surface.h"

namespace burin {
namespace {

constexpr const char* kGiven = "given, and held fixed";

std::string number(double value, int digits = 2) {
  std::ostringstream out;
  out.precision(digits);
  out << value;
  return out.str();
}

// How well something must be known, in its unit.
struct Limits {
  double determined, weakly;
};
constexpr Limits kRelative{20, 60};     // %: roughness, depth, intensity
constexpr Limits kLampPosition{5, 20};  // % of the distance
constexpr Limits kAxis{5, 20};          // degrees
constexpr Limits kExponent{50, 150};    // %
constexpr Limits kMachine{0.1, 0.3};    // mm over the carve area
constexpr Limits kVignette{2, 10};      // % of a pixel's value, half way to the picture's corners
constexpr Limits kAmbient{2, 10};       // % of what white paper sends back of the lamp's light
constexpr Limits kFocal{0.5, 2};        // % of the focal length; a center: of the picture's longer side
constexpr Limits kCenter{1, 5};         // %
constexpr Limits kPose{0.3, 2};         // % of the camera's distance
constexpr Limits kBow{0.02, 0.2};       // mm; 0.1 mm moves a lamp by 12 to 18 mm (docs/model.md 9)
constexpr double kTagsLearnt = 0.5;     // of what was believed: photos that leave more say little
constexpr double kTagsNotLearnt = 0.95;

// What the halves say of several combinations that are one parameter together.
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

std::string halves_in_words(const HalvesVerdict& halves, const char* of_what) {
  if (halves.degrees == 0) return std::string("too few ") + of_what + " to compare halves of them";
  std::string out = std::string("halves of the ") + of_what;
  if (halves.contradict())
    out += " contradict each other: they differ " + number(halves.ratio) +
           " times as much as the covariance allows (up to " + number(halves.limit) +
           " is chance), so the sigma was made that much larger";
  else
    out += " agree (their difference is " + number(halves.ratio) + " of what is to be expected; up to " +
           number(halves.limit) + " is chance)";
  constexpr double kFewCarry = 4;
  if (halves.half_to_whole > kFewCarry) out += "; it rests on few of the " + std::string(of_what);
  return out;
}

// `sigma` in `unit`, already widened.
Verdict judged(double sigma, const Limits& limits, const std::string& unit, const std::string& what,
               const std::string& halves) {
  Verdict out;
  out.determined = sigma < limits.determined;
  out.weakly = !out.determined && sigma < limits.weakly;
  out.sigma = sigma;
  out.unit = unit;
  out.reason = "one sigma is " + number(sigma) + " " + unit + what;
  if (!out.determined)
    out.reason += out.weakly ? "; the photos do not tell it better than that" : ", so the photos do not tell it";
  if (!halves.empty()) out.reason += "; " + halves;
  return out;
}

// Sine of a camera's lean from the board's normal, times its azimuth's cosine and sine: what sets views apart.
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

// Each view's pose from halves of its tags, everything else held: the ratio by view (1 where there are too few).
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
    parts[i].prior = Eigen::MatrixXd::Zero(6, 6);
    parts[i].prior_gradient = Eigen::VectorXd::Zero(6);
    parts[i].pairs = pair_neighbors(angle[i], std::vector<std::size_t>(angle[i].size(), 0));
    const Eigen::Matrix<double, 3, 6> D = center_by_pose(bundle.views[solved[i]]);
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

bool lens_was_given(const Bench& bench) {
  const auto verdict = bench.verdict.find("lens");
  return verdict != bench.verdict.end() && verdict->second.reason == kGiven;
}

Combinations judge_geometry(const BoardSolution& geometry, const Board& board, bool fixed_lens, Bench& bench) {
  const BundleEquations equations = bundle_equations(geometry.bundle, geometry.options);
  EquationsInParts parts;
  std::vector<double> keys;
  std::vector<std::size_t> solved;  // indices into the bundle's views of geometry.views, in their order
  for (std::size_t v = 0; v < equations.views.size(); ++v) {
    const auto& view = equations.views[v];
    if (!view.used) continue;
    solved.push_back(v);
    parts.information.push_back(view.information);
    parts.gradient.push_back(view.gradient);
    const Eigen::Vector3d eye = geometry.bundle.views[v].inverse().translation();
    const Eigen::Vector3d middle(0.5 * board.size_mm.x(), 0.5 * board.size_mm.y(), 0);
    keys.push_back(lean_key((eye - middle).normalized()));
  }
  parts.prior = equations.prior;
  parts.prior_gradient = equations.prior_gradient;
  parts.pairs = pair_neighbors(keys, std::vector<std::size_t>(keys.size(), 0));
  const HalfSamples halves = half_samples(parts);
  const auto column = [&](int at) { return Eigen::VectorXd(Eigen::VectorXd::Unit(equations.columns, at)); };
  const auto sigma_of = [&](int at) { return std::sqrt(std::max(0.0, halves.inverse(at, at))); };

  Combinations judged_here;
  const Lens& lens = geometry.lens;
  if (fixed_lens) {
    bench.verdict["lens"] = {true, kGiven};
  } else {
    std::vector<Eigen::VectorXd> rows;
    std::vector<double> sigmas;
    for (int i = 0; i < 4; ++i) {
      rows.push_back(column(equations.lens_at + i));
      sigmas.push_back(sigma_of(equations.lens_at + i));
    }
    const HalvesVerdict check = pooled(halves, rows, sigmas);
    const double grow = widening(check), longer = std::max(lens.width, lens.height);
    const double focal = 100 * grow * std::max(sigmas[0] / lens.intrinsics[0], sigmas[1] / lens.intrinsics[1]);
    const double center = 100 * grow * std::max(sigmas[2], sigmas[3]) / longer;
    // One number for both: the share of the focal length, or what of a center counts as much.
    const double share = std::max(focal, center * kFocal.determined / kCenter.determined);
    std::ostringstream text;
    text << " of the focal length or as much for the center (" << lens.model << ", focal length "
         << number(lens.intrinsics[0], 6) << " +- " << number(grow * sigmas[0]) << " px, center +- "
         << number(grow * std::max(sigmas[2], sigmas[3])) << " px; corners " << number(geometry.rms_px, 3)
         << " px RMS per axis)";
    bench.verdict["lens"] = judged(share, kFocal, "%", text.str(), halves_in_words(check, "photos"));
    judged_here["lens"] = rows;
  }

  // Poses: the worst camera, and those that are worse than determined by name.
  const std::vector<HalvesVerdict> poses = pose_halves(geometry, solved, equations.views);
  double worst = 0;
  int contradicting = 0;
  std::string worst_view;
  for (std::size_t i = 0; i < solved.size() && i < bench.views.size(); ++i) {
    View& view = bench.views[i];
    const Eigen::Matrix<double, 3, 6> D = center_by_pose(geometry.bundle.views[solved[i]]);
    const Eigen::Matrix3d own = D * equations.views[solved[i]].H.ldlt().solve(D.transpose());
    const double grow = widening(poses[i]);
    contradicting += poses[i].contradict();
    Eigen::Vector3d sigma = view.center_sigma_mm.value_or(Eigen::Vector3d::Zero());
    for (int axis = 0; axis < 3; ++axis)
      sigma[axis] = std::sqrt(sigma[axis] * sigma[axis] + (grow * grow - 1) * own(axis, axis));
    view.center_sigma_mm = sigma;
    const double distance = view.T_camera_board.translation().norm(), share = 100 * sigma.norm() / distance;
    if (share >= kPose.determined || poses[i].contradict()) {
      Verdict& verdict = bench.verdict["pose." + view.name] =
          judged(share, kPose, "%", " of the camera's distance", halves_in_words(poses[i], "tags"));
      if (!verdict.determined)
        verdict.next_photo = own.trace() > 0.5 * sigma.squaredNorm()
                                 ? "the same view again with more of the board's tags in it, sharp"
                                 : "any that helps the lens, which this pose depends on";
    }
    if (share >= worst) {
      worst = share;
      worst_view = view.name;
    }
  }
  bench.verdict["poses"] =
      judged(worst, kPose, "%", " of the camera's distance, in view " + worst_view + ", the worst",
             contradicting == 0 ? "in every view, poses from halves of its tags agree"
                                : "in " + std::to_string(contradicting) + " of " + std::to_string(solved.size()) +
                                      " views, poses from halves of the tags contradict each other, and their sigmas "
                                      "were made larger");

  // Tags as a group: root mean square.
  std::vector<Eigen::VectorXd> rows;
  std::vector<double> sigmas;
  double sum2 = 0;
  for (const int at : equations.tag_at)
    for (int i = 0; at >= 0 && i < 2; ++i) {
      rows.push_back(column(at + i));
      sigmas.push_back(sigma_of(at + i));
      sum2 += sigmas.back() * sigmas.back();
    }
  if (!rows.empty()) {
    const HalvesVerdict check = pooled(halves, rows, sigmas);
    const double sigma = widening(check) * std::sqrt(sum2 / static_cast<double>(rows.size()));
    const double believed = std::max(board.tags.sigma_mm, 1e-9);
    judged_here["board.tags"] = rows;
    bench.verdict["board.tags"] =
        judged(sigma, {kTagsLearnt * believed, kTagsNotLearnt * believed}, "mm",
               " for a tag's place against the others' (believed before: " + number(believed) + " mm)",
               halves_in_words(check, "photos"));
  }
  if (equations.shared_at >= 0 && !equations.bow_held) {
    rows.clear();
    sigmas.clear();
    for (int i = 0; i < 3; ++i) {
      rows.push_back(column(equations.shared_at + 1 + i));
      sigmas.push_back(sigma_of(equations.shared_at + 1 + i));
    }
    const HalvesVerdict check = pooled(halves, rows, sigmas);
    bench.verdict["board.bow_mm"] = judged(widening(check) * *std::max_element(sigmas.begin(), sigmas.end()), kBow,
                                           "mm", ", from the tags", halves_in_words(check, "photos"));
    judged_here["board.bow_mm"] = rows;
  }
  return judged_here;
}

// --- light, grooves, machine -----------------------------------------------------------------------------------------

Straddle straddle_of(const Carved& grooves, const Surface& surface, double alpha, double depth_um, double tool_width_um,
                     const Eigen::Vector3d& lamp, const Eigen::Vector3d& camera) {
  const Scratches& carved = grooves.scratches;
  Straddle out;
  for (std::size_t i = 0; i < carved.size(); ++i) {
    const Eigen::Vector3d a(carved.x0_mm[i], carved.y0_mm[i], 0), b(carved.x1_mm[i], carved.y1_mm[i], 0);
    const Eigen::Vector3d p = 0.5 * (a + b);
    const Eigen::Vector3d n = face_normal(surface, p.x(), p.y());
    const Eigen::Vector3d along = (b - a).normalized(), across = along.cross(n);
    const Eigen::Vector3d h = ((lamp - p).normalized() + (camera - p).normalized()).normalized();
    if (std::abs(std::asin(std::clamp(h.dot(along), -1.0, 1.0))) > 2 * alpha) continue;
    const double width = carved.width_um.empty() ? tool_width_um : carved.width_um[i];
    const double cutoff = 2 * std::atan(groove_rim(width, carved.depth_um.empty() ? depth_um : carved.depth_um[i]));
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

Combinations judge_light(const Problem& data, const State& state, const Uncertainty& u, const Stage& stage,
                         Bench& bench) {
  const HalfSamples halves = half_samples(light_in_parts(data, state, u));
  const Eigen::Index n = u.covariances.front().rows();
  const auto unit = [&](int at) { return Eigen::VectorXd(Eigen::VectorXd::Unit(n, at)); };
  const auto check_of = [&](const std::vector<Eigen::VectorXd>& rows) {
    std::vector<double> sigmas;
    sigmas.reserve(rows.size());
    for (const Eigen::VectorXd& row : rows) sigmas.push_back(u.sigma(row));
    return pooled(halves, rows, sigmas);
  };
  const auto& s = state.shared;
  Combinations judged_here;

  // Roughness and depth, whose unknowns are logarithms: sigmas are shares.
  const auto material = [&](const char* name, int at, double value, std::optional<double>& sigma) {
    judged_here[name] = {unit(at)};
    const HalvesVerdict check = check_of(judged_here[name]);
    const double share = 100 * widening(check) * u.sigma(at);
    const Verdict verdict = bench.verdict[name] = judged(share, kRelative, "%", "", halves_in_words(check, "photos"));
    if (verdict.determined || verdict.weakly)
      sigma = value * share / 100;
    else
      sigma.reset();
  };
  if (stage.groove) {
    material("alpha", unknown::log_alpha, bench.material.alpha, bench.material_sigma.alpha);
    material("depth_um", unknown::log_depth, bench.material.depth_um, bench.material_sigma.depth_um);
    ModelData whole = data.model;
    whole.crossings = Crossings::add;
    const Carved carved = carved_at(whole, state.of(0));
    Straddle straddle;
    for (const PhotoData& photo : data.photos) {
      const Straddle one = straddle_of(
          carved, photo.camera.surface, bench.material.alpha, bench.material.depth_um, data.model.board->tool_width_um,
          state.of(photo.photo.light).segment<3>(unknown::lamp_position), photo.scene.camera_center_mm);
      straddle.inside += one.inside;
      straddle.outside += one.outside;
    }
    const std::string counts = std::to_string(straddle.inside) + " half vectors lean a little less and " +
                               std::to_string(straddle.outside) + " a little more than the grooves' steepest wall";
    Verdict& depth = bench.verdict["depth_um"];
    if (straddle.both()) {
      depth.reason += "; " + counts;
    } else {
      depth = {false,
               counts + ", so no photo shows where the glints end; photograph the board from " +
                   (straddle.inside >= straddle.outside ? "further to the side" : "nearer to the lamp's mirror image")};
      bench.material_sigma.depth_um.reset();
    }
  }
  if (stage.base)
    material("base_alpha", unknown::log_base_alpha, bench.material.base_alpha, bench.material_sigma.base_alpha);

  if (stage.machine) {
    const Board& board = *data.model.board;
    const Eigen::Vector2d c = data.model.center_mm;
    const Eigen::Matrix3d frame = tag_frame_covariance(board);
    std::vector<Eigen::VectorXd> rows;
    double photos = 0, whole = 0;  // the worst over the carve area's corners
    for (const double x : {board.carve_min_mm.x(), board.carve_max_mm.x()})
      for (const double y : {board.carve_min_mm.y(), board.carve_max_mm.y()})
        for (int row = 0; row < 2; ++row) {
          rows.push_back((x - c.x()) * unit(unknown::machine + 2 * row) +
                         (y - c.y()) * unit(unknown::machine + 2 * row + 1) + unit(unknown::machine + 4 + row));
          photos = std::max(photos, u.sigma(rows.back()));
          const Eigen::Vector3d at(x, y, 1);
          whole = std::max(whole, std::hypot(u.sigma(rows.back()), std::sqrt(at.dot(frame * at))));
        }
    const HalvesVerdict check = check_of(rows);
    const double grow = widening(check);
    judged_here["machine.affine"] = rows;
    bench.verdict["machine.affine"] =
        judged(std::hypot(whole, std::sqrt(grow * grow - 1) * photos), kMachine, "mm",
               " at most over the carve area, the tags' places included (" + number(grow * photos) + " mm without)",
               halves_in_words(check, "photos"));
    if (bench.machine_affine_sigma) *bench.machine_affine_sigma *= grow;
  }

  // What white paper in the middle sends back of the first lamp's light: the scale for ambient light.
  const Eigen::Vector3d center(data.model.center_mm.x(), data.model.center_mm.y(), 0);
  double paper = 0;
  for (const Light& light : bench.lights) {
    const Eigen::Vector3d d = light.position_mm - center;
    paper = std::max(paper,
                     light.intensity.mean() * std::max(0.0, d.normalized().z()) / d.squaredNorm() / std::numbers::pi);
  }
  if (stage.ambient) {
    const HalvesVerdict check = check_of(judged_here["ambient"] = {unit(unknown::ambient)});
    bench.verdict["ambient"] =
        judged(100 * widening(check) * u.sigma(unknown::ambient) / std::max(paper, 1e-300), kAmbient, "%",
               " of the lamp's own light on paper", halves_in_words(check, "photos"));
  }
  if (stage.vignette) {
    constexpr double kRadius2 = 0.5;
    const Eigen::VectorXd at = kRadius2 * unit(unknown::vignette) + kRadius2 * kRadius2 * unit(unknown::vignette + 1) +
                               kRadius2 * kRadius2 * kRadius2 * unit(unknown::vignette + 2);
    const HalvesVerdict check = check_of(judged_here["sensor.vignette"] = {at});
    bench.verdict["sensor.vignette"] =
        judged(100 * widening(check) * u.sigma(at), kVignette, "%",
               " of a pixel's value at 0.7 of the way to the picture's corner", halves_in_words(check, "photos"));
  }
  if (stage.blur) {
    const HalvesVerdict check = check_of(judged_here["sensor.psf_sigma_px"] = {unit(unknown::log_blur)});
    bench.verdict["sensor.psf_sigma_px"] =
        judged(100 * widening(check) * u.sigma(unknown::log_blur), kRelative, "%",
               " of " + number(std::exp(s[unknown::log_blur])) + " px", halves_in_words(check, "photos"));
  }

  for (std::size_t i = 0; i < bench.lights.size(); ++i) {
    Light& light = bench.lights[i];
    const std::string name = "light." + light.id;
    const auto at = [&](int index) { return global_index(index, i); };
    if (std::none_of(data.photos.begin(), data.photos.end(), [&](const PhotoData& p) { return p.photo.light == i; })) {
      bench.verdict[name + ".position_mm"] = {false, "no photo shows the board under this lamp"};
      continue;
    }
    if (!stage.lamp) {
      bench.verdict[name + ".position_mm"] = {true, kGiven};
    } else {
      const int x = unknown::lamp_position;
      std::vector<Eigen::VectorXd> rows{unit(at(x)), unit(at(x + 1)), unit(at(x + 2))};
      const HalvesVerdict check = check_of(judged_here[name + ".position_mm"] = rows);
      Eigen::Vector3d sigma;
      for (int k = 0; k < 3; ++k) sigma[k] = widening(check) * u.sigma(rows[k]);
      light.position_sigma_mm = sigma;
      const double distance = (light.position_mm - center).norm();
      Verdict& verdict = bench.verdict[name + ".position_mm"] =
          judged(100 * sigma.norm() / distance, kLampPosition, "%", " of its distance, " + number(sigma.norm()) + " mm",
                 halves_in_words(check, "photos"));
      verdict.sigma = sigma.norm();
      verdict.unit = "mm";
      if (data.is_spot[i]) {
        const HalvesVerdict exponent =
            check_of(judged_here[name + ".falloff_exponent"] = {unit(at(unknown::spot + 2))});
        light.falloff_exponent_sigma = widening(exponent) * u.sigma(at(unknown::spot + 2));
        bench.verdict[name + ".falloff_exponent"] =
            judged(100 * *light.falloff_exponent_sigma / std::max(1e-9, light.falloff_exponent), kExponent, "%", "",
                   halves_in_words(exponent, "photos"));
        rows = {unit(at(unknown::spot)), unit(at(unknown::spot + 1))};
        const HalvesVerdict aim = check_of(judged_here[name + ".axis"] = rows);
        const double across = widening(aim) * std::hypot(u.sigma(rows[0]), u.sigma(rows[1]));
        bench.verdict[name + ".axis"] = judged(std::atan(across / distance) * 180 / std::numbers::pi, kAxis, "degrees",
                                               "", halves_in_words(aim, "photos"));
      } else {
        const std::string bare = "a bare lamp: taking it for a spot explains paper and face no better";
        bench.verdict[name + ".falloff_exponent"] = {true, bare};
        bench.verdict[name + ".axis"] = {true, bare + ", and it needs no axis"};
      }
    }
    if (stage.intensity) {
      const HalvesVerdict check = check_of(judged_here[name + ".intensity"] = {unit(at(unknown::log_intensity))});
      const double share = widening(check) * u.sigma(at(unknown::log_intensity));
      light.intensity_sigma = light.intensity * share;
      bench.verdict[name + ".intensity"] = judged(100 * share, kRelative, "%", "", halves_in_words(check, "photos"));
    }
  }
  return judged_here;
}

}  // namespace burin

#include "burin/calib/verdict/next_photo.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "burin/base/files/decimals.h"
#include "burin/base/files/file_names.h"
#include "burin/base/median.h"
#include "burin/calib/geometry/information.h"
#include "burin/calib/photo/bench_unknowns.h"
#include "burin/calib/verdict/candidate_photo.h"
#include "burin/calib/verdict/half_samples.h"
#include "burin/scene/parameter_name.h"

namespace burin {
namespace {

std::vector<std::string> left_open(const Combinations& judged, const Bench& bench) {
  std::vector<std::string> out;
  for (const auto& [name, rows] : judged)
    if (const auto at = bench.verdict.find(name); at != bench.verdict.end() && !at->second.determined())
      out.push_back(name);
  return out;
}

// Largest remaining fraction of the sigma for a photo to be named.
constexpr double kWorthTaking = 2.0 / 3;

// The part of a sigma's square that no photo reduces: the contribution of the tags' places to the machine's map.
double beyond_photos(const Verdict& verdict) {
  for (const Cause& cause : verdict.causes)
    if (cause.kind == Cause::Kind::of_carve_area && verdict.sigma && *verdict.sigma > 0)
      return std::max(0.0, 1 - std::pow(cause.numbers[0] / *verdict.sigma, 2));
  return 0;
}

double variance(const std::vector<Eigen::VectorXd>& rows, const Eigen::MatrixXd& covariance) {
  double sum = 0;
  for (const Eigen::VectorXd& a : rows) sum += a.dot(covariance.topLeftCorner(a.size(), a.size()) * a);
  return sum;
}

// The predicted sigma.
std::optional<double> to_be_expected(const Verdict& verdict, double ratio) {
  if (!verdict.sigma) return std::nullopt;
  return *verdict.sigma * ratio;
}

// Viewpoints within the sharp range of the existing photos, estimated from their places: nobody refocuses for one
// additional photo. Empty if no viewpoint within it sees the whole board.
std::vector<CameraPlace> places_in_focus(const std::vector<double>& distances_mm, const Board& board, const Lens& lens,
                                         bool variants) {
  if (!distances_mm.empty()) {
    const auto [nearest, furthest] = std::minmax_element(distances_mm.begin(), distances_mm.end());
    FocusRange focus = depth_of_field(lens, median_of(distances_mm));
    focus.near_mm = std::min(focus.near_mm, *nearest);
    focus.far_mm = std::max(focus.far_mm, *furthest);
    std::vector<CameraPlace> places = camera_places(board, lens, variants, focus);
    if (!places.empty()) return places;
  }
  return camera_places(board, lens, variants);
}

// Distance of an existing photo's camera from the board's middle.
double distance_mm(const Eigen::Isometry3d& T_camera_board, const Board& board) {
  return (T_camera_board * Eigen::Vector3d(board.size_mm.x() / 2, board.size_mm.y() / 2, 0)).norm();
}

}  // namespace

void advise_geometry(const BoardSolution& geometry, const Board& board, const Combinations& judged, Bench& bench) {
  const std::vector<std::string> open = left_open(judged, bench);
  if (open.empty()) return;
  std::vector<double> sigmas;
  for (const BundleCorner& c : geometry.bundle.corners)
    if (c.used) sigmas.push_back(c.sigma_px);
  Bundle bundle = geometry.bundle;
  const std::size_t taken = bundle.views.size();
  std::vector<double> distances;
  for (const Eigen::Isometry3d& T_camera_board : bundle.views) distances.push_back(distance_mm(T_camera_board, board));
  const std::vector<CameraPlace> places = places_in_focus(distances, board, geometry.lens, true);
  append_candidates(bundle, board, places, median_of(sigmas), geometry.lens_scatter);
  const BundleEquations equations = bundle_equations(bundle, geometry.options);
  Eigen::MatrixXd H = equations.prior;
  for (std::size_t v = 0; v < taken; ++v) H += equations.views[v].information;
  const Eigen::MatrixXd before = shared_covariance(H);
  std::vector<double> best(open.size(), 1);
  std::vector<std::size_t> place(open.size(), 0);
  for (std::size_t p = 0; p < places.size(); ++p) {
    if (!equations.views[taken + p].used) continue;
    const Eigen::MatrixXd after = shared_covariance(H + equations.views[taken + p].information);
    for (std::size_t i = 0; i < open.size(); ++i) {
      const auto& rows = judged.at(open[i]);
      const double ratio = std::sqrt(variance(rows, after) / variance(rows, before));
      if (ratio < best[i]) {
        best[i] = ratio;
        place[i] = p;
      }
    }
  }
  for (std::size_t i = 0; i < open.size(); ++i)
    if (best[i] <= kWorthTaking) {
      Verdict& verdict = bench.verdict[open[i]];
      verdict.next_photo = NextPhoto{NextPhoto::Kind::at_place, place_in_words(places[place[i]], board),
                                     to_be_expected(verdict, best[i])};
    }
}

namespace {

// The setup with possible lamps as additional unknowns, after the existing ones.
struct WiderBench {
  Bench bench;
  Problem problem;  // without photos
  State state;
  std::vector<bool> free;
  std::size_t own_lamps = 0;
};

WiderBench wider_bench(const Problem& data, const State& state, const Uncertainty& u, const Bench& bench) {
  WiderBench out;
  out.bench = bench;
  out.own_lamps = bench.lights.size();
  const Light& lamp_there = bench.lights[data.photos.front().photo.light];
  for (const Light& light : turned_lamps(lamp_there, *data.model.board, {90, 180, 270}))
    out.bench.lights.push_back(light);
  out.problem = make_problem(*data.model.board, *data.model.sent, out.bench);
  out.problem.model = data.model;
  out.problem.merged_bin = data.merged_bin;
  const State all = state_of(out.bench, out.problem);
  out.state = state;
  if (data.surroundings) out.state.shared[unknown::ambient] = 0;  // a candidate is judged by its lamp's light
  out.free = u.free;
  for (std::size_t lamp = out.own_lamps; lamp < out.bench.lights.size(); ++lamp) {
    out.state.lamps.push_back(all.lamps[lamp]);
    for (const UnknownRow& row : kUnknownRows)
      if (row.scope == Scope::lamp) out.free.insert(out.free.end(), row.size, has_unknown(out.problem, row, lamp));
  }
  return out;
}

// Information of the existing photos over the unknowns of the wider setup. Unknowns without information get a small
// one, because zero would mean fixed.
Eigen::MatrixXd information_so_far(const Uncertainty& u, const WiderBench& wider) {
  const auto n = static_cast<Eigen::Index>(u.free.size()), wide = static_cast<Eigen::Index>(wider.free.size());
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(wide, wide);
  for (const Eigen::MatrixXd& part : u.part_information) H.topLeftCorner(n, n) += part;
  for (Eigen::Index i = 0; i < wide; ++i)
    if (wider.free[static_cast<std::size_t>(i)])
      H(i, i) += i < n ? u.prior_information[i] + 1e-9 * H(i, i) + 1e-12 : 1e-12;
  return H;
}

// Candidates have larger pixels than the fit of the photos. Three existing photos, rendered like candidates, give the
// ratio of a photo's information to its prediction.
double information_scale(const Problem& data, const Uncertainty& u, const WiderBench& wider,
                         const LightCandidateOptions& options) {
  std::vector<double> scales;
  for (std::size_t k = 0; k < u.part_photo.size(); k += std::max<std::size_t>(1, u.part_photo.size() / 3)) {
    const PhotoData& photo = data.photos[u.part_photo[k]];
    CameraPlace same;
    same.T_camera_board = photo.camera.T_camera_board;
    same.distance_mm = same.T_camera_board.translation().norm();
    const LightCandidate like =
        light_candidate(wider.problem, wider.state, wider.bench, same, photo.photo.light, wider.free, options);
    for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(u.free.size()); ++i)
      if (like.information(i, i) > 0 && u.part_information[k](i, i) > 0)
        scales.push_back(u.part_information[k](i, i) / like.information(i, i));
  }
  return scales.empty() ? 1 : median_of(std::move(scales));
}

// The best photo so far for one parameter.
struct Best {
  double score = 1;
  const CameraPlace* place = nullptr;
  std::size_t light = 0, straddling = 0;
};

// The best photo under an existing lamp, unless only a moved lamp gives enough information; without a place if no photo
// is worth it. For a depth with an unseen cut-off, any photo that brings the cut-off nearer counts.
Best chosen(const Best& own, const Best& moved, std::size_t rarer) {
  if (own.place != nullptr && is_worth_taking(own.score, own.straddling, rarer)) return own;
  const Best& best = moved.place != nullptr && moved.score < own.score ? moved : own;
  return best.straddling > 0 || best.score <= kWorthTaking ? best : Best{};
}

NextPhoto next_photo_of(const Best& best, const Verdict& verdict, const WiderBench& wider, const Board& board) {
  NextPhoto next{NextPhoto::Kind::at_place, place_in_words(*best.place, board), {}, {}};
  const Light& light = wider.bench.lights[best.light];
  const auto own = static_cast<std::ptrdiff_t>(wider.own_lamps);
  if (best.light >= wider.own_lamps)
    next.place += moved_lamp_in_words(light, {wider.bench.lights.begin(), wider.bench.lights.begin() + own}, board);
  else if (wider.own_lamps > 1)
    next.place += ", under lamp " + light.id;
  if (best.straddling > 0)
    next.half_vectors = static_cast<int>(best.straddling);
  else
    next.sigma = to_be_expected(verdict, best.score);
  return next;
}

}  // namespace

bool is_worth_taking(double sigma_ratio, std::size_t half_vectors, std::size_t half_vectors_now) {
  // A second photo of this kind would show the cut-off.
  if (half_vectors > 0) {
    const std::size_t by_two = half_vectors_now + 2 * (half_vectors - std::min(half_vectors, half_vectors_now));
    return Straddle{by_two, by_two}.both();
  }
  return sigma_ratio <= kWorthTaking;
}

std::string moved_lamp_in_words(const Light& moved, const std::vector<Light>& lamps, const Board& board) {
  std::string id;
  for (int number = 2; id.empty(); ++number) {
    const std::string wanted = lamps.front().id + "-" + std::to_string(number);
    if (std::none_of(lamps.begin(), lamps.end(), [&](const Light& lamp) { return lamp.id == wanted; })) id = wanted;
  }
  const Eigen::Vector3d& p = moved.position_mm;
  return ", the lamp moved to " + place_in_words(p, board) +
         ", where it counts as another one: list it among the \"lights\" of the nominal bench.json (in a loop, the "
         "project's own) as {\"id\": \"" +
         id + "\", \"position_mm\": [" + fixed(p.x(), 0) + ", " + fixed(p.y(), 0) + ", " + fixed(p.z(), 0) +
         "]}, and put the photo into photos/" + file_name_of(id);
}

void advise_light(const Problem& data, const State& state, const Uncertainty& u, const Combinations& judged,
                  Bench& bench, const Progress& progress) {
  const std::vector<std::string> open = left_open(judged, bench);
  if (open.empty() || bench.lights.empty()) return;
  const Board& board = *data.model.board;
  const WiderBench wider = wider_bench(data, state, u, bench);
  const Eigen::MatrixXd H = information_so_far(u, wider), before = inverse_information(H);
  LightCandidateOptions options;
  if (!data.photo_model_error.empty()) options.model_error = std::max(0.005, median_of(data.photo_model_error));
  const double scale = information_scale(data, u, wider, options);
  const Straddle straddle = straddle_of(data, state);
  const std::size_t rarer = std::min(straddle.inside, straddle.outside);

  std::vector<Best> own(open.size()), moved(open.size());
  const auto consider = [&](const LightCandidate& candidate, const CameraPlace& place, std::size_t light) {
    const Eigen::MatrixXd after = inverse_information(H + scale * candidate.information);
    for (std::size_t i = 0; i < open.size(); ++i) {
      const auto& rows = judged.at(open[i]);
      const double left = beyond_photos(bench.verdict.at(open[i]));
      double score = std::sqrt(left + (1 - left) * variance(rows, after) / variance(rows, before));
      std::size_t straddling = 0;
      if (open[i] == parameter::kDepth && !straddle.both()) {
        // The cut-off must come into view first, on both its sides.
        straddling =
            std::min(straddle.inside + candidate.straddle.inside, straddle.outside + candidate.straddle.outside);
        if (straddling <= rarer) continue;
        score = 1 / (1 + static_cast<double>(straddling));
      }
      Best& best = (light < wider.own_lamps ? own : moved)[i];
      if (score < best.score) best = {score, &place, light, straddling};
    }
  };
  std::vector<double> distances;
  for (const PhotoData& photo : data.photos) distances.push_back(distance_mm(photo.camera.T_camera_board, board));
  const std::vector<CameraPlace> places = places_in_focus(distances, board, bench.lens, false);
  for (std::size_t p = 0; p < places.size(); ++p) {
    if (progress)
      progress("looking for the photo that would help most",
               static_cast<double>(p) / static_cast<double>(places.size()));
    for (std::size_t light = 0; light < wider.bench.lights.size(); ++light) {
      if (!wider.bench.lights[light].is_near()) continue;
      if (light >= wider.own_lamps && p % 2 == 1) continue;  // a moved lamp is tried from every second place
      if (in_the_way(places[p].center_mm(), wider.bench.lights[light].position_mm, board)) continue;
      const LightCandidate candidate =
          light_candidate(wider.problem, wider.state, wider.bench, places[p], light, wider.free, options);
      if (candidate.light.paper > 0) consider(candidate, places[p], light);
    }
  }
  for (std::size_t i = 0; i < open.size(); ++i) {
    const Best best = chosen(own[i], moved[i], rarer);
    if (best.place == nullptr) continue;
    Verdict& verdict = bench.verdict[open[i]];
    verdict.next_photo = next_photo_of(best, verdict, wider, board);
  }
}

}  // namespace burin

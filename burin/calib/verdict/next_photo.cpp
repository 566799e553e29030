#include "burin/calib/verdict/next_photo.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "burin/calib/verdict/candidate_photo.h"
#include "burin/calib/verdict/half_samples.h"

namespace burin {
namespace {

std::vector<std::string> left_open(const Combinations& judged, const Bench& bench) {
  std::vector<std::string> out;
  for (const auto& [name, rows] : judged)
    if (const auto at = bench.verdict.find(name); at != bench.verdict.end() && !at->second.determined)
      out.push_back(name);
  return out;
}

double variance(const std::vector<Eigen::VectorXd>& rows, const Eigen::MatrixXd& covariance) {
  double sum = 0;
  for (const Eigen::VectorXd& a : rows) sum += a.dot(covariance.topLeftCorner(a.size(), a.size()) * a);
  return sum;
}

std::string number(double value) {
  std::ostringstream out;
  out.precision(2);
  out << value;
  return out.str();
}

// "; its sigma would come to about 0.4 %".
std::string to_be_expected(const Verdict& verdict, double ratio) {
  if (!verdict.sigma) return "";
  const double sigma = *verdict.sigma * ratio;
  return "; its sigma would come to about " + number(sigma) + (verdict.unit.empty() ? "" : " " + verdict.unit);
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
  const std::vector<CameraPlace> places = camera_places(board, geometry.lens, true);
  append_candidates(bundle, board, places, median_of(sigmas));
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
    if (best[i] < 1) {
      Verdict& verdict = bench.verdict[open[i]];
      verdict.next_photo = place_in_words(places[place[i]], board) + to_be_expected(verdict, best[i]);
    }
}

void advise_light(const Problem& data, const State& state, const Uncertainty& u, const Combinations& judged,
                  Bench& bench, const Progress& progress) {
  const std::vector<std::string> open = left_open(judged, bench);
  if (open.empty() || bench.lights.empty()) return;
  const Board& board = *data.model.board;

  // The bench with lamps that could be put elsewhere: unknowns of their own, behind those there are.
  Bench wider = bench;
  Problem candidates;
  candidates.model = data.model;
  candidates.is_spot = data.is_spot;
  State there = state;
  const std::size_t own = bench.lights.size();
  for (const Light& light : turned_lamps(bench.lights.front(), board, {90, 180, 270})) {
    wider.lights.push_back(light);
    candidates.is_spot.push_back(data.is_spot.front());
    std::array<double, kLampUnknowns> lamp = state.lamps.front();
    for (int k = 0; k < 3; ++k) lamp[k] = light.position_mm[k];
    const State aimed = state_of(wider, data.model);
    for (int k = 0; k < 2; ++k) lamp[4 + k] = aimed.lamps.back()[4 + k];
    there.lamps.push_back(lamp);
  }
  const auto n = static_cast<Eigen::Index>(u.free.size());
  const Eigen::Index wide = n + static_cast<Eigen::Index>(wider.lights.size() - own) * kLampUnknowns;
  std::vector<bool> free = u.free;
  for (std::size_t lamp = own; lamp < wider.lights.size(); ++lamp)
    for (int k = 0; k < kLampUnknowns; ++k)
      free.push_back(kFirstLampUnknown + k < unknown::spot || candidates.is_spot[lamp]);

  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(wide, wide);
  for (const Eigen::MatrixXd& part : u.part_information) H.topLeftCorner(n, n) += part;
  // What nothing says has a little information, so that it is unknown and not held.
  for (Eigen::Index i = 0; i < wide; ++i)
    if (free[static_cast<std::size_t>(i)]) H(i, i) += i < n ? u.prior_information[i] + 1e-9 * H(i, i) + 1e-12 : 1e-12;

  LightCandidateOptions options;
  std::vector<double> errors = data.photo_model_error;
  if (!errors.empty()) options.model_error = std::max(0.005, median_of(errors));
  // Candidates are rendered in larger pixels than the photos were fitted in: three of the photos themselves, seen like
  // candidates, say how much less that tells.
  std::vector<double> scales;
  for (std::size_t k = 0; k < u.part_photo.size(); k += std::max<std::size_t>(1, u.part_photo.size() / 3)) {
    const PhotoData& photo = data.photos[u.part_photo[k]];
    CameraPlace same;
    same.T_camera_board = photo.camera.T_camera_board;
    same.distance_mm = same.T_camera_board.translation().norm();
    const LightCandidate like = light_candidate(candidates, there, wider, same, photo.photo.light, free, options);
    for (Eigen::Index i = 0; i < n; ++i)
      if (like.information(i, i) > 0 && u.part_information[k](i, i) > 0)
        scales.push_back(u.part_information[k](i, i) / like.information(i, i));
  }
  const double scale = scales.empty() ? 1 : median_of(scales);

  Straddle straddle;
  ModelData whole = data.model;
  whole.crossings = Crossings::add;
  const Carved carved = carved_at(whole, state.of(0));
  for (const PhotoData& photo : data.photos) {
    const Unknowns x = state.of(photo.photo.light);
    const Straddle one =
        straddle_of(carved, photo.camera.surface, bench.material.alpha, bench.material.depth_um, board.tool_width_um,
                    x.segment<3>(unknown::lamp_position), photo.scene.camera_center_mm);
    straddle.inside += one.inside;
    straddle.outside += one.outside;
  }
  const std::size_t rarer = std::min(straddle.inside, straddle.outside);

  const Eigen::MatrixXd before = inverse_information(H);
  struct Best {
    double score = 1;
    const CameraPlace* place = nullptr;
    std::size_t light = 0, straddling = 0;
  };
  std::vector<Best> best(open.size());
  const std::vector<CameraPlace> places = camera_places(board, bench.lens, false);
  for (std::size_t p = 0; p < places.size(); ++p) {
    if (progress)
      progress("looking for the photo that would help most",
               static_cast<double>(p) / static_cast<double>(places.size()));
    for (std::size_t light = 0; light < wider.lights.size(); ++light) {
      if (light >= own && p % 2 == 1) continue;  // a moved lamp is tried from every other place
      if (in_the_way(places[p].center_mm(), wider.lights[light].position_mm, board)) continue;
      const LightCandidate candidate = light_candidate(candidates, there, wider, places[p], light, free, options);
      if (!(candidate.light.paper > 0)) continue;
      const Eigen::MatrixXd after = inverse_information(H + scale * candidate.information);
      for (std::size_t i = 0; i < open.size(); ++i) {
        const auto& rows = judged.at(open[i]);
        double score = std::sqrt(variance(rows, after) / variance(rows, before));
        std::size_t straddling = 0;
        if (open[i] == "depth_um" && !straddle.both()) {
          // First of all the cut-off must come into sight, on both its sides.
          straddling =
              std::min(straddle.inside + candidate.straddle.inside, straddle.outside + candidate.straddle.outside);
          if (straddling <= rarer) continue;
          score = 1 / (1 + static_cast<double>(straddling));
        }
        if (score < best[i].score) best[i] = {score, &places[p], light, straddling};
      }
    }
  }
  for (std::size_t i = 0; i < open.size(); ++i) {
    if (best[i].place == nullptr) continue;
    Verdict& verdict = bench.verdict[open[i]];
    const Light& light = wider.lights[best[i].light];
    verdict.next_photo = place_in_words(*best[i].place, board);
    if (best[i].light >= own)
      verdict.next_photo += ", the lamp moved to " + place_in_words(light.position_mm, board);
    else if (own > 1)
      verdict.next_photo += ", under lamp " + light.id;
    verdict.next_photo += best[i].straddling > 0 ? "; " + std::to_string(best[i].straddling) +
                                                       " half vectors would then lie on either side of the cut-off"
                                                 : to_be_expected(verdict, best[i].score);
  }
}

}  // namespace burin

#include "burin/scene/bench_of_board.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/scene/files/camera_json.h"
#include "burin/scene/lens.h"
#include "burin/scene/parameter_name.h"

namespace burin {
namespace {

// Tolerance for the digits of a person or of another program: the number is still the same.
constexpr double kSame = 1e-9;
bool same(double a, double b) { return std::abs(a - b) <= kSame * std::max(std::abs(a), std::abs(b)); }

struct Settling {
  Bench& bench;
  const Board& board;
  std::string bench_file, board_file;

  // True without photos: every number is a person's.
  bool nominal() const { return bench.verdict.empty(); }

  bool measured(const char* parameter, const std::optional<double>& sigma) const {
    if (const Verdict* verdict = find_verdict(bench, parameter))
      return verdict->known() && verdict->source != Source::assumed;
    return sigma.has_value();
  }

  // True if photos refute the depth prior of that time. A later prior is not refuted; the setup follows it.
  bool depth_is_refuted() const {
    const Verdict* verdict = find_verdict(bench, parameter::kDepth);
    return verdict != nullptr && rests_on(*verdict, Cause::Kind::believed_refuted) && bench.told.depth_um &&
           same(*bench.told.depth_um, board.material.depth_um);
  }

  [[noreturn]] void contradict(const std::string& key, double bench_says, double believed, bool board_says) const {
    fail(bench_file,
         "material." + key + " is " + significant(bench_says, 6) + ", but " + board_file +
             (board_says ? " says " : " lacks it, which means ") + significant(believed, 6),
         "no photo has measured it, so it is one number: write it into board.json, and leave it out of bench.json");
  }

  void note(const std::string& key, const std::string& what) const {
    bench.findings.push_back(
        {FindingCode::value_assumed, Finding::Severity::note, bench_file, what, "", "material." + key});
  }

  void number(const char* parameter, const std::string& key, bool said, bool board_says,
              const std::optional<double>& sigma, double believed, double& value) const {
    if (measured(parameter, sigma)) return;
    if (!said && !board_says)
      note(key, "neither this nor " + board_file + " has material." + key + "; " + significant(believed, 6) +
                    " is believed");
    if (same(value, believed)) return;
    if (said && find_verdict(bench, parameter) == nullptr) contradict(key, value, believed, board_says);
    if (said)
      note(key, "the photos did not determine material." + key + ": " + board_file + "'s " + significant(believed, 6) +
                    " is believed");
    value = believed;
  }

  void told(const std::string& field, const std::optional<double>& then, double now) const {
    if (!then || same(*then, now)) return;
    fail(board_file,
         field + " is " + significant(now, 6) + ", but " + bench_file + " was measured on a board with " +
             significant(*then, 6) + " (its material.told)",
         "write " + significant(*then, 6) + " there again: what the machine makes of it is what was measured" +
             (field == "material.depth_um" ? "; grooves of another depth are a matter of the design (--depth " +
                                                 significant(now, 6) + " of burin loop or burin design)"
                                           : ", or begin from a nominal bench.json"));
  }
};

}  // namespace

void settle_material(Bench& bench, const std::filesystem::path& bench_file, const Board& board,
                     const std::filesystem::path& board_file) {
  aim_views(bench, board);
  const Settling s{bench, board, bench_file.string(), board_file.string()};
  Material& m = bench.material;
  const MaterialSigma& sigma = bench.material_sigma;
  if (!bench.said.grain && s.nominal()) m.grain = board.material.grain;
  if (!bench.said.profile && s.nominal()) m.profile = board.material.profile;
  if (s.measured(parameter::kAlpha, sigma.alpha)) s.told("material.alpha", bench.told.alpha, board.material.alpha);
  if (s.measured(parameter::kDepth, sigma.depth_um))
    s.told("material.depth_um", bench.told.depth_um, board.material.depth_um);
  s.told("tool.width_um", bench.told.tool_width_um, board.tool_width_um);
  s.number(parameter::kAlpha, "alpha", bench.said.alpha, board.said.alpha, sigma.alpha, board.material.alpha, m.alpha);
  if (!s.depth_is_refuted())
    s.number(parameter::kDepth, "depth_um", bench.said.depth_um, board.said.depth_um, sigma.depth_um,
             board.material.depth_um, m.depth_um);
  // Paper and plain face determine this number if any lamp is known.
  if (s.nominal() || !bench.said.base_alpha)
    s.number(parameter::kBaseAlpha, "base_alpha", bench.said.base_alpha, board.said.base_alpha, sigma.base_alpha,
             board.material.base_alpha, m.base_alpha);
  for (int c = 0; c < 3; ++c) {
    if (bench.said.f0 && !same(m.f0[c], board.material.f0[c]))
      s.contradict("f0[" + std::to_string(c) + "]", m.f0[c], board.material.f0[c], board.said.f0);
    m.f0[c] = board.material.f0[c];
  }
  bench.said = {};
}

void aim_views(Bench& bench, const Board& board) {
  const Eigen::Vector3d middle(board.size_mm.x() / 2, board.size_mm.y() / 2, 0);
  for (View& view : bench.views) {
    if (!view.roll_to_middle_deg) continue;
    view.T_camera_board = aimed_at(view.T_camera_board, middle, *view.roll_to_middle_deg);
    view.roll_to_middle_deg.reset();
  }
}

void fill_material(Bench& bench, const Board& board) {
  aim_views(bench, board);
  if (!bench.said.alpha) bench.material.alpha = board.material.alpha;
  if (!bench.said.depth_um) bench.material.depth_um = board.material.depth_um;
  if (!bench.said.base_alpha) bench.material.base_alpha = board.material.base_alpha;
  if (!bench.said.f0) bench.material.f0 = board.material.f0;
  bench.said = {};
}

Bench read_bench_of(const Board& board, const std::filesystem::path& board_file,
                    const std::filesystem::path& bench_file) {
  Bench bench = read_bench(bench_file);
  settle_material(bench, bench_file, board, board_file);
  return bench;
}

namespace {

bool is_flat(const Board& board) { return board.mesh.empty() && !board.bend; }

// Places all over the board, in camera coordinates.
std::vector<Eigen::Vector3d> places_seen_from(const View& view, const Board& board) {
  constexpr int kPlaces = 9;  // per side
  std::vector<Eigen::Vector3d> places;
  for (int j = 0; j < kPlaces; ++j)
    for (int i = 0; i < kPlaces; ++i)
      places.push_back(view.T_camera_board * Eigen::Vector3d(board.size_mm.x() * i / (kPlaces - 1),
                                                             board.size_mm.y() * j / (kPlaces - 1), 0));
  return places;
}

bool is_dark(const Light& light) { return !(light.intensity.maxCoeff() > 0); }

bool is_behind(const Light& light) { return light.is_near() && !(light.position_mm.z() > 0); }

}  // namespace

void fail_unless_sees(const View& view, const Board& board) {
  if (!is_flat(board)) return;
  if (!(view.T_camera_board.inverse().translation().z() > 0))
    fail("view " + view.name, "its camera lies in or behind the board's face, and sees nothing of it",
         "the board frame has z out of the metal: check the view's eye_mm or T_camera_board in the bench");
  const std::vector<Eigen::Vector3d> places = places_seen_from(view, board);
  if (std::none_of(places.begin(), places.end(), [](const Eigen::Vector3d& p) { return p.z() > 0; }))
    fail("view " + view.name, "its camera looks away from the board",
         "turn it round: T_camera_board takes places of the board to the camera's axes, whose z looks forward");
}

void fail_unless_lights(const Light& light, const Board& board) {
  std::vector<const Light*> all{&light};
  for (const Light& more : light.also) all.push_back(&more);
  if (std::all_of(all.begin(), all.end(), [](const Light* one) { return is_dark(*one); }))
    fail("light " + light.id, "shines with an intensity of 0", "give it one above 0 in the bench");
  if (is_flat(board) &&
      std::all_of(all.begin(), all.end(), [](const Light* one) { return is_dark(*one) || is_behind(*one); }))
    fail("light " + light.id, "lies in or behind the board's face, which it cannot reach",
         "the board frame has z out of the metal: check its position_mm in the bench");
}

bool is_in_picture(const Bench& bench, const View& view, const Board& board) {
  std::vector<Eigen::Vector3d> places = places_seen_from(view, board);
  std::erase_if(places, [](const Eigen::Vector3d& p) { return !(p.z() > 0); });
  std::vector<Eigen::Vector2d> pixels(places.size());
  project(lens_of(bench, view), places, pixels);
  return std::any_of(pixels.begin(), pixels.end(), [&](const Eigen::Vector2d& q) {
    return q.x() > -0.5 && q.y() > -0.5 && q.x() < bench.lens.width - 0.5 && q.y() < bench.lens.height - 0.5;
  });
}

}  // namespace burin

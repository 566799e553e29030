// How a loop project is shown: for every picture the target, and round after round what was promised and what came.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "burin/capture/photo.h"
#include "burin/capture/session.h"
#include "burin/optimize/design_file.h"
#include "burin/optimize/loss/picture_metrics.h"
#include "burin/optimize/target.h"
#include "burin/render/bench.h"
#include "burin/render/board.h"
#include "burin/render/predicted_photo.h"
#include "burin/render/scratches.h"
#include "tools/project.h"
#include "tools/report/html.h"
#include "tools/report/rectified.h"
#include "tools/report/rerun.h"
#include "tools/report/section.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

constexpr int kSidePx = 360;

// Something that a view shows, or is to show, and how near it comes to the target.
struct Shown {
  Image picture;  // gamma-encoded; no pixels where there is none
  double psnr_db = 0;
};

// Linear values of one exposure beside a gamma-encoded target, at the exposure that comes nearest.
Shown nearest_exposure(const Image& linear, const Image& target) {
  Image radiance = luminance(linear);
  const float brightest = percentile(radiance, 0.99);
  if (!(brightest > 0)) return {};
  for (float& v : radiance.data) v = std::isinf(v) ? 10 * brightest : v > 0 ? v : 0;  // infinite: clipped
  const double exposure = best_exposure(radiance, target, 1 / brightest);
  Shown out;
  out.picture = shown(radiance, static_cast<float>(1 / exposure));
  out.psnr_db = psnr_db(out.picture, target);
  return out;
}

Shown photographed(const fs::path& round, const View& view, const Bench& bench, const std::string& light,
                   const Image& target) {
  const Session session = read_session(round / "session.json");
  const Board board = read_board(session.board);
  std::vector<Photo> photos;
  std::copy_if(session.photos.begin(), session.photos.end(), std::back_inserter(photos),
               [&](const Photo& p) { return p.view == view.name && p.light == light; });
  if (photos.empty()) return {};
  MergedView merged = merge_bracket(photos);
  for (std::size_t i = 0; i < merged.valid.size(); ++i)
    if (!merged.valid[i])
      for (int c = 0; c < merged.value.channels; ++c) merged.value.data[i * merged.value.channels + c] = INFINITY;
  const BoardFrame frame{board.carve_min_mm, board.carve_max_mm, target.width, target.height};
  return nearest_exposure(
      rectified(merged.value, 0, 0, bench.lens, view.T_camera_board, {board.size_mm, bench.bow_mm}, frame), target);
}

// What a photo of the round's board should look like from there, for the bench that it was designed for.
Shown promised(const fs::path& scratches, const Board& board, const Bench& bench, const View& view,
               const std::string& light, const Image& target) {
  if (!fs::exists(scratches)) return {};
  const PixelWindow window = carve_window(bench, board, view);
  if (window.width == 0 || window.height == 0) return {};
  const BoardFrame frame{board.carve_min_mm, board.carve_max_mm, target.width, target.height};
  PredictedPhotoOptions options;
  options.window = window;
  const Image photo = predicted_photo(bench, board, view, find_light(bench, light, scratches.string()),
                                      carve(Designed(read_scratches(scratches)), bench, board), options);
  return nearest_exposure(
      rectified(photo, window.x0, window.y0, bench.lens, view.T_camera_board, {board.size_mm, bench.bow_mm}, frame),
      target);
}

std::string decibels(const Shown& shown) {
  return shown.picture.data.empty() ? "" : fmt::format("{:.1f} dB", shown.psnr_db);
}

}  // namespace

std::optional<Section> project_section(const fs::path& folder, const Progress& progress) {
  const Project project{folder};
  const int rounds = project.rounds();
  if (rounds == 0 || !fs::exists(folder / "design.json")) return std::nullopt;
  const DesignSpec spec = read_design(folder / "design.json");
  const Board board = read_board(spec.board);
  const Bench nominal = read_bench(spec.bench);
  const Eigen::Vector2d area = board.carve_max_mm - board.carve_min_mm;
  const BoardFrame frame = board_frame(board.carve_min_mm, board.carve_max_mm, kSidePx);

  Section out;
  Table results;
  results.header = {"View"};
  for (int r = 1; r <= rounds; ++r) {
    results.header.push_back(fmt::format("Round {}: promised", r));
    if (fs::exists(project.round(r) / "bench.json")) results.header.push_back(fmt::format("Round {}: photographed", r));
  }
  std::string pictures;
  double first_promise_sum = 0, first_photo_sum = 0, next_promise_sum = 0, last_photo_sum = 0;
  int measured_rounds = 0, compared = 0;
  std::vector<RerunView> reruns;  // the first board as photographed, and the second as promised or photographed
  while (measured_rounds < rounds && fs::exists(project.round(measured_rounds + 1) / "bench.json")) ++measured_rounds;

  for (std::size_t k = 0; k < spec.views.size(); ++k) {
    if (progress) progress("comparing rounds", static_cast<double>(k) / static_cast<double>(spec.views.size()));
    const DesignView& designed = spec.views[k];
    const View& nominal_view = find_view(nominal, designed.view, (folder / "design.json").string());
    const double rotation = designed.target.upright_in_view
                                ? viewer_rotation_deg(nominal_view, (board.carve_min_mm + board.carve_max_mm) / 2)
                                : designed.target.rotation_deg;
    const Image target = load_target(designed.target, rotation, area, frame.width, frame.height).picture;
    std::vector<std::string> row, cells = {html(designed.view)};
    row.push_back(figure(target, "<b>Target</b>"));
    RerunView rerun{designed.view, 0, 0, 0, {}};
    for (int r = 1; r <= rounds; ++r) {
      const fs::path round = project.round(r);
      if (!fs::exists(round / "scratches.csv")) continue;
      const Bench known = read_bench(project.bench_before(r));
      const View* from = r == 1 ? &nominal_view : measured_view(known, nominal_view, board);
      const Shown promise =
          from ? promised(round / "scratches.csv", board, known, *from, designed.light, target) : Shown{};
      cells.push_back(decibels(promise));
      if (!promise.picture.data.empty())
        row.push_back(figure(promise.picture, fmt::format("<b>Round {}, promised</b> by the {} bench: {}", r,
                                                          r == 1 ? "believed" : "measured", decibels(promise))));
      if (r == measured_rounds + 1) next_promise_sum += promise.psnr_db;
      if (r == 1) first_promise_sum += promise.psnr_db;
      if (r <= 2) (r == 1 ? rerun.promised_before_db : rerun.promised_after_db) = promise.psnr_db;
      if (!fs::exists(round / "bench.json")) continue;
      const Bench measured = read_bench(round / "bench.json");
      const View* taken = measured_view(measured, nominal_view, board);
      const Shown photo = taken ? photographed(round, *taken, measured, designed.light, target) : Shown{};
      cells.push_back(decibels(photo));
      if (photo.picture.data.empty()) continue;
      row.push_back(figure(photo.picture, fmt::format("<b>Round {}, photographed</b> (as {}): {}", r, html(taken->name),
                                                      decibels(photo))));
      if (r == 1) {
        first_photo_sum += photo.psnr_db;
        rerun.seen_before_db = photo.psnr_db;
        ++compared;
      }
      if (r == 2) rerun.seen_after_db = photo.psnr_db;
      if (r == measured_rounds) last_photo_sum += photo.psnr_db;
    }
    pictures += fmt::format("<h3>View {}</h3>\n", html(designed.view)) + figure_row(row);
    results.rows.push_back(cells);
    if (rerun.seen_before_db > 0 && rerun.promised_after_db > 0) reruns.push_back(std::move(rerun));
  }

  if (measured_rounds == 0) {
    out.outcome =
        "The first board is designed for the bench as it is believed to be, and has not been photographed yet.";
  } else {
    out.outcome = fmt::format("The loop has turned {} time{}.", measured_rounds, measured_rounds == 1 ? "" : "s");
    if (compared > 0) {
      out.outcome += fmt::format(
          " The board designed for the believed bench should have shown its pictures at {:.1f} dB, and was "
          "photographed at "
          "{:.1f} dB",
          first_promise_sum / compared, first_photo_sum / compared);
      if (measured_rounds > 1)
        out.outcome += fmt::format("; the board of round {} at {:.1f} dB", measured_rounds, last_photo_sum / compared);
      if (rounds > measured_rounds)
        out.outcome += fmt::format("; the next, designed for the bench as measured, promises {:.1f} dB",
                                   next_promise_sum / compared);
      out.outcome += ".";
    }
    if (!reruns.empty()) out.outcome += " " + rerun_sentence(reruns);
  }
  out.body =
      "<h2>Round after round</h2>\n<p>Promised: the photo that the bench it was designed for would "
      "give. Photographed: the photo taken from there. All are laid flat on the carve area, at the one exposure that "
      "comes nearest to the target. Each is compared with the target after gamma 1/2.2, as PSNR. A camera blurs the "
      "hatching that a design's own figures count, all its pixels one by one: these here are higher.</p>\n" +
      table(results) + pictures;
  // The whole of the newest: the measured bench, and the design made for it.
  if (measured_rounds > 0) {
    const auto session = session_section(project.round(measured_rounds), {}, progress);
    if (session) {
      out.outcome += " " + session->outcome;
      out.body += session->body;
    }
  }
  if (const auto design = design_section(project.round(rounds))) out.body += design->body;
  return out;
}

}  // namespace burin

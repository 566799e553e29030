// How a loop project is shown: for every picture the target, and round after round what was promised and what came.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "burin/capture/photo.h"
#include "burin/capture/session.h"
#include "burin/optimize/design_file.h"
#include "burin/optimize/loss/picture_metrics.h"
#include "burin/optimize/target.h"
#include "burin/render/bench.h"
#include "burin/render/bench_of_board.h"
#include "burin/render/board.h"
#include "burin/render/predicted_photo.h"
#include "burin/render/scratches.h"
#include "tools/project.h"
#include "tools/report/html.h"
#include "tools/report/rectified.h"
#include "tools/report/rerun.h"
#include "tools/report/section.h"
#include "tools/round_names.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

constexpr int kSidePx = 360;

// Something that a view shows, or is to show, and how near it comes to the target.
struct Shown {
  Image picture;  // gamma-encoded; no pixels where there is none
  double psnr_db = 0;

  bool there() const { return !picture.data.empty(); }
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

// The project as its rounds left it.
struct Rounds {
  Project project;
  int count = 0, measured = 0;  // designed ones, and those of them whose board was photographed and measured
  DesignSpec spec;
  Board board;
  Bench nominal;
  BoardFrame frame;
  std::vector<Matching> names;  // of the measured rounds
};

// One view in one round: what the board was to show there, and what a photo of it shows.
struct ViewInRound {
  Shown promised, photographed;
  std::string photo;  // name of the photographed view
};

// One view, round after round.
struct ViewHistory {
  std::string view;
  Image target;
  std::vector<ViewInRound> rounds;
};

// What a round's board was to show of one picture, and the bench that it was designed for.
struct Asked {
  DesignView picture;
  fs::path bench;
};

// The picture of the project's design with that index, in a round's own design: by its name, or, where views took the
// names of photos, by its place in the list.
std::optional<Asked> in_round(const Rounds& in, int number, std::size_t index) {
  const DesignSpec spec = read_design(in.project.round(number) / "design.json");
  const DesignView& wanted = in.spec.views[index];
  for (const DesignView& v : spec.views)
    if (v.view == wanted.view && v.light == wanted.light) return Asked{v, spec.bench};
  if (spec.views.size() != in.spec.views.size()) return std::nullopt;
  return Asked{spec.views[index], spec.bench};
}

// What a designed view or lamp is called in the round's photos; empty where that is not decided.
std::string measured_name(const std::vector<Match>& matches, const std::string& designed) {
  const auto found =
      std::find_if(matches.begin(), matches.end(), [&](const Match& match) { return match.designed == designed; });
  return found == matches.end() ? "" : found->measured;
}

ViewHistory history_of(const Rounds& in, std::size_t index) {
  const DesignView& designed = in.spec.views[index];
  const View& nominal = find_view(in.nominal, designed.view, (in.project.folder / "design.json").string());
  const double rotation = designed.target.upright_in_view
                              ? viewer_rotation_deg(nominal, (in.board.carve_min_mm + in.board.carve_max_mm) / 2)
                              : designed.target.rotation_deg;
  ViewHistory out{designed.view, {}, {}};
  out.target = load_target(designed.target, rotation, in.board.carve_max_mm - in.board.carve_min_mm, in.frame.width,
                           in.frame.height)
                   .picture;
  for (int r = 1; r <= in.count; ++r) {
    const fs::path round = in.project.round(r);
    ViewInRound& now = out.rounds.emplace_back();
    if (const auto asked = in_round(in, r, index)) {
      Bench known = read_bench(asked->bench);
      fill_material(known, in.board);
      now.promised =
          promised(round / "scratches.csv", in.board, known,
                   find_view(known, asked->picture.view, asked->bench.string()), asked->picture.light, out.target);
    }
    if (r > in.measured) continue;
    const Matching& names = in.names[static_cast<std::size_t>(r - 1)];
    const std::string taken = measured_name(names.views, designed.view),
                      lamp = measured_name(names.lamps, designed.light);
    if (taken.empty() || lamp.empty()) continue;
    const Bench measured = read_bench(round / "bench.json");
    now.photographed =
        photographed(round, find_view(measured, taken, (round / "bench.json").string()), measured, lamp, out.target);
    now.photo = taken;
  }
  return out;
}

std::string decibels(const Shown& shown) { return shown.there() ? fmt::format("{:.1f} dB", shown.psnr_db) : ""; }

// Target, and what each round promised and showed, side by side.
std::string pictures_of(const ViewHistory& view) {
  std::vector<std::string> row{figure(view.target, "<b>Target</b>")};
  for (std::size_t i = 0; i < view.rounds.size(); ++i) {
    const ViewInRound& round = view.rounds[i];
    if (round.promised.there())
      row.push_back(
          figure(round.promised.picture, fmt::format("<b>Round {}, promised</b> by the {} bench: {}", i + 1,
                                                     i == 0 ? "believed" : "measured", decibels(round.promised))));
    if (round.photographed.there())
      row.push_back(figure(round.photographed.picture, fmt::format("<b>Round {}, photographed</b> (as {}): {}", i + 1,
                                                                   html(round.photo), decibels(round.photographed))));
  }
  return fmt::format("<h3>View {}</h3>\n", html(view.view)) + figure_row(row);
}

std::string table_of(const Rounds& in, const std::vector<ViewHistory>& views) {
  Table out;
  out.header = {"View"};
  for (int r = 1; r <= in.count; ++r) {
    out.header.push_back(fmt::format("Round {}: promised", r));
    if (r <= in.measured) out.header.push_back(fmt::format("Round {}: photographed", r));
  }
  for (const ViewHistory& view : views) {
    std::vector<std::string> cells{html(view.view)};
    for (int r = 0; r < in.count; ++r) {
      cells.push_back(decibels(view.rounds[static_cast<std::size_t>(r)].promised));
      if (r < in.measured) cells.push_back(decibels(view.rounds[static_cast<std::size_t>(r)].photographed));
    }
    out.rows.push_back(std::move(cells));
  }
  return table(out);
}

// The mean over those views whose first board was photographed, and which have a picture of that kind; empty if none.
std::string mean_decibels(const std::vector<ViewHistory>& views, int round, Shown ViewInRound::*which) {
  double sum = 0;
  int count = 0;
  for (const ViewHistory& view : views) {
    const Shown& shown = view.rounds[static_cast<std::size_t>(round - 1)].*which;
    if (!view.rounds.front().photographed.there() || !shown.there()) continue;
    sum += shown.psnr_db;
    ++count;
  }
  return count == 0 ? "" : fmt::format("{:.1f} dB", sum / count);
}

// One sentence for the top; `points` gets what else there is to say.
std::string outcome_of(const Rounds& in, const std::vector<ViewHistory>& views, std::vector<std::string>& points) {
  if (in.measured == 0)
    return "The first board is designed for the bench as it is believed to be, and has not been photographed yet.";
  std::string out = fmt::format("The loop has turned {} time{}.", in.measured, in.measured == 1 ? "" : "s");
  const std::string first = mean_decibels(views, 1, &ViewInRound::photographed);
  if (!first.empty()) {
    out += fmt::format(
        " The board designed for the believed bench should have shown its pictures at {} on average, and was "
        "photographed at {}",
        mean_decibels(views, 1, &ViewInRound::promised), first);
    const std::string last = mean_decibels(views, in.measured, &ViewInRound::photographed);
    if (in.measured > 1 && !last.empty()) out += fmt::format("; the board of round {} at {}", in.measured, last);
    if (in.count > in.measured) {
      const std::string next = mean_decibels(views, in.measured + 1, &ViewInRound::promised);
      if (!next.empty()) out += fmt::format("; the next, designed for the bench as measured, promises {}", next);
    }
    out += ".";
  }
  std::vector<RerunView> reruns;  // the first board as photographed, and the second as promised or photographed
  for (const ViewHistory& view : views) {
    if (in.count < 2 || !view.rounds[0].photographed.there() || !view.rounds[1].promised.there()) continue;
    const ViewInRound &before = view.rounds[0], &after = view.rounds[1];
    reruns.push_back(
        {view.view, before.promised.psnr_db, before.photographed.psnr_db, after.promised.psnr_db, std::nullopt});
    if (after.photographed.there()) reruns.back().seen_after_db = after.photographed.psnr_db;
  }
  if (!reruns.empty()) points.push_back(rerun_sentence(reruns));
  return out;
}

}  // namespace

std::optional<Section> project_section(const fs::path& folder, const Progress& progress) {
  Rounds in;
  in.project.folder = folder;
  in.count = in.project.rounds();
  while (in.count > 0 && !fs::exists(in.project.round(in.count) / "scratches.csv")) --in.count;  // not designed yet
  if (in.count == 0 || !fs::exists(folder / "design.json")) return std::nullopt;
  in.measured = std::min(in.count, in.project.measured());
  in.spec = read_design(folder / "design.json");
  in.board = read_board(in.spec.board);
  in.nominal = read_bench(in.spec.bench);
  in.frame = board_frame(in.board.carve_min_mm, in.board.carve_max_mm, kSidePx);

  for (int r = 1; r <= in.measured; ++r) in.names.push_back(match_round(in.project, r));

  std::vector<ViewHistory> views;
  for (std::size_t index = 0; index < in.spec.views.size(); ++index) {
    if (progress) progress("comparing rounds", static_cast<double>(index) / static_cast<double>(in.spec.views.size()));
    views.push_back(history_of(in, index));
  }
  Section out;
  out.outcome = outcome_of(in, views, out.points);
  out.body = "<h2>Round after round</h2>\n" + table_of(in, views);
  for (const ViewHistory& view : views) out.body += pictures_of(view);
  out.body +=
      "<p class=\"soft\">Promised: the photo that the bench would give for which the board was designed. "
      "Photographed: the photo taken from there. All are laid flat on the carve area, each at the one exposure that "
      "comes nearest to the target, and compared with it after gamma 1/2.2, as PSNR. A camera blurs the hatching; a "
      "design's own figures count it pixel by pixel, and so are lower than these.</p>\n";
  // The whole of the newest: the measured bench, and the design made for it.
  if (in.measured > 0) {
    const auto session = session_section(in.project.round(in.measured), {}, progress);
    if (session) {
      out.points.push_back(session->outcome);
      out.points.insert(out.points.end(), session->points.begin(), session->points.end());
      out.body += session->body;
    }
  }
  if (const auto design = design_section(in.project.round(in.count))) out.body += design->body;
  return out;
}

}  // namespace burin

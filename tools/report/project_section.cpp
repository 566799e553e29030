// Report of a loop project: for every picture the target, and the prediction and the photo of each round.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "burin/calib/predicted_photo.h"
#include "burin/capture/photo.h"
#include "burin/capture/session.h"
#include "burin/optimize/design/color_views.h"
#include "burin/optimize/design_file.h"
#include "burin/optimize/loss/color_metrics.h"
#include "burin/optimize/target.h"
#include "burin/scene/bench.h"
#include "burin/scene/bench_of_board.h"
#include "burin/scene/board.h"
#include "burin/scene/board_face.h"
#include "burin/scene/scratches.h"
#include "tools/commands.h"
#include "tools/loop/round_lamps.h"
#include "tools/match_views.h"
#include "tools/picture_quality.h"
#include "tools/project.h"
#include "tools/report/bench_section.h"
#include "tools/report/chart.h"
#include "tools/report/html.h"
#include "tools/report/pictures.h"
#include "tools/report/rectified.h"
#include "tools/report/rerun.h"
#include "tools/report/section.h"
#include "tools/round_names.h"
#include "tools/rounds_quality.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

constexpr int kSidePx = 360;       // compared pixels, unless eyes at the viewpoints resolve fewer
constexpr int kMostShownPx = 720;  // most displayed pixels, if the photos have as many on the carve area

// A picture of a view and its similarity to the target.
struct Shown {
  Image picture;  // gamma-encoded, at its displayed size; without pixels if there is none
  double psnr_db = 0;

  bool there() const { return !picture.data.empty(); }
};

// The target, at the compared and at the displayed size.
struct Target {
  Image compared, shown;
};

// Converts a picture to its target's channels: luminance, or red, green and blue with white balance.
Image light_of(const Image& linear, const Target& target, const Eigen::Vector3d& gains) {
  if (target.compared.channels == 1) return luminance(linear);
  Image out = linear;
  for (std::size_t i = 0; i < out.data.size(); ++i)
    out.data[i] *= static_cast<float>(gains[static_cast<Eigen::Index>(i % 3)]);
  return out;
}

// Replaces clipped (infinite) values by very bright ones, and missing values by dark.
Image comparable(Image out, float brightest) {
  for (float& v : out.data) v = std::isinf(v) ? 10 * brightest : v > 0 ? v : 0;
  return out;
}

// Returns one factor per channel: the white balance with the best match.
Eigen::Vector3d best_gains(const Image& radiance, const Image& target, float brightest) {
  Eigen::Vector3d out;
  for (int c = 0; c < 3; ++c)
    out[c] = color_best_exposure(channel_of(radiance, c), channel_of(target, c), 1 / static_cast<double>(brightest));
  return out / out.mean();
}

// Lights and white balance of a view on a bench.
struct Seen {
  std::vector<std::string> lights;  // several: one photo per light, added up
  Eigen::Vector3d gains{1, 1, 1};   // factors on R, G, B, in color
  bool each_channel = false;        // in color, one exposure per channel
};

// Rectifies a photo to the carve area, at the exposure nearest to the target.
Shown nearest_exposure(const Target& target, const Seen& seen, const Board& board,
                       const std::function<Image(const BoardFrame&)>& laid_flat) {
  const auto frame = [&](const Image& like) {
    return BoardFrame{board.carve_min_mm, board.carve_max_mm, like.width, like.height};
  };
  Eigen::Vector3d gains = seen.gains;
  Image flat = light_of(laid_flat(frame(target.compared)), target, gains);
  float brightest = percentile(flat, 0.99);
  if (!(brightest > 0)) return {};
  if (seen.each_channel) {
    const Eigen::Vector3d more = best_gains(comparable(flat, brightest), target.compared, brightest);
    if (!more.allFinite()) return {};
    flat = light_of(flat, target, more);
    gains = gains.cwiseProduct(more);
    brightest = percentile(flat, 0.99);
    if (!(brightest > 0)) return {};
  }
  const Image radiance = comparable(std::move(flat), brightest);
  const auto white = static_cast<float>(1 / color_best_exposure(radiance, target.compared, 1 / brightest));
  Shown out;
  out.psnr_db = color_psnr_db(shown(radiance, white), target.compared);
  out.picture = shown(comparable(light_of(laid_flat(frame(target.shown)), target, gains), brightest), white);
  return out;
}

// Light of one lamp in the photos of a view; infinite if all are clipped.
struct LitView {
  View view;
  Image light;
};

std::optional<LitView> lit_view(const Session& session, const View& view, const std::string& light) {
  std::vector<Photo> photos;
  std::copy_if(session.photos.begin(), session.photos.end(), std::back_inserter(photos),
               [&](const Photo& p) { return p.view == view.name && p.light == light; });
  if (photos.empty()) return std::nullopt;
  MergedView merged = merge_bracket(photos);
  for (std::size_t i = 0; i < merged.valid.size(); ++i)
    if (!merged.valid[i])
      for (int c = 0; c < merged.value.channels; ++c) merged.value.data[i * merged.value.channels + c] = INFINITY;
  return LitView{view, std::move(merged.value)};
}

// Adds up a round's photos of a picture, as light adds up on the board. For each lamp, uses the first of `views` that
// was photographed under it. Each photo also contains the ambient light.
Shown photographed(const fs::path& round, const std::vector<std::string>& views, const Bench& bench, const Seen& seen,
                   const Target& target) {
  const Session session = read_session(round / "session.json");
  const Board board = read_board(session.board);
  std::vector<LitView> lit;
  for (const std::string& light : seen.lights) {
    std::optional<LitView> found;
    for (const std::string& name : views)
      if (!found) found = lit_view(session, find_view(bench, name, (round / "bench.json").string()), light);
    if (!found) return {};
    if (target.compared.channels == 3 && found->light.channels != 3) return {};  // a gray photo does not show color
    lit.push_back(std::move(*found));
  }
  return nearest_exposure(target, seen, board, [&](const BoardFrame& frame) {
    Image sum;
    for (const LitView& one : lit) {
      const Image flat = rectified(one.light, 0, 0, lens_of(bench, one.view), one.view.T_camera_board,
                                   surface_of(board, bench), frame);
      if (sum.data.empty())
        sum = flat;
      else
        for (std::size_t i = 0; i < sum.data.size(); ++i) sum.data[i] += flat.data[i];
    }
    return sum;
  });
}

// Renders the round's board from there, on the bench of its design.
Shown promised(const fs::path& scratches, const Board& board, const Bench& bench, const View& view, const Seen& seen,
               const Target& target) {
  if (!fs::exists(scratches)) return {};
  const PixelWindow window = carve_window(bench, board, view);
  if (window.width == 0 || window.height == 0) return {};
  PredictedPhotoOptions options;
  options.window = window;
  options.channels = target.compared.channels;
  const Image photo =
      predicted_photo(bench, board, view, find_lit(bench, joined_lights(seen.lights), scratches.string()),
                      carve(Designed(read_scratches(scratches)), bench, board), options);
  return nearest_exposure(target, seen, board, [&](const BoardFrame& frame) {
    return rectified(photo, window.x0, window.y0, lens_of(bench, view), view.T_camera_board, surface_of(board, bench),
                     frame);
  });
}

// Results of all rounds of a project.
struct Rounds {
  Project project;
  int count = 0, measured = 0;  // designed rounds, and those of them with a photographed and measured board
  DesignSpec spec;
  Board board;
  Bench nominal;
  int compared_px = kSidePx, shown_px = kSidePx;  // of the longer side of the pictures
  std::optional<DesignQuality> designed;          // of the newest round, by its own report
  std::vector<Matching> names;                    // of the measured rounds
};

// One view in one round: the prediction and the photo.
struct ViewInRound {
  Shown promised, photographed;
  std::string photo;  // name of the photographed view
};

// One view in all rounds.
struct ViewHistory {
  std::string view;
  Target target;
  std::vector<ViewInRound> rounds;
};

// A picture in a round's design, and the bench of that design.
struct Asked {
  DesignView picture;
  fs::path bench;
};

// Finds the picture with that index of the project's design in a round's design. It matches by name or, if views took
// the names of photos, by index.
std::optional<Asked> in_round(const Rounds& in, int number, std::size_t index) {
  const DesignSpec spec = read_design(in.project.round(number) / "design.json");
  const DesignView& wanted = in.spec.views[index];
  for (const DesignView& v : spec.views)
    if (v.view == wanted.view && v.light == wanted.light) return Asked{v, spec.bench};
  if (spec.views.size() != in.spec.views.size()) return std::nullopt;
  return Asked{spec.views[index], spec.bench};
}

// Returns the name of a designed view or lamp in the round's photos; empty if undecided.
std::string measured_name(const std::vector<Match>& matches, const std::string& designed) {
  const auto found =
      std::find_if(matches.begin(), matches.end(), [&](const Match& match) { return match.designed == designed; });
  return found == matches.end() ? "" : found->measured;
}

// Returns the names of measured views for a designed one: its match, and others near it, which may be the same
// viewpoint under other lamps. Empty without a match.
std::vector<std::string> measured_names(const std::vector<Match>& matches, const std::string& designed) {
  std::vector<std::string> out;
  for (const Match& match : matches) {
    if (match.designed != designed || match.measured.empty()) continue;
    out.push_back(match.measured);
    for (const Candidate& near : match.near)
      if (near.name != match.measured) out.push_back(near.name);
  }
  return out;
}

// Returns the lights of a picture and its white balance on a bench with the design's names.
Seen seen_on(const DesignView& picture, const Board& board, const Bench& bench) {
  Seen out{light_names(picture.light), {1, 1, 1}, picture.color && picture.white.kind == White::Kind::each};
  if (picture.color) out.gains = white_gains(picture, board, bench);
  return out;
}

// seen_on() with the names of the round's photos; nothing if one of its lights has no match.
std::optional<Seen> seen_in_photos(const DesignView& picture, const Board& board, const Matching& names) {
  std::vector<std::string> lights;
  for (const std::string& id : light_names(picture.light)) {
    lights.push_back(measured_name(names.lamps, id));
    if (lights.back().empty()) return std::nullopt;
  }
  Seen out = seen_on(picture, board, names.bench);
  out.lights = std::move(lights);
  return out;
}

// Returns a view's target on the carve area: luminance, or in color.
Image target_of(const DesignView& view, double rotation_deg, const Board& board, const BoardFrame& frame) {
  const Eigen::Vector2d area = board.carve_max_mm - board.carve_min_mm;
  if (!view.color) return load_target(view.target, rotation_deg, area, frame.width, frame.height).picture;
  const auto in = load_color_target(view.target, rotation_deg, area, frame.width, frame.height);
  return in_color(in[0].picture, in[1].picture, in[2].picture);
}

ViewHistory history_of(const Rounds& in, std::size_t index) {
  const DesignView& designed = in.spec.views[index];
  const View& nominal = find_view(in.nominal, designed.view, (in.project.folder / "design.json").string());
  const double rotation = designed.target.upright_in_view
                              ? viewer_rotation_deg(nominal, (in.board.carve_min_mm + in.board.carve_max_mm) / 2)
                              : designed.target.rotation_deg;
  ViewHistory out{designed.view, {}, {}};
  const auto drawn = [&](int side_px) {
    return target_of(designed, rotation, in.board, board_frame(in.board.carve_min_mm, in.board.carve_max_mm, side_px));
  };
  out.target = {drawn(in.compared_px), drawn(in.shown_px)};
  for (int r = 1; r <= in.count; ++r) {
    const fs::path round = in.project.round(r);
    ViewInRound& now = out.rounds.emplace_back();
    if (const auto asked = in_round(in, r, index)) {
      Bench known = read_bench(asked->bench);
      fill_material(known, in.board);
      now.promised = promised(round / "scratches.csv", in.board, known,
                              find_view(known, asked->picture.view, asked->bench.string()),
                              seen_on(asked->picture, in.board, known), out.target);
    }
    if (r > in.measured) continue;
    const Matching& names = in.names[static_cast<std::size_t>(r - 1)];
    const std::vector<std::string> taken = measured_names(names.views, designed.view);
    if (taken.empty()) continue;
    const std::optional<Seen> seen = seen_in_photos(designed, in.board, names);
    if (!seen) continue;
    const Bench measured = read_bench(round / "bench.json");
    now.photographed = photographed(round, taken, measured, *seen, out.target);
    now.photo = taken.front();
  }
  return out;
}

std::string value_of(const Shown& shown) { return shown.there() ? decibels(shown.psnr_db) : ""; }

// Returns the target, and each round's prediction and photo. The wipe starts between the target and the newest photo.
std::string pictures_of(const ViewHistory& view) {
  std::vector<Figure> figures{{view.target.shown, "View " + view.view + ": the target, as it lies on the carve area",
                               "<b>Target</b>", "Target"}};
  std::size_t newest = 0;
  const auto add = [&](const Shown& shown, int round, const std::string& word, const std::string& how) {
    if (!shown.there()) return;
    const std::string name = fmt::format("Round {}, {}", round, word);
    const std::string word_html = word == "photographed" ? "photo&shy;graphed" : word;  // may break in a small picture
    figures.push_back({shown.picture,
                       fmt::format("View {}, round {}: {} {}, {}", view.view, round, word, how, value_of(shown)),
                       fmt::format("<b>Round {}, {}</b> {}<span class=\"more\"> {}</span>", round, word_html,
                                   unbroken(value_of(shown)), html(how)),
                       name});
  };
  for (std::size_t i = 0; i < view.rounds.size(); ++i) {
    const ViewInRound& round = view.rounds[i];
    const int number = static_cast<int>(i) + 1;
    add(round.promised, number, "promised", i == 0 ? "by the believed bench" : "by the measured bench");
    if (newest == 0) newest = figures.size() - 1;
    add(round.photographed, number, "photographed", "as " + round.photo);
    if (round.photographed.there()) newest = figures.size() - 1;
  }
  return compared("View " + view.view, figures, 0, newest);
}

std::string table_of(const Rounds& in, const std::vector<ViewHistory>& views) {
  Table out;
  out.header = {"View"};
  for (int r = 1; r <= in.count; ++r) {
    out.header.push_back(fmt::format("Round {}: promised of a photo ({} px)", r, in.compared_px));
    if (r <= in.measured) out.header.push_back(fmt::format("Round {}: photographed ({} px)", r, in.compared_px));
  }
  for (const ViewHistory& view : views) {
    std::vector<std::string> cells{html(view.view)};
    for (int r = 0; r < in.count; ++r) {
      cells.push_back(value_of(view.rounds[static_cast<std::size_t>(r)].promised));
      if (r < in.measured) cells.push_back(value_of(view.rounds[static_cast<std::size_t>(r)].photographed));
    }
    out.rows.push_back(std::move(cells));
  }
  return table(out);
}

// Returns curves over the rounds: dashed for predictions, solid for photos.
std::string curves_of(const Rounds& in, const std::vector<ViewHistory>& views) {
  if (in.count < 2) return "";
  std::vector<Curve> curves;
  std::string told = "PSNR in dB, round after round.";
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t k = 0; k < views.size(); ++k) {
    Curve promised{views[k].view + ", promised", {}, true, static_cast<int>(k)},
        seen{views[k].view, {}, false, static_cast<int>(k)};
    told += fmt::format(" View {}:", views[k].view);
    for (std::size_t r = 0; r < views[k].rounds.size(); ++r) {
      const ViewInRound& round = views[k].rounds[r];
      promised.values.push_back(round.promised.there() ? round.promised.psnr_db : kNone);
      seen.values.push_back(round.photographed.there() ? round.photographed.psnr_db : kNone);
      if (round.promised.there()) told += fmt::format(" round {} promised {},", r + 1, value_of(round.promised));
      if (round.photographed.there()) told += fmt::format(" photographed {},", value_of(round.photographed));
    }
    told.back() = '.';
    curves.push_back(std::move(promised));
    curves.push_back(std::move(seen));
  }
  ChartWords words{"round", "dB", told};
  for (int r = 1; r <= in.count; ++r) words.x_names.push_back(fmt::format("round {}", r));
  words.marks = true;
  words.of_dashed = "dashed, hollow: promised; whole: photographed";
  return chart(curves, words);
}

// Mean PSNR of one kind of picture over the views that have both, and their number.
struct Mean {
  double db = 0;
  int views = 0;
};

Mean mean_of(const std::vector<ViewHistory>& views, int round, Shown ViewInRound::*which, int other_round,
             Shown ViewInRound::*other) {
  Mean mean;
  for (const ViewHistory& view : views) {
    const Shown& shown = view.rounds[static_cast<std::size_t>(round - 1)].*which;
    if (!shown.there() || !(view.rounds[static_cast<std::size_t>(other_round - 1)].*other).there()) continue;
    mean.db += shown.psnr_db;
    ++mean.views;
  }
  if (mean.views > 0) mean.db /= mean.views;
  return mean;
}

std::string gain_in_words(double gain_db, const std::string& than) {
  if (!std::isfinite(gain_db) || std::abs(gain_db) < 0.05) return "as good as " + than;
  return fmt::format("{:.1f} dB {} than {}", std::abs(gain_db), gain_db > 0 ? "better" : "worse", than);
}

std::string pictures_in_words(int shown, std::size_t all) {
  if (all == 1) return "its picture";
  if (static_cast<std::size_t>(shown) == all) return fmt::format("its {} pictures", all);
  return fmt::format("{} of its {} pictures", shown, all);
}

// Returns one sentence for the top: the result of the newest board, compared with the one before and the next.
std::string outcome_of(const Rounds& in, const std::vector<ViewHistory>& views) {
  constexpr auto kPromised = &ViewInRound::promised, kSeen = &ViewInRound::photographed;
  const int last = in.measured;
  if (last == 0) {
    if (!in.designed) return "The first board is designed, and has not been photographed yet.";
    const DesignQuality& q = *in.designed;
    const bool one = views.size() == 1;
    return fmt::format(
        "The first board should show {} at {}{} ({}{}), if the bench is as it is believed to be. It has not been "
        "photographed yet.",
        pictures_in_words(static_cast<int>(views.size()), views.size()), decibels_of(q.mean_db(), q.px),
        one ? "" : " on average", one ? "" : "the worst: ", q.in_words(q.worst()));
  }
  const Mean seen = mean_of(views, last, kSeen, last, kSeen);
  if (seen.views == 0)
    return fmt::format(
        "The board of round {} was photographed and the bench measured, but no photo was taken from where one of its "
        "pictures is to be seen.",
        last);
  std::string out = fmt::format(
      "The board{} shows {} at {}{} ({} px of its photo{}; {})", last > 1 ? fmt::format(" of round {}", last) : "",
      pictures_in_words(seen.views, views.size()), decibels(seen.db), seen.views > 1 ? " on average" : "",
      in.compared_px, seen.views > 1 ? "s" : "", quality_in_words(seen.db));
  if (last > 1) {
    const Mean now = mean_of(views, last, kSeen, last - 1, kSeen),
               before = mean_of(views, last - 1, kSeen, last, kSeen);
    if (now.views > 0) out += ", " + gain_in_words(now.db - before.db, "the board before");
  }
  const Mean promise = mean_of(views, last, kPromised, last, kSeen);
  if (promise.views == seen.views)
    out += fmt::format("; promised {} {}", seen.views > 1 ? "were" : "was", decibels(promise.db));
  if (in.count > last) {
    const Mean next = mean_of(views, last + 1, kPromised, last, kSeen),
               now = mean_of(views, last, kSeen, last + 1, kPromised);
    if (next.views > 0)
      out += fmt::format("; designed for the bench as measured, the next one promises {}, {}", decibels(next.db),
                         gain_in_words(next.db - now.db, "this one shows"));
  }
  return out + ".";
}

RoundsQuality quality_of(const Rounds& in, const std::vector<ViewHistory>& views) {
  RoundsQuality out;
  for (int r = 0; r < in.count; ++r) {
    std::vector<ViewQuality>& round = out.emplace_back();
    for (const ViewHistory& view : views) {
      const ViewInRound& now = view.rounds[static_cast<std::size_t>(r)];
      ViewQuality& quality = round.emplace_back(ViewQuality{view.view});
      if (now.promised.there()) quality.promised_db = now.promised.psnr_db;
      if (now.photographed.there()) quality.photographed_db = now.photographed.psnr_db;
    }
  }
  return out;
}

std::string next_of(const Rounds& in, const RoundsQuality& quality) {
  const Project project{folder_on_page(in.project.folder)};
  const std::string loop = "<code>" + html("burin loop " + shell_word(project.folder.string())) + "</code>";
  if (in.count == in.measured) return loop + " designs the next board for the bench as measured.";
  if (const std::optional<NextBoard> next = next_board(quality); next && is_last(*next))
    return html(hang_in_words(*next)) + ". <code>" +
           html("burin loop " + shell_word(project.folder.string()) + " --another") + "</code> goes on with it.";
  const fs::path round = project.round(in.count);
  const fs::path gcode = round / "board.gcode";
  return fmt::format(
      "carve {}, put photos of it into {}, then {}.",
      fs::exists(gcode) ? "<code>" + html(gcode.string()) + "</code>" : fmt::format("the board of round {}", in.count),
      html(photo_folders_in_words(project, in.count)), loop);
}

// Returns the findings from the comparison of rounds.
std::vector<Finding> findings_of(const Rounds& in, const std::vector<ViewHistory>& views) {
  std::vector<Finding> out;
  std::vector<RerunView> reruns;  // the first board as photographed, and the second as predicted or photographed
  for (std::size_t k = 0; k < views.size(); ++k) {
    const ViewHistory& view = views[k];
    const bool several = light_names(in.spec.views[k].light).size() > 1;
    if (in.measured > 0 && !view.rounds[static_cast<std::size_t>(in.measured - 1)].photographed.there())
      out.push_back(
          {FindingCode::position_changed,
           Finding::Severity::warning,
           {},
           fmt::format("view {}: no photo of round {} shows it as it is to be seen", view.view, in.measured),
           fmt::format("take {} from its designed place, or name it: burin loop {} --view {}=PHOTOGRAPHED_VIEW",
                       several ? "one under each of its lamps alone, in color," : "one",
                       shell_word(in.project.folder.string()), view.view)});
    if (in.count < 2 || !view.rounds[0].photographed.there() || !view.rounds[1].promised.there()) continue;
    const ViewInRound &before = view.rounds[0], &after = view.rounds[1];
    reruns.push_back(
        {view.view, before.promised.psnr_db, before.photographed.psnr_db, after.promised.psnr_db, std::nullopt});
    if (after.photographed.there()) reruns.back().seen_after_db = after.photographed.psnr_db;
  }
  append(out, rerun_findings(reruns));
  return out;
}

// Returns the photos' resolution on the carve area, between the compared and the largest displayed one.
int shown_side_px(const Rounds& in) {
  int longest = kSidePx;
  const auto look = [&](const Bench& bench) {
    for (const View& view : bench.views) {
      const PixelWindow window = carve_window(bench, in.board, view);
      longest = std::max({longest, window.width, window.height});
    }
  };
  if (in.measured > 0)
    look(read_bench(in.project.round(in.measured) / "bench.json"));
  else
    look(in.nominal);
  return std::min(longest, kMostShownPx);
}

constexpr const char* kWhatIsCompared =
    "<p class=\"soft\">Promised: the photo that the bench would give for which the board was designed. Photographed: "
    "the "
    "photo taken from there. All are laid flat on the carve area, each at the one exposure that comes nearest to the "
    "target, and compared with it after gamma 1/2.2, as PSNR (in color over red, green and blue); a view under several "
    "lamps by the sum of its photos under each alone (what else shines counts in each): 20 dB is recognizable, 25 dB "
    "good, 30 dB hard to tell "
    "apart. A camera blurs the hatching, so what is promised of its photos has more dB than what the design counts for "
    "eyes.</p>\n";

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
  aim_views(in.nominal, in.board);
  for (int r = 1; r <= in.count; ++r) {
    const fs::path report = in.project.round(r) / "design" / "design-report.json";
    in.designed.reset();
    if (!fs::exists(report)) continue;
    in.designed = quality_of_design(report);
    if (in.designed->px > 0) in.compared_px = std::min(in.compared_px, in.designed->px);
  }
  in.shown_px = shown_side_px(in);

  for (int r = 1; r <= in.measured; ++r) in.names.push_back(match_round(in.project, r));

  std::vector<ViewHistory> views;
  for (std::size_t index = 0; index < in.spec.views.size(); ++index) {
    if (progress) progress("comparing rounds", static_cast<double>(index) / static_cast<double>(in.spec.views.size()));
    views.push_back(history_of(in, index));
  }
  Section out;
  out.title = "The project";
  out.outcome = outcome_of(in, views);
  const RoundsQuality quality = quality_of(in, views);
  out.next = next_of(in, quality);
  out.rounds = rounds_text(quality, folder / "rounds.json");
  out.findings = findings_of(in, views);
  std::string pictures;
  for (const ViewHistory& view : views) pictures += pictures_of(view);
  out.pictures = compared_in_lockstep("carve area", pictures) +
                 fmt::format(
                     "<p class=\"soft\">dB here are those of photos, which a camera blurs, in {} pixels along the "
                     "longer side; the design's own are for eyes.</p>\n",
                     in.compared_px);
  const std::string curves = curves_of(in, views);
  if (!curves.empty()) out.open += "<section><h2>Round after round</h2>\n" + curves + "</section>\n";
  out.parts = folded("What each round promised and showed", "view by view, and how it is compared",
                     table_of(in, views) + kWhatIsCompared);
  // All about the newest round: the measured bench, and the design for it.
  if (in.measured > 0) {
    if (const auto session = session_section(in.project.round(in.measured), {}, progress)) {
      append(out.findings, session->findings);
      out.has_scene = session->has_scene;
      out.open += session->open;
      out.parts +=
          folded("Photo beside prediction", "every photo, as the measured bench predicts it", session->pictures);
      out.parts += session->parts;
    }
  }
  if (!out.has_scene) {
    const fs::path report = in.project.round(in.count) / "design" / "design-report.json";
    out.open += bench_section(in.nominal, in.board, shown_tolerances(in.spec, in.nominal, in.board, report),
                              "The bench as it is believed to be");
    out.has_scene = true;
  }
  out.open = "<div class=\"beside\">\n" + out.open + "</div>\n";
  if (const auto design = design_section(in.project.round(in.count))) {
    append(out.findings, design->findings);
    out.parts += folded(fmt::format("The design of round {}", in.count), design->outcome, whole_section(*design));
  }
  return out;
}

}  // namespace burin

#include "burin/calib/calibrate.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <set>
#include <thread>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/base/files/files_together.h"
#include "burin/base/files/json_file.h"
#include "burin/base/median.h"
#include "burin/calib/change_in_time.h"
#include "burin/calib/geometry/own_focal.h"
#include "burin/calib/light/lamp.h"
#include "burin/calib/light/lamp_colors.h"
#include "burin/calib/light/light_samples.h"
#include "burin/calib/light/photo_faults.h"
#include "burin/calib/light/white_balance.h"
#include "burin/calib/verdict/identifiability.h"
#include "burin/calib/verdict/next_photo.h"
#include "burin/capture/photo.h"
#include "burin/capture/tags/tag_family.h"
#include "burin/scene/board_face.h"
#include "burin/scene/parameter_name.h"
#include "burin/scene/scratches.h"

namespace burin {
namespace {

std::string list_of(const std::set<int>& ids) {
  std::string out;
  int shown = 0;
  for (const int id : ids) {
    if (shown++ == 8) return out + ", ...";
    out += (out.empty() ? "" : ", ") + std::to_string(id);
  }
  return out;
}

// Fails with the reason for missing tags of the board: another family, other ids, or no tag at all.
[[noreturn]] void fail_without_tags(const Session& session, const std::vector<Bracket>& brackets,
                                    const std::vector<NoiseModel>& noise, const Board& board,
                                    const std::set<int>& foreign_ids) {
  const std::string& family = board.tags.family;
  const auto file = [&](std::size_t b) { return session.photos[brackets[b].photos.front()].file.string(); };
  if (!foreign_ids.empty()) {
    std::set<int> listed;
    for (const Tag& tag : board.tags.list) listed.insert(tag.id);
    fail(file(0),
         "the photos show tags " + list_of(foreign_ids) + " of family " + family + ", board.json lists " +
             list_of(listed),
         "give the board.json of this board, or correct the ids in its tags.list");
  }
  const std::size_t step = std::max<std::size_t>(1, brackets.size() / 3);
  for (std::size_t b = 0; b < brackets.size(); b += step) {
    std::vector<Photo> photos;
    for (const int i : brackets[b].photos) photos.push_back(session.photos[i]);
    GrayView gray;
    merge_bracket(photos, noise[b], {1, &gray});
    const std::string instead = explain_missing_tags(gray.value, gray.valid, family);
    if (!instead.empty())
      fail(file(b), std::string("no tag of family ").append(family).append(" was found in any photo; ").append(instead),
           "set tags.family in board.json to the family on the board, and give the photos as the camera wrote them");
  }
  fail(file(0), "no tags were found in " + counted(brackets.size(), "view"),
       "photograph the whole board, sharp, its tags at least 20 pixels wide and their paper not clipped");
}

// The mean of the channels, sufficient for finding lamps.
MergedView without_color(MergedView&& view) {
  const int n = view.value.channels;
  if (n == 1) return std::move(view);
  Image value(view.value.width, view.value.height, 1), sigma(view.value.width, view.value.height, 1);
  for (std::size_t i = 0; i < value.data.size(); ++i) {
    double sum = 0, variance = 0;
    for (int c = 0; c < n; ++c) {
      sum += view.value.data[i * n + c];
      variance += static_cast<double>(view.sigma.data[i * n + c]) * view.sigma.data[i * n + c];
    }
    value.data[i] = static_cast<float>(sum / n);
    sigma.data[i] = static_cast<float>(std::sqrt(variance) / n);
  }
  view.value = std::move(value);
  view.sigma = std::move(sigma);
  return std::move(view);
}

// Data kept of the photos after reading.
struct Pictures {
  std::vector<TagsInPhoto> tags;   // one per bracket
  std::vector<MergedView> merged;  // binned, without color
  std::vector<std::vector<PaperColor>> paper;
  std::vector<std::vector<Eigen::Vector3d>> paper_light;  // with the lamps' colors
};

Pictures read_pictures(const Session& session, const std::vector<Bracket>& brackets,
                       const std::vector<NoiseModel>& noise, const Board& board, int bin, const Progress& progress) {
  Pictures out;
  out.tags.resize(brackets.size());
  out.merged.resize(brackets.size());
  out.paper.resize(brackets.size());
  out.paper_light.resize(brackets.size());
  std::vector<int> ids;
  for (const Tag& tag : board.tags.list) ids.push_back(tag.id);
  tbb::enumerable_thread_specific<TagDetector> detector([&] { return TagDetector(board.tags.family); });
  const std::thread::id caller = std::this_thread::get_id();
  std::atomic<std::size_t> done = 0;
  for_each_merged(session, brackets, noise, bin, [&](std::size_t b, MergedView&& view, GrayView&& gray) {
    out.tags[b] = detector.local().detect(gray.value, gray.valid, ids);
    out.paper[b] = paper_colors(view, out.tags[b]);
    out.paper_light[b] = paper_light(view, out.tags[b]);
    out.merged[b] = without_color(std::move(view));
    ++done;
    if (progress && std::this_thread::get_id() == caller)
      progress("reading photos, finding tags", static_cast<double>(done) / static_cast<double>(brackets.size()));
  });
  return out;
}

double median_tag_side_px(const std::vector<TagsInPhoto>& pictures) {
  std::vector<double> sides;
  for (const TagsInPhoto& picture : pictures)
    for (const TagDetection& tag : picture.tags) sides.push_back((tag.corner_px[1] - tag.corner_px[0]).norm());
  return sides.empty() ? 1e9 : median_of(std::move(sides));
}

// Photos and tags as this camera stores them. Puts its processing into out.bench.sensor. If the first look at the tags
// shows more of it, all are read again.
Pictures read_as_stored(const Session& given, const std::vector<Bracket>& brackets, std::vector<NoiseModel>& noise,
                        const Board& board, PhotoSize size, const CalibrateOptions& options, const Progress& progress,
                        Calibration& out) {
  Sensor& sensor = out.bench.sensor;
  int bin = light_bin(size.width, size.height, 1e9);
  look_at_brackets(given, options.curve, sensor, out.findings);
  Session session = with_camera(given, sensor);
  noise = session_noise(session, brackets);
  const auto read = [&] {
    Pictures pictures = read_pictures(session, brackets, noise, board, bin, progress);
    if (const int smaller = light_bin(size.width, size.height, median_tag_side_px(pictures.tags)); smaller < bin) {
      bin = smaller;
      pictures = read_pictures(session, brackets, noise, board, bin, progress);
    }
    return pictures;
  };
  Pictures pictures = read();
  if (options.curve == CurveFrom::none) return pictures;
  const int cells = tag_pattern(board.tags.family, board.tags.list.front().id).border_cells;
  look_at_edges(given, brackets, pictures.tags, cells, sensor, out.findings);
  const bool balanced = look_at_paper_colors(given, brackets, pictures.paper, sensor, out.findings);
  if (!balanced) return pictures;
  session = with_camera(given, sensor);
  noise = session_noise(session, brackets);
  return read();
}

// Views whose focal length is too uncertain to place them on one side of a change by `log_ratio`.
std::vector<std::string> views_of_unknown_zoom(const BoardSolution& solved, const std::vector<ViewTags>& pictures,
                                               double log_ratio) {
  constexpr double kTells = 5;  // sigmas
  const std::vector<std::optional<OwnFocal>> focals = own_focals(solved.bundle);
  std::vector<std::string> names, out;  // in the bundle's order
  for (const ViewTags& picture : pictures)
    if (std::find(names.begin(), names.end(), picture.view) == names.end()) names.push_back(picture.view);
  for (const View& view : solved.views) {
    const auto at = static_cast<std::size_t>(std::find(names.begin(), names.end(), view.name) - names.begin());
    if (at >= focals.size() || !focals[at] || kTells * focals[at]->sigma > std::abs(log_ratio))
      out.push_back(view.name);
  }
  return out;
}

// Seeks a zoom that was turned half way through the session. Lens, bow and poses together absorb it, and no view is an
// outlier. All views before, or after, one moment then fit far better without the others. The others become odd, and
// `focals` becomes all views'.
void seek_turned_zoom(const Session& session, const Board& board, const std::vector<ViewTags>& pictures, PhotoSize size,
                      BoardSolverOptions options, BoardSolution& solved, std::vector<std::optional<OwnFocal>>& focals) {
  constexpr double kFarBetter = 0.4;  // of the RMS, which includes the corners' noise
  std::vector<std::string> views;     // in order of time
  for (const Photo& photo : session.photos)
    if (std::find(views.begin(), views.end(), photo.view) == views.end() &&
        std::any_of(solved.views.begin(), solved.views.end(), [&](const View& v) { return v.name == photo.view; }))
      views.push_back(photo.view);
  options.check_with_mrcal = false;
  const std::vector<std::string> given = options.leave_out;
  for (std::size_t others = 2; 2 * others <= views.size() && views.size() >= others + 4; ++others)
    for (const bool first : {false, true}) {
      const auto begin = first ? views.begin() : views.end() - static_cast<std::ptrdiff_t>(others);
      const std::vector<std::string> odd(begin, begin + static_cast<std::ptrdiff_t>(others));
      options.leave_out = given;
      options.leave_out.insert(options.leave_out.end(), odd.begin(), odd.end());
      BoardSolution without = solve_board(board, pictures, size.width, size.height, options);
      if (without.rms_px > kFarBetter * solved.rms_px || without.views.size() + others < views.size()) continue;
      Bundle all = without.bundle;  // the others' poses are not solved there
      for (std::size_t v = 0; v < all.views.size(); ++v)
        if (all.views[v].isApprox(Eigen::Isometry3d::Identity())) all.views[v] = solved.bundle.views[v];
      focals = own_focals(all);
      solved = std::move(without);
      solved.odd_views = odd;
      return;
    }
}

// Lens, poses and tags, by one lens. Views left out for their focal length may be all views before, or after, one
// moment. Then the zoom was turned at this moment. Views of that side which look straight at the board do not determine
// their focal length, fit any, and are left out too.
BoardSolution solve_with_one_lens(const Session& session, const Board& board, const std::vector<ViewTags>& pictures,
                                  PhotoSize size, BoardSolverOptions& solver, const Progress& progress) {
  BoardSolution solved = solve_board(board, pictures, size.width, size.height, solver, progress);
  if (solver.fix_lens) return solved;
  std::vector<std::optional<OwnFocal>> focals = own_focals(solved.bundle);
  const BoardSolution with_all = solved;
  if (solved.odd_views.size() < 2 && solved.focal_scatter > 0)
    seek_turned_zoom(session, board, pictures, size, solver, solved, focals);
  if (solved.odd_views.size() < 2) return solved;
  std::vector<std::string> names;
  for (const ViewTags& picture : pictures)
    if (std::find(names.begin(), names.end(), picture.view) == names.end()) names.push_back(picture.view);
  std::vector<double> ratios;
  for (const std::string& odd : solved.odd_views) {
    const auto at = static_cast<std::size_t>(std::find(names.begin(), names.end(), odd) - names.begin());
    if (at < focals.size() && focals[at]) ratios.push_back(focals[at]->log_ratio);
  }
  const double log_ratio = median_of(ratios);
  constexpr double kLeastZoom = 0.004;
  if (ratios.size() < 2 || std::abs(log_ratio) < kLeastZoom) return with_all;
  const std::vector<std::string> unknown = views_of_unknown_zoom(solved, pictures, log_ratio);
  const auto change = change_in_time(session, solved.odd_views, unknown);
  if (!change) return with_all;
  // Views between the last one of one side and the first one of the other may belong to either, and are left out too.
  solver.leave_out = solved.odd_views;
  std::string with_them;
  const auto index_of = [&](const std::string& view) {
    return std::find(names.begin(), names.end(), view) - names.begin();
  };
  for (const std::string& view : unknown) {
    const bool of_their_side = change->odd_after ? index_of(view) > index_of(change->view_before)
                                                 : index_of(view) < index_of(change->view_after);
    if (!of_their_side) continue;
    solver.leave_out.push_back(view);
    with_them += (with_them.empty() ? "" : ", ") + view;
  }
  std::string list;
  for (const std::string& name : solved.odd_views) list += (list.empty() ? "" : ", ") + name;
  const Finding turned = make_warning(
      FindingCode::camera_changed,
      "the zoom or focus was turned between " + change->photo_before + " and " + change->photo_after + ": views " +
          list + (change->odd_after ? ", taken after it," : ", taken before it,") + " fit a focal length " +
          fixed(std::exp(log_ratio), 3) + " times the others' and are left out" +
          (with_them.empty()
               ? ""
               : "; so is " + with_them + ", which does not determine its focal length and shares their time"),
      "leave zoom and focus alone during a session, and take these photos again");
  solved = solve_board(board, pictures, size.width, size.height, solver, progress);
  solved.findings.insert(solved.findings.begin(), turned);
  return solved;
}

// Lens, poses and tags; if lenses differ between photos, each view has its own. The solve with one lens comes first, to
// detect a zoom turned between two photos: own lenses would absorb it.
BoardSolution solve_lenses(const Session& session, const Board& board, const std::vector<ViewTags>& pictures,
                           PhotoSize size, BoardSolverOptions& solver, const Progress& progress) {
  solver.own_lenses = false;
  const std::vector<std::string> given = solver.leave_out;
  BoardSolution solved = solve_with_one_lens(session, board, pictures, size, solver, progress);
  solver.own_lenses = true;
  const bool turned = solver.leave_out != given;
  if (turned ? !solved.lenses_differ : !solved.lenses_differ && solved.odd_views.empty()) return solved;
  BoardSolution own = solve_board(board, pictures, size.width, size.height, solver, progress);
  if (turned) own.findings.insert(own.findings.begin(), solved.findings.front());
  return own;
}

// A view under one light.
using LitView = std::pair<std::string, std::string>;

// Adds the shifts of lamps and face by local tone mapping to their sigmas; `without` are samples with it removed.
void count_tones(const std::vector<LightSample>& without, const Board& board, const Bench& named, Bench& bench) {
  std::vector<Finding> told_before;
  const Bench other = with_lamps(without, board, named, told_before);
  for (std::size_t i = 0; i < bench.lights.size(); ++i) {
    Light& light = bench.lights[i];
    if (!light.position_sigma_mm) continue;
    const Eigen::Vector3d moved_mm = other.lights[i].position_mm - light.position_mm;
    light.position_sigma_mm = (light.position_sigma_mm->cwiseAbs2() + moved_mm.cwiseAbs2()).cwiseSqrt();
    Verdict& verdict = bench.verdict[parameter::light_position(light.id)];
    verdict.degree = Degree::not_determined;
    verdict.sigma = light.position_sigma_mm->norm();
  }
  if (auto& sigma = bench.material_sigma.base_alpha)
    sigma = std::hypot(*sigma, other.material.base_alpha - bench.material.base_alpha);
}

// Finds the lamps in the remaining pictures; returns views with different light. `on_camera` gets the names of lamps
// that move with the camera.
std::set<LitView> find_lamps(const Session& session, std::vector<MergedView>&& merged, const Board& board,
                             Calibration& out, std::vector<std::string>& on_camera) {
  std::set<LitView> odd;
  const Sent sent(board.scratches.empty() ? Scratches{} : read_scratches(board.scratches));
  std::vector<Finding> notes;
  Bench named = out.bench;  // with its lights
  // Views without a pose have findings already.
  std::erase_if(merged, [&](const MergedView& m) {
    return std::none_of(named.views.begin(), named.views.end(), [&](const View& v) { return v.name == m.view; });
  });
  std::vector<LightView> views = make_light_views(merged, board, named, notes);
  std::vector<LightSample> samples = gather_light_samples(views, board, named, sent);
  on_camera = lamps_that_ride(views, samples, named);
  if (!on_camera.empty()) {
    for (MergedView& photo : merged)
      if (std::ranges::find(on_camera, photo.light) != on_camera.end())
        photo.light = lamp_on_camera(photo.light, photo.view);
    out.findings.push_back(
        {FindingCode::lamp_moves,
         Finding::Severity::note,
         {},
         "the lamp \"" + on_camera.front() +
             "\" rides on the camera, such as a phone's torch: each view has a lamp of its own",
         "use a lamp that does not move: photos determine it better, and boards are designed for it"});
    named = out.bench;
    notes.clear();
    views = make_light_views(merged, board, named, notes);
    samples = gather_light_samples(views, board, named, sent);
  }
  for (const LampGroup& group : photos_of_another_lamp(samples, named)) {
    std::set<std::size_t> left_out(group.light_views.begin(), group.light_views.end());
    std::set<std::string> names;
    for (const std::size_t k : left_out) {
      names.insert(merged[views[k].merged].view);
      odd.insert({merged[views[k].merged].view, group.light});
    }
    std::string list;
    for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
    const auto change = change_in_time(session, {names.begin(), names.end()});
    out.findings.push_back({FindingCode::lamp_differs,
                            Finding::Severity::warning,
                            {},
                            "the lamp \"" + group.light + "\" lights the paper in view" +
                                (names.size() > 1 ? "s " : " ") + list + " differently from the other photos (by " +
                                std::to_string(std::lround(100 * group.spread)) +
                                " % over the board): " + (names.size() > 1 ? "they are" : "it is") + " left out",
                            (change ? "the lamp was moved between " + change->photo_before + " and " +
                                          change->photo_after + ": take these photos again, or give them a light"
                                    : std::string("if the lamp was moved, give these photos a light")) +
                                " of their own in session.json (\"light\": \"" + group.light + "-2\")"});
    std::erase_if(samples, [&](const LightSample& s) { return left_out.count(s.light_view) > 0; });
    std::erase_if(named.views, [&](const View& v) { return names.count(v.name) > 0; });
    for (const std::string& name : names) named.verdict.erase(parameter::pose(name));
  }
  out.bench = with_lamps(samples, board, named, notes);
  if (const std::optional<LocalTones> tones = find_local_tones(views, samples, named)) {
    notes.push_back(told(*tones));
    count_tones(without_local_tones(views, samples, *tones, named), board, named, out.bench);
  }
  for (Finding& finding : notes) {
    if (finding.remedy.empty()) finding.remedy = "burin refine needs a lamp to start from";
    out.findings.push_back(std::move(finding));
  }
  return odd;
}

// Estimates the lamps' colors from the paper in all photos except those of another lamp.
void find_colors(const Session& session, std::span<const Bracket> brackets,
                 std::vector<std::vector<Eigen::Vector3d>>&& paper, const std::set<LitView>& odd, const Board& board,
                 Calibration& out) {
  for (std::size_t b = 0; b < brackets.size(); ++b)
    if (odd.count({brackets[b].view, brackets[b].light}) > 0) paper[b].clear();
  if (std::any_of(paper.begin(), paper.end(), [](const auto& p) { return !p.empty(); }))
    append(out.findings, check_white_balance(session));
  color_lamps(brackets, paper, board, out.bench);
}

// Puts the solved cameras, sheet and tags into the bench, with their verdicts.
void fill_geometry(const Board& board, bool fix_lens, Calibration& out) {
  const BoardSolution& solved = out.geometry;
  Bench& bench = out.bench;
  bench.lens = solved.lens;
  bench.views = solved.views;
  bench.lens_scatter = solved.lens_scatter;
  bench.bow_mm = solved.bow_mm;
  if (!solved.options.fix_bow && !board.bend) bench.bow_sigma_mm = solved.bow_sigma_mm;
  if (board.bend) {
    bench.bend_sigma = bend_sigma_of(surface_of(board, bench), solved.bow_sigma_mm.head<2>());
    settle_bend(board, bench);
  }
  bench.tags = solved.tags;
  for (Tag& tag : bench.tags) tag.size_mm += 2 * solved.edge_mm;
  bench.material = board.material;
  const Combinations judged = judge_geometry(solved, board, fix_lens, bench);
  advise_geometry(solved, board, judged, bench);
}

}  // namespace

Calibration calibrate(const Session& session, const Board& board, const CalibrateOptions& options,
                      const Progress& progress) {
  const std::string where = session.file.empty() ? "the session" : session.file.string();
  auto report = [&progress](const char* stage, double fraction) {
    if (progress) progress(stage, fraction);
  };
  if (session.photos.empty()) fail(where, "has no photos", "list them under \"photos\"");
  if (options.fix_lens && !options.lens)
    fail("the calibration's options", "ask for a fixed lens without giving one", "give a .cameramodel");
  if (board.tags.list.size() < 3)
    fail("board.json: tags.list", "has " + counted(board.tags.list.size(), "tag"),
         "list at least three, better ten around the carved area");
  std::set<std::string> views;
  for (const Photo& photo : session.photos) views.insert(photo.view);
  if (views.size() < (options.fix_lens ? 1U : 3U))
    fail(where,
         views.size() == 1
             ? "all its photos are of one view, \"" + *views.begin() + "\", which do not determine lens and poses"
             : "two views do not determine lens and poses",
         "photograph the board from at least three places, better ten, tilted in different directions");

  report("reading photos", 0);
  // Sizes first: headers are quick to read, and a person should get this error early.
  const auto [width, height] = photo_size(session);
  if (options.lens && (options.lens->width != width || options.lens->height != height))
    fail("the given camera",
         "is for pictures of " + std::to_string(options.lens->width) + " x " + std::to_string(options.lens->height) +
             " pixels, the photos have " + std::to_string(width) + " x " + std::to_string(height),
         "give the camera model of these photos");
  const std::vector<Bracket> brackets = brackets_of(session);
  Calibration out;
  std::vector<NoiseModel> noise;
  Pictures pictures = read_as_stored(session, brackets, noise, board, {width, height}, options, progress, out);
  std::vector<ViewTags> tags;
  std::set<int> foreign;
  std::size_t found = 0;
  for (std::size_t b = 0; b < brackets.size(); ++b) {
    const std::filesystem::path& file = session.photos[brackets[b].photos.front()].file;
    tags.push_back({brackets[b].view, file, std::move(pictures.tags[b].tags), std::move(pictures.tags[b].rejected)});
    found += tags.back().tags.size();
    out.photos.push_back(file.filename().string());
  }
  leave_out_blurred(tags, options.fix_lens ? 1 : 4);
  for (const ViewTags& picture : tags)
    for (const RejectedTag& r : picture.rejected) {
      if (std::none_of(board.tags.list.begin(), board.tags.list.end(), [&](const Tag& t) { return t.id == r.id; }))
        foreign.insert(r.id);
      out.rejected.push_back(r);
      out.rejected_view.push_back(picture.view);
    }
  if (found == 0) {
    // Seen, but none usable: report the reason.
    for (std::size_t i = 0; i < out.rejected.size(); ++i)
      if (!foreign.count(out.rejected[i].id))
        fail(session.photos.front().file.string(),
             "no tag can be used in any photo; in view " + out.rejected_view[i] + ", of tag " +
                 std::to_string(out.rejected[i].id) + ", " + in_words(out.rejected[i]),
             "take the photos again");
    fail_without_tags(session, brackets, noise, board, foreign);
  }

  BoardSolverOptions solver;
  solver.lens_model = options.lens_model;
  solver.lens = options.lens;
  solver.fix_lens = options.fix_lens;
  solver.check_with_mrcal = options.check_with_mrcal;
  out.geometry = solve_lenses(session, board, tags, {width, height}, solver, progress);
  const auto tell = [&out](const std::vector<Finding>& more) { append(out.findings, more); };
  tell(out.geometry.findings);
  tell(rejected_tags(tags, board, out.geometry));
  tell(unseen_tags(tags, board, out.geometry));

  out.pictures = std::move(tags);
  out.solver = solver;
  out.tool_width_um = board.tool_width_um;
  fill_geometry(board, options.fix_lens, out);

  if (options.find_lamps) {
    report("looking for the lamp", 0);
    std::vector<std::string> on_camera;
    const std::set<LitView> odd = find_lamps(session, std::move(pictures.merged), board, out, on_camera);
    std::vector<Bracket> lit = brackets;
    for (Bracket& bracket : lit)
      if (std::ranges::find(on_camera, bracket.light) != on_camera.end())
        bracket.light = lamp_on_camera(bracket.light, bracket.view);
    find_colors(session, lit, std::move(pictures.paper_light), odd, board, out);
    report("looking for the lamp", 1);
  }
  return out;
}

std::string residual_table(const Calibration& c) {
  auto word = [](const std::string& text) {
    std::string out;
    for (const char ch : text) out += ch == ' ' ? "%20" : ch == '\t' ? "%09" : std::string(1, ch);
    return out.empty() ? "-" : out;
  };
  std::string out = "# view tag corner x_px y_px dx_px dy_px sigma_px used photo\n";
  for (const SolvedCorner& r : c.geometry.corners) {
    const bool known = r.residual_px.allFinite();
    const Eigen::Vector2d left_px = known ? r.residual_px : Eigen::Vector2d(0, 0);
    for (const std::string& field :
         {word(r.view), std::to_string(r.tag), std::to_string(r.corner), fixed(r.q_px.x(), 4), fixed(r.q_px.y(), 4),
          fixed(left_px.x(), 5), fixed(left_px.y(), 5), fixed(r.sigma_px, 5), std::string(r.used && known ? "1" : "0")})
      out += field + " ";
    out += word(c.photos[r.picture]) + "\n";
  }
  return out;
}

void write_calibration(const Calibration& c, const std::filesystem::path& folder) {
  make_output_folder(folder);
  FilesTogether all;
  write_text(residual_table(c), folder / "residuals.vnl");
  Bench bench = c.bench;
  bench.camera = folder / "camera.cameramodel";
  write_bench(bench, c.tool_width_um, folder / "bench.json");
  all.put();
}

}  // namespace burin

#include "calib/calibrate.h"

#include <algorithm>
#include <cstdio>
#include <set>

#include "calib/identifiability.h"
#include "calib/lamp.h"
#include "calib/next_photo.h"
#include "capture/photo.h"
#include "render/error.h"
#include "render/json_file.h"
#include "render/scratches.h"

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

// Why no view has a tag of the board's: another family, other ids, or nothing at all.
[[noreturn]] void fail_without_tags(const std::vector<MergedView>& merged,
                                    const std::vector<std::filesystem::path>& files, const Board& board,
                                    const std::set<int>& foreign_ids) {
  const std::string& family = board.tags.family;
  if (!foreign_ids.empty()) {
    std::set<int> listed;
    for (const Tag& tag : board.tags.list) listed.insert(tag.id);
    fail(files.front().string(),
         "the photos show tags " + list_of(foreign_ids) + " of family " + family + ", board.json lists " +
             list_of(listed),
         "give the board.json of this board, or correct the ids in its tags.list");
  }
  const std::size_t step = std::max<std::size_t>(1, merged.size() / 3);
  for (std::size_t i = 0; i < merged.size(); i += step) {
    const std::string instead = explain_missing_tags(merged[i].value, merged[i].valid, family);
    if (!instead.empty())
      fail(files[i].string(),
           std::string("no tag of family ").append(family).append(" was found in any photo; ").append(instead),
           "set tags.family in board.json to the family on the board, and give the photos as the camera wrote them");
  }
  fail(files.front().string(), "no tags were found in any of the " + std::to_string(merged.size()) + " views",
       "photograph the whole board, sharp, its tags at least 20 pixels wide and their paper not clipped");
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
    fail("board.json: tags.list", "has " + std::to_string(board.tags.list.size()) + " tags",
         "list at least three, better ten around the carved area");
  std::set<std::string> views;
  for (const Photo& photo : session.photos) views.insert(photo.view);
  if (views.size() < (options.fix_lens ? 1U : 3U))
    fail(where,
         views.size() == 1
             ? "all its photos are of one view, \"" + *views.begin() + "\", which cannot tell lens and poses"
             : "two views cannot tell lens and poses",
         "photograph the board from at least three places, better ten, tilted in different directions");

  report("reading photos", 0);
  const std::vector<Bracket> brackets = brackets_of(session);
  const std::vector<MergedView> merged = merge_session(session);
  std::vector<std::filesystem::path> files;
  files.reserve(brackets.size());
  for (const Bracket& b : brackets) files.push_back(session.photos[b.photos.front()].file);
  const int width = merged.front().value.width, height = merged.front().value.height;
  if (options.lens && (options.lens->width != width || options.lens->height != height))
    fail("the given camera",
         "is for pictures of " + std::to_string(options.lens->width) + " x " + std::to_string(options.lens->height) +
             " pixels, the photos have " + std::to_string(width) + " x " + std::to_string(height),
         "give the camera model of these photos");

  Calibration out;
  TagDetector detector(board.tags.family);
  std::vector<int> ids;
  for (const Tag& tag : board.tags.list) ids.push_back(tag.id);
  std::vector<ViewTags> pictures;
  std::set<int> foreign;
  std::size_t found = 0;
  for (std::size_t i = 0; i < merged.size(); ++i) {
    report("finding tags", static_cast<double>(i) / static_cast<double>(merged.size()));
    TagsInPhoto tags = detector.detect(merged[i].value, merged[i].valid, ids);
    found += tags.tags.size();
    for (const RejectedTag& r : tags.rejected) {
      if (std::find(ids.begin(), ids.end(), r.id) == ids.end()) foreign.insert(r.id);
      out.rejected.push_back(r);
      out.rejected_view.push_back(merged[i].view);
    }
    pictures.push_back({merged[i].view, files[i], std::move(tags.tags), std::move(tags.rejected)});
    out.photos.push_back(files[i].filename().string());
  }
  if (found == 0) {
    // Seen, but none usable: say what is wrong with them.
    for (std::size_t i = 0; i < out.rejected.size(); ++i)
      if (!foreign.count(out.rejected[i].id))
        fail(files.front().string(),
             "no tag can be used in any photo; in view " + out.rejected_view[i] + ", of tag " +
                 std::to_string(out.rejected[i].id) + ", " + out.rejected[i].reason,
             "take the photos again");
    fail_without_tags(merged, files, board, foreign);
  }
  for (std::size_t i = 0; i < out.rejected.size(); ++i)
    out.findings.push_back(
        {Finding::Severity::note,
         {},
         "tag " + std::to_string(out.rejected[i].id) + " is not used in view " + out.rejected_view[i],
         out.rejected[i].reason});
  report("finding tags", 1);

  BoardSolverOptions solver;
  solver.lens_model = options.lens_model;
  solver.lens = options.lens;
  solver.fix_lens = options.fix_lens;
  solver.check_with_mrcal = options.check_with_mrcal;
  out.geometry = solve_board(board, pictures, width, height, solver, progress);
  out.findings.insert(out.findings.end(), out.geometry.findings.begin(), out.geometry.findings.end());

  out.pictures = std::move(pictures);
  out.solver = solver;
  out.tool_width_um = board.tool_width_um;
  out.bench.lens = out.geometry.lens;
  out.bench.views = out.geometry.views;
  out.bench.bow_mm = out.geometry.bow_mm;
  out.bench.tags = out.geometry.tags;
  for (Tag& tag : out.bench.tags) tag.size_mm += 2 * out.geometry.edge_mm;
  out.bench.material = board.material;
  const Combinations judged = judge_geometry(out.geometry, board, options.fix_lens, out.bench);
  advise_geometry(out.geometry, board, judged, out.bench);

  if (options.find_lamps) {
    report("looking for the lamp", 0);
    const Scratches designed = board.scratches.empty() ? Scratches{} : read_scratches(board.scratches);
    std::vector<std::string> notes;
    out.bench = with_lamps(merged, board, designed, out.bench, notes);
    for (const std::string& n : notes)
      out.findings.push_back({Finding::Severity::warning, {}, n, "burin refine needs a lamp to start from"});
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
  char line[200];
  for (const SolvedCorner& r : c.geometry.corners) {
    const bool known = r.residual_px.allFinite();
    std::snprintf(line, sizeof line, " %d %d %.4f %.4f %.5f %.5f %.5f %d ", r.tag, r.corner, r.q_px.x(), r.q_px.y(),
                  known ? r.residual_px.x() : 0, known ? r.residual_px.y() : 0, r.sigma_px, r.used && known ? 1 : 0);
    out += word(r.view) + line + word(c.photos[r.picture]) + "\n";
  }
  return out;
}

void write_calibration(const Calibration& c, const std::filesystem::path& folder) {
  make_output_folder(folder);
  write_text(residual_table(c), folder / "residuals.vnl");
  Bench bench = c.bench;
  bench.camera = folder / "camera.cameramodel";
  write_bench(bench, c.tool_width_um, folder / "bench.json");
}

}  // namespace burin

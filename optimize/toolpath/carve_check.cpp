#include "burin/optimize/toolpath/carve_check.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/base/files/json_file.h"
#include "burin/optimize/design/glint.h"
#include "burin/optimize/design/to_metal.h"
#include "burin/optimize/toolpath/ends.h"
#include "burin/optimize/toolpath/release_check.h"
#include "burin/optimize/toolpath/sheet.h"
#include "burin/optimize/toolpath/toolpath_check.h"
#include "burin/scene/carve.h"
#include "burin/scene/groove.h"
#include "burin/scene/keep_out.h"
#include "burin/scene/parameter_name.h"

namespace burin {
namespace {

using Severity = Finding::Severity;

constexpr double kRounding_mm = 2e-3;  // files are rounded; a smaller violation of a rule is invisible

void add(CarveCheck& check, FindingCode code, Severity severity, std::string what, std::string remedy) {
  check.findings.push_back({code, severity, {}, std::move(what), std::move(remedy)});
}

// State of one check.
struct Work {
  const CarveCheckInput& input;
  Bench bench;    ///< as given, or one without measurements
  Toolpath told;  ///< the files' own tool path
  std::vector<ReplayedScratch> replayed;
};

Work begin(const CarveCheckInput& input) {
  Work work{input, {}, {}, {}};
  if (input.bench)
    work.bench = *input.bench;
  else
    work.bench.material = input.board.material;
  work.told.workpiece = workpiece_of(input.board, input.bench ? &*input.bench : nullptr);
  work.told.face = face_to_follow(input.board, work.bench, input.heights, input.follow_bow);
  return work;
}

// Replays every file as the machine would. A file without a valid replay is an error.
void replay_files(Work& work, CarveCheck& check) {
  check.tool_min_mm.setConstant(std::numeric_limits<double>::infinity());
  check.tool_max_mm = -check.tool_min_mm;
  for (const std::filesystem::path& file : work.input.files) {
    CheckedFile done{file};
    try {
      const ReleasedFile released =
          check_release(read_text(file), work.input.machine, work.told.workpiece, work.told.face, file.string());
      const Replay& replay = released.replay;
      append(check.findings, released.faults);
      fail_unless_ended(replay, work.input.machine, file.string());
      done.scratches = replay.scratches.size();
      done.lines = replay.lines;
      done.duration_s = replay.duration_s;
      done.min_mm = replay.min_mm.head<2>(), done.max_mm = replay.max_mm.head<2>();
      work.replayed.insert(work.replayed.end(), replay.scratches.begin(), replay.scratches.end());
      for (const ReplayedScratch& s : replay.scratches)
        work.told.scratches.push_back(
            {static_cast<std::uint32_t>(work.told.scratches.size()), s.from_mm, s.to_mm,
             std::isnan(s.depth_mm) ? 1e-3 * work.input.board.material.depth_um : s.depth_mm});
      for (int axis = 0; axis < 3; ++axis) {
        check.tool_min_mm[axis] = std::fmin(check.tool_min_mm[axis], replay.min_mm[axis]);
        check.tool_max_mm[axis] = std::fmax(check.tool_max_mm[axis], replay.max_mm[axis]);
      }
      check.carve_mm += replay.carve_mm;
      check.travel_mm += replay.travel_mm;
      if (done.scratches > 0) check.duration_s += replay.duration_s;
    } catch (const Error& error) {
      add(check, FindingCode::gcode_unsafe, Severity::error, error.what(), "");
    }
    check.files.push_back(std::move(done));
  }
}

// Throws Error if the files are not the tool path of these scratches.
void fail_unless_carved(const Work& work, const Scratches& scratches) {
  const CarveCheckInput& input = work.input;
  ToolpathOptions options;
  options.keep_order = true;
  options.heights = input.heights;
  options.follow_bow = input.follow_bow;
  constexpr double kTolerance_mm = 1e-3;
  const double depths = depth_share(work.told.face);
  const auto planned_for = [&](const Scratches& told) {
    return plan_toolpath(told, input.board, input.bench ? &*input.bench : nullptr, input.machine, options).scratches;
  };
  std::vector<PlannedScratch> planned = planned_for(scratches);
  if (input.bench && !input.bench->machine_errors.none()) {
    // A reversed scratch has another command: backlash acts from the other side.
    Scratches backwards = scratches;
    std::swap(backwards.x0_mm, backwards.x1_mm);
    std::swap(backwards.y0_mm, backwards.y1_mm);
    const std::vector<PlannedScratch> other_way = planned_for(backwards);
    const std::vector<std::ptrdiff_t> as_given = find_planned(work.replayed, planned, kTolerance_mm, depths),
                                      turned = find_planned(work.replayed, other_way, kTolerance_mm, depths);
    for (std::size_t k = 0; k < as_given.size(); ++k)
      if (as_given[k] < 0 && turned[k] >= 0) planned[turned[k]] = other_way[turned[k]];
  }
  fail_unless_good(check_toolpath(work.replayed, planned, kTolerance_mm, depths), "the files against the scratches");
}

// True if the files are the tool path of the scratches within the machine's limits (burin toolpath --mend).
bool carved_mended(const Work& work, CarveCheck& check) {
  const CarveCheckInput& input = work.input;
  const CarvingLimits limits = toolpath_limits(input.board, input.bench ? &*input.bench : nullptr, input.machine);
  fail_if_crowded(*input.scratches, limits);
  const Mended mended = mend(*input.scratches, limits);
  const std::size_t lost = input.scratches->size() - mended.rows.size();
  try {
    fail_unless_carved(work, mended.scratches);
  } catch (const Error&) {
    return false;
  }
  add(check, FindingCode::scratches_changed, Severity::warning,
      "the files carve the scratches as the machine's limits let them: " + std::to_string(lost) + " are left out" +
          (lost > 0 ? " (" + dropped_text(mended.dropped) + ")" : "") + ", the others moved by up to " +
          fixed(mended.moved_mm, 4) + " mm",
      "a design made with --machine loses less");
  return true;
}

// Compares the files with the table behind them.
void compare_with_design(const Work& work, CarveCheck& check) {
  const CarveCheckInput& input = work.input;
  if (!input.scratches) return;
  for (std::size_t i = 0; i < input.scratches->size(); ++i)
    check.already_carved += input.scratches->is_carved(i) ? 1 : 0;
  try {
    fail_unless_carved(work, *input.scratches);
  } catch (const Error& error) {
    if (!carved_mended(work, check)) add(check, FindingCode::gcode_unsafe, Severity::error, error.what(), "");
  }
}

// Carves the strokes: places, depths and roughnesses by the bench.
void carve_them(const Work& work, CarveCheck& check) {
  Scratches sent;
  for (const PlannedScratch& s : work.told.scratches) {
    sent.x0_mm.push_back(s.from_mm.x()), sent.y0_mm.push_back(s.from_mm.y());
    sent.x1_mm.push_back(s.to_mm.x()), sent.y1_mm.push_back(s.to_mm.y());
    sent.depth_um.push_back(1e3 * s.depth_mm);
  }
  Bench bench = work.bench;
  bench.crossings = Crossings::add;  // whole grooves, one row each
  // An unmeasured depth is the commanded one.
  if (!depth_is_measured(bench)) bench.material.depth_um = work.input.board.material.depth_um;
  check.carved = carve(Sent(std::move(sent)), bench, work.input.board).scratches;
  const DepthRange told = depth_range(work.told);
  check.least_depth_um = 1e3 * told.least_mm;
  check.most_depth_um = 1e3 * told.most_mm;
  const auto [least, most] = std::minmax_element(check.carved.depth_um.begin(), check.carved.depth_um.end());
  check.least_made_um = *least, check.most_made_um = *most;
}

// Remedy: a deeper design, if the machine has a command for it.
std::string deeper(const Work& work, const CarveCheck& check, double lean) {
  const Board& board = work.input.board;
  const DepthTable& table = work.input.machine.depth_table;
  const double depth_um = std::ceil(10 * depth_for_lean_um(lean, board.tool_width_um)) / 10;
  const double gain = check.least_made_um / check.least_depth_um;
  const bool by_table = work.input.machine.depth_by != DepthBy::fixed_z && !table.rows.empty();
  const std::string closer = "bring lamp and eye closer to the mirror direction";
  if (by_table && depth_um / gain > table.rows.back().depth_um)
    return closer + ": " + fixed(depth_um, 1) + " um with this cutter would do, too (now " +
           fixed(check.least_made_um, 1) + " um), but the depth table of " + work.input.machine.name +
           " ends at what makes " + fixed(table.rows.back().depth_um * gain, 1) + " um";
  return "design it " + fixed(depth_um, 1) + " um deep with this cutter (now " + fixed(check.least_made_um, 1) +
         " um): --depth " + fixed(depth_um, 1) + " of burin loop or burin design; or " + closer;
}

// One error for all strokes that break a rule.
struct Broken {
  std::size_t count = 0, first = 0;
};

void add_broken(CarveCheck& check, const Broken& broken, const std::string& what, const std::string& remedy) {
  if (broken.count == 0) return;
  const Ends e = ends_of(check.carved, broken.first);
  add(check, FindingCode::gcode_differs, Severity::error,
      counted(broken.count, "scratch") + " " + what + ", the first from (" + fixed(e.a.x(), 2) + ", " +
          fixed(e.a.y(), 2) + ") to (" + fixed(e.b.x(), 2) + ", " + fixed(e.b.y(), 2) + ") mm",
      remedy);
}

// Finds grooves outside of the sheet or the carve area, or over tags and keep-outs, at their whole width.
void judge_places(const Work& work, CarveCheck& check) {
  const Board& board = work.input.board;
  std::vector<KeepOut> places = board.keep_out;
  for (const Tag& tag : work.bench.tags.empty() ? board.tags.list : work.bench.tags)
    places.push_back(tag_paper(tag, board.tags.family));
  Broken off_sheet, out_of_area;
  std::map<std::string, Broken> over;
  const auto count = [&](Broken& broken, std::size_t i) {
    if (broken.count++ == 0) broken.first = i;
    if (check.faulty.empty() || check.faulty.back() != i) check.faulty.push_back(i);
  };
  for (std::size_t i = 0; i < check.carved.size(); ++i) {
    const Ends e = ends_of(check.carved, i);
    const double half_mm = 1e-3 * half_width_um(board.tool_width_um, check.carved.depth_um[i]);
    const auto within = [&](const Eigen::Vector2d& low, const Eigen::Vector2d& high, double edge_mm) {
      return (e.a.cwiseMin(e.b).array() >= low.array() + edge_mm - kRounding_mm).all() &&
             (e.a.cwiseMax(e.b).array() <= high.array() - edge_mm + kRounding_mm).all();
    };
    if (!within({0, 0}, board.size_mm, half_mm))
      count(off_sheet, i);
    else if (!within(board.carve_min_mm, board.carve_max_mm, 0))
      count(out_of_area, i);
    for (const KeepOut& place : places) {
      const auto free = free_parts(e.a, e.b, std::span(&place, 1), std::max(0.0, half_mm - kRounding_mm));
      if (free.size() != 1 || free[0] != LinePart{0, 1}) count(over[place.name.empty() ? "a keep-out" : place.name], i);
    }
  }
  add_broken(check, off_sheet, "would run off the sheet", "make the tool path again, and look where work zero is");
  add_broken(check, out_of_area, "would leave the carve area",
             "make the tool path again from scratches within carve_mm");
  for (const auto& [name, broken] : over)
    add_broken(check, broken, "would be carved over " + name,
               "design again with these tags and keep-outs in board.json, or leave these scratches out (--mend)");
}

// Checks the frame, the path around all scratches in the air: it must exist, and enclose these scratches.
void judge_frame(const Work& work, CarveCheck& check) {
  const auto frame = std::find_if(check.files.begin(), check.files.end(),
                                  [](const CheckedFile& f) { return f.scratches == 0 && f.lines > 0; });
  if (frame == check.files.end()) {
    add(check, FindingCode::frame, Severity::note, "there is no frame to run in the air first",
        "burin toolpath --frame writes one");
    return;
  }
  Eigen::Vector2d low = work.told.scratches[0].from_mm, high = low;
  for (const PlannedScratch& s : work.told.scratches) {
    low = low.cwiseMin(s.from_mm).cwiseMin(s.to_mm);
    high = high.cwiseMax(s.from_mm).cwiseMax(s.to_mm);
  }
  if (!((frame->min_mm - low).cwiseAbs().maxCoeff() < 1 && (frame->max_mm - high).cwiseAbs().maxCoeff() < 1))
    check.findings.push_back({FindingCode::frame, Severity::warning, frame->file,
                              "goes round another job than these files carve",
                              "make the frame again (burin toolpath --frame)"});
}

// Finds scratches beyond the cutoff: each belongs to the view with its largest glint, and its wall must be steep enough
// for that view.
void judge_glints(const Work& work, CarveCheck& check) {
  if (!work.input.design || check.carved.size() == 0) return;
  std::vector<GlintView> views;
  for (const DesignView& v : work.input.design->views) {
    views.push_back(glint_of(v, work.bench));
    check.views.push_back({v.view, v.light});
  }
  std::vector<std::size_t> dark(views.size(), 0);
  std::vector<double> most_lean(views.size(), 0);
  for (std::size_t i = 0; i < check.carved.size(); ++i) {
    const Ends e = ends_of(check.carved, i);
    const Eigen::Vector2d middle = (e.a + e.b) / 2, along = e.b - e.a;
    const double direction = std::atan2(along.y(), along.x());
    const double alpha = check.carved.alpha.empty() ? work.bench.material.alpha : check.carved.alpha[i];
    std::size_t best = 0;
    double best_light = -1, best_lean = 0;
    for (std::size_t k = 0; k < views.size(); ++k) {
      const Lean lean = lean_at(views[k], {middle.x(), middle.y(), 0});
      const double turn = std::abs(std::remainder(direction - lean.scratch_direction(), std::numbers::pi));
      const double light = lobe(lean.angle, turn, alpha);
      if (light > best_light) best = k, best_light = light, best_lean = lean.angle;
    }
    const double steepest = 2 * std::atan(groove_rim(work.input.board.tool_width_um, check.carved.depth_um[i]));
    ++check.views[best].scratches;
    dark[best] += reach(best_lean, steepest, alpha) < 0.5 ? 1 : 0;
    most_lean[best] = std::max(most_lean[best], best_lean);
  }
  constexpr double kSpoiled = 0.5, kNoticed = 0.05;
  for (std::size_t k = 0; k < views.size(); ++k) {
    ViewReach& view = check.views[k];
    if (view.scratches == 0) continue;
    view.dark = static_cast<double>(dark[k]) / static_cast<double>(view.scratches);
    if (view.dark < kNoticed) continue;
    add(check, FindingCode::lamp_angle, view.dark > kSpoiled ? Severity::error : Severity::warning,
        "view " + view.view + ": " + fixed(100 * view.dark, 0) + " % of its " + counted(view.scratches, "scratch") +
            " lie beyond the cut-off: their walls are not steep enough to glint there",
        deeper(work, check, most_lean[k]));
  }
}

// Without a measured crossing rule, pictures may rely on light that a tool cuts away.
void judge_crossings(const Work& work, CarveCheck& check) {
  constexpr double kCrowded = 0.3;  // below, a groove crosses few others
  if (work.bench.crossings != Crossings::add || depth_is_measured(work.bench)) return;
  const Board& board = work.input.board;
  const double covered = area_mm2(check.carved, work.bench, board) / (board.carve_max_mm - board.carve_min_mm).prod();
  if (covered < kCrowded) return;
  add(check, FindingCode::crossings_ignored, Severity::warning,
      "grooves would cover the carve area " + fixed(covered, 1) +
          " times, and the pictures count on the light of both where two cross; a tool that cuts leaves only the lower "
          "of the two, and such a board shows several dB less than it promises",
      "write \"material\": {\"crossings\": \"deepest\"} into bench.json and design again; or carve, and photograph the "
      "board");
}

}  // namespace

CarveCheck check_carve(const CarveCheckInput& input) {
  if (input.files.empty()) fail("carve check", "there is no G-code to look at", "make it first (burin toolpath)");
  CarveCheck check;
  Work work = begin(input);
  replay_files(work, check);
  if (work.told.scratches.empty()) {
    if (check.good())
      add(check, FindingCode::gcode_differs, Severity::error, "these files carve nothing",
          "give the files with the scratches");
    return check;
  }
  compare_with_design(work, check);
  carve_them(work, check);
  judge_places(work, check);
  judge_frame(work, check);
  append(check.findings, reach_findings(input.machine));
  append(check.findings, sheet_findings(work.told, input.board, input.bench ? &*input.bench : nullptr, input.machine));
  judge_glints(work, check);
  judge_crossings(work, check);
  std::stable_sort(check.findings.begin(), check.findings.end(),
                   [](const Finding& a, const Finding& b) { return a.severity > b.severity; });
  return check;
}

}  // namespace burin

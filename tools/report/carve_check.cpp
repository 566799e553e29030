#include "tools/report/carve_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/base/files/json_file.h"
#include "burin/base/files/svg.h"
#include "burin/base/image.h"
#include "burin/optimize/duration.h"
#include "burin/optimize/toolpath.h"
#include "burin/scene/bench_of_board.h"
#include "tools/picture_quality.h"
#include "tools/project_settings.h"
#include "tools/report/html.h"
#include "tools/report/pictures.h"
#include "tools/report/section.h"

namespace burin {
namespace {

namespace fs = std::filesystem;
using Severity = Finding::Severity;

constexpr int kCarvePictureSidePx = 360;

std::size_t count_of(const CarveCheck& check, Severity severity) {
  return static_cast<std::size_t>(std::count_if(check.findings.begin(), check.findings.end(),
                                                [&](const Finding& f) { return f.severity == severity; }));
}

// Describes a file: its part of the job, the frame, or an invalid file.
std::string file_text(const CheckedFile& file) {
  if (file.lines == 0) return "cannot be followed";
  if (file.scratches == 0) return "carves nothing: the frame, to be run first, in the air";
  return counted(file.scratches, "scratch") + ", " + duration_text(file.duration_s);
}

std::string range_text(double least_um, double most_um) {
  if (most_um - least_um < 0.05) return fmt::format("{:.1f} µm", most_um);
  return fmt::format("{:.1f} to {:.1f} µm", least_um, most_um);
}

// Depth of the finished grooves.
std::string depth_text(const CarveCheck& check) { return range_text(check.least_made_um, check.most_made_um); }

// Commanded depth, if it differs.
std::string told_text(const CarveCheck& check) {
  const std::string told = range_text(check.least_depth_um, check.most_depth_um);
  return told == depth_text(check) ? "" : fmt::format(" (commanded: {})", told);
}

// Table of the tool's path.
std::string tool_table(const CarveCheck& check, const MachineProfile& machine) {
  Table t;
  t.header = {"the tool", html(machine.name)};
  const auto range = [&](int axis, int decimals) {
    return fmt::format("{:.{}f} to {:.{}f} mm", check.tool_min_mm[axis], decimals, check.tool_max_mm[axis], decimals);
  };
  t.rows.push_back({"X", range(0, 2)});
  t.rows.push_back({"Y", range(1, 2)});
  t.rows.push_back({"Z", range(2, 4)});
  t.rows.push_back({"depth", depth_text(check) + told_text(check) + ", by " + depth_by_name(machine.depth_by)});
  t.rows.push_back({"scratches", fmt::format("{}, {:.1f} m in the metal, {:.1f} m in the air", check.carved.size(),
                                             check.carve_mm / 1000, check.travel_mm / 1000)});
  if (check.already_carved > 0)
    t.rows.push_back({"in the metal", counted(check.already_carved, "scratch") + " carved already"});
  t.rows.push_back({"time", html(duration_text(check.duration_s))});
  return table(t);
}

std::string files_table(const CarveCheck& check) {
  Table t;
  t.header = {"file", "lines", "what"};
  for (const CheckedFile& f : check.files)
    t.rows.push_back({html(f.file.filename().string()), std::to_string(f.lines), html(file_text(f))});
  return table(t);
}

// Draws the sheet: tags, keep-outs, carve area, scratches (forbidden ones in red), and work zero.
std::string sheet_drawing(const CarveCheck& check, const Board& board) {
  constexpr double kWidth = 720;
  constexpr std::size_t kMostDrawn = 6000;
  const double scale = kWidth / board.size_mm.x();
  const auto at = [&](const Eigen::Vector2d& p) -> Eigen::Vector2d {
    return {p.x() * scale, (board.size_mm.y() - p.y()) * scale};
  };
  const auto polygon = [&](std::vector<Eigen::Vector2d> points, std::string_view attributes) {
    for (Eigen::Vector2d& p : points) p = at(p);
    return svg_polygon(points, attributes);
  };
  const auto box = [](const Eigen::Vector2d& low, const Eigen::Vector2d& high) -> std::vector<Eigen::Vector2d> {
    return {low, {high.x(), low.y()}, high, {low.x(), high.y()}};
  };
  std::string out = polygon(box({0, 0}, board.size_mm), "fill=\"#eef0f2\" stroke=\"#5b6570\"");
  out +=
      polygon(box(board.carve_min_mm, board.carve_max_mm), "fill=\"#fff\" stroke=\"#9aa4ae\" stroke-dasharray=\"5 4\"");
  for (const Tag& tag : board.tags.list)
    out += polygon(tag_paper(tag, board.tags.family).polygon_mm, "fill=\"#c9ced4\" stroke=\"none\"");
  for (const KeepOut& place : board.keep_out)
    out += place.polygon_mm.empty()
               ? fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\" fill=\"#c9ced4\"/>\n",
                             at(place.center_mm).x(), at(place.center_mm).y(), place.radius_mm * scale)
               : polygon(place.polygon_mm, "fill=\"#c9ced4\" stroke=\"none\"");
  const Scratches& s = check.carved;
  const std::size_t every = s.size() / kMostDrawn + 1;
  const auto scratch = [&](std::size_t i, std::string_view attributes) {
    return svg_line(at({s.x0_mm[i], s.y0_mm[i]}), at({s.x1_mm[i], s.y1_mm[i]}), attributes);
  };
  for (std::size_t i = 0; i < s.size(); i += every) out += scratch(i, "stroke=\"#8a4b12\" stroke-width=\"0.4\"");
  for (std::size_t k = 0; k < std::min(check.faulty.size(), kMostDrawn); ++k)
    out += scratch(check.faulty[k], "stroke=\"#d1190d\" stroke-width=\"2.5\"");
  out += fmt::format(
      "<circle cx=\"{0:.1f}\" cy=\"{1:.1f}\" r=\"5\" fill=\"none\" stroke=\"#1f5f8b\" "
      "stroke-width=\"2\"/>\n",
      at({0, 0}).x() + 6, at({0, 0}).y() - 6);
  return "<div class=\"sheet\">" +
         svg_drawing(
             {kWidth, board.size_mm.y() * scale},
             fmt::format("role=\"img\" aria-label=\"The sheet, {:.0f} by {:.0f} mm, with its tags, its carve area "
                         "and {}{}\"",
                         board.size_mm.x(), board.size_mm.y(), grouped(static_cast<long long>(s.size()), "scratch"),
                         check.faulty.empty() ? "" : ", in red those that must not be carved"),
             out) +
         fmt::format(
             "</div>\n<p class=\"soft\">The sheet, {:.0f} x {:.0f} mm, lower left corner (work zero) ringed in blue; "
             "gray: "
             "tags and keep-outs; dashed: the carve area{}{}.</p>\n",
             board.size_mm.x(), board.size_mm.y(), every > 1 ? fmt::format("; one scratch in {} is drawn", every) : "",
             check.faulty.empty() ? "" : "; red: must not be carved");
}

// Predicted pictures from the design's own report. Empty without one.
struct Promise {
  std::string pictures;  ///< HTML
  std::vector<Finding> findings;
};

Promise promise_of(const fs::path& folder) {
  Promise out;
  const fs::path file = folder / "design-report.json";
  if (folder.empty() || !fs::exists(file)) return out;
  const Json json = read_json(file, "burin/design-report", 1);
  JsonObject report(json, file.string());
  std::string all;
  const DesignQuality quality = quality_of_design(report, file);
  std::size_t k = 0;
  for (JsonObject& view : report.objects("views")) {
    const std::string name = view.text("view"), promised = quality.in_decibels(k), looks = quality.in_words(k);
    const Likeness likeness = quality.likeness[k++];
    const double allows = view.number("achievable_psnr_db");
    std::string more = "; " + looks + ".";
    if (view.has("tolerance")) more += " " + html(view.object("tolerance").text("text")) + ".";
    const std::vector<Figure> figures{
        {picture_within(folder / view.text("target"), kCarvePictureSidePx), "View " + name + ": the target",
         "<b>Target</b>", "Target"},
        {picture_within(folder / view.text("preview"), kCarvePictureSidePx),
         fmt::format("View {}, as promised: {}", name, promised + ", " + looks),
         fmt::format("<b>As promised</b> {}<span class=\"more\">{}</span>", unbroken(promised), more), "As promised"}};
    all += compared("View " + name, figures, 0, 1);
    if (is_unlike(likeness))
      out.findings.push_back({FindingCode::view_limit,
                              Severity::warning,
                              {},
                              fmt::format("view {}: few would recognize it: its correlation with its picture is {:.2f} "
                                          "(1: alike), with another's {:.2f}",
                                          name, likeness.own, likeness.other),
                              "do not carve it like this: give the board fewer pictures or more room, or this picture "
                              "more contrast"});
    if (allows < kRecognizable_db)
      out.findings.push_back({FindingCode::view_limit,
                              Severity::warning,
                              {},
                              fmt::format("view {}: the plain face's own light allows {:.1f} dB only, which is hard to "
                                          "recognize",
                                          view.text("view"), allows),
                              "move its lamp or eye farther from the mirror direction, or polish the face less"});
  }
  out.pictures = compared_in_lockstep("carve area", all);
  if (report.has("dropped_by_limits"))
    for (const auto& [rule, count] : report.raw("dropped_by_limits").items())
      if (count.is_number() && count.get<double>() > 0)
        out.findings.push_back(
            {FindingCode::scratches_changed,
             Severity::note,
             {},
             fmt::format("{} left out of the design: {}", grouped(std::llround(count.get<double>()), "scratch"), rule),
             ""});
  if (report.has("stopped_early") && report.boolean("stopped_early"))
    out.findings.push_back(
        {FindingCode::start_cut_short, Severity::warning, {}, "the design was stopped before it was finished", ""});
  append(out.findings, design_findings(report));
  return out;
}

std::string outcome_of(const CarveCheck& check, std::size_t warnings) {
  const std::size_t errors = count_of(check, Severity::error);
  if (errors > 0)
    return fmt::format("<span class=\"error\">Do not carve this: {} would spoil the board.</span>",
                       counted(errors, "error"));
  return fmt::format("<span class=\"good\">No error.</span> {}, {}, {}{}.",
                     grouped(static_cast<long long>(check.carved.size()), "scratch"), depth_text(check) + " deep",
                     html(duration_text(check.duration_s)), warnings > 0 ? "; " + counted(warnings, "warning") : "");
}

}  // namespace

CarveCheckFiles round_files(const fs::path& round, const std::string& machine) {
  CarveCheckFiles files;
  files.machine = machine;
  files.design = round / "design.json";
  files.scratches = round / "scratches.csv";
  if (!fs::is_directory(round) || !fs::exists(files.design) || !fs::exists(files.scratches))
    fail(round.string(), "is no round of a loop that is designed: it lacks design.json or scratches.csv",
         "name a round's folder, or a scratches.csv with --board and --gcode");
  const DesignSpec spec = read_design(files.design);
  files.board = spec.board;
  files.bench = spec.bench;
  files.folder = round / "design";
  if (fs::exists(round / "heights.json")) files.heights = round / "heights.json";
  for (const auto& entry : fs::directory_iterator(round)) {
    const fs::path& file = entry.path();
    if (file.filename().string().starts_with("board") && has_gcode_name(file)) files.gcode.push_back(file);
  }
  std::sort(files.gcode.begin(), files.gcode.end());
  return files;
}

CheckedCarving check_carve_files(const CarveCheckFiles& files) {
  const MachineProfile machine = machine_in_project(files.machine, files.scratches);
  CarveCheckInput input{files.gcode, machine, read_board(files.board)};
  if (!files.bench.empty()) input.bench = read_bench_of(input.board, files.board, files.bench);
  if (!files.scratches.empty()) input.scratches = read_scratches(files.scratches);
  if (!files.design.empty() && input.bench) input.design = read_design(files.design);
  if (!files.heights.empty()) input.heights = read_heights(files.heights);
  input.follow_bow = files.follow_bow;
  CarveCheck check = check_carve(input);
  Promise promise = promise_of(files.folder);
  append(check.findings, promise.findings);
  append(check.findings, files.outdated);
  std::stable_sort(check.findings.begin(), check.findings.end(),
                   [](const Finding& a, const Finding& b) { return a.severity > b.severity; });
  return {std::move(check), machine, std::move(promise.pictures)};
}

std::vector<std::string> unreadable_views(const fs::path& folder) {
  std::vector<std::string> out;
  const fs::path file = folder / "design-report.json";
  if (!fs::exists(file)) return out;
  const Json json = read_json(file, "burin/design-report", 1);
  JsonObject report(json, file.string());
  const DesignQuality quality = quality_of_design(report, file);
  std::size_t k = 0;
  for (JsonObject& view : report.objects("views"))
    if (is_unlike(quality.likeness[k++])) out.push_back(view.text("view"));
  return out;
}

std::string carve_check_text(const CarveCheck& check) {
  std::string text;
  for (const Finding& f : check.findings)
    if (f.severity != Severity::note) text += fmt::format("{}: {}\n", in_words(f.severity), sentence(f));
  if (const std::size_t notes = count_of(check, Severity::note); notes > 0)
    text += fmt::format("note: {} on the page\n", counted(notes, "more line"));
  for (const CheckedFile& f : check.files) text += fmt::format("{}  {}\n", f.file.string(), file_text(f));
  if (check.carved.size() > 0)
    text += fmt::format("tool  X {:.2f} to {:.2f}, Y {:.2f} to {:.2f}, Z {:.4f} to {:.4f} mm; {} deep{}\n",
                        check.tool_min_mm.x(), check.tool_max_mm.x(), check.tool_min_mm.y(), check.tool_max_mm.y(),
                        check.tool_min_mm.z(), check.tool_max_mm.z(), depth_text(check), told_text(check));
  for (const ViewReach& v : check.views)
    text += fmt::format("view {}: {}, {:.0f} % of them beyond the cut-off\n", v.view, counted(v.scratches, "scratch"),
                        100 * v.dark);
  return text;
}

std::string carve_question(const CheckedCarving& checked, const CarveCheckFiles& files) {
  const auto& [check, machine, pictures] = checked;
  const bool frame = std::any_of(check.files.begin(), check.files.end(),
                                 [](const CheckedFile& f) { return f.lines > 0 && f.scratches == 0; });
  std::string zero = "on its face";
  if (!files.heights.empty())
    zero = "as the probing left it";
  else if (by_preload(machine.depth_by))
    zero = "where the tool first touches it";
  else if (machine.depth_by == DepthBy::servo)
    zero = "anywhere";
  return fmt::format("Is the sheet clamped, X and Y zero at its lower left corner, Z zero {}{}{}?", zero,
                     machine.laser ? ", the laser's beam off" : "",
                     frame ? ", and did the frame run clear of clamps and tags" : "");
}

void write_carve_check_page(const CheckedCarving& checked, const CarveCheckFiles& files, const fs::path& file) {
  const auto& [check, machine, pictures] = checked;
  const Board board = read_board(files.board);
  Page out{"Burin · before metal moves", outcome_of(check, count_of(check, Severity::warning))};
  out.next_word = "Before it starts";
  if (check.good()) out.next = html(carve_question(checked, files));
  if (!pictures.empty()) out.pictures = "<h2>What it will show</h2>\n" + pictures;
  out.findings = check.findings;
  out.body += "<h2>Where the tool goes</h2>\n";
  if (check.carved.size() > 0) out.body += sheet_drawing(check, board);
  std::string parts;
  if (check.carved.size() > 0)
    parts += folded("The tool", fmt::format("{} deep, {}", depth_text(check), html(duration_text(check.duration_s))),
                    tool_table(check, machine));
  parts += folded("The files", grouped(static_cast<long long>(check.files.size()), "file"), files_table(check));
  if (!check.views.empty()) {
    Table t;
    t.header = {"View", "Scratches that glint for it", "Of those beyond the cut-off"};
    double worst = 0;
    for (const ViewReach& v : check.views) {
      t.rows.push_back(
          {html(v.view), grouped(static_cast<long long>(v.scratches)), fmt::format("{:.0f} %", 100 * v.dark)});
      worst = std::max(worst, v.dark);
    }
    parts +=
        folded("Light that the grooves' walls reach",
               fmt::format("at most {:.0f} % of a view's scratches lie beyond the cut-off", 100 * worst), table(t));
  }
  out.body += folds(parts);
  write_text(page(out), file);
}

}  // namespace burin

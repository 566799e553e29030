#include "tools/view/view_sources.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "burin/base/error.h"
#include "burin/optimize/design/color_views.h"
#include "burin/optimize/loss/color_metrics.h"
#include "burin/optimize/target.h"
#include "burin/scene/bench_of_board.h"
#include "burin/scene/scratches.h"
#include "tools/commands.h"
#include "tools/project.h"
#include "tools/report/rectified.h"
#include "tools/round_names.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

constexpr int kTargetSide_px = 320;

// Returns the targets of the design's views on the carve area.
std::vector<ViewedPicture> pictures_of(const DesignSpec& spec, const Bench& bench, const Board& board,
                                       const fs::path& design) {
  const BoardFrame frame = board_frame(board.carve_min_mm, board.carve_max_mm, kTargetSide_px);
  std::vector<ViewedPicture> pictures;
  for (const DesignView& v : spec.views) {
    const View& view = find_view(bench, v.view, design.string());
    find_light(bench, v.light, design.string());
    const double rotation = v.target.upright_in_view
                                ? viewer_rotation_deg(view, (board.carve_min_mm + board.carve_max_mm) / 2)
                                : v.target.rotation_deg;
    pictures.push_back({v.view, v.light, {}});
    ViewedPicture& picture = pictures.back();
    const Eigen::Vector2d area = board.carve_max_mm - board.carve_min_mm;
    if (!v.color) {
      picture.target = load_target(v.target, rotation, area, frame.width, frame.height).picture;
      continue;
    }
    const std::vector<Target> channels = load_color_target(v.target, rotation, area, frame.width, frame.height);
    picture.target = in_color(channels[0].picture, channels[1].picture, channels[2].picture);
    picture.gains = white_gains(v, board, bench);
    picture.each_channel = v.white.kind == White::Kind::each;
  }
  if (pictures.empty()) fail(design.string(), "names no views", "add what the board is to show from where");
  return pictures;
}

Bench bench_for(const fs::path& file, const Board& board, std::vector<Finding>& findings) {
  Bench bench = read_bench(file);
  fill_material(bench, board);
  if (bench.lights.empty()) fail(file.string(), "has no lights", "add one, or calibrate the bench");
  append(findings, bench.findings);
  return bench;
}

// Returns a round's board as designed, on the bench of its design.
ViewedBoard designed_round(const Project& project, int number, std::vector<Finding>& findings) {
  const fs::path round = project.round(number);
  const fs::path file = fs::exists(round / "design.json") ? round / "design.json" : project.folder / "design.json";
  const DesignSpec spec = read_design(file);
  const Board board = read_board(spec.board);
  ViewedBoard out;
  out.bench = bench_for(spec.bench, board, findings);
  out.carved = carve(Designed(read_scratches(round / "scratches.csv")), out.bench, board);
  out.pictures = pictures_of(spec, out.bench, board, file);
  out.tolerances = shown_tolerances(spec, out.bench, board, round / "design" / "design-report.json");
  return out;
}

// Returns the same board as carved, on the measured bench; nothing if its views are not matched yet.
std::optional<ViewedBoard> measured_round(const Project& project, int number, std::vector<Finding>& findings) {
  const fs::path round = project.round(number), design = project.folder / "design.json";
  if (!fs::exists(round / "sent.csv")) return std::nullopt;
  Matching matching = match_round(project, number);
  if (!matching.complete()) {
    findings.push_back({FindingCode::views_undecided, Finding::Severity::warning, round / "bench.json",
                        "it is not decided which photos are the designed views, so the board as carved is left out",
                        "`burin loop " + shell_word(project.folder.string()) + "` asks"});
    return std::nullopt;
  }
  const DesignSpec spec = read_design(design);
  const Board board = read_board(spec.board);
  ViewedBoard out;
  out.bench = std::move(matching.bench);
  fill_material(out.bench, board);
  out.carved = carve(Sent(read_scratches(round / "sent.csv")), out.bench, board);
  out.pictures = pictures_of(spec, out.bench, board, design);
  out.tolerances = shown_tolerances(spec, out.bench, board, round / "design" / "design-report.json");
  return out;
}

// Returns the scratches of a project without a round.
fs::path first_scratches(const fs::path& folder, const Board& board) {
  for (const char* name : {"design", "preview"})
    if (fs::exists(folder / name / "scratches.csv")) return folder / name / "scratches.csv";
  if (!board.scratches.empty() && fs::exists(board.scratches)) return board.scratches;
  return {};
}

// Returns true for the preview scratches of `burin new`, which are next to their picture.
bool is_preview(const fs::path& scratches) { return fs::exists(scratches.parent_path() / "preview.png"); }

BoardView first_design(const fs::path& folder, std::vector<Finding>& findings) {
  const DesignSpec spec = read_design(folder / "design.json");
  BoardView out;
  out.board = read_board(spec.board);
  const fs::path scratches = first_scratches(folder, out.board);
  if (scratches.empty())
    fail(folder.string(), "nothing is designed here yet",
         fmt::format("run burin design {} --out {}", shell_word((folder / "design.json").string()),
                     shell_word((folder / "design").string())));
  ViewedBoard board;
  board.name = "As designed";
  board.sentence = "The board as it is designed, on the bench that it is designed for.";
  board.bench = bench_for(spec.bench, out.board, findings);
  const Scratches rows = read_scratches(scratches);
  if (is_preview(scratches)) {
    board.name = "Preview";
    board.sentence = fmt::format("A quick preview, {} of {} scratches; burin loop {} designs the whole board.",
                                 rows.size(), spec.scratches, shell_word(folder.string()));
  }
  board.carved = carve(Designed(rows), board.bench, out.board);
  board.pictures = pictures_of(spec, board.bench, out.board, folder / "design.json");
  board.tolerances = shown_tolerances(spec, board.bench, out.board, scratches.parent_path() / "design-report.json");
  out.boards.push_back(std::move(board));
  return out;
}

std::string title_of(const fs::path& path) {
  const fs::path whole = fs::absolute(path).lexically_normal();
  const fs::path name = whole.has_filename() ? whole.filename() : whole.parent_path().filename();
  return name.string();
}

// Only the small pictures contain lights other than lamps.
void find_far_lights(const BoardView& view, std::vector<Finding>& findings) {
  std::set<std::string> left_out;
  for (const ViewedBoard& viewed : view.boards)
    for (const ViewedPicture& picture : viewed.pictures)
      for (const std::string& id : light_names(picture.light))
        if (!find_light(viewed.bench, id, "the viewer").is_near()) left_out.insert(id);
  for (const std::string& id : left_out)
    findings.push_back(
        make_warning(FindingCode::page_shortened, "light \"" + id +
                                                      "\" is no lamp, and the viewer does not show its light where one "
                                                      "moves: the small pictures below do"));
}

void find_mesh(const Board& board, std::vector<Finding>& findings) {
  if (!board.mesh.empty())
    findings.push_back(make_warning(FindingCode::page_shortened,
                                    board.mesh.string() + " bends the board, and the viewer shows it flat"));
  if (board.bend)
    findings.push_back(
        make_warning(FindingCode::page_shortened,
                     fmt::format("board.json bends the board to a radius of {} mm, and the viewer shows it flat",
                                 board.bend->radius_mm)));
}

}  // namespace

BoardView view_of_project(const fs::path& folder, std::vector<Finding>& findings) {
  if (!fs::exists(folder / "design.json"))
    fail((folder / "design.json").string(), "a project needs this file",
         "name a project folder, or give --board, --bench and --scratches");
  const Project project{folder};
  int count = 0;
  while (fs::exists(project.round(count + 1) / "scratches.csv")) ++count;
  const int measured = std::min(count, project.measured());
  BoardView out;
  if (count == 0) {
    out = first_design(folder, findings);
  } else {
    out.board = read_board(read_design(folder / "design.json").board);
    std::optional<ViewedBoard> carved;
    if (measured > 0) carved = measured_round(project, measured, findings);
    const int shown = carved ? measured : count;
    ViewedBoard& designed = out.boards.emplace_back(designed_round(project, shown, findings));
    designed.name = carved ? "Before" : "As designed";
    designed.sentence = fmt::format("The board of round {}, as it was designed, on the bench as it was {}.", shown,
                                    shown == 1 ? "believed" : "measured in the round before");
    if (carved) {
      carved->name = "As carved";
      carved->sentence =
          fmt::format("The same board of round {} as it was carved, on the bench as its photos measured it.", shown);
      out.boards.push_back(std::move(*carved));
      if (count > measured) {
        ViewedBoard& next = out.boards.emplace_back(designed_round(project, measured + 1, findings));
        next.name = "Next";
        next.sentence = fmt::format("The board of round {}, designed for the bench as it was measured.", measured + 1);
      }
    }
  }
  out.title = title_of(folder);
  find_mesh(out.board, findings);
  find_far_lights(out, findings);
  return out;
}

BoardView view_of_files(const ViewFiles& files, std::vector<Finding>& findings) {
  BoardView out;
  out.board = read_board(files.board);
  ViewedBoard board;
  board.bench = read_bench_of(out.board, files.board, files.bench);
  append(findings, board.bench.findings);
  if (board.bench.lights.empty()) fail(files.bench.string(), "has no lights", "add one, or calibrate the bench");
  const fs::path scratches = files.scratches.empty() ? out.board.scratches : files.scratches;
  if (scratches.empty())
    fail(files.board.string(), "names no scratches", "name some in \"scratches\", or give --scratches FILE.csv");
  const Scratches rows = read_scratches(scratches);
  board.carved =
      files.as_sent ? carve(Sent(rows), board.bench, out.board) : carve(Designed(rows), board.bench, out.board);
  board.name = files.as_sent ? "As carved" : "As designed";
  board.sentence =
      fmt::format("{} on the bench of {}.", scratches.filename().string(), files.bench.filename().string());
  if (!files.design.empty()) {
    const DesignSpec spec = read_design(files.design);
    board.pictures = pictures_of(spec, board.bench, out.board, files.design);
    board.tolerances = shown_tolerances(spec, board.bench, out.board, {});
  } else {
    for (const View& view : board.bench.views) {
      const DesignView seen{view.name, board.bench.lights.front().id, {}, 1};
      board.pictures.push_back({seen.view, seen.light, {}});
      board.tolerances.push_back(default_tolerance(seen, board.bench, out.board));
    }
  }
  if (board.pictures.empty()) fail(files.bench.string(), "has no views", "add the places to look from");
  out.title = title_of(files.board.parent_path().empty() ? fs::path(".") : files.board.parent_path());
  out.boards.push_back(std::move(board));
  find_mesh(out.board, findings);
  find_far_lights(out, findings);
  return out;
}

}  // namespace burin

#include <CLI/Error.hpp>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "burin/base/files/decimals.h"
#include "burin/base/files/files_together.h"
#include "burin/base/files/json_file.h"
#include "burin/base/image.h"
#include "burin/base/median.h"
#include "burin/calib/geometry/chessboard.h"
#include "burin/calib/geometry/lens_solver.h"
#include "burin/pictures/picture.h"
#include "tools/commands.h"
#include "tools/progress_bar.h"
#include "tools/work_lock.h"

namespace burin {
namespace {

// "9x6"
std::pair<int, int> pair_of(const std::string& text, const std::string& option) {
  int a = 0, b = 0;
  const char* end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, a);
  const bool cross = first.ec == std::errc() && first.ptr != end && *first.ptr == 'x';
  if (cross) {
    const auto second = std::from_chars(first.ptr + 1, end, b);
    if (second.ec == std::errc() && second.ptr == end && a > 1 && b > 1) return {a, b};
  }
  throw CLI::ValidationError(option, "\"" + text + "\" is not of the form 9x6");
}

// Draws every corner at its place in the photo, from blue (no residual) to red (three times the RMS and more).
Image coverage_picture(const std::vector<TargetView>& views, const LensSolution& solution) {
  constexpr int kWidth = 800;
  const double scale = static_cast<double>(kWidth) / solution.lens.width;
  Image picture(kWidth, std::max(1, static_cast<int>(std::lround(scale * solution.lens.height))), 3, 0.96F);
  for (std::size_t v = 0; v < views.size(); ++v)
    for (std::size_t i = 0; i < views[v].q_px.size(); ++i) {
      const double badness = solution.residual_px[v][i].norm() / (3 * std::sqrt(2.0) * std::max(solution.rms_px, 1e-9));
      const auto red = static_cast<float>(std::clamp(badness, 0.0, 1.0));
      const int x = static_cast<int>(std::lround(scale * (views[v].q_px[i].x() + 0.5) - 0.5));
      const int y = static_cast<int>(std::lround(scale * (views[v].q_px[i].y() + 0.5) - 0.5));
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          const int px = x + dx, py = y + dy;
          if (px < 0 || py < 0 || px >= picture.width || py >= picture.height) continue;
          picture.at(px, py, 0) = red;
          picture.at(px, py, 1) = 0.25F;
          picture.at(px, py, 2) = 1 - red;
        }
    }
  return picture;
}

// Counts the parts of the frame, divided into 4 x 3, with a corner.
int parts_covered(const std::vector<TargetView>& views, int width, int height) {
  std::array<bool, 12> seen{};
  for (const TargetView& view : views)
    for (const Eigen::Vector2d& q : view.q_px) {
      const auto column = static_cast<std::size_t>(std::clamp(4 * q.x() / width, 0.0, 3.0)),
                 row = static_cast<std::size_t>(std::clamp(3 * q.y() / height, 0.0, 2.0));
      seen[4 * row + column] = true;
    }
  return static_cast<int>(std::count(seen.begin(), seen.end(), true));
}

struct LensArguments {
  std::filesystem::path input, out;
  std::string chessboard = "9x6", model, image_size;
  double square_mm = 0;
  int window_px = kCornerWindow_px;
  bool bow = false;
};

ChessboardViews read_views(const LensArguments& options, const Chessboard& board) {
  if (std::filesystem::is_directory(options.input)) {
    ProgressBar bar;
    return find_chessboards(options.input, board, options.window_px, bar.progress());
  }
  if (options.image_size.empty())
    throw CLI::ValidationError("--image-size", "a table of corners has no picture size: give WIDTHxHEIGHT in pixels");
  const auto [width, height] = pair_of(options.image_size, "--image-size");
  return read_corners(options.input, board, width, height);
}

// Solves the lens without outlier photos. They show another board, or the camera moved.
LensSolution solve_without_strays(ChessboardViews& found, const Chessboard& board, const LensSolverOptions& solver) {
  constexpr double kFarFactor = 5, kFar_px = 2;
  while (true) {
    LensSolution s = solve_lens(found.views, found.width, found.height, board.size_mm(), solver);
    const double usual = median_of(s.view_rms_point_px);
    const auto worst = std::max_element(s.view_rms_point_px.begin(), s.view_rms_point_px.end());
    if (!(*worst > kFar_px && *worst > kFarFactor * usual) || found.views.size() <= 3) return s;
    const auto at = found.views.begin() + (worst - s.view_rms_point_px.begin());
    found.findings.push_back(
        {FindingCode::photo_omitted, Finding::Severity::warning, at->name,
         fmt::format("is left out: its corners miss by {:.2f} px RMS, the others' by {:.2f} px", *worst, usual),
         "it was moved while it was exposed, or shows another board"});
    found.views.erase(at);
  }
}

void report_lens(const ChessboardViews& found, const LensSolution& s, bool bow, Report& report) {
  for (std::size_t v = 0; v < found.views.size(); ++v)
    report.add("photos").line("{:<24} {:4} corners, {:.3f} px RMS\n", fact("photo", found.views[v].name),
                              fact("corners", found.views[v].q_px.size()), fact("rms", s.view_rms_point_px[v], "px"));
  const auto sigma = [&](int i) { return std::sqrt(std::max(0.0, s.covariance(i, i))); };
  report.in("lens").line(
      "lens     {}: focal lengths {:.3f} +- {:.3f} and {:.3f} +- {:.3f} px, center {:.2f}, {:.2f} px\n",
      fact("model", s.lens.model), fact("focal_x", s.lens.intrinsics[0], "px", sigma(0)), sigma(0),
      fact("focal_y", s.lens.intrinsics[1], "px", sigma(1)), sigma(1),
      fact("center_x", s.lens.intrinsics[2], "px", sigma(2)), fact("center_y", s.lens.intrinsics[3], "px", sigma(3)));
  report.in("corners").line("corners  {:.4f} px RMS a point, {:.4f} px per axis, in {}\n",
                            fact("rms_point", s.rms_point_px, "px"), fact("rms", s.rms_px, "px"),
                            counted(found.views.size(), "photo"));
  if (bow) {
    report.all().set("bow", {s.bow_mm[0], s.bow_mm[1], s.bow_mm[2]}, "mm");
    report.line("board    bow {:.3f}, {:.3f}, {:.3f} mm\n", s.bow_mm[0], s.bow_mm[1], s.bow_mm[2]);
  }
  report.in("check").line("check    mrcal's own solver moves corners by {:.5f} px\n",
                          fact("largest_shift", s.check.max_shift_px, "px"));
}

Report run(const LensArguments& options) {
  const WorkLock lock(options.out.parent_path(), "burin lens", WorkLock::Where::projects);
  Chessboard board;
  std::tie(board.columns, board.rows) = pair_of(options.chessboard, "--chessboard");
  board.square_mm = options.square_mm;
  ChessboardViews found = read_views(options, board);
  for (const Finding& finding : found.findings) tell(finding);  // first: they explain why too few photos remain
  found.findings.clear();
  LensSolverOptions solver;
  solver.model = options.model;
  solver.solve_bow = options.bow;
  const LensSolution s = solve_without_strays(found, board, solver);

  if (options.out.has_parent_path()) make_output_folder(options.out.parent_path());
  std::filesystem::path picture = options.out;
  picture.replace_extension(".coverage.png");
  FilesTogether all;
  write_picture(coverage_picture(found.views, s), picture);
  write_cameramodel(s.lens, options.out);
  all.put();

  for (const Finding& finding : found.findings) tell(finding);
  Report report;
  report_lens(found, s, options.bow, report);
  const int parts = parts_covered(found.views, found.width, found.height);
  report.line("coverage {} of 12 parts of the frame; {} shows every corner\n", fact("parts_covered", parts),
              fact("coverage_picture", picture.string()));
  constexpr int kFewParts = 10;
  if (parts < kFewParts)
    tell(make_warning(FindingCode::coverage, "the corners of the frame are not covered: the lens is a guess there",
                      "add photos with the board in them"));
  for (const std::string& name : s.not_determined)
    tell(make_warning(FindingCode::lens_weak, name + " is hardly determined",
                      "add photos with the board tilted, in different directions"));
  report.line("Wrote {}; next: burin calibrate SESSION.json --camera {} --out DIR\n", options.out.string(),
              shell_word(options.out.string()));
  return report;
}

}  // namespace

void add_lens_command(CLI::App& burin) {
  auto options = std::make_shared<LensArguments>();
  CLI::App* command = burin.add_subcommand("lens", "Calibrate a lens from photos of a chessboard");
  command
      ->add_option("INPUT", options->input, "Read this folder of chessboard photos, or a corners.vnl of mrcal's tools")
      ->required();
  command->add_option("--chessboard", options->chessboard, "Set the number of inner corners, COLUMNSxROWS")->required();
  add_length_option(*command, "--square", options->square_mm, "Set the side length of a square")
      ->required()
      ->check(CLI::PositiveNumber);
  command->add_option("--out", options->out, "Write this .cameramodel, with a picture of the coverage next to it")
      ->required();
  command->add_option("--lens-model", options->model,
                      "Use LENSMODEL_OPENCV4, 5 or 8 [default: the smallest that the photos support]");
  command->add_option("--image-size", options->image_size,
                      "Set the size of a corners.vnl's photos, pixels, WIDTHxHEIGHT");
  command
      ->add_option("--corner-window", options->window_px,
                   "Refine corners in a window of this half-width, pixels; 0: as large as the squares allow")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_flag("--bow", options->bow, "Solve for the chessboard's warp (three quadratic terms)");
  command->footer(example("burin lens chessboard-photos --chessboard 9x6 --square 25 --out camera.cameramodel"));
  command->callback([options] { print(run(*options)); });
}

}  // namespace burin

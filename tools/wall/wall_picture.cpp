#include "tools/wall/wall_picture.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/base/files/file_names.h"
#include "burin/optimize/design/design_output.h"
#include "burin/pictures/picture.h"
#include "tools/project.h"
#include "tools/wall/lay_wall.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

// A board's predicted picture and target of one view, of one size.
struct BoardPictures {
  WallArea area;
  Image shown, target;
};

// The design's previews are named in its report.
BoardPictures pictures_of_board(const Wall& wall, std::size_t index, std::size_t view) {
  const Board board = board_of(wall, index);
  const WallBoard& on_wall = wall.boards[index];
  BoardPictures out;
  out.area = {on_wall.corner_mm + board.carve_min_mm, on_wall.corner_mm + board.carve_max_mm};
  const Project project{wall.folder / on_wall.name};
  for (int round = project.rounds(); round > 0 && out.shown.data.empty(); --round) {
    const fs::path file = project.round(round) / "design" / "design-report.json";
    if (!fs::exists(file)) continue;
    const Json json = read_json(file, "burin/design-report", 1);
    for (const Json& v : json.at("views")) {
      if (v.at("view") != wall.views[view].name) continue;
      out.shown = luminance(read_picture(file.parent_path() / v.at("preview").get<std::string>()));
      out.target = luminance(read_picture(file.parent_path() / v.at("target").get<std::string>()));
    }
  }
  if (!out.shown.data.empty()) return out;
  Image target = read_picture(wall.folder / on_wall.name / "targets" / (file_name_of(wall.views[view].name) + ".png"));
  if (brightest(target) < kBlackTone) {  // black, and without a preview
    out.shown = out.target = Image(1, 1, 1);
    return out;
  }
  const fs::path preview =
      wall.folder / "previews" / (on_wall.name + "-" + file_name_of(wall.views[view].name) + ".png");
  if (!fs::exists(preview))
    fail((wall.folder / on_wall.name).string(), "has neither a design nor a preview",
         "run: burin wall work " + wall.folder.string());
  out.shown = luminance(read_picture(preview));
  for (float& v : target.data) v = std::pow(srgb_to_linear(v), 1 / 2.2F);
  out.target = resized(luminance(target), out.shown.width, out.shown.height);
  return out;
}

double light(float shown) { return std::pow(static_cast<double>(shown), 2.2); }

// Mean light of a strip along one edge: 0 left, 1 right, 2 bottom, 3 top.
double light_at_edge(const Image& image, int edge) {
  constexpr int kParts = 8;  // of the board's width
  const int depth = std::max(1, (edge < 2 ? image.width : image.height) / kParts);
  const int x0 = edge == 1 ? image.width - depth : 0, x1 = edge == 0 ? depth : image.width;
  const int y0 = edge == 2 ? image.height - depth : 0, y1 = edge == 3 ? depth : image.height;
  double sum = 0;
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) sum += light(image.at(x, y));
  return sum / (static_cast<double>(x1 - x0) * (y1 - y0));
}

// Logarithm of the ratio of shown to wanted light beside two neighbors' common edge, one less the other. Nothing where
// either is nearly black.
std::optional<double> seam_step(const BoardPictures& a, int edge_a, const BoardPictures& b, int edge_b) {
  constexpr double kDark = 0.01;
  const double wanted_a = light_at_edge(a.target, edge_a), wanted_b = light_at_edge(b.target, edge_b);
  if (wanted_a < kDark || wanted_b < kDark) return std::nullopt;
  return std::log(light_at_edge(a.shown, edge_a) / wanted_a) - std::log(light_at_edge(b.shown, edge_b) / wanted_b);
}

// Steps at all seams between boards that face each other.
std::vector<double> seam_steps(const std::vector<BoardPictures>& boards, const Wall& wall,
                               const std::vector<std::size_t>& at) {
  std::vector<double> steps;
  const auto overlap = [](double a0, double a1, double b0, double b1) { return std::min(a1, b1) - std::max(a0, b0); };
  for (std::size_t i = 0; i < at.size(); ++i)
    for (std::size_t k = 0; k < at.size(); ++k) {
      const WallBoard &a = wall.boards[at[i]], &b = wall.boards[at[k]];
      const Eigen::Vector2d gap = b.corner_mm - (a.corner_mm + a.size_mm);
      const Eigen::Vector2d end_a = a.corner_mm + a.size_mm, end_b = b.corner_mm + b.size_mm;
      const double near = std::min(a.size_mm.minCoeff(), b.size_mm.minCoeff()) / 2;
      constexpr double kMost = 0.8;  // of the shorter side must face the other
      std::optional<double> step;
      if (gap.x() > -1e-6 && gap.x() < near &&
          overlap(a.corner_mm.y(), end_a.y(), b.corner_mm.y(), end_b.y()) >
              kMost * std::min(a.size_mm.y(), b.size_mm.y()))
        step = seam_step(boards[i], 1, boards[k], 0);
      else if (gap.y() > -1e-6 && gap.y() < near &&
               overlap(a.corner_mm.x(), end_a.x(), b.corner_mm.x(), end_b.x()) >
                   kMost * std::min(a.size_mm.x(), b.size_mm.x()))
        step = seam_step(boards[i], 3, boards[k], 2);
      if (step && std::isfinite(*step)) steps.push_back(*step);
    }
  return steps;
}

}  // namespace

Report picture_of_wall(const fs::path& folder) {
  const Wall wall = read_wall(folder);
  const LaidWall laid = read_laid(folder);
  const WallArea area = area_of(wall);
  std::vector<std::size_t> at;
  for (std::size_t b = 0; b < wall.boards.size(); ++b)
    if (!laid.is_blank(wall.boards[b].name)) at.push_back(b);
  Report report;
  for (std::size_t k = 0; k < wall.views.size(); ++k) {
    std::vector<BoardPictures> boards;
    double squares = 0, area_mm2 = 0, pitch_mm = INFINITY;
    for (const std::size_t b : at) {
      boards.push_back(pictures_of_board(wall, b, k));
      const BoardPictures& board = boards.back();
      const double pixel_mm2 = board.area.size_mm().prod() / static_cast<double>(board.shown.data.size());
      for (std::size_t i = 0; i < board.shown.data.size(); ++i)
        squares += pixel_mm2 * std::pow(static_cast<double>(board.shown.data[i]) - board.target.data[i], 2);
      area_mm2 += board.area.size_mm().prod();
      pitch_mm = std::min(pitch_mm, board.area.size_mm().x() / board.shown.width);
    }
    constexpr double kMostPixels = 4000;  // of the whole sheet
    pitch_mm = std::max(pitch_mm, area.size_mm().maxCoeff() / kMostPixels);
    const auto pixels = [&](double mm) { return std::max(1, static_cast<int>(std::lround(mm / pitch_mm))); };
    Image shown(pixels(area.size_mm().x()), pixels(area.size_mm().y()), 1), target = shown, difference = shown;
    std::fill(difference.data.begin(), difference.data.end(), 0.5F);
    for (const BoardPictures& board : boards) {
      const int left = static_cast<int>(std::lround((board.area.min_mm.x() - area.min_mm.x()) / pitch_mm)),
                top = static_cast<int>(std::lround((area.max_mm.y() - board.area.max_mm.y()) / pitch_mm)),
                w = std::min(pixels(board.area.size_mm().x()), shown.width - left),
                h = std::min(pixels(board.area.size_mm().y()), shown.height - top);
      const Image a = resized(board.shown, w, h), b = resized(board.target, w, h);
      for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x) {
          shown.at(left + x, top + y) = a.at(x, y);
          target.at(left + x, top + y) = b.at(x, y);
          difference.at(left + x, top + y) = std::clamp(0.5F + (a.at(x, y) - b.at(x, y)) / 2, 0.0F, 1.0F);
        }
    }
    const std::string name = "wall-" + file_name_of(wall.views[k].name) + ".png";
    write_picture(tiled({{shown}, {target}, {difference}}, 4), folder / name);
    const std::vector<double> steps = seam_steps(boards, wall, at);
    double square = 0, most = 0;
    for (const double s : steps) {
      square += s * s / static_cast<double>(steps.size());
      most = std::max(most, std::abs(s));
    }
    Facts view = report.add("views");
    view.line("view {}: {:.2f} dB over {}; {} seams, brightness steps of {:.1f} % (RMS), at most {:.1f} %\n",
              fact("view", wall.views[k].name), fact("psnr", -10 * std::log10(squares / area_mm2), "dB"),
              counted(at.size(), "board"), fact("seams", steps.size()), fact("seam_rms", 100 * std::sqrt(square), "%"),
              fact("seam_most", 100 * most, "%"));
  }
  report.line("Wrote {}: shown, wanted, and the difference around gray, from above\n",
              (folder / "wall-*.png").string());
  return report;
}

}  // namespace burin

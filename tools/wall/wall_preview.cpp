#include "tools/wall/wall_preview.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "burin/base/error.h"
#include "burin/base/files/file_names.h"
#include "burin/optimize/design.h"
#include "burin/optimize/toolpath/carving_time.h"
#include "burin/pictures/picture.h"
#include "burin/scene/bench_of_board.h"
#include "tools/loop/options.h"
#include "tools/progress_bar.h"
#include "tools/stop_signal.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

constexpr int kPreviewIterations = 16;

fs::path preview_file(const fs::path& wall, const std::string& board) { return wall / "previews" / (board + ".json"); }

// Squared error over the carve area, mm^2.
double error_mm2(const DesignResult& result, const DesignSpec& spec, double area_mm2) {
  double sum = 0;
  for (std::size_t k = 0; k < result.views.size(); ++k)
    sum += spec.views[k].weight * std::pow(10, -result.views[k].psnr_db / 10) * area_mm2;
  return sum;
}

// The shown values grow by 1/2.2 of the exposure's logarithm; values at white do not.
double stiffness_mm2(const DesignedView& view, double weight, double area_mm2) {
  double sum = 0;
  for (const float v : view.shown.data)
    if (v < 1) sum += static_cast<double>(v) * v / (2.2 * 2.2);
  return weight * sum / static_cast<double>(view.shown.data.size()) * area_mm2;
}

}  // namespace

void make_preview(const Wall& wall, const LaidWall& laid, std::size_t index) {
  const std::string& name = wall.boards[index].name;
  const fs::path folder = wall.folder / name;
  DesignSpec spec = read_design(folder / "design.json");
  // A view whose part is black here needs no scratches, and has no exposure of its own.
  std::vector<std::string> black;
  for (DesignView& v : spec.views) {
    v.exposure.reset();
    v.target.may_be_even = true;
    if (brightest(read_picture(v.target.picture)) < kBlackTone) black.push_back(v.view);
  }
  std::erase_if(spec.views, [&](const DesignView& v) { return std::count(black.begin(), black.end(), v.view) > 0; });
  const Board board = read_board(spec.board);
  const Bench bench = read_bench_of(board, spec.board, spec.bench);
  DesignOptions options;
  options.pixels = pixels_of(board, pitch_of(wall));
  options.iterations = kPreviewIterations;
  options.contact_frames = 0;
  options.note_few_strokes = false;
  options.carve_machine = machine_of(read_loop_options(folder), folder);
  options.machine = options.carve_machine.limits;
  options.stop = &StopOnSignal::asked;
  const double area_mm2 = (board.carve_max_mm - board.carve_min_mm).prod();
  const int share = preview_scratches(wall, index);
  Json trials = Json::array(), views = Json::array();
  ProgressBar bar;
  for (const double part : {0.5, 1.0, 2.0}) {
    spec.scratches = std::max(2, static_cast<int>(std::lround(part * share)));
    const DesignResult result = design(spec, board, bench, options, bar.progress());
    stop_if_asked();
    trials.push_back({{"scratches", result.started_with},
                      {"error_mm2", error_mm2(result, spec, area_mm2)},
                      {"carve_s", carving_time_s(result.scratches, bench.material.depth_um, options.carve_machine)}});
    if (part != 1.0) continue;
    make_output_folder(wall.folder / "previews");
    for (const WallView& on_wall : wall.views) {
      Json view{{"view", on_wall.name}, {"best_exposure", 0}, {"stiffness_mm2", 0}};
      for (std::size_t k = 0; k < result.views.size(); ++k) {
        const DesignedView& v = result.views[k];
        if (v.view != on_wall.name) continue;
        view["best_exposure"] = v.best_exposure;
        view["stiffness_mm2"] = stiffness_mm2(v, spec.views[k].weight, area_mm2);
        write_picture(v.shown, wall.folder / "previews" / (name + "-" + file_name_of(v.view) + ".png"));
      }
      views.push_back(view);
    }
  }
  bar.clear();
  write_json(Json{{"format", "burin/wall-preview"},
                  {"version", 1},
                  {"wall", laid.key},
                  {"board", name},
                  {"views", views},
                  {"trials", trials}},
             preview_file(wall.folder, name));
}

std::optional<BoardPreview> read_preview(const fs::path& wall_folder, const std::string& board,
                                         const std::string& key) {
  const fs::path file = preview_file(wall_folder, board);
  if (!fs::exists(file)) return std::nullopt;
  const Json json = read_json(file, "burin/wall-preview", 1);
  JsonObject root(json, file.string());
  if (root.text("wall") != key) return std::nullopt;
  BoardPreview preview;
  for (JsonObject& view : root.objects("views"))
    preview.views.push_back({view.number("best_exposure"), view.number("stiffness_mm2")});
  for (JsonObject& trial : root.objects("trials"))
    preview.trials.push_back({trial.positive("scratches"), trial.number("error_mm2"), trial.number("carve_s")});
  if (preview.trials.empty()) root.fail_field("trials", "is empty", "remove this file: burin wall work makes it again");
  return preview;
}

}  // namespace burin

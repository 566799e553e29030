#include "tools/loop/round_design.h"

#include <fmt/core.h>

#include "burin/optimize/design_file.h"
#include "burin/render/bench.h"
#include "burin/render/board.h"
#include "burin/render/error.h"

namespace burin {

namespace fs = std::filesystem;

void write_round_design(const Project& project, int number, const fs::path& file) {
  DesignSpec spec = read_design(project.folder / "design.json");
  if (number > 1) {
    const fs::path measured_file = project.bench_before(number);
    const Bench nominal = read_bench(spec.bench), measured = read_bench(measured_file);
    const Board board = read_board(spec.board);
    for (DesignView& view : spec.views) {
      const View& designed = find_view(nominal, view.view, (project.folder / "design.json").string());
      const View* taken = measured_view(measured, designed, board);
      if (!taken)
        fail(measured_file.string(), fmt::format("no photo was taken from the designed view \"{}\"", designed.name),
             "photograph the board from there too, or change that view in the project's bench.json");
      view.view = taken->name;
    }
    spec.bench = measured_file;
  }
  write_design(spec, file);
}

}  // namespace burin

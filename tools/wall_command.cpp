// burin wall - boards that hang side by side and show pictures together, made by any number of computers. The work is
// in tools/wall.
#include <CLI/Error.hpp>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/base/files/file_names.h"
#include "burin/optimize/duration.h"
#include "burin/optimize/layout/tag_layout.h"
#include "tools/commands.h"
#include "tools/new/lay_out.h"
#include "tools/new/pictures.h"
#include "tools/new/project_files.h"
#include "tools/new/words.h"
#include "tools/wall/lay_wall.h"
#include "tools/wall/wall_picture.h"
#include "tools/wall/work_wall.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

struct NewWallArguments {
  fs::path folder, drawing;
  std::string grid, board = "200x150", gap = "3mm", border, camera = "phone", lamp = "above", stand;
  std::vector<std::string> pictures, machines{"grbl-spring"}, fit, keep;
  int scratches = 0;
  std::string hours;
};

// "4x3": columns and rows.
std::pair<int, int> grid_in_words(const std::string& text) {
  int columns = 0, rows = 0;
  const char *begin = text.data(), *end = begin + text.size();
  const auto first = std::from_chars(begin, end, columns);
  const auto second = first.ptr < end ? std::from_chars(first.ptr + 1, end, rows) : first;
  constexpr int kMost = 1000;
  if (first.ptr >= end || (*first.ptr != 'x' && *first.ptr != 'X') || second.ptr != end || columns < 1 || rows < 1 ||
      columns > kMost || rows > kMost)
    fail("--grid " + text, "is not a number of columns and rows", "give both, as 4x3, each up to 1000");
  return {columns, rows};
}

double gap_in_words(const std::string& text, double shorter_mm) {
  const double gap_mm = text == "0" || text == "0mm" ? 0 : length_in_words(text, "the gap between boards");
  if (gap_mm > shorter_mm)
    fail("--gap " + text, "is wider than a board, so that more of the pictures is lost than shown",
         fmt::format("give at most {:g} mm, or larger boards", shorter_mm));
  return gap_mm;
}

Wall wall_in_words(const NewWallArguments& o) {
  Wall wall;
  wall.folder = o.folder;
  if (o.drawing.empty() == o.grid.empty()) throw CLI::ValidationError("--grid", "or --layout: give one of both");
  if (o.drawing.empty()) {
    const auto [columns, rows] = grid_in_words(o.grid);
    const Eigen::Vector2d board_mm = size_in_words(o.board, "board");
    wall.boards = grid_of_boards(columns, rows, board_mm, gap_in_words(o.gap, board_mm.minCoeff()));
  } else {
    wall.boards = boards_of_drawing(o.drawing);
  }
  for (std::size_t b = 0; b < wall.boards.size(); ++b) {
    const std::string& machine = o.machines[b % o.machines.size()];
    std::error_code ignored;
    wall.boards[b].machine =
        fs::is_regular_file(machine, ignored) ? path_beside(o.folder / "wall.json", machine) : machine;
  }
  Eigen::Vector2d size(0, 0), smallest(INFINITY, INFINITY);
  for (const WallBoard& b : wall.boards) {
    size = size.cwiseMax(b.corner_mm + b.size_mm);
    if (b.size_mm.minCoeff() < smallest.minCoeff()) smallest = b.size_mm;
  }
  if (o.border.empty())
    wall.tag_mm = tag_sizes(smallest).usual_mm;
  else
    wall.border_mm = length_in_words(o.border, "the border");

  BenchWishes wanted;
  // Eyes and lamp are chosen as for one board of this size; boards with tags have limits that a wall has not.
  constexpr double kLeastBoard_mm = 60, kMostBoard_mm = 5000;
  wanted.board_mm = size.cwiseMax(kLeastBoard_mm).cwiseMin(kMostBoard_mm);
  const Eigen::Vector2d shift = (size - wanted.board_mm) / 2;
  const Eigen::Vector3d to_wall(shift.x(), shift.y(), 0);
  wanted.views = static_cast<int>(o.pictures.size());
  wanted.camera = camera_in_words(o.camera);
  wanted.lamp = lamp_in_words(o.lamp);
  wanted.stand_mm = o.stand.empty() ? 0 : length_in_words(o.stand, "how far away one stands");
  if (wanted.lamp.position_mm) *wanted.lamp.position_mm -= to_wall;
  const LaidOutBench bench = lay_out(wanted);
  wall.depth_um = bench.board.material.depth_um;
  wall.face_alpha = bench.board.material.base_alpha;
  if (wanted.camera.cameramodel.empty())
    wall.camera = {{"focal_35mm", wanted.camera.focal_35mm},
                   {"pixels", {wanted.camera.lens.width, wanted.camera.lens.height}}};
  else
    wall.camera = path_beside(o.folder / "wall.json", wanted.camera.cameramodel);
  wall.lights = Json::array({Json{{"id", "lamp"}, {"position_mm", to_json(Eigen::Vector3d(bench.lamp_mm + to_wall))}}});
  wall.material = {{"crossings", "deepest"}};
  constexpr int kPerPicture = 4000;
  if (!o.hours.empty())
    wall.machine_hours = duration_from_text(o.hours) / 3600;
  else
    wall.scratches =
        o.scratches > 0 ? o.scratches : kPerPicture * static_cast<int>(o.pictures.size() * wall.boards.size());
  constexpr std::size_t kMostPictures = 9;
  const std::vector<ChosenPicture> pictures = choose_pictures({o.pictures.begin(), o.pictures.end()}, kMostPictures);
  const WallArea area = area_of(wall);
  for (std::size_t k = 0; k < pictures.size(); ++k) {
    ChosenPicture p = pictures[k];
    lay_as_usual(p, area.size_mm());
    const auto one_of = [&](const std::vector<std::string>& list, const char* option) -> const std::string* {
      if (list.size() > 1 && list.size() != pictures.size())
        throw CLI::ValidationError(option, "takes one word for all pictures, or one for each");
      return list.empty() ? nullptr : &list[list.size() == 1 ? 0 : k];
    };
    if (const std::string* keep = one_of(o.keep, "--keep")) lay_as(p, *keep);
    if (const std::string* fit = one_of(o.fit, "--fit")) lay_as(p, *fit);
    wall.views.push_back(
        {p.view, "lamp", bench.eyes_mm[k] + to_wall, wall.folder / "pictures" / p.stored, p.fit, p.keep, 1});
  }
  make_output_folder(wall.folder);
  make_output_folder(wall.folder / "pictures");
  for (const ChosenPicture& p : pictures) store_picture(p, wall.folder / "pictures");
  return wall;
}

// Adds what a person needs to know about a layout.
void report_layout(const Wall& wall, const LaidWall& laid, Report& report) {
  const WallArea area = area_of(wall);
  double carved_mm2 = 0;
  for (std::size_t b = 0; b < wall.boards.size(); ++b) {
    const Board board = board_of(wall, b);
    carved_mm2 += (board.carve_max_mm - board.carve_min_mm).prod();
  }
  const double lost = 1 - carved_mm2 / area.size_mm().prod();
  report.line("{}; pictures on {:g} x {:g} mm, of which {:.0f} % are lost behind gaps and edges\n",
              counted(wall.boards.size(), "board"), area.size_mm().x(), area.size_mm().y(),
              fact("lost", 100 * lost, "%"));
  report.all().set("boards", wall.boards.size());
  report.line("pixels of {:.2f} mm; {}\n", fact("pixel", pitch_of(wall), "mm"),
              wall.machine_hours > 0 ? fmt::format("{:g} machine hours to share", wall.machine_hours)
                                     : fmt::format("{} scratches to share", wall.scratches));
  if (wall.tag_mm > 0)
    report.line("each board has a ring of tags of {:g} mm; --border 1mm carves up to the edges, without tags\n",
                wall.tag_mm);
  if (!laid.blank.empty()) {
    report.all().set("blank", laid.blank);
    report.line("dark in all views, so without a project: {}\n", fmt::join(laid.blank, ", "));
  }
  report.next.push_back({"burin", "wall", "work", wall.folder.string()});
  report.line("Wrote {}; next, on each computer that shares this folder: {}\n", wall.folder.string(),
              command_text(report.next.back()));
}

Report new_wall(const NewWallArguments& o) {
  if (o.pictures.empty()) throw CLI::RequiredError("--pictures");
  fail_unless_new(o.folder);
  Wall wall = wall_in_words(o);
  check_boards(wall.boards, "the wall");
  write_wall(wall);
  wall = read_wall(o.folder);
  Report report;
  report_layout(wall, lay_wall(wall), report);
  return report;
}

Report lay_wall_anew(const fs::path& folder) {
  const Wall wall = read_wall(folder);
  Report report;
  report_layout(wall, lay_wall(wall), report);
  return report;
}

void add_new_wall(CLI::App& wall) {
  auto o = std::make_shared<NewWallArguments>();
  CLI::App* c = wall.add_subcommand("new", "Create a wall: wall.json, and a loop project for each board");
  c->add_option("WALL", o->folder, "Create this folder, which must not exist yet")->required();
  c->add_option("--pictures", o->pictures, "Show these one to nine pictures over the whole wall, one viewpoint each")
      ->type_name("PICTURE ...")
      ->expected(1, -1);
  c->add_option("--grid", o->grid, "Hang equal boards in this many columns and rows: 4x3")->type_name("COLUMNSxROWS");
  c->add_option("--layout", o->drawing, "Hang boards as the rectangles of this SVG instead (mm, or with a width in mm)")
      ->type_name(kFile);
  c->add_option("--board", o->board, "Set the size of a board in the grid, mm or with a unit: 200x150, 8x6in")
      ->capture_default_str();
  c->add_option("--gap", o->gap, "Leave this length between boards; the pictures behind it are lost")
      ->capture_default_str();
  c->add_option("--border", o->border,
                "Carve up to this length from the edges, without tags [default: a ring of tags on each board]");
  c->add_option("--count", o->scratches,
                "Share this number of scratches among all boards [default: 4000 per picture and board]")
      ->check(CLI::Range(1, 2000000000));
  c->add_option("--hours", o->hours, "Share this time of all machines together instead: 40h")->check(wrong_duration);
  c->add_option("--machine", o->machines, "Carve with these built-in machines or burin/machine files, in turn by board")
      ->type_name("MACHINE ...")
      ->expected(1, -1)
      ->capture_default_str();
  c->add_option("--camera", o->camera, "Use this camera, as for burin new")->type_name("CAMERA")->capture_default_str();
  c->add_option("--lamp", o->lamp,
                "Place the lamp above, left, right or below the wall, or at X,Y,Z from its lower left corner, mm")
      ->type_name("LAMP")
      ->capture_default_str();
  c->add_option("--stand", o->stand, "Set the distance from the eyes to the wall: 3m [default: about four diagonals]");
  c->add_option("--fit", o->fit, "Fill the wall (cover) or show whole pictures (contain): one word, or one per picture")
      ->type_name("WORD ...")
      ->expected(1, -1)
      ->check(CLI::IsMember({"cover", "contain"}));
  c->add_option("--keep", o->keep, "Keep this part of cropped pictures: one word, or one per picture")
      ->type_name("WORD ...")
      ->expected(1, -1)
      ->check(CLI::IsMember({"top", "middle", "bottom", "left", "right"}));
  c->footer(
      example("burin wall new mural --grid 4x3 --board 200x150mm --gap 3mm --pictures a.jpg b.jpg\n"
              "  burin wall new mural --layout boards.svg --pictures a.jpg --machine grbl-spring big-mill.toml"));
  c->callback([o] { print(new_wall(*o)); });
}

void add_work_on_wall(CLI::App& wall) {
  struct Arguments {
    fs::path folder;
    std::string stale = "2min";
    bool retry = false;
  };
  auto o = std::make_shared<Arguments>();
  CLI::App* c = wall.add_subcommand(
      "work", "Make stage after stage of free boards until none is left; start it on any number of computers");
  c->add_option("WALL", o->folder, "Work on this wall, a folder that all workers share")->required();
  c->add_option("--stale", o->stale, "Take over a board whose worker was silent for this long")
      ->check(wrong_duration)
      ->capture_default_str();
  c->add_flag("--retry", o->retry, "Also take boards whose work failed before");
  c->footer(
      example("burin wall work mural\n"
              "  parallel --sshlogin pc1,pc2,pc3 --nonall burin wall work /shared/mural"));
  c->callback([o] {
    print(work_on_wall(o->folder, {std::chrono::seconds(std::lround(duration_from_text(o->stale, 1))), o->retry}));
  });
}

struct SlurmArguments {
  fs::path folder, out;
  int workers = 10, at_once = 0, threads = 8;
  std::string time = "4:00:00", partition;
};

Report write_slurm(const SlurmArguments& o) {
  read_laid(o.folder);
  const fs::path folder = fs::absolute(o.folder).lexically_normal();
  const fs::path file = o.out.empty() ? o.folder / "wall.sbatch" : o.out;
  make_output_folder(o.folder / "logs");
  const std::string limit = o.at_once > 0 ? fmt::format("%{}", o.at_once) : "";
  const std::string partition = o.partition.empty() ? "" : fmt::format("#SBATCH --partition={}\n", o.partition);
  const std::string place = shell_word(folder.string());
  // The batch shell gets the signal a minute before the end, passes it on, and asks for another turn: the worker gives
  // its board back, and no board waits for a heartbeat to become stale.
  write_text(fmt::format("#!/bin/bash\n"
                         "#SBATCH --job-name=burin-wall\n"
                         "#SBATCH --array=0-{}{}\n"
                         "#SBATCH --ntasks=1\n"
                         "#SBATCH --cpus-per-task={}\n"
                         "#SBATCH --time={}\n"
                         "{}"
                         "#SBATCH --signal=B:TERM@60\n"
                         "#SBATCH --requeue\n"
                         "#SBATCH --open-mode=append\n"
                         "#SBATCH --output={}/logs/%A-%a.txt\n"
                         "again() {{\n"
                         "  kill -TERM \"$worker\"\n"
                         "  wait \"$worker\"\n"
                         "  scontrol requeue \"${{SLURM_ARRAY_JOB_ID}}_${{SLURM_ARRAY_TASK_ID}}\"\n"
                         "  exit 0\n"
                         "}}\n"
                         "trap again TERM\n"
                         "burin --threads \"${{SLURM_CPUS_PER_TASK:-1}}\" wall work {} &\n"
                         "worker=$!\n"
                         "wait \"$worker\"\n",
                         o.workers - 1, limit, o.threads, o.time, partition, folder.string(), place),
             file);
  Report report;
  report.line("Wrote {}: {} workers of {} threads; next: sbatch {}\n", fact("file", file.string()),
              fact("workers", o.workers), fact("threads", o.threads), shell_word(file.string()));
  return report;
}

void add_slurm_of_wall(CLI::App& wall) {
  auto o = std::make_shared<SlurmArguments>();
  CLI::App* c = wall.add_subcommand("slurm", "Write a job file for Slurm: an array of workers that requeue themselves");
  c->add_option("WALL", o->folder, "Work on this wall, in a folder that all nodes share")->required();
  c->add_option("--workers", o->workers, "Start this number of workers")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  c->add_option("--at-once", o->at_once, "Run at most this number at the same time; 0: all")
      ->check(CLI::Range(0, 10000))
      ->capture_default_str();
  c->add_option("--cores", o->threads, "Give each worker this number of cores")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  c->add_option("--time", o->time, "Limit each turn of a worker, as Slurm writes it: 4:00:00")->capture_default_str();
  c->add_option("--partition", o->partition, "Use this partition [default: the cluster's]");
  c->add_option("--out", o->out, "Write this file [default: WALL/wall.sbatch]");
  c->footer(example("burin wall slurm mural --workers 40 --cores 8 --time 2:00:00"));
  c->callback([o] { print(write_slurm(*o)); });
}

// A subcommand with the wall as its only argument.
void add_simple(CLI::App& wall, const char* name, const char* words, const char* argument, const std::string& footer,
                Report (*run)(const fs::path&)) {
  auto folder = std::make_shared<fs::path>();
  CLI::App* c = wall.add_subcommand(name, words);
  c->add_option("WALL", *folder, argument)->required();
  c->footer(example(footer));
  c->callback([folder, run] { print(run(*folder)); });
}

}  // namespace

void add_wall_command(CLI::App& burin) {
  CLI::App* wall = burin.add_subcommand(
      "wall", "Make boards that hang side by side and show pictures together, on any number of computers");
  wall->require_subcommand(1);
  wall->footer(
      example("burin wall new mural --grid 4x3 --board 200x150mm --gap 3mm --pictures a.jpg b.jpg\n"
              "  burin wall work mural\n"
              "  burin wall status mural"));
  add_new_wall(*wall);
  add_simple(*wall, "lay", "Lay the boards out again after a change of wall.json", "Lay out the boards of this wall",
             "burin wall lay mural", lay_wall_anew);
  add_work_on_wall(*wall);
  add_simple(*wall, "settle", "Solve the boards' couplings from their previews; burin wall work does it by itself",
             "Solve the couplings of this wall", "burin wall settle mural", settle_wall);
  add_simple(*wall, "status", "Show the state and the worker of each board", "Show this wall",
             "burin wall status mural\n  burin --json wall status mural", wall_status);
  add_simple(*wall, "picture", "Write the pictures that all boards show together, and measure the seams",
             "Show the pictures of this wall", "burin wall picture mural", picture_of_wall);
  add_slurm_of_wall(*wall);
}

}  // namespace burin

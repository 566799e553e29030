#include "tools/new/project_files.h"

#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/base/files/json_file.h"
#include "burin/base/files/named_paths.h"
#include "burin/base/files/unfinished.h"
#include "burin/optimize/design.h"
#include "burin/optimize/design/design_output.h"
#include "burin/optimize/machine_profile.h"
#include "burin/pictures/picture.h"
#include "burin/scene/bench_of_board.h"
#include "burin/scene/scratches.h"
#include "tools/commands.h"
#include "tools/drawing/label.h"
#include "tools/loop/toml_line.h"
#include "tools/picture_quality.h"
#include "tools/progress_bar.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

// A project contains a copy of a calibrated lens; bench.json describes other lenses itself.
constexpr const char* kLensFile = "camera.cameramodel";

Json bench_json(const NewProject& project) {
  Json json;
  json["format"] = "burin/bench";
  json["version"] = 2;
  if (project.camera.cameramodel.empty())
    json["camera"] = {{"focal_35mm", project.camera.focal_35mm},
                      {"pixels", {project.camera.lens.width, project.camera.lens.height}}};
  else
    json["camera"] = kLensFile;
  json["views"] = Json::array();
  for (std::size_t k = 0; k < project.pictures.size(); ++k)
    json["views"].push_back({{"view", project.pictures[k].view}, {"eye_mm", to_json(project.bench.eyes_mm[k])}});
  json["lights"] = Json::array({Json{{"id", "lamp"}, {"position_mm", to_json(project.bench.lamp_mm)}}});
  // For cutting tools. A first design with additive light would predict more than metal can show.
  json["material"] = {{"crossings", "deepest"}};
  return json;
}

DesignSpec design_of(const NewProject& project, const fs::path& folder) {
  DesignSpec spec;
  spec.board = folder / "board.json";
  spec.bench = folder / "bench.json";
  spec.scratches = project.scratches;
  for (const ChosenPicture& p : project.pictures) {
    DesignView view;
    view.view = p.view;
    view.target.picture = folder / "targets" / p.stored;
    view.target.fit = p.fit;
    if (p.fit == Fit::cover) view.target.keep = p.keep;
    spec.views.push_back(view);
  }
  return spec;
}

// Text of loop.toml, with files relative to the project's folder.
std::string loop_toml(const NewProject& project) {
  std::string machine = project.machine;
  std::error_code ignored;
  if (fs::exists(machine, ignored))
    machine = fs::absolute(machine)
                  .lexically_normal()
                  .lexically_proximate(fs::absolute(project.folder).lexically_normal())
                  .string();
  return "# What `burin loop` makes this board with (docs/file-formats.md). grbl-spring: a tool on a spring, which "
         "rides over\n"
         "# a sheet that is not flat; its table from preload to depth is a guess until `burin coupon` has measured "
         "yours.\n"
         "format = \"burin/loop\"\nversion = 1\nmachine = " +
         Json(machine).dump() + "\n";
}

void write_into(const NewProject& project, const fs::path& folder) {
  make_output_folder(folder / "targets");
  for (const ChosenPicture& picture : project.pictures) store_picture(picture, folder / "targets");
  Board board = project.bench.board;
  board.scratches = folder / "scratches.csv";
  write_board(board, folder / "board.json");
  if (!project.camera.cameramodel.empty()) write_cameramodel(project.camera.lens, folder / kLensFile);
  write_json(bench_json(project), folder / "bench.json");
  write_text(loop_toml(project), folder / "loop.toml");
  write_picture(crop_sheet(project.pictures, board.carve_max_mm - board.carve_min_mm), folder / "crops.png");
  write_design(design_of(project, folder), folder / "design.json");
  // Reports errors of the other commands immediately.
  const DesignSpec spec = read_design(folder / "design.json");
  read_bench_of(read_board(spec.board), spec.board, spec.bench);
}

// Pixels along the longer side: few, but enough across a long board.
int preview_pixels(const Board& board) {
  constexpr double kUsual = 128, kAcross = 64, kMost = 640;
  const Eigen::Vector2d area = board.carve_max_mm - board.carve_min_mm;
  return static_cast<int>(std::clamp(kAcross * area.maxCoeff() / area.minCoeff(), kUsual, kMost));
}

// Enlarges a design's few pixels for display next to others.
Image to_look_at(const Image& image, int pictures) {
  constexpr int kLargest = 360, kSmallest = 160, kAll = 1440;
  const double scale =
      static_cast<double>(std::clamp(kAll / pictures, kSmallest, kLargest)) / std::max(image.width, image.height);
  return resized(image, std::max(1, static_cast<int>(std::lround(image.width * scale))),
                 std::max(1, static_cast<int>(std::lround(image.height * scale))));
}

// Adds names above the pictures' columns, which are `gap` apart.
Image with_names(const std::vector<Image>& names, const Image& sheet, int gap) {
  Image out(sheet.width, sheet.height + kLabelPx, sheet.channels, 0.15F);
  std::copy(sheet.data.begin(), sheet.data.end(), out.data.end() - static_cast<std::ptrdiff_t>(sheet.data.size()));
  int left = gap;
  for (const Image& name : names) {
    for (int y = 0; y < name.height; ++y)
      for (int x = 0; x < name.width; ++x)
        for (int c = 0; c < out.channels; ++c) out.at(left + x, y, c) = name.at(x, y);
    left += name.width + gap;
  }
  return out;
}

// Explains a board with some bad pictures.
Finding why_unlike(int unlike, int views, const Board& board) {
  const Eigen::Vector2d area = board.carve_max_mm - board.carve_min_mm;
  constexpr int kFew = 3;  // pictures for which any board has room
  const std::string which = fmt::format("{} of the {} pictures", unlike, views);
  if (views <= kFew)
    return make_warning(
        FindingCode::view_limit,
        fmt::format("{} can hardly be recognized in the preview", views == 1 ? "the picture" : which),
        "take pictures with large light shapes on a dark ground, a larger board (--board) or more scratches "
        "(--scratches)");
  return make_warning(
      FindingCode::view_limit,
      fmt::format("{} can hardly be recognized in the preview: {:.0f} x {:.0f} mm are small for so many", which,
                  area.x(), area.y()),
      "take a larger board (--board), or fewer pictures: one to three show most");
}

// Designs the project in `folder`, whose final name is `project`, `spent_s` after the start. Returns each view's PSNR
// in words.
std::string preview_project(const fs::path& folder, const fs::path& project, double spent_s) {
  const DesignSpec written = read_design(folder / "design.json");
  const Board board = read_board(written.board);
  const Bench bench = read_bench_of(board, written.board, written.bench);
  DesignSpec spec = written;
  const int views = static_cast<int>(spec.views.size());
  constexpr int kScratches = 1500, kMostScratches = 6000;  // per view; in total
  spec.scratches = std::min({spec.scratches, kScratches * views, kMostScratches});
  DesignOptions options;
  options.pixels = preview_pixels(board);
  options.iterations = 40;
  options.contact_frames = 0;
  options.note_few_strokes = false;                            // not for a preview
  constexpr double kWhole_s = 11, kUsual_s = 7, kLeast_s = 2;  // of fifteen seconds, on two slower cores
  options.time_limit_s = std::clamp(kWhole_s - spent_s, kLeast_s, kUsual_s);
  ProgressBar bar;
  const DesignResult result = design(spec, board, bench, options, bar.progress());
  std::vector<Image> names, shown, targets;
  std::string numbers;
  int unlike = 0;
  for (std::size_t k = 0; k < result.views.size(); ++k) {
    const DesignedView& view = result.views[k];
    shown.push_back(to_look_at(view.shown, views));
    targets.push_back(to_look_at(view.target, views));
    names.push_back(label(view.view, shown.back().width));
    const Likeness likeness = likeness_of(view.ghost, view.target_correlation, k);
    numbers += fmt::format("{}{} {:.1f} dB ({})", numbers.empty() ? "" : ", ", view.view, view.psnr_db,
                           quality_in_words(view.psnr_db, likeness));
    if (is_unlike(likeness)) ++unlike;
  }
  write_scratches(result.scratches, folder / "scratches.csv");
  write_picture(with_names(names, tiled({shown, targets}, 4), 4), folder / "preview.png");
  bar.clear();
  for (Finding finding : result.findings) {
    if (finding.file.is_absolute()) finding.file = project / finding.file.lexically_relative(folder);
    tell(finding);
  }
  if (unlike > 0) tell(why_unlike(unlike, views, board));
  const Image& picture = result.views.front().shown;
  const int px = std::max(picture.width, picture.height);
  return fmt::format(
      "{}, of {} px ({} x {} pixels, {} of {}, {:.0f} s), as from {:.2g} m; the whole design counts the {} "
      "px "
      "that eyes {:.2g} m away tell apart, where dB are fewer",
      numbers, px, picture.width, picture.height, counted(result.scratches.size(), "scratch"), written.scratches,
      result.total_seconds, result.eye_from_m * result.eye_px / px, result.eye_px, result.eye_from_m);
}

// Removes unfinished projects of ended processes: ".my-board.new-4711".
void remove_stagings_of_dead(const fs::path& parent, const std::string& begin) {
  std::error_code error;
  std::vector<fs::path> left;
  for (fs::directory_iterator entry(parent, error), end; !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (!name.starts_with(begin)) continue;
    const int process = std::atoi(name.c_str() + begin.size());
    if (process > 0 && (process == getpid() || (::kill(process, 0) != 0 && errno == ESRCH)))
      left.push_back(entry->path());
  }
  for (const fs::path& folder : left) fs::remove_all(folder, error);
}

// Renames the whole project if the folder is missing or empty. A folder that cannot be replaced (a link, a mounted
// disk, a working directory) is filled, with design.json last: a folder without it is no project.
void put_in_place(const fs::path& staging, const fs::path& folder) {
  std::error_code error;
  note_moved(staging, folder);
  fs::rename(staging, folder, error);
  if (!error) return;
  make_output_folder(folder);
  std::vector<fs::path> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(staging)) names.push_back(entry.path().filename());
  std::stable_partition(names.begin(), names.end(), [](const fs::path& name) { return name != "design.json"; });
  for (const fs::path& name : names) fs::rename(staging / name, folder / name);
  fs::remove_all(staging, error);
}

}  // namespace

void fail_unless_new(const fs::path& folder) {
  if (folder.empty()) fail("the project's folder", "has no name", "give one: my-board");
  std::error_code error;
  if (!fs::exists(folder, error)) return;
  if (!fs::is_directory(folder, error)) fail(folder.string(), "is a file", "give a folder that is not there yet");
  if (!fs::is_empty(folder, error) || error)
    fail(folder.string(), "exists and is not empty", "give a folder that is not there yet: nothing is overwritten");
}

std::string write_project(const NewProject& project) {
  fail_unless_new(project.folder);
  fs::path folder = fs::absolute(project.folder).lexically_normal();
  if (!folder.has_filename()) folder = folder.parent_path();  // "my-board/"
  make_output_folder(folder.parent_path());
  const std::string begin = fmt::format(".{}.new-", folder.filename().string());
  remove_stagings_of_dead(folder.parent_path(), begin);
  const fs::path staging = folder.parent_path() / (begin + std::to_string(getpid()));
  std::error_code error;
  const Unfinished unfinished(staging);
  const auto began = std::chrono::steady_clock::now();
  try {
    write_into(project, staging);
    const std::chrono::duration<double> writing = std::chrono::steady_clock::now() - began;
    std::string preview = preview_project(staging, project.folder, project.spent_s + writing.count());
    const auto whole = finishing();
    put_in_place(staging, folder);
    return preview;
  } catch (...) {
    fs::remove_all(staging, error);
    throw;
  }
}

}  // namespace burin

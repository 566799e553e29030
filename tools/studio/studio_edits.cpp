// Edits of the studio: pictures before a project exists, and the project's own files.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>

#include "burin/base/error.h"
#include "burin/base/files/file_error.h"
#include "burin/base/files/named_paths.h"
#include "burin/base/files/printable.h"
#include "burin/base/files/write_file.h"
#include "burin/optimize/design_file.h"
#include "burin/optimize/target.h"
#include "burin/pictures/picture.h"
#include "burin/scene/bench_of_board.h"
#include "burin/scene/board.h"
#include "tools/new/pictures.h"
#include "tools/studio/studio.h"
#include "tools/studio/studio_names.h"
#include "tools/work_lock.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMostMask_bytes = 20'000'000;
constexpr std::size_t kMostStaged = 30, kMostFormer = 100;
constexpr int kTargetSide_px = 480;
constexpr double kFarthest_mm = 20000;

// The readers of the commands judge an edited file before it takes its place.
void check_edited(const fs::path& folder, const std::string& name, const fs::path& file) {
  if (name == "design.json") {
    read_design(file);
    return;
  }
  const fs::path board = folder / "board.json";
  const Board read = read_board(board);
  const Bench bench = read_bench_of(read, board, file);
  for (const View& view : bench.views) fail_unless_sees(view, read);
  for (const Light& light : bench.lights) fail_unless_lights(light, read);
}

Json& entry_named(Json& list, const char* key, const std::string& name) {
  if (list.is_array())
    for (Json& entry : list)
      if (entry.is_object() && entry.value(key, "") == name) return entry;
  fail(printable(name), "is not in the project", "reload the page");
}

void set_view(const Json& change, Json& design) {
  Json& view = entry_named(design["views"], "view", change.value("view", ""));
  for (const char* key : {"fit", "keep"})
    if (change.contains(key)) view[key] = plain_value(change, key);
  if (change.contains("rotation_deg")) view["rotation_deg"] = number_within(change, "rotation_deg", -360, 360);
  if (change.contains("weight")) view["weight"] = number_within(change, "weight", 0.01, 100);
  if (change.contains("levels")) {
    const Json& levels = change["levels"];
    if (levels.is_null())
      view.erase("levels");
    else
      view["levels"] = levels;  // read_design() judges it
  }
  if (change.contains("mask") && change["mask"].is_null()) view.erase("mask");
}

void set_place(Json& list, const char* key, const char* place, const Json& places) {
  for (const auto& [name, at_mm] : places.items()) {
    if (!at_mm.is_array() || at_mm.size() != 3)
      fail(printable(name), "has no place of three numbers", "reload the page");
    for (const Json& value : at_mm)
      if (!value.is_number() || std::abs(value.get<double>()) > kFarthest_mm)
        fail(printable(name), "lies too far away", "move it nearer to the board");
    Json& entry = entry_named(list, key, name);
    if (!entry.contains(place))
      fail(printable(name), "was measured", "its place is a result of photos; edit bench.json by hand to change it");
    entry[place] = at_mm;
  }
}

void set_places(const Json& change, Json& bench) {
  if (change.contains("eyes")) set_place(bench["views"], "view", "eye_mm", change["eyes"]);
  if (change.contains("lamps")) set_place(bench["lights"], "id", "position_mm", change["lamps"]);
}

// Returns a picture as the bytes of a PNG.
std::string png_of(const Image& image, const fs::path& folder) {
  std::string name = (folder / ".picture-XXXXXX.png").string();
  const int fd = ::mkstemps(name.data(), 4);
  if (fd < 0) fail_with(folder.string(), "a picture cannot be prepared", errno);
  ::close(fd);
  try {
    allow_change_of(name);
    write_picture(image, name);
    std::string bytes = read_text(name);
    ::unlink(name.c_str());
    return bytes;
  } catch (...) {
    ::unlink(name.c_str());
    throw;
  }
}

}  // namespace

void Studio::keep_former(const std::string& name, const std::string& text) {
  const fs::path folder = workshop() / "former";
  make_output_folder(folder);
  std::vector<fs::path> kept;
  for (const auto& entry : fs::directory_iterator(folder)) kept.push_back(entry.path());
  std::sort(kept.begin(), kept.end());
  const int last = kept.empty() ? 0 : std::atoi(kept.back().filename().c_str());
  write_text(text, folder / fmt::format("{:06}-{}", last + 1, name));
  if (kept.size() >= kMostFormer) fs::remove(kept.front());
}

void Studio::change_file(const std::string& name, const std::function<void(Json&)>& change) {
  const fs::path file = folder_ / name;
  const WorkLock lock(folder_, "burin studio");
  const std::string former = read_text(file);
  Json json = Json::parse(former);
  const Json before = json;
  change(json);
  if (json == before) return;
  allow_change_of(file);
  write_file(json_text(json, file), file, Durability::on_disk,
             [&](const fs::path& written) { check_edited(folder_, name, written); });
  keep_former(name, former);
}

void Studio::undo() {
  const WorkLock lock(folder_, "burin studio");
  std::vector<fs::path> kept;
  std::error_code error;
  for (fs::directory_iterator entry(workshop() / "former", error), end; !error && entry != end; entry.increment(error))
    kept.push_back(entry->path());
  if (kept.empty()) fail("undo", "there is no former version", "change something first");
  const fs::path last = *std::max_element(kept.begin(), kept.end());
  const std::string name = last.filename().string().substr(last.filename().string().find('-') + 1);
  if (name != "design.json" && name != "bench.json") fail(last.string(), "is no file of a project", "remove it");
  allow_change_of(folder_ / name);
  write_file(read_text(last), folder_ / name, Durability::on_disk,
             [&](const fs::path& written) { check_edited(folder_, name, written); });
  fs::remove(last);
}

void Studio::edit(const Json& change) {
  if (!is_made()) fail("edit", "there is no board yet", "add pictures and make the board first");
  const std::string what = plain_value(change, "what");
  const std::lock_guard lock(mutex_);
  if (what == "view")
    change_file("design.json", [&](Json& design) { set_view(change, design); });
  else if (what == "place")
    change_file("bench.json", [&](Json& bench) { set_places(change, bench); });
  else if (what == "undo")
    undo();
  else
    fail("edit", "\"" + what + "\" is none of the studio's edits", "reload the page");
  looked_ = {};
  changed_.notify_all();
}

Json Studio::add_picture(const std::string& given, const UploadBody& body) {
  if (is_made())
    fail(printable(given), "comes too late: the board is made", "begin another project for other pictures");
  const std::string name = upload_name(given);
  const fs::path folder = workshop() / "pictures";
  make_output_folder(folder);
  std::error_code error;
  if (std::distance(fs::directory_iterator(folder, error), fs::directory_iterator()) >=
      static_cast<std::ptrdiff_t>(kMostStaged))
    fail(name, fmt::format("is one too many: {} pictures wait already", kMostStaged),
         "remove some; a board shows one to nine");
  const fs::path stored = store(body, kMostPicture_bytes);
  fs::path named;
  try {
    const std::lock_guard lock(pictures_mutex_);
    named = free_name(folder, name);
    fs::rename(stored, named);
    const ChosenPicture picture = choose_pictures({named}, 1).front();  // the judgment of `burin new`
    const std::lock_guard changed(mutex_);
    looked_ = {};
    changed_.notify_all();
    return {{"file", named.filename().string()},
            {"width", picture.width},
            {"height", picture.height},
            {"ground", picture.ground}};
  } catch (...) {
    fs::remove(stored, error);
    if (!named.empty()) fs::remove(named, error);
    throw;
  }
}

StudioFile Studio::thumbnail(const std::string& path) {
  const std::lock_guard lock(pictures_mutex_);
  const fs::path file = is_made() ? confined(folder_, path) : confined(workshop() / "pictures", path);
  make_output_folder(workshop());
  return {png_of(choose_pictures({file}, 1).front().small, workshop()), "image/png", false};
}

StudioFile Studio::target(const std::string& name, bool mask) {
  const std::lock_guard lock(pictures_mutex_);
  const DesignSpec spec = read_design(folder_ / "design.json");
  const auto view =
      std::find_if(spec.views.begin(), spec.views.end(), [&](const DesignView& v) { return v.view == name; });
  if (view == spec.views.end()) fail(printable(name), "is no view of this board", "reload the page");
  const Board board = read_board(spec.board);
  const Eigen::Vector2d area_mm = board.carve_max_mm - board.carve_min_mm;
  double rotation_deg = view->target.rotation_deg;
  if (view->target.upright_in_view)
    rotation_deg += viewer_rotation_deg(find_view(read_bench_of(board, spec.board, spec.bench), name, "design.json"),
                                        0.5 * (board.carve_min_mm + board.carve_max_mm));
  const double scale = kTargetSide_px / area_mm.maxCoeff();
  const Target target =
      load_target(view->target, rotation_deg, area_mm, std::max(1, static_cast<int>(scale * area_mm.x())),
                  std::max(1, static_cast<int>(scale * area_mm.y())));
  make_output_folder(workshop());
  if (mask && target.mask.data.empty()) fail(printable(name), "has no mask", "paint one first");
  return {png_of(mask ? target.mask : target.picture, workshop()), "image/png", false};
}

void Studio::set_mask(const std::string& view, const UploadBody& body) {
  if (!is_made()) fail("mask", "there is no board yet", "make the board first");
  const fs::path stored = store(body, kMostMask_bytes);
  std::error_code error;
  fs::path named;
  try {
    const std::lock_guard pictures(pictures_mutex_);
    named = free_name(folder_ / "targets", "mask-" + upload_name(view + ".png"));
    make_output_folder(folder_ / "targets");
    fs::rename(stored, named);
    const Image read = read_picture(named);  // judged before design.json names it
    const std::lock_guard lock(mutex_);
    change_file("design.json", [&](Json& design) {
      entry_named(design["views"], "view", view)["mask"] = "targets/" + named.filename().string();
    });
    looked_ = {};
    changed_.notify_all();
  } catch (...) {
    fs::remove(stored, error);
    if (!named.empty()) fs::remove(named, error);
    throw;
  }
}

}  // namespace burin

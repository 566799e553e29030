#include "tools/wall/lay_wall.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "burin/base/error.h"
#include "burin/base/files/file_names.h"
#include "burin/base/srgb.h"
#include "burin/optimize/machine_profile.h"
#include "burin/pictures/linear_picture.h"
#include "burin/pictures/picture.h"
#include "burin/scene/bench_of_board.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

constexpr const char* kWallLens = "camera.cameramodel";

// A surroundings map is a file, too.
Json light_on_board(const Json& light, const Wall& wall, const WallBoard& board) {
  Json out = light;
  if (out.is_object() && out.contains("position_mm") && out["position_mm"].is_array() &&
      out["position_mm"].size() == 3 && out["position_mm"][0].is_number() && out["position_mm"][1].is_number()) {
    out["position_mm"][0] = out["position_mm"][0].get<double>() - board.corner_mm.x();
    out["position_mm"][1] = out["position_mm"][1].get<double>() - board.corner_mm.y();
  }
  if (out.is_object() && out.contains("surroundings") && out["surroundings"].is_object() &&
      out["surroundings"].contains("picture") && out["surroundings"]["picture"].is_string())
    out["surroundings"]["picture"] =
        path_beside(wall.folder / board.name / "bench.json",
                    resolve_path(wall.folder / "wall.json", out["surroundings"]["picture"].get<std::string>()));
  return out;
}

Json bench_of_wall(const Wall& wall, const WallBoard& board) {
  Json json;
  json["format"] = "burin/bench";
  json["version"] = 2;
  json["camera"] = wall.camera.is_string() ? Json(kWallLens) : wall.camera;
  json["views"] = Json::array();
  for (const WallView& v : wall.views)
    json["views"].push_back(
        {{"view", v.name},
         {"eye_mm", {v.eye_mm.x() - board.corner_mm.x(), v.eye_mm.y() - board.corner_mm.y(), v.eye_mm.z()}}});
  json["lights"] = Json::array();
  for (const Json& light : wall.lights) json["lights"].push_back(light_on_board(light, wall, board));
  if (!wall.material.is_null()) json["material"] = wall.material;
  return json;
}

std::string machine_on_board(const Wall& wall, const WallBoard& board) {
  std::error_code ignored;
  const fs::path file = wall.folder / board.machine;
  return fs::is_regular_file(file, ignored) ? path_beside(wall.folder / board.name / "loop.toml", file) : board.machine;
}

DesignSpec design_on_board(const Wall& wall, std::size_t index) {
  const fs::path folder = wall.folder / wall.boards[index].name;
  DesignSpec spec;
  spec.board = folder / "board.json";
  spec.bench = folder / "bench.json";
  spec.scratches = std::min(preview_scratches(wall, index), 2'000'000);
  for (const WallView& v : wall.views) {
    DesignView view;
    view.view = v.name;
    view.light = v.light;
    view.weight = v.weight;
    view.target.picture = folder / "targets" / (file_name_of(view.view) + ".png");
    view.target.keep = Keep::middle;  // the part has the carve area's shape
    spec.views.push_back(view);
  }
  return spec;
}

WallArea carve_area(const Wall& wall, std::size_t index) {
  const Board board = board_of(wall, index);
  const Eigen::Vector2d corner = wall.boards[index].corner_mm;
  return {corner + board.carve_min_mm, corner + board.carve_max_mm};
}

// Everything of a board except its design.json and its targets.
void write_board_files(const Wall& wall, std::size_t index, double pitch_mm) {
  const WallBoard& on_wall = wall.boards[index];
  const fs::path folder = wall.folder / on_wall.name;
  const Board board = board_of(wall, index);
  write_board(board, folder / "board.json");
  if (wall.camera.is_string())
    copy_whole(resolve_path(wall.folder / "wall.json", wall.camera.get<std::string>()), folder / kWallLens);
  write_json(bench_of_wall(wall, on_wall), folder / "bench.json");
  // A person's own options of a board stay.
  if (fs::exists(folder / "loop.toml")) return;
  write_text(fmt::format(
                 "# A board of a wall: {}\nformat = \"burin/loop\"\nversion = 1\nmachine = {}\n[design]\npixels = {}\n",
                 "../wall.json has its place, lamps and eyes", Json(machine_on_board(wall, on_wall)).dump(),
                 pixels_of(board, pitch_mm)),
             folder / "loop.toml");
}

}  // namespace

float brightest(const Image& image) {
  return image.data.empty() ? 0 : *std::max_element(image.data.begin(), image.data.end());
}

bool LaidWall::is_blank(const std::string& board) const {
  return std::find(blank.begin(), blank.end(), board) != blank.end();
}

int preview_scratches(const Wall& wall, std::size_t index) {
  double all_mm2 = 0;
  for (const WallBoard& b : wall.boards) all_mm2 += b.size_mm.prod();
  constexpr double kScratch_s = 3;  // of a common machine; the previews give each machine's own
  const double all = wall.scratches > 0 ? wall.scratches : wall.machine_hours * 3600 / kScratch_s;
  const double share = all * wall.boards[index].size_mm.prod() / all_mm2;
  return static_cast<int>(std::max(share, 8.0 * static_cast<double>(wall.views.size())));
}

Image part_of_picture(const Image& linear, const Eigen::Vector2d& min_px, const Eigen::Vector2d& max_px, int width,
                      int height) {
  // Source pixels and their weights for one axis. A box of at least one pixel interpolates in larger pictures.
  struct Weighted {
    int at;
    float weight;
  };
  const auto boxes = [](double from, double to, int count, int size) {
    std::vector<std::vector<Weighted>> out(static_cast<std::size_t>(count));
    const double step = (to - from) / count, half = std::max(step, 1.0) / 2;
    for (int i = 0; i < count; ++i) {
      const double middle = from + (i + 0.5) * step, low = middle - half, high = middle + half;
      for (int at = std::max(0, static_cast<int>(std::floor(low))); at < std::min<double>(size, high); ++at) {
        const double cover = std::min<double>(at + 1, high) - std::max<double>(at, low);
        if (cover > 0) out[static_cast<std::size_t>(i)].push_back({at, static_cast<float>(cover / (2 * half))});
      }
    }
    return out;
  };
  const auto columns = boxes(min_px.x(), max_px.x(), width, linear.width),
             rows = boxes(min_px.y(), max_px.y(), height, linear.height);
  Image out(width, height, linear.channels);
  std::vector<float> row(static_cast<std::size_t>(linear.width) * linear.channels);
  for (int y = 0; y < height; ++y) {
    std::fill(row.begin(), row.end(), 0.0F);
    for (const Weighted& source : rows[static_cast<std::size_t>(y)])
      for (std::size_t i = 0; i < row.size(); ++i)
        row[i] += source.weight * linear.data[static_cast<std::size_t>(source.at) * row.size() + i];
    for (int x = 0; x < width; ++x)
      for (const Weighted& source : columns[static_cast<std::size_t>(x)])
        for (int c = 0; c < linear.channels; ++c)
          out.at(x, y, c) +=
              source.weight * row[static_cast<std::size_t>(source.at) * linear.channels + static_cast<std::size_t>(c)];
  }
  return out;
}

Image picture_on_board(const Image& linear, const LaidPicture& laid, const WallArea& wall, const WallArea& board) {
  const Eigen::Vector2d middle = (wall.min_mm + wall.max_mm) / 2;
  const auto at_px = [&](double x_mm, double y_mm) {
    return Eigen::Vector2d(laid.center_px.x() + (x_mm - middle.x()) / laid.mm_per_px,
                           laid.center_px.y() - (y_mm - middle.y()) / laid.mm_per_px);
  };
  const Eigen::Vector2d min_px = at_px(board.min_mm.x(), board.max_mm.y()),
                        max_px = at_px(board.max_mm.x(), board.min_mm.y()), size = max_px - min_px;
  // Sides in whole pixels whose ratio is that of the rectangle, to a hundredth of a pixel if possible.
  const double longer = std::clamp(size.maxCoeff(), 512.0, 2048.0), ratio = size.minCoeff() / size.maxCoeff();
  int best_long = static_cast<int>(longer);
  double least = 1;
  for (int n = static_cast<int>(longer); n < static_cast<int>(1.25 * longer) && least > 0.01; ++n) {
    const double off = std::abs(ratio * n - std::round(ratio * n));
    if (off >= least) continue;
    least = off;
    best_long = n;
  }
  const int best_short = std::max(1, static_cast<int>(std::lround(ratio * best_long)));
  const bool wide = size.x() >= size.y();
  Image part = part_of_picture(linear, min_px, max_px, wide ? best_long : best_short, wide ? best_short : best_long);
  for (float& v : part.data) v = linear_to_srgb(std::clamp(v, 0.0F, 1.0F));
  return part;
}

LaidWall lay_wall(const Wall& wall) {
  for (const WallBoard& b : wall.boards) {
    std::error_code ignored;
    const fs::path file = wall.folder / b.machine;
    plunge_mm(machine_profile(fs::is_regular_file(file, ignored) ? file.string() : b.machine), wall.depth_um / 1000);
  }
  LaidWall laid;
  laid.key = wall_key(wall.folder);
  const WallArea area = area_of(wall);
  std::vector<float> bright(wall.boards.size(), 0);
  for (const WallView& v : wall.views) {
    const Image linear = read_linear_picture(v.picture);
    float of_view = 0;
    const LaidPicture placed = laid_picture(linear.width, linear.height, v.fit, v.keep, 0, area.size_mm());
    for (std::size_t b = 0; b < wall.boards.size(); ++b) {
      const Image part = picture_on_board(linear, placed, area, carve_area(wall, b));
      bright[b] = std::max(bright[b], brightest(part));
      of_view = std::max(of_view, brightest(part));
      const fs::path targets = wall.folder / wall.boards[b].name / "targets";
      make_output_folder(targets);
      write_picture(part, targets / (file_name_of(v.name) + ".png"), 16);
    }
    if (of_view < kBlackTone)
      fail(v.picture.string(), "is black on all boards", "give a brighter picture, or place it otherwise (fit, keep)");
  }
  const double pitch_mm = pitch_of(wall);
  const auto settled = read_settled(wall.folder, laid.key);
  for (std::size_t b = 0; b < wall.boards.size(); ++b) {
    const std::string& name = wall.boards[b].name;
    if (bright[b] < kBlackTone) {
      laid.blank.push_back(name);
      continue;
    }
    write_board_files(wall, b, pitch_mm);
    write_design(design_on_board(wall, b), wall.folder / name / "design.json");
    if (settled) settle_design(wall, b, *settled);
    // Reports errors of the other commands immediately.
    const DesignSpec spec = read_design(wall.folder / name / "design.json");
    read_bench_of(read_board(spec.board), spec.board, spec.bench);
  }
  Json json{{"format", "burin/wall-laid"}, {"version", 1}, {"wall", laid.key}, {"blank", laid.blank}};
  write_json(json, wall.folder / "laid.json");
  return laid;
}

LaidWall read_laid(const fs::path& folder) {
  const fs::path file = folder / "laid.json";
  const std::string remedy = "lay the boards out with: burin wall lay " + folder.string();
  if (!fs::exists(file)) fail(file.string(), "is not there, so the boards are not laid out", remedy);
  const Json json = read_json(file, "burin/wall-laid", 1);
  JsonObject root(json, file.string());
  LaidWall laid;
  laid.key = root.text("wall");
  for (const Json& name : root.raw("blank")) laid.blank.push_back(name.get<std::string>());
  if (laid.key != wall_key(folder))
    fail((folder / "wall.json").string(), "was changed after its boards were laid out", remedy);
  return laid;
}

std::optional<SettledWall> read_settled(const fs::path& folder, const std::string& key) {
  const fs::path file = folder / "settled.json";
  if (!fs::exists(file)) return std::nullopt;
  const Json json = read_json(file, "burin/wall-settled", 1);
  JsonObject root(json, file.string());
  SettledWall settled;
  settled.key = root.text("wall");
  if (settled.key != key) return std::nullopt;
  for (JsonObject& view : root.objects("views")) settled.exposures.push_back(view.positive("exposure"));
  for (JsonObject& board : root.objects("boards")) settled.scratches[board.text("name")] = board.integer("scratches");
  return settled;
}

void write_settled(const Wall& wall, const LaidWall& laid, const SettledWall& settled) {
  Json json{{"format", "burin/wall-settled"}, {"version", 1}, {"wall", settled.key}};
  json["views"] = Json::array();
  for (std::size_t k = 0; k < wall.views.size(); ++k)
    json["views"].push_back({{"view", wall.views[k].name}, {"exposure", settled.exposures[k]}});
  json["boards"] = Json::array();
  for (const WallBoard& b : wall.boards)
    if (!laid.is_blank(b.name))
      json["boards"].push_back({{"name", b.name}, {"scratches", settled.scratches.at(b.name)}});
  write_json(json, wall.folder / "settled.json");
  for (std::size_t b = 0; b < wall.boards.size(); ++b)
    if (!laid.is_blank(wall.boards[b].name)) settle_design(wall, b, settled);
}

void settle_design(const Wall& wall, std::size_t index, const SettledWall& settled) {
  const std::string& name = wall.boards[index].name;
  const fs::path file = wall.folder / name / "design.json";
  DesignSpec spec = read_design(file);
  const int scratches = settled.scratches.at(name);
  bool same = spec.scratches == scratches;
  for (DesignView& v : spec.views)
    for (std::size_t k = 0; k < wall.views.size(); ++k) {
      if (v.view != wall.views[k].name) continue;
      same = same && v.exposure == settled.exposures[k];
      v.exposure = settled.exposures[k];
    }
  spec.scratches = scratches;
  if (!same) write_design(spec, file);
}

}  // namespace burin

#include "tools/wall/wall_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <set>

#include "burin/base/degrees.h"
#include "burin/base/error.h"
#include "burin/base/files/input_file.h"
#include "burin/base/files/table.h"
#include "burin/base/limits.h"
#include "burin/optimize/layout/tag_layout.h"
#include "tools/content_hash.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostBoards = 100'000;
constexpr int kTagNumbers = 2115;  // of the family tagStandard41h12

WallView read_wall_view(JsonObject& json, const fs::path& file) {
  WallView view;
  view.name = json.text("view");
  view.light = json.text("light", view.light);
  view.eye_mm = json.vec3("eye_mm");
  if (!(view.eye_mm.z() > 0))
    json.fail_field("eye_mm", "is behind the boards", "give a z above 0: the wall's z points towards the eyes");
  view.picture = resolve_path(file, json.text("picture"));
  const std::string fit = json.text("fit", "cover");
  if (fit != "cover" && fit != "contain") json.fail_field("fit", "is \"" + fit + "\"", "give \"cover\" or \"contain\"");
  view.fit = fit == "cover" ? Fit::cover : Fit::contain;
  const std::string keep = json.text("keep", "middle");
  const std::optional<Keep> named = keep_named(keep);
  if (!named)
    json.fail_field("keep", "is \"" + keep + "\"", "give \"top\", \"middle\", \"bottom\", \"left\" or \"right\"");
  view.keep = *named;
  view.weight = json.positive("weight", 1);
  json.finish();
  return view;
}

WallBoard read_wall_board(JsonObject& json) {
  WallBoard board;
  board.name = json.text("name");
  board.corner_mm = json.vec2("corner_mm");
  board.size_mm = json.vec2("size_mm");
  if (!(board.size_mm.minCoeff() > 0) || board.size_mm.maxCoeff() > limit::kBoard_mm)
    json.fail_field("size_mm", "is no size of a board", "give width and height in mm, above 0");
  board.machine = json.text("machine", "grbl-spring");
  json.finish();
  return board;
}

// Attributes of one element: name="value" or name='value'.
std::string attribute_of(const std::string& element, const std::string& name) {
  for (std::size_t at = element.find(name); at != std::string::npos; at = element.find(name, at + 1)) {
    if (at == 0 ||
        (element[at - 1] != ' ' && element[at - 1] != '\t' && element[at - 1] != '\n' && element[at - 1] != '\r'))
      continue;
    std::size_t next = at + name.size();
    while (next < element.size() && (element[next] == ' ' || element[next] == '=')) ++next;
    if (next >= element.size() || (element[next] != '"' && element[next] != '\'')) continue;
    const std::size_t end = element.find(element[next], next + 1);
    if (end != std::string::npos) return element.substr(next + 1, end - next - 1);
  }
  return "";
}

// A length of an SVG in mm; `unit_mm` is its user unit.
double svg_length_mm(const std::string& text, double unit_mm, const std::string& where) {
  const std::size_t end = std::min(text.find_first_not_of("0123456789.+-eE"), text.size());
  const std::optional<double> number = number_in(text.substr(0, end));
  const std::string unit = text.substr(end);
  const double mm = unit.empty() || unit == "px" ? unit_mm
                    : unit == "mm"               ? 1
                    : unit == "cm"               ? 10
                    : unit == "in"               ? 25.4
                                                 : 0;
  if (!number || !(mm > 0) || !std::isfinite(*number))
    fail(where, "has the length \"" + text + "\"", "give numbers, with mm, cm or in if they have a unit");
  return *number * mm;
}

}  // namespace

void check_boards(const std::vector<WallBoard>& boards, const std::string& where) {
  if (boards.empty()) fail(where, "has no boards", "give at least one");
  require_at_most(boards.size(), kMostBoards, where, "boards", "make several walls of them");
  std::set<std::string> names;
  for (const WallBoard& b : boards) {
    const bool fits = !b.name.empty() && b.name.size() <= 60 && b.name[0] != '-' &&
                      b.name.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_") ==
                          std::string::npos;
    static const std::set<std::string> kTaken{"pictures", "previews", "claims", "logs", "settle"};
    if (!fits || kTaken.contains(b.name))
      fail(where, "a board's name is \"" + b.name + "\", which cannot be its folder",
           "use letters, digits, - and _, and none of pictures, previews, claims, logs and settle");
    if (!names.insert(b.name).second) fail(where, "two boards are named " + b.name, "give each a name of its own");
  }
  // Sorted by their left edges, boards far to the right cannot overlap.
  std::vector<const WallBoard*> sorted;
  for (const WallBoard& b : boards) sorted.push_back(&b);
  std::sort(sorted.begin(), sorted.end(), [](const WallBoard* a, const WallBoard* b) {
    return a->corner_mm.x() != b->corner_mm.x() ? a->corner_mm.x() < b->corner_mm.x() : a->name < b->name;
  });
  constexpr double kTouch_mm = 1e-6;  // boards may touch
  for (std::size_t i = 0; i < sorted.size(); ++i)
    for (std::size_t k = i + 1; k < sorted.size(); ++k) {
      const WallBoard &a = *sorted[i], &b = *sorted[k];
      if (b.corner_mm.x() >= a.corner_mm.x() + a.size_mm.x() - kTouch_mm) break;
      if (b.corner_mm.y() < a.corner_mm.y() + a.size_mm.y() - kTouch_mm &&
          a.corner_mm.y() < b.corner_mm.y() + b.size_mm.y() - kTouch_mm)
        fail(where, "the boards " + a.name + " and " + b.name + " overlap", "move one of them, or make it smaller");
    }
}

Wall read_wall(const fs::path& folder) {
  const fs::path file = folder / "wall.json";
  const Json json = read_json(file, "burin/wall", 1);
  JsonObject root(json, file.string());
  root.text("format");
  root.integer("version");
  Wall wall;
  wall.folder = folder;
  if (root.has("scratches") == root.has("machine_hours"))
    root.fail_field("scratches", "and machine_hours are the two ways to limit the work",
                    "give one of them: the scratches, or the hours, of all boards together");
  if (root.has("scratches")) {
    wall.scratches = root.integer("scratches");
    if (wall.scratches < 1 || wall.scratches > 2'000'000'000)
      root.fail_field("scratches", "is " + std::to_string(wall.scratches),
                      "give 1 to 2000000000; 4000 per picture suit a board");
  } else {
    wall.machine_hours = root.positive("machine_hours");
  }
  if (root.has("tag_mm") == root.has("border_mm"))
    root.fail_field("tag_mm", "and border_mm are the two kinds of edges",
                    "give tag_mm for boards with tags, or border_mm for boards that are carved up to their edges");
  if (root.has("tag_mm")) wall.tag_mm = root.positive("tag_mm");
  if (root.has("border_mm")) {
    wall.border_mm = root.number("border_mm");
    constexpr double kLeastBorder_mm = 0.5;  // burin check carve refuses grooves whose rims run off the sheet
    if (!(wall.border_mm >= kLeastBorder_mm))
      root.fail_field("border_mm", fmt::format("is {:g}, so that grooves would run off the sheets", wall.border_mm),
                      "give 0.5 or more");
  }
  wall.depth_um = root.positive("depth_um", wall.depth_um);
  wall.face_alpha = root.positive("face_alpha", wall.face_alpha);
  wall.camera = root.raw("camera");
  wall.lights = root.raw("lights");
  if (!wall.lights.is_array() || wall.lights.empty())
    root.fail_field("lights", "is no list of lamps", "list them as in bench.json, with positions in the wall's frame");
  if (root.has("material")) wall.material = root.raw("material");
  std::set<std::string> names;
  for (JsonObject& view : root.objects("views")) {
    wall.views.push_back(read_wall_view(view, file));
    if (!names.insert(wall.views.back().name).second)
      view.fail_field("view", "\"" + wall.views.back().name + "\" is there twice", "give each view a name of its own");
  }
  if (wall.views.empty()) root.fail_field("views", "is empty", "give at least one view and its picture");
  for (JsonObject& board : root.objects("boards")) wall.boards.push_back(read_wall_board(board));
  root.finish();
  check_boards(wall.boards, file.string() + ": boards");
  return wall;
}

void write_wall(const Wall& wall) {
  const fs::path file = wall.folder / "wall.json";
  Json json;
  json["format"] = "burin/wall";
  json["version"] = 1;
  if (wall.machine_hours > 0)
    json["machine_hours"] = wall.machine_hours;
  else
    json["scratches"] = wall.scratches;
  if (wall.tag_mm > 0)
    json["tag_mm"] = wall.tag_mm;
  else
    json["border_mm"] = wall.border_mm;
  json["depth_um"] = wall.depth_um;
  json["face_alpha"] = wall.face_alpha;
  json["camera"] = wall.camera;
  json["lights"] = wall.lights;
  if (!wall.material.is_null()) json["material"] = wall.material;
  json["views"] = Json::array();
  for (const WallView& v : wall.views) {
    Json view{
        {"view", v.name}, {"light", v.light}, {"eye_mm", to_json(v.eye_mm)}, {"picture", path_beside(file, v.picture)}};
    if (v.fit == Fit::contain)
      view["fit"] = "contain";
    else
      view["keep"] = keep_name(v.keep);
    if (v.weight != 1) view["weight"] = v.weight;
    json["views"].push_back(view);
  }
  json["boards"] = Json::array();
  for (const WallBoard& b : wall.boards)
    json["boards"].push_back({{"name", b.name},
                              {"corner_mm", to_json(b.corner_mm)},
                              {"size_mm", to_json(b.size_mm)},
                              {"machine", b.machine}});
  write_json(json, file);
}

std::string wall_key(const fs::path& folder) { return content_hash(folder / "wall.json"); }

Board board_of(const Wall& wall, std::size_t index) {
  const WallBoard& on_wall = wall.boards[index];
  Board board;
  if (wall.tag_mm > 0) {
    board = board_with_tags(on_wall.size_mm, wall.tag_mm);
    const int tags = static_cast<int>(board.tags.list.size());
    const int first = static_cast<int>(index % static_cast<std::size_t>(kTagNumbers / tags)) * tags;
    for (Tag& tag : board.tags.list) tag.id += first;
  } else {
    board.size_mm = on_wall.size_mm;
    board.carve_min_mm = Eigen::Vector2d(wall.border_mm, wall.border_mm);
    board.carve_max_mm = on_wall.size_mm - board.carve_min_mm;
    if (!((board.carve_max_mm - board.carve_min_mm).minCoeff() > 0))
      fail((wall.folder / "wall.json").string() + ": border_mm", "leaves nothing of board " + on_wall.name,
           "make it smaller");
  }
  board.material.depth_um = wall.depth_um;
  board.material.base_alpha = wall.face_alpha;
  return board;
}

WallArea area_of(const Wall& wall) {
  WallArea area{{INFINITY, INFINITY}, {-INFINITY, -INFINITY}};
  for (std::size_t b = 0; b < wall.boards.size(); ++b) {
    const Board board = board_of(wall, b);
    area.min_mm = area.min_mm.cwiseMin(wall.boards[b].corner_mm + board.carve_min_mm);
    area.max_mm = area.max_mm.cwiseMax(wall.boards[b].corner_mm + board.carve_max_mm);
  }
  return area;
}

double pitch_of(const Wall& wall) {
  constexpr double kAcuity_rad = 1.5 / 60 * kDegree_rad, kMostPerStroke = 40, kUsualPerStroke = 16, kMostPixels = 512;
  const WallArea area = area_of(wall);
  const Eigen::Vector2d middle = (area.min_mm + area.max_mm) / 2;
  double distance_mm = 0, carved_mm2 = 0, longest_mm = 0;
  for (const WallView& v : wall.views)
    distance_mm +=
        (v.eye_mm - Eigen::Vector3d(middle.x(), middle.y(), 0)).norm() / static_cast<double>(wall.views.size());
  for (std::size_t b = 0; b < wall.boards.size(); ++b) {
    const Board board = board_of(wall, b);
    const Eigen::Vector2d size = board.carve_max_mm - board.carve_min_mm;
    carved_mm2 += size.prod();
    longest_mm = std::max(longest_mm, size.maxCoeff());
  }
  double pitch = std::max(kAcuity_rad * distance_mm, longest_mm / kMostPixels);
  if (wall.scratches > 0) {
    const double strokes = wall.scratches / static_cast<double>(wall.views.size());
    const double per_stroke = carved_mm2 / (pitch * pitch) / strokes;
    if (per_stroke > kMostPerStroke) pitch = std::sqrt(carved_mm2 / (kUsualPerStroke * strokes));
  }
  return pitch;
}

int pixels_of(const Board& board, double pitch_mm) {
  const double longer_mm = (board.carve_max_mm - board.carve_min_mm).maxCoeff();
  return static_cast<int>(std::clamp(std::lround(longer_mm / pitch_mm), 16L, 512L));
}

std::vector<WallBoard> grid_of_boards(int columns, int rows, const Eigen::Vector2d& board_mm, double gap_mm) {
  std::vector<WallBoard> boards;
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c)
      boards.push_back({fmt::format("r{}c{}", r + 1, c + 1),
                        {c * (board_mm.x() + gap_mm), (rows - 1 - r) * (board_mm.y() + gap_mm)},
                        board_mm,
                        ""});
  return boards;
}

std::vector<WallBoard> boards_of_drawing(const fs::path& svg) {
  const std::string text = read_bytes(svg, limit::kTomlBytes, "a drawing");
  const std::size_t root = text.find("<svg");
  if (root == std::string::npos) fail(svg.string(), "is no SVG", "draw rectangles and save them as plain SVG");
  const std::string head = text.substr(root, text.find('>', root) - root);
  double unit_mm = 1;
  const std::string width = attribute_of(head, "width"), box = attribute_of(head, "viewBox");
  if (const std::size_t last = box.find_last_of(" ,"); !width.empty() && last != std::string::npos) {
    double sizes[4] = {0, 0, 0, 0};
    const char* at = box.c_str();
    for (double& size : sizes) {
      char* end = nullptr;
      size = std::strtod(at, &end);
      at = end + (*end == ',' ? 1 : 0);
    }
    const bool has_unit = width.find_first_not_of("0123456789.+-eE") != std::string::npos && !width.ends_with("px");
    if (has_unit && sizes[2] > 0) unit_mm = svg_length_mm(width, 1, svg.string()) / sizes[2];
  }
  if (text.find("transform", root) != std::string::npos)
    fail(svg.string(), "has a transform, by which its rectangles lie elsewhere than their numbers",
         "ungroup the rectangles, or save without transforms");
  struct Rect {
    std::string name;
    double x, y, w, h;
  };
  std::vector<Rect> rects;
  double bottom = 0, left = INFINITY;
  for (std::size_t at = text.find("<rect", root); at != std::string::npos; at = text.find("<rect", at + 1)) {
    const std::string element = text.substr(at, text.find('>', at) - at);
    const auto length = [&](const char* name) {
      const std::string value = attribute_of(element, name);
      return value.empty() ? 0 : svg_length_mm(value, unit_mm, svg.string() + ": rect " + attribute_of(element, "id"));
    };
    const std::string id = attribute_of(element, "id");
    rects.push_back({id.empty() ? fmt::format("b{}", rects.size() + 1) : id, length("x"), length("y"), length("width"),
                     length("height")});
    if (!(rects.back().w > 0 && rects.back().h > 0))
      fail(svg.string(), "the rectangle " + rects.back().name + " has no width or height",
           "give it a size, or take it out");
    bottom = rects.size() == 1 ? rects[0].y + rects[0].h : std::max(bottom, rects.back().y + rects.back().h);
    left = std::min(left, rects.back().x);
  }
  const auto to_a_micrometer = [](double mm) { return std::round(mm * 1000) / 1000; };
  std::vector<WallBoard> boards;
  for (const Rect& r : rects)
    boards.push_back({r.name,
                      {to_a_micrometer(r.x - left), to_a_micrometer(bottom - r.y - r.h)},
                      {to_a_micrometer(r.w), to_a_micrometer(r.h)},
                      ""});
  check_boards(boards, svg.string());
  return boards;
}

}  // namespace burin

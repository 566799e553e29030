#include "burin/scene/board.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "burin/base/error.h"
#include "burin/base/files/input_file.h"
#include "burin/base/files/json_file.h"
#include "burin/base/limits.h"
#include "burin/scene/files/bend_json.h"
#include "burin/scene/files/material_json.h"
#include "burin/scene/files/profile_json.h"
#include "burin/scene/physical_bounds.h"

namespace burin {
namespace {

/// A number from 0 to 1, both included: albedos and reflectances.
double fraction(JsonObject& json, const std::string& key, double fallback) {
  const double v = json.number(key, fallback);
  if (v < 0 || v > 1) json.fail_field(key, "is " + Json(v).dump(), "write a number from 0 to 1");
  return v;
}

// Modules across the square of AprilTag's reported corners, modules across the whole tag with its border, and the
// number of tags: width_at_border, total_width and ncodes of AprilTag's families.
struct FamilyLayout {
  const char* name;
  int border_modules, total_modules, tags;
  /// Data reaches the edge of the paper; other families have a white border there, which neighbors may share.
  bool printed_to_edge() const { return total_modules > border_modules + 2; }
};
constexpr std::array<FamilyLayout, 9> kFamilies{{{"tag16h5", 6, 8, 30},
                                                 {"tag25h9", 7, 9, 35},
                                                 {"tag36h10", 8, 10, 2320},
                                                 {"tag36h11", 8, 10, 587},
                                                 {"tagCircle21h7", 5, 9, 38},
                                                 {"tagCircle49h12", 5, 11, 65535},
                                                 {"tagCustom48h12", 6, 10, 42211},
                                                 {"tagStandard41h12", 5, 9, 2115},
                                                 {"tagStandard52h13", 6, 10, 48714}}};

FamilyLayout layout_of(const std::string& family, const std::string& where) {
  for (const FamilyLayout& f : kFamilies)
    if (family == f.name) return f;
  std::string known;
  for (const FamilyLayout& f : kFamilies) known += (known.empty() ? "" : ", ") + std::string(f.name);
  fail(where + ".family", "\"" + family + "\" is not known", "use one of " + known);
}

TagSet read_tags(JsonObject json, const Eigen::Vector2d& size_mm) {
  TagSet tags;
  tags.family = json.text("family", tags.family);
  tags.z_mm = require_within(json, "z_mm", json.number("z_mm", tags.z_mm), 0, bound::kStanding_mm, "mm above the face");
  tags.sigma_mm = json.positive("sigma_mm", tags.sigma_mm);
  tags.white_albedo = fraction(json, "white_albedo", tags.white_albedo);
  tags.black_albedo = fraction(json, "black_albedo", tags.black_albedo);
  if (!(tags.white_albedo > tags.black_albedo))
    json.fail_field("white_albedo", "is not greater than black_albedo", "correct one of them");
  if (json.has("list")) {
    require_at_most(json.raw("list").size(), limit::kTags, json.where() + ".list", "tags",
                    "list fewer: a few dozen are enough");
    std::set<int> ids;
    const int of_family = layout_of(tags.family, json.where()).tags;
    for (JsonObject& item : json.objects("list")) {
      Tag tag;
      tag.id = item.integer("id");
      if (tag.id < 0 || tag.id >= of_family)
        item.fail_field("id", "is " + std::to_string(tag.id),
                        "write the number of a tag of " + tags.family + ", 0 to " + std::to_string(of_family - 1));
      if (!ids.insert(tag.id).second)
        item.fail_field("id", "tag " + std::to_string(tag.id) + " is listed twice", "give every tag an id of its own");
      tag.center_mm = item.vec2("center_mm");
      if ((tag.center_mm.array() < 0).any() || (tag.center_mm.array() > size_mm.array()).any())
        item.fail_field("center_mm", "lies outside of the board",
                        "write it in board coordinates, mm from the lower-left corner");
      tag.size_mm = item.positive("size_mm");
      tag.rotation_deg = item.number("rotation_deg", 0);
      item.finish();
      tags.list.push_back(tag);
    }
  }
  json.finish();
  return tags;
}

bool crosses(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c, const Eigen::Vector2d& d) {
  const auto side = [](const Eigen::Vector2d& p, const Eigen::Vector2d& q, const Eigen::Vector2d& r) {
    return (q - p).x() * (r - p).y() - (q - p).y() * (r - p).x();
  };
  return side(a, b, c) * side(a, b, d) < 0 && side(c, d, a) * side(c, d, b) < 0;
}

std::vector<Eigen::Vector2d> read_polygon(const JsonObject& json, const std::string& key, const Json& points) {
  std::vector<Eigen::Vector2d> polygon;
  const auto number = [](const Json& v) { return v.is_number() && std::isfinite(v.get<double>()); };
  if (points.is_array())
    for (const Json& p : points)
      if (p.is_array() && p.size() == 2 && number(p[0]) && number(p[1]))
        polygon.emplace_back(p[0].get<double>(), p[1].get<double>());
  if (!points.is_array() || polygon.size() != points.size() || polygon.size() < 3)
    json.fail_field(key, "is no list of at least three points", "write [[x, y], [x, y], [x, y]] in mm");
  double twice_area = 0;
  const std::size_t n = polygon.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector2d &a = polygon[i], &b = polygon[(i + 1) % n];
    twice_area += a.x() * b.y() - a.y() * b.x();
    for (std::size_t j = i + 2; j < n; ++j)
      if (crosses(a, b, polygon[j], polygon[(j + 1) % n]))
        json.fail_field(key, "crosses itself", "write the corners in order, one way round");
  }
  if (!(std::abs(twice_area) > 0)) json.fail_field(key, "has no area", "write three corners that do not lie in a line");
  return polygon;
}

KeepOut read_keep_out(JsonObject& json) {
  KeepOut place;
  place.name = json.text("name", "");
  const bool circle = json.has("center_mm"), rectangle = json.has("rect_mm"), polygon = json.has("polygon_mm");
  if (circle + rectangle + polygon != 1)
    json.fail_field("polygon_mm", "or one of the others is needed, and no more than one",
                    "write center_mm and radius_mm, or rect_mm, or polygon_mm");
  if (circle) {
    place.center_mm = json.vec2("center_mm");
    place.radius_mm = json.positive("radius_mm");
  } else if (rectangle) {
    const Eigen::MatrixXd rect = json.matrix("rect_mm", 2, 2);
    const Eigen::Vector2d low = rect.row(0).transpose(), high = rect.row(1).transpose();
    if (!(low.array() < high.array()).all())
      json.fail_field("rect_mm", "is " + to_json(rect).dump(), "write the lower-left, then the upper-right corner");
    place.polygon_mm = {low, {high.x(), low.y()}, high, {low.x(), high.y()}};
  } else {
    place.polygon_mm = read_polygon(json, "polygon_mm", json.raw("polygon_mm"));
  }
  if (json.has("height_mm"))
    place.height_mm =
        require_within(json, "height_mm", json.number("height_mm"), 0, bound::kStanding_mm, "mm above the face");
  json.finish();
  return place;
}

}  // namespace

std::array<Eigen::Vector2d, 4> tag_corners_mm(const Tag& tag) {
  const double angle = tag.rotation_deg * std::numbers::pi / 180, half = tag.size_mm / 2;
  const Eigen::Vector2d right(std::cos(angle) * half, std::sin(angle) * half), up(-right.y(), right.x());
  const Eigen::Vector2d& c = tag.center_mm;
  return {c - right - up, c + right - up, c + right + up, c - right + up};
}

namespace {

std::array<Eigen::Vector2d, 4> corners_at(const Tag& tag, double times) {
  Tag larger = tag;
  larger.size_mm *= times;
  return tag_corners_mm(larger);
}

// True if a line along a side of either square separates the two.
bool apart(const std::array<Eigen::Vector2d, 4>& a, const std::array<Eigen::Vector2d, 4>& b) {
  constexpr double kTouch_mm = 1e-6;
  for (const auto* square : {&a, &b})
    for (int k = 0; k < 2; ++k) {
      const Eigen::Vector2d axis = ((*square)[k + 1] - (*square)[k]).normalized();
      const auto range = [&](const std::array<Eigen::Vector2d, 4>& corners) {
        std::array<double, 2> out{INFINITY, -INFINITY};
        for (const Eigen::Vector2d& p : corners) {
          out[0] = std::min(out[0], axis.dot(p));
          out[1] = std::max(out[1], axis.dot(p));
        }
        return out;
      };
      const auto of_a = range(a), of_b = range(b);
      if (of_a[1] <= of_b[0] + kTouch_mm || of_b[1] <= of_a[0] + kTouch_mm) return true;
    }
  return false;
}

// Throws Error if a tag's print or border overlaps another tag's print: the detector would miss or misplace it.
void fail_if_tags_overlap(const TagSet& tags, const std::string& where) {
  if (tags.list.size() < 2) return;
  const FamilyLayout family = layout_of(tags.family, where);
  const double paper = static_cast<double>(family.total_modules) / family.border_modules,
               print = family.printed_to_edge() ? paper : 1;
  for (std::size_t i = 0; i < tags.list.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const Tag &a = tags.list[i], &b = tags.list[j];
      constexpr double kHalfDiagonal = 0.7072;
      if ((a.center_mm - b.center_mm).norm() > kHalfDiagonal * paper * (a.size_mm + b.size_mm)) continue;
      if (apart(corners_at(a, paper), corners_at(b, print)) && apart(corners_at(a, print), corners_at(b, paper)))
        continue;
      const auto mm = [](double v) { return Json(std::round(v * 100) / 100).dump(); };
      fail(where + ".list[" + std::to_string(i) + "]",
           "tag " + std::to_string(a.id) + " overlaps tag " + std::to_string(b.id) + ": with size_mm " + mm(a.size_mm) +
               " the paper of a " + tags.family + " is " + mm(paper * a.size_mm) + " mm wide",
           "move them apart, or correct size_mm: the side of the square whose corners AprilTag reports, 1/" +
               mm(paper) + " of the paper's");
    }
}

}  // namespace

KeepOut tag_paper(const Tag& tag, const std::string& family) {
  const FamilyLayout layout = layout_of(family, "tags");
  const auto corners = corners_at(tag, static_cast<double>(layout.total_modules) / layout.border_modules);
  return {"tag " + std::to_string(tag.id), {corners.begin(), corners.end()}, {0, 0}, 0};
}

Eigen::Vector2d read_board_size(JsonObject& json) {
  const Eigen::Vector2d size_mm = json.vec2("size_mm");
  if (!(size_mm.array() > 0).all())
    json.fail_field("size_mm", "is " + to_json(size_mm).dump(), "write width and height in mm, both above 0");
  if (size_mm.maxCoeff() > limit::kBoard_mm)
    json.fail_field("size_mm", "is " + to_json(size_mm).dump(),
                    "write width and height in mm, at most " +
                        with_commas(static_cast<std::uintmax_t>(limit::kBoard_mm)) + " (docs/limits.md)");
  return size_mm;
}

Board read_board(const std::filesystem::path& file) {
  const Json content = read_json(file, "burin/board", 1);
  JsonObject json(content, file.string());

  Board board;
  board.size_mm = read_board_size(json);
  board.carve_max_mm = board.size_mm;
  if (json.has("carve_mm")) {
    const Eigen::MatrixXd carve = json.matrix("carve_mm", 2, 2);
    board.carve_min_mm = carve.row(0).transpose();
    board.carve_max_mm = carve.row(1).transpose();
    if (!(board.carve_min_mm.array() < board.carve_max_mm.array()).all() || (board.carve_min_mm.array() < 0).any() ||
        (board.carve_max_mm.array() > board.size_mm.array()).any())
      json.fail_field("carve_mm", "is " + to_json(carve).dump(),
                      "write the lower-left and the upper-right corner of the carve area, within the board");
  }
  if (json.has("keep_out")) {
    require_at_most(json.raw("keep_out").size(), limit::kKeepOut, file.string() + ": keep_out", "places",
                    "join those that touch");
    for (JsonObject& place : json.objects("keep_out")) board.keep_out.push_back(read_keep_out(place));
  }
  if (json.has("tags")) {
    board.tags = read_tags(json.object("tags"), board.size_mm);
    fail_if_tags_overlap(board.tags, file.string() + ": tags");
  }
  if (json.has("scratches")) board.scratches = resolve_path(file, json.text("scratches"));
  if (json.has("tool")) {
    JsonObject tool = json.object("tool");
    board.tool_width_um = read_tool_width_um(tool, "width_um", board.tool_width_um);
    tool.finish();
  }
  board.said = {false, false, false, false};
  if (json.has("material")) {
    JsonObject material = json.object("material");
    board.material = read_material(material);
    board.said = said_material(material);
    material.finish();
  }
  if (json.has("flatness_um")) {
    board.flatness_um = json.number("flatness_um");
    if (*board.flatness_um < 0)
      json.fail_field("flatness_um", "is negative",
                      "write how far the face's highest place lies above its lowest, in um");
  }
  if (json.has("mesh")) board.mesh = resolve_path(file, json.text("mesh"));
  if (json.has("bend")) {
    if (!board.mesh.empty())
      json.fail_field("bend", "contradicts mesh: a board has one shape", "keep the one that is so");
    board.bend = read_bend(json.object("bend"), board.size_mm);
  }
  json.finish();
  return board;
}

void write_board(const Board& board, const std::filesystem::path& file) {
  Json json;
  json["format"] = "burin/board";
  json["version"] = 1;
  json["size_mm"] = to_json(board.size_mm);
  json["carve_mm"] = Json::array({to_json(board.carve_min_mm), to_json(board.carve_max_mm)});
  if (!board.keep_out.empty()) json["keep_out"] = Json::array();
  for (const KeepOut& place : board.keep_out) {
    Json item = Json::object();
    if (!place.name.empty()) item["name"] = place.name;
    if (place.polygon_mm.empty()) {
      item["center_mm"] = to_json(place.center_mm);
      item["radius_mm"] = place.radius_mm;
    } else {
      for (const Eigen::Vector2d& p : place.polygon_mm) item["polygon_mm"].push_back(to_json(p));
    }
    if (place.height_mm) item["height_mm"] = *place.height_mm;
    json["keep_out"].push_back(item);
  }
  Json& tags = json["tags"];
  tags["family"] = board.tags.family;
  tags["z_mm"] = board.tags.z_mm;
  tags["sigma_mm"] = board.tags.sigma_mm;
  tags["white_albedo"] = board.tags.white_albedo;
  tags["black_albedo"] = board.tags.black_albedo;
  tags["list"] = Json::array();
  for (const Tag& tag : board.tags.list)
    tags["list"].push_back({{"id", tag.id},
                            {"center_mm", to_json(tag.center_mm)},
                            {"size_mm", tag.size_mm},
                            {"rotation_deg", tag.rotation_deg}});
  if (!board.scratches.empty()) json["scratches"] = path_beside(file, board.scratches);
  json["tool"]["width_um"] = board.tool_width_um;
  json["material"] = {{"alpha", board.material.alpha},
                      {"depth_um", board.material.depth_um},
                      {"base_alpha", board.material.base_alpha},
                      {"f0", to_json(board.material.f0)}};
  if (!board.material.grain.none()) json["material"]["brushed"] = grain_json(board.material);
  if (!board.material.profile.is_paper()) json["material"]["profile"] = profile_json(board.material.profile);
  if (board.flatness_um) json["flatness_um"] = *board.flatness_um;
  if (!board.mesh.empty()) json["mesh"] = path_beside(file, board.mesh);
  if (board.bend) json["bend"] = bend_json(*board.bend);
  write_json(json, file);
}

}  // namespace burin

#include "burin/simulate/things_on_board.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <random>
#include <string>
#include <utility>

#include "burin/base/cell_grid.h"
#include "burin/capture/tags/tag_family.h"

namespace burin {
struct ThingsOnBoard::Thing {
  enum class Kind { tag, rectangle, ellipse, capsule } kind = Kind::rectangle;
  Eigen::Vector2d center{0, 0}, half{0, 0};  // of the box in its own frame; a capsule's: half length + radius, radius
  double cos_angle = 1, sin_angle = 0;
  double z_mm = 0;
  Coat coat;
  // Cells of a tag, row by row from the top; `coat` is the white paper.
  int cells = 0;
  double cell_mm = 0;
  std::vector<bool> black;
  Eigen::Vector3d black_albedo{0, 0, 0};
};

struct ThingsOnBoard::Bins {
  CellGrid grid;
  std::vector<std::vector<int>> lists;
  double margin_mm = 0;  // largest apparent shift of an object by its height
};

ThingsOnBoard::ThingsOnBoard(const BenchTruth& truth) : bins_(std::make_unique<Bins>()) {
  const auto turn = [](Thing& thing, double degrees) {
    thing.cos_angle = std::cos(degrees * std::numbers::pi / 180);
    thing.sin_angle = std::sin(degrees * std::numbers::pi / 180);
  };

  const TagSet& tags = truth.board.tags;
  if (!tags.list.empty()) {
    const std::string where = truth.file.string() + ": board.tags";
    const TagFamily family = make_tag_family(tags.family, where + ".family");
    for (const Tag& tag : tags.list) {
      const TagPattern pattern = tag_pattern(*family, tag.id, where + ".list");
      Thing thing;
      thing.kind = Thing::Kind::tag;
      thing.center = tag.center_mm;
      turn(thing, tag.rotation_deg);
      thing.z_mm = tags.z_mm;
      thing.cells = pattern.total_cells;
      thing.cell_mm = tag.size_mm / pattern.border_cells;
      thing.half.setConstant(thing.cells * thing.cell_mm / 2 + truth.quiet_mm);
      thing.coat.albedo.setConstant(tags.white_albedo);
      thing.coat.gloss_alpha = truth.tag_gloss_alpha;
      thing.coat.gloss_f0 = truth.tag_gloss_f0;
      thing.black_albedo.setConstant(tags.black_albedo);
      for (const std::uint8_t white : pattern.white) thing.black.push_back(white == 0);
      things_.push_back(std::move(thing));
    }
  }
  for (const ShapeOnBoard& shape : truth.shapes) {
    Thing thing;
    thing.kind = shape.ellipse ? Thing::Kind::ellipse : Thing::Kind::rectangle;
    thing.center = shape.center_mm;
    thing.half = shape.half_mm;
    turn(thing, shape.rotation_deg);
    thing.z_mm = shape.z_mm;
    thing.coat = {shape.albedo, shape.gloss_alpha, shape.gloss_f0, shape.smudge};
    things_.push_back(std::move(thing));
  }

  // Dust: more small specks than large ones; fibers are chains of capsules in a random walk.
  std::mt19937_64 random(truth.dust.seed);
  std::uniform_real_distribution<> unit;
  std::normal_distribution<> normal;
  const auto place = [&] {
    return Eigen::Vector2d(unit(random), unit(random)).cwiseProduct(truth.board.size_mm).eval();
  };
  const auto add_capsule = [&](const Eigen::Vector2d& from, const Eigen::Vector2d& to, double radius) {
    Thing thing;
    thing.kind = Thing::Kind::capsule;
    thing.center = (from + to) / 2;
    const double length = (to - from).norm();
    if (length > 0) {
      thing.cos_angle = (to - from).x() / length;
      thing.sin_angle = (to - from).y() / length;
    }
    thing.half = {length / 2 + radius, radius};
    thing.coat.albedo = truth.dust.albedo;
    things_.push_back(std::move(thing));
  };
  for (int i = 0; i < truth.dust.specks; ++i) {
    const Eigen::Vector2d p = place();
    const double radius = truth.dust.smallest_mm *
                          std::pow(truth.dust.largest_mm / truth.dust.smallest_mm, unit(random) * unit(random)) / 2;
    add_capsule(p, p, radius);
  }
  for (int i = 0; i < truth.dust.fibers; ++i) {
    Eigen::Vector2d p = place();
    double angle = 2 * std::numbers::pi * unit(random);
    const double radius = 0.02 + 0.02 * unit(random), bend = 0.4 * normal(random);
    const int pieces = 8 + static_cast<int>(12 * unit(random));
    for (int k = 0; k < pieces; ++k) {
      const Eigen::Vector2d next = p + 0.6 * Eigen::Vector2d(std::cos(angle), std::sin(angle));
      add_capsule(p, next, radius);
      p = next;
      angle += 0.3 * bend + 0.15 * normal(random);
    }
  }

  const CellGrid grid = bins_->grid = cell_grid(truth.board.size_mm, 4);
  bins_->lists.resize(grid.cells());
  double highest = 0;
  for (int i = static_cast<int>(things_.size()) - 1; i >= 0; --i) {  // top first
    const Thing& thing = things_[i];
    highest = std::max(highest, std::abs(thing.z_mm));
    const double reach = thing.half.norm();
    for (int y = grid.row(thing.center.y() - reach); y <= grid.row(thing.center.y() + reach); ++y)
      for (int x = grid.column(thing.center.x() - reach); x <= grid.column(thing.center.x() + reach); ++x)
        bins_->lists[grid.cell(x, y)].push_back(i);
  }
  bins_->margin_mm = 4 * highest;  // a view flatter than 14 degrees would see further under
}

ThingsOnBoard::~ThingsOnBoard() = default;

void ThingsOnBoard::near(const Eigen::Vector2d& min_mm, const Eigen::Vector2d& max_mm, std::vector<int>& found) const {
  found.clear();
  const Eigen::Vector2d low = min_mm.array() - bins_->margin_mm, high = max_mm.array() + bins_->margin_mm;
  const CellGrid& grid = bins_->grid;
  const int x0 = grid.column(low.x()), x1 = grid.column(high.x());
  const int y0 = grid.row(low.y()), y1 = grid.row(high.y());
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x)
      for (const int i : bins_->lists[grid.cell(x, y)]) {
        const Thing& thing = things_[i];
        const double reach = thing.half.norm();
        if (thing.center.x() + reach >= low.x() && thing.center.x() - reach <= high.x() &&
            thing.center.y() + reach >= low.y() && thing.center.y() - reach <= high.y())
          found.push_back(i);
      }
  if (x0 == x1 && y0 == y1) return;
  std::sort(found.begin(), found.end(), std::greater<>());
  found.erase(std::unique(found.begin(), found.end()), found.end());
}

double ThingsOnBoard::z_mm(int thing) const { return things_[thing].z_mm; }

bool ThingsOnBoard::at(int index, double x_mm, double y_mm, Coat& coat) const {
  const Thing& thing = things_[index];
  const double dx = x_mm - thing.center.x(), dy = y_mm - thing.center.y();
  const double x = thing.cos_angle * dx + thing.sin_angle * dy, y = thing.cos_angle * dy - thing.sin_angle * dx;
  if (std::abs(x) > thing.half.x() || std::abs(y) > thing.half.y()) return false;
  switch (thing.kind) {
    case Thing::Kind::ellipse: {
      const double u = x / thing.half.x(), v = y / thing.half.y();
      if (u * u + v * v > 1) return false;
      break;
    }
    case Thing::Kind::capsule: {
      const double beyond = std::max(0.0, std::abs(x) - (thing.half.x() - thing.half.y()));
      if (beyond * beyond + y * y > thing.half.y() * thing.half.y()) return false;
      break;
    }
    default:
      break;
  }
  coat = thing.coat;
  if (thing.kind == Thing::Kind::tag) {
    const int column = static_cast<int>(std::floor(x / thing.cell_mm + thing.cells / 2.0));
    const int row = static_cast<int>(std::floor(thing.cells / 2.0 - y / thing.cell_mm));
    if (column >= 0 && column < thing.cells && row >= 0 && row < thing.cells &&
        thing.black[static_cast<std::size_t>(row) * thing.cells + column])
      coat.albedo = thing.black_albedo;
  }
  return true;
}

}  // namespace burin

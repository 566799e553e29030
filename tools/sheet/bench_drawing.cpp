#include "tools/sheet/bench_drawing.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace burin {
namespace {

// Returns the page's right and up directions.
Eigen::Matrix<double, 2, 3> axes_of(Projection projection) {
  Eigen::Matrix<double, 2, 3> m = Eigen::Matrix<double, 2, 3>::Zero();
  switch (projection) {
    case Projection::table_above:
    case Projection::wall_front:
      m(0, 0) = m(1, 1) = 1;
      break;
    case Projection::table_front:
      m(0, 0) = m(1, 2) = 1;
      break;
    case Projection::wall_above:
      m(0, 0) = 1, m(1, 2) = -1;
      break;
    case Projection::wall_side:
      m(0, 2) = m(1, 1) = 1;
      break;
  }
  return m;
}

struct Box {
  Eigen::Vector2d low, high;
};

double shared_area(const Box& a, const Box& b) {
  const Eigen::Vector2d d = a.high.cwiseMin(b.high) - a.low.cwiseMax(b.low);
  return std::max(0.0, d.x()) * std::max(0.0, d.y());
}

Box grown(const Box& box, double by) {
  return {box.low - Eigen::Vector2d::Constant(by), box.high + Eigen::Vector2d::Constant(by)};
}

// Places labels one after the other, so that they cover no other label and no dot and stay on the drawing.
struct LabelRoom {
  Box page;
  std::vector<Box> dots, labels;
  std::vector<Eigen::Vector2d> lines;      // points of lines that labels should not cover
  std::vector<Eigen::Vector2d> leaders{};  // points of leader lines to labels
  Box board;

  double badness(const Box& box) const {
    const double area = (box.high - box.low).prod();
    double bad = 1000 * (area - shared_area(box, page));
    for (const Box& label : labels) bad += 1000 * shared_area(grown(box, 0.4), label);
    for (const Box& dot : dots) bad += 300 * shared_area(box, dot);
    for (const Eigen::Vector2d& p : lines)
      if ((p.array() > box.low.array()).all() && (p.array() < box.high.array()).all()) bad += 0.8;
    return bad + 2 * shared_area(box, board);
  }

  // Returns points of the leader line from a dot to its label, half a millimeter apart.
  static std::vector<Eigen::Vector2d> leader(const Eigen::Vector2d& dot, const Box& box) {
    const Eigen::Vector2d way = dot.cwiseMax(box.low).cwiseMin(box.high) - dot;
    std::vector<Eigen::Vector2d> points;
    for (int k = 0; 0.5 * k < way.norm(); ++k) points.emplace_back(dot + 0.5 * k / way.norm() * way);
    return points;
  }

  // Counts the points of leader lines within labels: of the new line in existing labels, and the reverse.
  double crossed(const Eigen::Vector2d& dot, const Box& box) const {
    const auto within = [](const Eigen::Vector2d& p, const Box& label) {
      return (p.array() > label.low.array()).all() && (p.array() < label.high.array()).all();
    };
    double count = 0;
    for (const Eigen::Vector2d& p : leader(dot, box))
      for (const Box& label : labels) count += within(p, label);
    for (const Eigen::Vector2d& p : leaders) count += within(p, box);
    return count;
  }

  Box place(const Eigen::Vector2d& dot, double width, double height) {
    Box best{dot, dot};
    double least = INFINITY;
    constexpr int kAngles = 24;
    for (const double reach : {2.0, 4.0, 7.0, 11.0, 16.0, 22.0, 30.0, 40.0})
      for (int i = 0; i < kAngles; ++i) {
        const double a = 2 * std::numbers::pi * i / kAngles;
        const Eigen::Vector2d toward(std::cos(a), std::sin(a)), half(width / 2, height / 2);
        const Eigen::Vector2d center = dot + reach * toward + toward.cwiseProduct(half);
        const Box box{center - half, center + half};
        // Labels at the side are easier to read than labels above or below.
        const double bad = badness(box) + 10 * crossed(dot, box) + reach + 0.8 * std::abs(toward.y());
        if (bad < least) {
          least = bad;
          best = box;
        }
      }
    const std::vector<Eigen::Vector2d> line = leader(dot, best);
    leaders.insert(leaders.end(), line.begin(), line.end());
    labels.push_back(best);
    return best;
  }
};

// Returns a length of 1, 2 or 5 times a power of ten, at most a quarter of the argument.
double ruler_length(double shown_mm) {
  const double wanted = shown_mm / 4, power = std::pow(10, std::floor(std::log10(wanted)));
  return power * (wanted >= 5 * power ? 5 : wanted >= 2 * power ? 2 : 1);
}

std::string length_text(double mm) {
  return mm >= 1000 ? fmt::format("{:g} m", mm / 1000) : fmt::format("{:g} mm", mm);
}

void add_star(Drawing& drawing, const Eigen::Vector2d& c, double radius) {
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i < 16; ++i) {
    const double r = i % 2 == 0 ? radius : 0.45 * radius, a = i * std::numbers::pi / 8;
    points.emplace_back(c.x() + r * std::cos(a), c.y() + r * std::sin(a));
  }
  add_polygon(drawing, std::move(points), Tint::lamp);
}

// The visible part of bench and room, right and up, mm, and its place on the drawing.
struct Frame {
  Eigen::Matrix<double, 2, 3> axes;
  Eigen::Vector2d low{0, 0}, high{0, 0};
  double scale = 1;
  Eigen::Vector2d origin{0, 0};
  bool floor_cut = false;  // further down than the drawing has room

  Eigen::Vector2d at(const Eigen::Vector2d& p) const {
    return {origin.x() + scale * (p.x() - low.x()), origin.y() + scale * (high.y() - p.y())};
  }
  Eigen::Vector2d at(const Eigen::Vector3d& p) const { return at(Eigen::Vector2d(axes * p)); }
};

constexpr double kPad_mm = 5;

Frame frame_of(const Board& board, const std::vector<SheetPlace>& places, Projection projection, double width_mm,
               double most_height_mm, double floor_y) {
  Frame frame;
  frame.axes = axes_of(projection);
  const auto include = [&](const Eigen::Vector2d& p) {
    frame.low = frame.low.cwiseMin(p);
    frame.high = frame.high.cwiseMax(p);
  };
  include(frame.axes * Eigen::Vector3d(board.size_mm.x(), board.size_mm.y(), 0));
  for (const SheetPlace& place : places) {
    const Eigen::Vector2d p = frame.axes * place.at_mm;
    include(p);
    for (const Eigen::Vector2d& d : tolerance_outline(board, place, projection)) include(p + d);
  }
  if (projection == Projection::wall_side) {
    constexpr double kMostTimes = 2.5;  // limit beyond which all else would be too small
    const double without = std::max((frame.high - frame.low).maxCoeff(), 1.0);
    frame.floor_cut = frame.high.y() - floor_y > kMostTimes * without;
    include({0, frame.floor_cut ? frame.low.y() - 0.15 * without : floor_y});
  }
  const double around = 0.04 * (frame.high - frame.low).maxCoeff();
  frame.low -= Eigen::Vector2d::Constant(around);
  frame.high += Eigen::Vector2d::Constant(around);
  const Eigen::Vector2d size = frame.high - frame.low;
  frame.scale = std::min((width_mm - 2 * kPad_mm) / size.x(), (most_height_mm - 2 * kPad_mm) / size.y());
  frame.origin = {(width_mm - frame.scale * size.x()) / 2, kPad_mm};
  return frame;
}

// Draws the table's top, the wall and the floor.
void draw_room(Drawing& drawing, const Frame& frame, Projection projection, double width, double text, double floor_y) {
  const Pen pen{Tint::soft, 0.3, 0};
  const auto words = [&](const Eigen::Vector2d& at, const std::string& what, Anchor anchor) {
    add_words(drawing, {.at_mm = at, .text = what, .size_mm = 0.85 * text, .tint = Tint::soft, .anchor = anchor});
  };
  const Eigen::Vector2d zero = frame.at(Eigen::Vector3d(0, 0, 0));
  if (projection == Projection::table_front || projection == Projection::wall_above) {
    add_line(drawing, {1, zero.y()}, {width - 1, zero.y()}, pen);
    words({1, zero.y() + (projection == Projection::table_front ? 1.1 * text : -0.4 * text)},
          projection == Projection::table_front ? "table" : "wall", Anchor::start);
  }
  if (projection != Projection::wall_side) return;
  const double bottom = frame.at(Eigen::Vector2d(0, frame.low.y())).y();
  const double floor = frame.floor_cut ? bottom : frame.at(Eigen::Vector2d(0, floor_y)).y();
  add_line(drawing, {zero.x(), 1}, {zero.x(), floor}, pen);
  words({zero.x() + 0.5 * text, 1 + 0.9 * text}, "wall", Anchor::start);
  Pen ground = pen;
  if (frame.floor_cut) ground.dash_mm = 1.5;
  add_line(drawing, {zero.x(), floor}, {width - 1, floor}, ground);
  words({width - 1, floor - 0.5 * text},
        frame.floor_cut ? fmt::format("floor {:.0f} mm below the board's lower edge, not to scale", -floor_y) : "floor",
        Anchor::end);
}

}  // namespace

std::vector<Eigen::Vector2d> tolerance_outline(const Board& board, const SheetPlace& place, Projection projection) {
  // Directions as in burin/optimize/design/tolerance.h.
  const Eigen::Vector2d middle = (board.carve_min_mm + board.carve_max_mm) / 2;
  const Eigen::Vector3d depth = (place.at_mm - Eigen::Vector3d(middle.x(), middle.y(), 0)).normalized();
  const Eigen::Vector3d level = Eigen::Vector3d::UnitZ().cross(depth);
  const Eigen::Vector3d sideways = level.norm() > 1e-6 ? level.normalized() : Eigen::Vector3d::UnitX();
  Eigen::Matrix3d half;  // half axes of the ellipsoid
  half << place.tolerance.sideways.least() * sideways, place.tolerance.up.least() * depth.cross(sideways),
      place.tolerance.depth.least() * depth;
  const Eigen::Matrix<double, 2, 3> seen = axes_of(projection) * half;
  // The outline's extent in direction u is sqrt(u^T M u), M = seen seen^T. The outline is the root of M times the unit
  // circle.
  const Eigen::Matrix2d M = seen * seen.transpose();
  // The root of a 2 x 2 matrix follows from Cayley and Hamilton: root^2 - trace(root) root + det(root) = 0. For an
  // ellipsoid seen edge on, the determinant may round below 0.
  const double det_root = std::sqrt(std::max(0.0, M.determinant()));
  const Eigen::Matrix2d root =
      (M + det_root * Eigen::Matrix2d::Identity()) / std::sqrt(std::max(1e-300, M.trace() + 2 * det_root));
  std::vector<Eigen::Vector2d> out;
  constexpr int kPoints = 48;
  for (int i = 0; i < kPoints; ++i) {
    const double a = 2 * std::numbers::pi * i / kPoints;
    out.emplace_back(root * Eigen::Vector2d(std::cos(a), std::sin(a)));
  }
  return out;
}

BenchDrawing bench_drawing(const Board& board, const std::vector<SheetPlace>& places, Projection projection,
                           double width_mm, double most_height_mm, double text_mm, double hang_height_mm) {
  const double floor_y = board.size_mm.y() / 2 - hang_height_mm;
  const Frame frame = frame_of(board, places, projection, width_mm, most_height_mm, floor_y);
  const double ruler_strip = 2.2 * text_mm;
  BenchDrawing out;
  out.scale = frame.scale;
  Drawing& drawing = out.drawing;
  const double foot = 2 * frame.origin.y() + frame.scale * (frame.high - frame.low).y();
  drawing.size_mm = {width_mm, foot + ruler_strip};

  std::vector<Eigen::Vector2d> lines;
  for (const SheetPlace& place : places) {
    std::vector<Eigen::Vector2d> outline = tolerance_outline(board, place, projection);
    const Eigen::Vector2d center = frame.axes * place.at_mm;
    for (Eigen::Vector2d& p : outline) p = frame.at(Eigen::Vector2d(center + p));
    lines.insert(lines.end(), outline.begin(), outline.end());
    add_polygon(drawing, outline, Tint::reach, {place.lamp ? Tint::lamp : Tint::eye, 0.15, 0});
  }
  draw_room(drawing, frame, projection, width_mm, text_mm, floor_y);
  const Eigen::Vector3d corner(board.size_mm.x(), board.size_mm.y(), 0);
  const Eigen::Vector2d a = frame.at(Eigen::Vector3d(0, 0, 0)), b = frame.at(corner);
  LabelRoom room{
      {{0.5, 0.5}, {width_mm - 0.5, foot - 0.5}}, {}, {}, std::move(lines), {}, {a.cwiseMin(b), a.cwiseMax(b)}};
  if ((b - a).cwiseAbs().minCoeff() > 0.5)
    add_rectangle(drawing, a, b, Tint::board, {Tint::ink, 0.3, 0});
  else
    add_line(drawing, a, b, {Tint::ink, 1.2, 0});

  const Eigen::Vector2d middle = frame.at(Eigen::Vector3d(board.size_mm.x() / 2, board.size_mm.y() / 2, 0));
  for (const SheetPlace& place : places) {
    out.places.push_back(frame.at(place.at_mm));
    add_line(drawing, out.places.back(), middle, {place.lamp ? Tint::lamp : Tint::eye, 0.15, place.lamp ? 1.2 : 0.0});
    const double length = (middle - out.places.back()).norm();
    for (int along = 2; along < length; ++along)
      room.lines.emplace_back(out.places.back() + along / length * (middle - out.places.back()));
    const Eigen::Vector2d half(1.6, 1.6);
    room.dots.push_back({out.places.back() - half, out.places.back() + half});
  }
  constexpr std::size_t kLongest = 22;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const SheetPlace& place = places[i];
    const Eigen::Vector2d& dot = out.places[i];
    std::string text = place.label + " " + place.name;
    if (place.label == place.name) text = place.name;
    if (text.size() > kLongest) text = place.label;
    const double text_width = words_width_mm(text, text_mm, true);
    const Box box = room.place(dot, text_width, 1.1 * text_mm);
    const Eigen::Vector2d nearest = dot.cwiseMax(box.low).cwiseMin(box.high);
    if ((nearest - dot).norm() > 3.5) add_line(drawing, dot, nearest, {Tint::faint, 0.2, 0});
    if (place.lamp)
      add_star(drawing, dot, 2);
    else
      add_circle(drawing, dot, 1.1, Tint::eye);
    add_words(drawing, {.at_mm = (box.low + box.high) / 2,
                        .text = text,
                        .size_mm = text_mm,
                        .tint = place.lamp ? Tint::lamp : Tint::eye,
                        .anchor = Anchor::middle,
                        .bold = true,
                        .centered = true});
  }
  const double ruler = ruler_length((width_mm - 2 * kPad_mm) / frame.scale), length = ruler * frame.scale;
  const Eigen::Vector2d end(width_mm - 1, foot + 0.4 * text_mm);
  add_line(drawing, end - Eigen::Vector2d(length, 0), end, {Tint::soft, 0.6, 0});
  add_words(drawing, {.at_mm = end + Eigen::Vector2d(-length / 2, 1.2 * text_mm),
                      .text = length_text(ruler),
                      .size_mm = 0.85 * text_mm,
                      .tint = Tint::soft,
                      .anchor = Anchor::middle});
  return out;
}

}  // namespace burin

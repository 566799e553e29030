#include "burin/optimize/design/color_views.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "burin/base/degrees.h"
#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/optimize/loss/color_metrics.h"
#include "burin/optimize/white.h"
#include "burin/scene/far_light.h"

namespace burin {
namespace {

constexpr double kOneColor_rad = 1 * kDegree_rad;  // lights at a smaller angle have one color

std::vector<Light> one_by_one(const Light& light) {
  std::vector<Light> all{light};
  all.insert(all.end(), light.also.begin(), light.also.end());
  all.front().also.clear();
  all.front().id = light_names(light.id).front();
  return all;
}

// Gray is the mean of three channels: this channel counts three times, the others not at all.
Eigen::Vector3d channel_alone(const Eigen::Vector3d& rgb, const LightPart& part) {
  if (part.channel < 0) return rgb;
  Eigen::Vector3d out(0, 0, 0);
  out[part.channel] = 3 * part.gain * rgb[part.channel];
  return out;
}

double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

// Amounts, none negative, of the colors that come closest to a light. Coordinate descent reaches the optimum, because
// the sum of squares is convex and each bound concerns one coordinate.
Eigen::Vector3d nearest_light(const Eigen::Vector3d& wanted, const LampColors& colors, std::vector<double>& amounts) {
  constexpr int kSteps = 60;
  constexpr double kStill = 1e-6;
  std::fill(amounts.begin(), amounts.end(), 0.0);
  Eigen::Vector3d rest = wanted;
  for (int step = 0; step < kSteps; ++step) {
    double moved = 0;
    for (std::size_t l = 0; l < colors.size(); ++l) {
      const double now = std::max(0.0, amounts[l] + colors[l].dot(rest));  // colors have length 1
      rest -= (now - amounts[l]) * colors[l];
      moved = std::max(moved, std::abs(now - amounts[l]));
      amounts[l] = now;
    }
    if (moved < kStill) break;
  }
  return wanted - rest;
}

}  // namespace

Light part_of(const Light& light, const LightPart& part, Eigen::Vector3d& ambient) {
  if (part.channel < 0 && part.only.empty()) return light;
  std::vector<Light> kept;
  for (Light& one : one_by_one(light)) {
    if (!part.only.empty() && one.id != part.only) continue;
    one.intensity = channel_alone(one.intensity, part);
    if (one.intensity.maxCoeff() > 0) kept.push_back(std::move(one));
  }
  ambient = channel_alone(ambient, part);
  if (kept.empty()) {
    kept.push_back(one_by_one(light).front());
    kept.front().intensity.setZero();
  }
  Light out = kept.front();
  out.also.assign(kept.begin() + 1, kept.end());
  return out;
}

std::vector<std::string> lights_served(const DesignView& view) {
  return view.color ? light_names(view.light) : std::vector<std::string>{view.light};
}

std::vector<GlintView> glints_served(const DesignView& view, const Bench& bench) {
  if (!view.color) return {glint_of(view, bench)};
  std::vector<GlintView> out;
  for (const std::string& id : lights_served(view)) {
    DesignView one = view;
    one.light = id;
    out.push_back(glint_of(one, bench));
    out.back().name += " under " + id;
  }
  return out;
}

void require_light(const DesignView& view, const Bench& bench) {
  for (const std::string& id : lights_served(view))
    if (view.color && !(find_light(bench, id, "design").intensity.maxCoeff() > 0))
      fail("view " + view.view,
           "is to be shown in color under light " + id + ", which has no light: its intensity is 0",
           "leave it out of the view's \"lights\", or give it an \"intensity\" in the bench");
}

Eigen::Vector3d paper_light(const Light& light, const Board& board) {
  const Eigen::Vector2d middle = (board.carve_min_mm + board.carve_max_mm) / 2;
  Eigen::Vector3d sum(0, 0, 0);
  for (const Light& one : one_by_one(light)) {
    if (one.far) {
      sum += one.far->is_sun()
                 ? Eigen::Vector3d(std::max(0.0, one.far->direction.z()) * one.intensity)
                 : irradiance(*one.far->surroundings, Eigen::Vector3d::UnitZ()).cwiseProduct(one.intensity);
      continue;
    }
    const Eigen::Vector3d way = one.position_mm - Eigen::Vector3d(middle.x(), middle.y(), 0);
    const double distance = way.norm(), beam = std::max(0.0, -one.axis.dot(way) / distance);
    const double spot = one.falloff_exponent == 0 ? 1 : std::pow(beam, one.falloff_exponent);
    sum += spot * std::max(0.0, way.z()) / (distance * distance * distance) * one.intensity;
  }
  return sum;
}

Eigen::Vector3d white_gains(const DesignView& view, const Board& board, const Bench& bench) {
  constexpr double kNone = 1e-4;  // of the brightest channel
  const Light light = find_light(bench, view.light, "design");
  const Eigen::Vector3d paper =
      paper_light(light, board) + std::numbers::pi * bench.ambient.cwiseMax(Eigen::Vector3d::Zero());
  Eigen::Vector3d brightest(0, 0, 0);
  for (const Light& one : one_by_one(light)) brightest = brightest.cwiseMax(paper_light(one, board));
  for (int c = 0; c < 3; ++c)
    if (!(brightest[c] > kNone * brightest.maxCoeff()))
      fail("view " + view.view,
           "is to be shown in color, and none of its lights (" + view.light + ") has any " +
               kChannelNames[static_cast<std::size_t>(c)],
           std::string("add a light with ") + kChannelNames[static_cast<std::size_t>(c)] +
               " to its \"lights\", or leave out \"color\" to show it in gray");
  const Eigen::Vector3d white = view.white.kind == White::Kind::light ? view.white.rgb : paper;
  if (view.white.kind == White::Kind::light && !can_be_white(white))
    fail("view " + view.view, "asks for a white that lacks a color, or has a thousand times less of it than of another",
         "give the light [r, g, b] that is to look white, as [1, 0.9, 0.7]");
  const Eigen::Vector3d gains = white.cwiseInverse();
  const Eigen::Vector3d luminance(0.2126, 0.7152, 0.0722);  // Rec. 709, as in burin::luminance
  return paper.mean() / luminance.dot(gains.cwiseProduct(paper)) * gains;
}

std::vector<Image> nearest_mixed(const std::vector<const Image*>& target, const LampColors& colors) {
  LampColors unit;
  for (const Eigen::Vector3d& color : colors)
    if (color.norm() > 0) unit.push_back(color.normalized());
  std::vector<Image> out;
  out.reserve(target.size());
  for (const Image* one : target) out.push_back(*one);
  std::vector<double> amounts(unit.size());
  for (std::size_t i = 0; i < out.front().data.size(); ++i) {
    Eigen::Vector3d light;
    for (std::size_t c = 0; c < 3; ++c) light[static_cast<Eigen::Index>(c)] = std::pow(target[c]->data[i], 2.2);
    const Eigen::Vector3d mixed = nearest_light(light, unit, amounts);
    for (std::size_t c = 0; c < 3; ++c)
      out[c].data[i] = static_cast<float>(std::pow(std::clamp(mixed[static_cast<Eigen::Index>(c)], 0.0, 1.0), 1 / 2.2));
  }
  return out;
}

std::vector<Finding> check_colors(const DesignView& view, const LampColors& colors,
                                  const std::vector<const Image*>& target, const Image& mask,
                                  const std::vector<Image>& nearest) {
  constexpr double kFair_db = 30;
  double widest = 0;
  for (const Eigen::Vector3d& a : colors)
    for (const Eigen::Vector3d& b : colors)
      if (a.norm() > 0 && b.norm() > 0) widest = std::max(widest, angle_between(a, b));
  if (widest < kOneColor_rad)
    fail(
        "view " + view.view,
        "is to be shown in color, and " + (colors.size() == 1 ? "has one light alone (" + view.light + ")"
                                                              : "all its lights (" + view.light + ") are of one color"),
        "name several of different colors at different places, \"lights\": [\"red\", \"green\", \"blue\"], or leave "
        "out \"color\" to show it in gray; photos determine lamps' colors if they are in color, one lamp "
        "each");
  const double db =
      color_psnr_db(in_color(nearest[0], nearest[1], nearest[2]), in_color(*target[0], *target[1], *target[2]), mask);
  if (db >= kFair_db) return {};
  return {make_warning(FindingCode::colors_mixed,
                       "view " + view.view + ": its lights (" + view.light +
                           ") cannot mix all colors of the picture: the nearest that they can is " + fixed(db, 1) +
                           " dB from it",
                       "add a light of what is missing, or take lights of purer colors")};
}

std::vector<Finding> check_gray(const DesignView& view, const Bench& bench) {
  if (view.color) return {};
  double widest = 0;
  const std::vector<Light> lights = one_by_one(find_light(bench, view.light, "design"));
  for (const Light& a : lights)
    for (const Light& b : lights) widest = std::max(widest, angle_between(a.intensity, b.intensity));
  constexpr double kPlain = 0.5;  // radians: red and green are pi / 2 apart
  if (widest < kPlain) return {};
  return {{FindingCode::colors_mixed, Finding::Severity::note, "design",
           "view " + view.view + ": its lights (" + view.light +
               ") differ in color, and its picture is shown in gray, by all of them together",
           "add \"color\": true to it to have the picture in color"}};
}

}  // namespace burin

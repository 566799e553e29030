#include "burin/optimize/design/glint_check.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "burin/base/degrees.h"
#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/optimize/design/collisions.h"
#include "burin/scene/steepest_lean.h"

namespace burin {
namespace {

std::string degrees(double radians) { return fixed(radians / kDegree_rad, 1); }
std::string number(double value) { return general(value, 3); }

// Whether scratches of any direction glint.
bool near_mirror(double lean, double alpha) { return std::sin(lean) < 3 * alpha; }

// Coverage of a view's lobe by a board's grooves.
struct Reached {
  double least_lean = std::numbers::pi / 2, most_lean = 0;  // tilt of h over the area
  double shallowest = std::numbers::pi / 2, steepest = 0;   // cutoff angle of the grooves over the area
  double best = 0;                                          // largest covered lobe fraction
  double dark = 0;    // share of the area with a covered lobe fraction below one half
  double mirror = 0;  // share of the area with too little tilt of h for a distinct direction
};

Reached reached_over(const GlintView& view, const Eigen::Vector2d& min_mm, const Eigen::Vector2d& max_mm,
                     double width_um, const GrooveAt& groove_at) {
  constexpr int kPoints = 9;  // lattice points along each side of the area
  Reached out;
  int dark = 0, mirror = 0;
  for (int j = 0; j < kPoints; ++j)
    for (int i = 0; i < kPoints; ++i) {
      const double fx = (i + 0.5) / kPoints, fy = (j + 0.5) / kPoints;
      const Eigen::Vector2d p(min_mm.x() + fx * (max_mm.x() - min_mm.x()), min_mm.y() + fy * (max_mm.y() - min_mm.y()));
      const double angle = lean_at(view, {p.x(), p.y(), 0}).angle;
      const GrooveShape groove = groove_at(p);
      const double steepest = steepest_lean(groove.profile, width_um, groove.depth_um);
      const double part = reach(angle, steepest, groove.alpha);
      out.least_lean = std::min(out.least_lean, angle);
      out.most_lean = std::max(out.most_lean, angle);
      out.shallowest = std::min(out.shallowest, steepest);
      out.steepest = std::max(out.steepest, steepest);
      out.best = std::max(out.best, part);
      dark += part < 0.5 ? 1 : 0;
      mirror += near_mirror(angle, groove.alpha) ? 1 : 0;
    }
  out.dark = static_cast<double>(dark) / (kPoints * kPoints);
  out.mirror = static_cast<double>(mirror) / (kPoints * kPoints);
  return out;
}

}  // namespace

std::vector<Finding> check_glints(const std::vector<GlintView>& views, const Eigen::Vector2d& min_mm,
                                  const Eigen::Vector2d& max_mm, double width_um, const GrooveAt& groove_at) {
  constexpr double kNoGlint = 0.02;  // covered lobe fraction 2 alpha beyond the cutoff angle
  std::vector<Finding> findings;
  const Eigen::Vector2d center = (min_mm + max_mm) / 2;
  const double alpha = groove_at(center).alpha;
  for (const GlintView& view : views) {
    const std::string where = "view " + view.name;
    if (!(view.camera_mm.z() > 0) || !(view.light_mm.z() > 0))
      fail(where, std::string(view.camera_mm.z() > 0 ? "its lamp" : "its camera") + " lies behind the board's face",
           "the board frame has z out of the metal: check the view's eye_mm (or T_camera_board) and the lamp's "
           "position_mm in the bench");
    const Reached reached = reached_over(view, min_mm, max_mm, width_um, groove_at);
    const Lean lean = lean_at(view, {center.x(), center.y(), 0});
    const std::string depth = number(std::ceil(10 * depth_for_lean_um(reached.most_lean, width_um)) / 10);
    const std::string remedy = "carve at least " + depth + " um deep with this cutter (--depth " + depth +
                               "), or bring lamp and eye closer to the mirror direction until "
                               "the half vector leans less than " +
                               degrees(reached.shallowest) + " degrees";
    if (reached.best < kNoGlint)
      fail(where,
           "no groove can glint there: the half vector leans " + degrees(reached.least_lean) + " to " +
               degrees(reached.most_lean) + " degrees from the board's normal, the steepest groove wall only " +
               degrees(reached.steepest) + " (" + degrees(reached.least_lean - reached.steepest) +
               " degrees too little)",
           remedy);
    if (reached.dark > 0)
      findings.push_back(
          make_warning(FindingCode::lamp_angle,
                       where + ": on " + std::to_string(std::lround(100 * reached.dark)) +
                           " % of the carve area the half vector leans beyond the grooves' steepest wall (" +
                           degrees(reached.shallowest) + " degrees, up to " + degrees(reached.most_lean) +
                           "), where scratches show less than half their light",
                       remedy));
    if (view.face != nullptr && reached.mirror > 0)
      findings.push_back(make_warning(
          FindingCode::lamp_angle,
          where + ": on " + std::to_string(std::lround(100 * reached.mirror)) +
              " % of the carve area the curved board lies near the mirror direction, where scratches of any direction "
              "glint and the plain face shines",
          "move the lamp or the eye along the cylinder's axis"));
    else if (view.face == nullptr && near_mirror(lean.angle, alpha))
      findings.push_back(make_warning(FindingCode::lamp_angle,
                                      where + ": lies near the mirror direction (the half vector leans " +
                                          degrees(lean.angle) +
                                          " degrees), where scratches of any direction glint and the plain face shines",
                                      "move the lamp or the eye"));
  }
  append(findings, told(collisions_of(views, min_mm, max_mm, groove_at), views));
  return findings;
}

}  // namespace burin

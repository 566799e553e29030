#include "burin/calib/verdict/effect_findings.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include "burin/base/files/decimals.h"
#include "burin/calib/light/lamp.h"

namespace burin {
namespace {

// Empty for a number that a person gave.
std::string plus_minus(const std::optional<double>& sigma) { return sigma ? " +- " + significant(*sigma) : ""; }

std::string measured(double value, const std::optional<double>& sigma, int decimals) {
  return fixed(value, decimals) + plus_minus(sigma);
}

std::string measured(const Eigen::Vector2d& v, const std::optional<Eigen::Vector2d>& sigma, int decimals) {
  using Sigma = std::optional<double>;
  return measured(v.x(), sigma ? Sigma(sigma->x()) : Sigma(), decimals) + " and " +
         measured(v.y(), sigma ? Sigma(sigma->y()) : Sigma(), decimals);
}

// The roughnesses of a brushed face follow from base_alpha and from half the logarithm of their ratio. The errors of
// both count as independent.
std::string tell_grain(const Material& m, const MaterialSigma& sigma) {
  const double root = std::sqrt(m.grain.ratio());
  std::optional<double> share;  // of each
  if (sigma.base_alpha && sigma.grain) share = std::hypot(*sigma.base_alpha / m.base_alpha, sigma.grain->maxCoeff());
  const auto roughness = [&](double alpha) {
    return significant(alpha, 3) + plus_minus(share ? std::optional(*share * alpha) : std::nullopt);
  };
  return "the plain face is brushed: roughness " + roughness(m.base_alpha / root) + " along " +
         fixed(m.grain.along_deg(), 1) + " degrees from the board's x, " + roughness(m.base_alpha * root) + " across";
}

void tell_profile(const Bench& bench, const Board& board, std::vector<Finding>& out) {
  const GrooveProfile& p = bench.material.profile;
  const MaterialSigma& sigma = bench.material_sigma;
  std::string what = "the grooves are not the paper's:";
  if (p.kind == GrooveProfile::Kind::rounded_v && !reaches_flanks(p, board.tool_width_um, bench.material.depth_um))
    what += " an arc of a circle, too shallow for flanks;";
  else if (p.kind == GrooveProfile::Kind::rounded_v)
    what += " flanks of " + measured(p.flank_deg, sigma.flank_deg, 1) + " degrees behind a rounded tip;";
  if (p.has_burrs())
    what += " burrs of " + measured(p.burr_left_um, sigma.burr_left_um, 2) + " (left) and " +
            measured(p.burr_right_um, sigma.burr_right_um, 2) + " um (right);";
  if (p.across != 1) what += " " + measured(p.across, sigma.across, 2) + " times as rough across as along;";
  what.back() = ',';
  const bool told = board.said.profile && !sigma.flank_deg && !sigma.across && !sigma.burr_left_um;
  out.push_back(
      told ? make_note(FindingCode::groove_profile, what + " as in board.json")
           : make_note(FindingCode::groove_profile,
                       what + " as the photos have it; burrs, roughness and depth trade with each other in photos",
                       "a look through a microscope decides: write what it shows into board.json, material.profile"));
}

// Direction of the unmodeled light from the board's middle, and its brightness there relative to the lamp.
Finding tell_stray(const Bench& bench, const Eigen::Vector2d& board_size_mm) {
  const Eigen::Vector3d middle(0.5 * board_size_mm.x(), 0.5 * board_size_mm.y(), 0);
  const auto light_on_middle = [&](const Light& light) {
    const Eigen::Vector3d to = light.position_mm - middle;
    return light.intensity.mean() * to.normalized().z() / to.squaredNorm();
  };
  const Eigen::Vector3d towards = (bench.stray->position_mm - middle).normalized();
  const double azimuth = std::atan2(towards.y(), towards.x()) * 180 / std::numbers::pi;
  const double degrees = std::acos(towards.z()) * 180 / std::numbers::pi;
  double brightest = 0;
  for (const Light& light : bench.lights)
    if (light.is_near()) brightest = std::max(brightest, light_on_middle(light));
  return make_note(
      FindingCode::stray_light,
      "another light shines, which no file names: " + fixed(degrees, 0) +
          " degrees from straight above the board's middle, towards " +
          fixed(azimuth < 0 ? azimuth + 360 : azimuth, 0) + " degrees from x counter-clockwise, with " +
          significant(100 * light_on_middle(*bench.stray) / brightest, 2) + " % of the lamp's light there",
      "it is measured, and designs with this bench.json count on it (stray_light); if it will not shine, switch "
      "it off or close the curtain, and take the photos again");
}

}  // namespace

std::vector<Finding> effect_findings(const Bench& bench, const Board& board) {
  std::vector<Finding> out;
  const Material& m = bench.material;
  if (!m.grain.none()) out.push_back(make_note(FindingCode::groove_variation, tell_grain(m, bench.material_sigma)));
  const MachineErrors& errors = bench.machine_errors;
  if (!errors.backlash_mm.isZero(0))
    out.push_back(make_note(
        FindingCode::machine_errors,
        "the machine has backlash of " + measured(errors.backlash_mm, errors.backlash_sigma_mm, 3) + " mm in x and y",
        "tool paths written with this bench undo it"));
  if (errors.uneven())
    out.push_back(make_note(FindingCode::machine_errors,
                            "the machine's screws add a sine of " +
                                measured(errors.screw_mm(), errors.screw_sigma_mm, 3) + " mm every " +
                                measured(errors.screw_period_mm, {}, 2) + " mm to x and y",
                            "tool paths written with this bench undo it at the ends of scratches"));
  if (!m.profile.is_paper()) tell_profile(bench, board, out);
  append(out, paper_findings(bench.paper));
  if (bench.stray) out.push_back(tell_stray(bench, board.size_mm));
  return out;
}

}  // namespace burin

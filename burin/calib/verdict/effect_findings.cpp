#include "burin/calib/verdict/effect_findings.h"

#include <cmath>
#include <string>

#include "burin/render/files/decimals.h"

namespace burin {
namespace {

Finding note(const std::string& what, const std::string& remedy = "") {
  return {Finding::Severity::note, {}, what, remedy};
}

std::string pair(const Eigen::Vector2d& v, int decimals) {
  return fixed(v.x(), decimals) + " and " + fixed(v.y(), decimals);
}

void tell_profile(const Bench& bench, std::vector<Finding>& out) {
  const GrooveProfile& p = bench.material.profile;
  const MaterialSigma& sigma = bench.material_sigma;
  std::string what = "the grooves are not the paper's:";
  if (p.kind == GrooveProfile::Kind::rounded_v)
    what += " flanks of " + fixed(p.flank_deg, 1) + " degrees behind a rounded tip;";
  if (p.burr_left_um > 0 || p.burr_right_um > 0)
    what += " burrs of " + fixed(p.burr_left_um, 2) + " (left) and " + fixed(p.burr_right_um, 2) + " um;";
  if (p.across != 1) what += " " + fixed(p.across, 2) + " times as rough across as along;";
  what.back() = ',';
  const bool told = !sigma.flank_deg && !sigma.across && !sigma.burr_left_um;
  out.push_back(
      told ? note(what + " as board.json says")
           : note(what + " as the photos have it; burrs, roughness and depth trade with each other in photos",
                  "a look through a microscope decides: write what it shows into board.json, material.profile"));
}

}  // namespace

std::vector<Finding> effect_findings(const Bench& bench) {
  std::vector<Finding> out;
  const Material& m = bench.material;
  if (!m.grain.none()) {
    const double root = std::sqrt(m.grain.ratio());
    out.push_back(note("the plain face is brushed: roughness " + significant(m.base_alpha / root, 3) + " along " +
                       fixed(m.grain.along_deg(), 1) + " degrees from the board's x, " +
                       significant(m.base_alpha * root, 3) + " across"));
  }
  const MachineErrors& errors = bench.machine_errors;
  if (!errors.backlash_mm.isZero(0))
    out.push_back(note("the machine has backlash of " + pair(errors.backlash_mm, 3) + " mm in x and y",
                       "tool paths written with this bench undo it"));
  if (errors.uneven())
    out.push_back(note("the machine's screws add a sine of " + pair(errors.screw_mm(), 3) + " mm every " +
                           pair(errors.screw_period_mm, 2) + " mm to x and y",
                       "tool paths written with this bench undo it at the ends of scratches"));
  if (!m.profile.is_paper()) tell_profile(bench, out);
  return out;
}

}  // namespace burin

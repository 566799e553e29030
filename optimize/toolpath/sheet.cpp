#include "burin/optimize/toolpath/sheet.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/scene/parameter_name.h"
#include "burin/scene/physical_bounds.h"
#include "burin/scene/surface.h"

namespace burin {
namespace {

constexpr double kSpoiled = 0.5, kNoticed = 0.1;  // of the depth

std::string micrometers(double mm) { return significant(1e3 * mm, 2) + " um"; }

const char* remedy(const MachineProfile& machine) {
  return machine.dialect == GcodeDialect::marlin
             ? "use a tool that is pressed by a spring (a profile with \"depth_by\": \"spring\")"
             : "probe the sheet as it lies on the machine (burin probe write) and give --heights (in a loop: put it "
               "into the round's folder as heights.json), use a tool that is pressed by a spring (--machine "
               "grbl-spring, or \"depth_by\" in a profile), or, where it is the very "
               "sheet that was photographed and lies as it lay then, --follow-bow";
}

void add(std::vector<Finding>& findings, FindingCode code, Finding::Severity severity, std::string what,
         std::string remedy) {
  findings.push_back({code, severity, {}, std::move(what), std::move(remedy)});
}

void judge_even_z(const DepthRange& depth, const std::optional<Unevenness>& known, const MachineProfile& machine,
                  std::vector<Finding>& findings) {
  if (!known) {
    add(findings, FindingCode::face_uneven, Finding::Severity::warning,
        "the sheet's flatness is unknown: Z goes to -" + fixed(depth.least_mm, 4) +
            " mm everywhere, which on a sheet that is not flat to " + micrometers(kNoticed * depth.least_mm) +
            " carves air in one place and too deep in another",
        std::string(remedy(machine)) + "; or write \"flatness_um\" into board.json once it is known");
    return;
  }
  const double error = known->mm;
  if (error <= kNoticed * depth.least_mm) return;
  const bool spoiled = error > kSpoiled * depth.least_mm;
  add(findings, FindingCode::face_uneven, spoiled ? Finding::Severity::error : Finding::Severity::warning,
      "the face lies " + micrometers(error) + " higher in one place than in another (" + known->source +
          "), and a fixed Z is to carve " + micrometers(depth.least_mm) + " deep: the depth would differ by " +
          fixed(100 * error / depth.least_mm, 0) + " %" +
          (spoiled ? ", and some scratches may not touch the metal" : ""),
      remedy(machine));
}

void judge_preload(const DepthRange& depth, const std::optional<Unevenness>& known, const MachineProfile& machine,
                   std::vector<Finding>& findings) {
  const double probe_mm = known ? known->mm : 0.1;
  const double error = depth_error_mm(machine, depth.least_mm, probe_mm);
  const std::string head = machine.depth_by == DepthBy::spring ? "the spring" : "the drag bit";
  if (!known) {
    add(findings, FindingCode::face_uneven, Finding::Severity::note,
        "the sheet's flatness is unknown; " + head + " turns each 0.1 mm of unevenness into " + micrometers(error) +
            " of depth",
        "");
  } else if (error > kNoticed * depth.least_mm) {
    add(findings, FindingCode::face_uneven,
        error > kSpoiled * depth.least_mm ? Finding::Severity::error : Finding::Severity::warning,
        "the face lies " + micrometers(probe_mm) + " higher in one place than in another (" + known->source +
            "), of which " + head + " makes " + micrometers(error) + " of the depth of " + micrometers(depth.least_mm),
        "clamp the sheet flatter, use a softer spring, or probe it (burin probe write) and give --heights (in a loop: "
        "put it into the round's folder as heights.json)");
  } else {
    add(findings, FindingCode::face_uneven, Finding::Severity::note,
        head + " makes " + micrometers(error) + " of depth of the face's " + micrometers(probe_mm) + " (" +
            known->source + ")",
        "");
  }
}

}  // namespace

std::optional<Unevenness> known_unevenness(const Board& board, const Bench* measured) {
  std::optional<Unevenness> out;
  if (board.flatness_um) out = Unevenness{1e-3 * *board.flatness_um, "board.json's flatness_um"};
  if (measured == nullptr || measured->bow_mm.isZero()) return out;
  const double bow = range_mm(Surface{board.size_mm, measured->bow_mm}, board.carve_min_mm, board.carve_max_mm);
  if (!out || bow > out->mm) out = Unevenness{bow, "the bow that photos measured"};
  return out;
}

bool depth_is_measured(const Bench& bench) {
  if (!bench.material_sigma.depth_um) return false;
  const Verdict* verdict = find_verdict(bench, parameter::kDepth);
  return verdict == nullptr || verdict->determined();
}

Face face_to_follow(const Board& board, const Bench& bench, const std::optional<HeightMap>& heights, bool follow_bow) {
  Face face;
  face.map = heights;
  face.carves = bench.machine_affine;
  if (follow_bow) {
    if (bench.bow_mm.isZero())
      fail("tool path", "there is no measured bow to follow", "give the bench.json that photos of this sheet measured");
    fail_unless_bow_fits(bench.bow_mm, board.size_mm, "tool path");
    face.bow = Surface{board.size_mm, bench.bow_mm};
  }
  face.zero_mm = face.map ? face.map->zero_mm : board.carve_min_mm;
  return face;
}

DepthRange depth_range(const Toolpath& path) {
  DepthRange range{std::numeric_limits<double>::infinity(), 0};
  for (const PlannedScratch& s : path.scratches) {
    range.least_mm = std::min(range.least_mm, s.depth_mm);
    range.most_mm = std::max(range.most_mm, s.depth_mm);
  }
  return range;
}

double depth_error_mm(const MachineProfile& machine, double depth_mm, double unevenness_mm) {
  if (machine.depth_by == DepthBy::servo) return 0;
  if (!by_preload(machine.depth_by)) return unevenness_mm;
  // With zero at the highest place, the preload is smaller at the lowest.
  const double preload_mm = plunge_mm(machine, depth_mm) - unevenness_mm;
  return depth_mm - (preload_mm > 0 ? depth_of_plunge_mm(machine, preload_mm) : 0);
}

std::vector<Finding> sheet_findings(const Toolpath& path, const Board& board, const Bench* measured,
                                    const MachineProfile& machine) {
  std::vector<Finding> findings;
  if (!board.mesh.empty())
    add(findings, FindingCode::board_shape, Finding::Severity::warning,
        "this board has the shape of " + board.mesh.filename().string() + ", and G-code is for the flat sheet",
        "carve it flat, before it is given its shape; on a face that is shaped already no file of Burin's is right");
  const DepthRange depth = depth_range(path);
  const double rounding_mm = 0.5 * std::pow(10.0, -machine.decimals);
  if (depth_error_mm(machine, depth.least_mm, rounding_mm) > kNoticed * depth.least_mm)
    add(findings, FindingCode::depth_rounded, Finding::Severity::warning,
        "coordinates with " + std::to_string(machine.decimals) + " decimals round a depth of " +
            micrometers(depth.least_mm) + " by up to " + micrometers(rounding_mm),
        "write more decimals (--decimals, or the profile's)");
  if (machine.depth_table.assumed && measured != nullptr && depth_is_measured(*measured))
    add(findings, FindingCode::depth_uncertain, Finding::Severity::note,
        "of " + significant(board.material.depth_um, 3) + " um as the guessed table of " + machine.name +
            " has them, photos measured " + significant(measured->material.depth_um, 3) + " um",
        "");
  else if (machine.depth_table.assumed)
    add(findings, FindingCode::depth_uncertain, Finding::Severity::warning,
        "no measurement relates preload to depth on " + machine.name + ": its table is a guess",
        "carve a coupon on scrap (burin coupon write), or let photos of the first board measure the depth");
  // A wire or a flat spring presses equally at every height.
  if (machine.depth_by == DepthBy::servo) return findings;
  if (path.face.map) {
    add(findings, FindingCode::face_followed, Finding::Severity::note,
        "Z follows the height map, " + micrometers(range_mm(*path.face.map)) + " from its lowest to its highest point",
        "");
    return findings;
  }
  if (path.face.bow) {
    add(findings, FindingCode::face_followed, Finding::Severity::warning,
        "Z follows the bow that photos measured: right only for that sheet, lying as it lay then", "");
    return findings;
  }
  const std::optional<Unevenness> known = known_unevenness(board, measured);
  if (by_preload(machine.depth_by))
    judge_preload(depth, known, machine, findings);
  else if (std::any_of(machine.per_scratch.begin(), machine.per_scratch.end(),
                       [](const std::string& line) { return line.find("{z_carve}") != std::string::npos; }))
    judge_even_z(depth, known, machine, findings);
  return findings;
}

}  // namespace burin

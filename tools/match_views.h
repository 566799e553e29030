// tools/match_views.h - matches measured views and lamps to designed ones, so that views keep their names after a
// measurement.
//
// Matching uses the viewpoint, never the name: capture numbers views v00, v01, ... in any case. A measured view is a
// candidate within kReach times the picture's tolerance in every direction. The tolerance comes from `burin design
// --report-tolerance` (design-report.json), or else from the width of a groove's glint (default_tolerance). Exactly one
// candidate is a match; none or several need a decision by the user. Lamps match in the same way, with one exception.
// The only lamp of a bench matches up to kOnlyLamp of its distance away, and a note gives the distance. Frame: board,
// mm. burin/optimize/design/tolerance.h defines the directions.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "burin/base/finding.h"
#include "burin/optimize/design/tolerance.h"
#include "burin/optimize/design_file.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"

namespace burin {

/// Reach of a match, in units of the distance at which the picture loses 3 dB. People hit a place a meter away to a few
/// cm by hand, but fine pictures degrade after one or two.
inline constexpr double kReach = 3;
/// Upper limit of the reach in depth, as a share of the distance. Beyond it the picture differs.
inline constexpr double kMostDepth = 0.25;
/// Reach of the only lamp, as a share of its nominal distance.
inline constexpr double kOnlyLamp = 0.15;

/// Tolerance of one designed picture. With several lamps, `eye` holds under the least tolerant one. `lamp` belongs to
/// the most tolerant one; designed_lamps() has the tolerance of each.
struct MatchTolerance {
  std::string view, light;
  PlaceTolerance eye, lamp;
};

/// Estimates the tolerance without a measurement. A groove's light halves when the half vector leaves the plane across
/// the groove by 0.77 alpha (burin/optimize/design/glint.h). The eye or lamp, at distance D, moves by 0.77 alpha D |wi
/// + wo| for this. Pictures of many such grooves lose 3 dB at about a third of this distance sideways and up. In depth
/// they lose 3 dB at eight times as much (docs/design.md, "Where one may stand").
MatchTolerance default_tolerance(const DesignView& picture, const Bench& designed, const Board& board);

/// One per picture of the design: the smaller of the estimate and the measurement in design-report.json. A missing
/// report (or an empty path) is valid; a broken one throws Error.
std::vector<MatchTolerance> match_tolerances(const DesignSpec& design, const Bench& designed, const Board& board,
                                             const std::filesystem::path& design_report);

/// One of the lamps that light a design's pictures.
struct DesignedLamp {
  std::string id;
  Eigen::Vector3d at_mm{0, 0, 0};
  PlaceTolerance tolerance;  ///< the smallest of its pictures
};

/// Returns every lamp of the design's pictures once, in the design's order. `tolerances`: one per picture. Throws Error
/// for lamps missing in `designed`.
std::vector<DesignedLamp> designed_lamps(const DesignSpec& design, const Bench& designed, const Board& board,
                                         const std::vector<MatchTolerance>& tolerances);

/// Tolerances for display, one per picture: the distance of eye and lamp at which the picture is lost. They are the
/// measured ones of `burin design`, or else default_tolerance(). match_tolerances() is stricter and accepts no distant
/// place as a designed one.
std::vector<MatchTolerance> shown_tolerances(const DesignSpec& design, const Bench& designed, const Board& board,
                                             const std::filesystem::path& design_report);

/// Offset of a measured place from the designed one.
struct Offset {
  double sideways_mm = 0, up_mm = 0;  ///< to the right and upwards, seen from the designed place
  double along_mm = 0;                ///< away from the carve area: the difference of both distances
  double degrees = 0;                 ///< between both directions from the center of the carve area
  double mm = 0;                      ///< distance between both places
  double reaches = 0;                 ///< in units of the reach; up to 1 is a candidate
};

/// Returns the offset between two places of an eye or a lamp. `reaches` is infinite behind the board.
Offset offset_of(const Eigen::Vector3d& designed_mm, const Eigen::Vector3d& measured_mm, const Board& board,
                 const PlaceTolerance& tolerance);

struct Candidate {
  std::string name;  ///< in the measured bench
  Offset offset;
};

/// One designed view or lamp and its candidates.
struct Match {
  std::string designed;
  std::string measured;          ///< empty: undecided
  bool given = false;            ///< by the user
  std::vector<Candidate> near;   ///< within reach, nearest first (by `reaches`)
  std::vector<Candidate> other;  ///< all others, nearest first
};

/// Measured names by designed names, as the user gave them: --view middle=v01, --lamp ceiling=lamp.
struct GivenNames {
  std::map<std::string, std::string> views, lamps;
};

struct Matching {
  std::vector<Match> views, lamps;  ///< those of the design, in its order
  /// The measured bench with the designed names, so that a design.json for the designed bench fits it too. Other views
  /// and lamps with such a name get the suffix "-photo". Complete only if complete().
  Bench bench;

  bool complete() const;
};

/// Matches all views and lamps of the design, with every lamp of a picture on its own. Photos do not measure the sun
/// and the surroundings: without them in `measured`, those of the design remain. `tolerances`: by match_tolerances(),
/// one per picture, in the design's order. Throws Error for an unknown given name, and for views and lamps of the
/// design missing in `designed`.
Matching match_bench(const DesignSpec& design, const Bench& designed, const Bench& measured, const Board& board,
                     const std::vector<MatchTolerance>& tolerances, const GivenNames& given = {});

/// Reports all matches with their distances: a note within reach, a warning for a given name beyond it. `where`: the
/// file of the measured bench.
std::vector<Finding> matched_findings(const Matching& matching, const std::filesystem::path& where);

/// Throws Error unless the matching is complete. The message lists everything undecided, the candidates, their
/// distances and the deciding options. `where`: the file of the measured bench.
void require_complete(const Matching& matching, const std::filesystem::path& where);

/// "4.0 mm to the right, 2.0 mm down, 8.0 mm further away; 9.2 mm and 0.54 degrees in all".
std::string in_words(const Offset& offset);

/// Parses "middle=v01" into `names`. Throws Error, naming `option`, for text without "=", an empty side, or a repeated
/// name.
void add_given_name(const std::string& option, const std::string& text, std::map<std::string, std::string>& names);

}  // namespace burin

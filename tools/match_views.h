// tools/match_views.h - which measured view (and lamp) is the one that a board was designed for, so that views keep
// their names through measuring.
//
// An eye is matched by its place, never by its name: capture counts views v00, v01, ... whatever they are called in a
// design. A measured view may be the designed one where it stands within kReach times what that picture tolerates in
// every direction: what `burin design --report-tolerance` measured (design-report.json), or else an estimate from how
// wide a groove glints (default_tolerance). Exactly one such view is it; none or several are a question to the person.
// A lamp is matched the same way, with one difference: a bench with one lamp can mean no other, so it is taken up to
// kOnlyLamp of its distance away, and the distance is told.
// Frame: board, mm. burin/optimize/design/tolerance.h has the directions.
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

/// A photo's eye counts as a designed one up to so many times the distance at which the picture has lost 3 dB: by hand
/// one hits a place a meter away to a few cm, while fine pictures are lost after one or two.
inline constexpr double kReach = 3;
/// But never further in depth than this share of the distance: the picture is then another one.
inline constexpr double kMostDepth = 0.25;
/// How far the only lamp may be from where it was believed, as a share of its distance.
inline constexpr double kOnlyLamp = 0.15;

/// What one designed picture tolerates. Under several lights: the eye under that light which tolerates least, and of
/// the lights the one that may move most (each has its own, no greater: designed_lamps()).
struct MatchTolerance {
  std::string view, light;
  PlaceTolerance eye, lamp;
};

/// An estimate where none was measured. A groove's light halves where the half vector leaves the plane across it by
/// 0.77 alpha (burin/optimize/design/glint.h), for which eye or lamp, at distance D, must move by
/// 0.77 alpha D |wi + wo|. Pictures made of many such grooves lose 3 dB at about a third of that sideways and up, and
/// eight times as far in depth (docs/design.md, "Where one may stand").
MatchTolerance default_tolerance(const DesignView& picture, const Bench& designed, const Board& board);

/// One a picture of the design: estimated and, where its design-report.json has one that is smaller, measured. A report
/// that is missing (or an empty path) is no error; a broken one throws Error.
std::vector<MatchTolerance> match_tolerances(const DesignSpec& design, const Bench& designed, const Board& board,
                                             const std::filesystem::path& design_report);

/// One of the lamps that a design's pictures are lit by.
struct DesignedLamp {
  std::string id;
  Eigen::Vector3d at_mm{0, 0, 0};
  PlaceTolerance tolerance;  ///< the least of the pictures that it lights
};

/// The lamps of a design's pictures one by one, each once, in the design's order: of a picture under several, every
/// one. `tolerances`: one a picture. Throws Error for lamps that `designed` lacks.
std::vector<DesignedLamp> designed_lamps(const DesignSpec& design, const Bench& designed, const Board& board,
                                         const std::vector<MatchTolerance>& tolerances);

/// How far eye and lamp of each picture may stand aside until it is lost: as `burin design` measured it and design,
/// check and report say it, or else default_tolerance(). For people; match_tolerances() takes no far place for a
/// designed one.
std::vector<MatchTolerance> shown_tolerances(const DesignSpec& design, const Bench& designed, const Board& board,
                                             const std::filesystem::path& design_report);

/// Where a measured place lies, as seen from the designed one.
struct Offset {
  double sideways_mm = 0, up_mm = 0;  ///< to the right as seen from there, upwards
  double along_mm = 0;                ///< away from the board's carve area; the difference of both distances
  double degrees = 0;                 ///< between both directions from the middle of the carve area
  double mm = 0;                      ///< from place to place
  double reaches = 0;                 ///< in units of what counts as the same place: up to 1 is a candidate
};

/// The same for two places of an eye or a lamp. `reaches` is infinite behind the board.
Offset offset_of(const Eigen::Vector3d& designed_mm, const Eigen::Vector3d& measured_mm, const Board& board,
                 const PlaceTolerance& tolerance);

struct Candidate {
  std::string name;  ///< in the measured bench
  Offset offset;
};

/// One designed view or lamp, and what was found for it.
struct Match {
  std::string designed;
  std::string measured;          ///< empty: not decided
  bool given = false;            ///< by a person
  std::vector<Candidate> near;   ///< within reach, nearest first (by `reaches`)
  std::vector<Candidate> other;  ///< all others, nearest first
};

/// Designed names to measured ones, as a person gave them: --view middle=v01, --lamp ceiling=lamp.
struct GivenNames {
  std::map<std::string, std::string> views, lamps;
};

struct Matching {
  std::vector<Match> views, lamps;  ///< those that the design uses, in its order
  /// The measured bench with the designed names: a design.json for the designed bench holds for it as well. Views and
  /// lamps of that name which are others get "-photo" behind it. Whole only if complete().
  Bench bench;

  bool complete() const;
};

/// Matches all views and lamps of the design, each of several lamps that light a picture on its own. The sun and
/// surroundings, which photos do not measure, stay as the design has them where `measured` has none. `tolerances`: by
/// match_tolerances(), one a picture, in the design's order. Throws Error for a given name that does not exist, and for
/// views and lamps of the design that `designed` lacks.
Matching match_bench(const DesignSpec& design, const Bench& designed, const Bench& measured, const Board& board,
                     const std::vector<MatchTolerance>& tolerances, const GivenNames& given = {});

/// What was matched to what, with the distances: a note for what is near, a warning for what a person gave although it
/// is not. `where` is the measured bench's file.
std::vector<Finding> matched_findings(const Matching& matching, const std::filesystem::path& where);

/// Throws Error with all that is undecided, the candidates, their distances, and the options that decide it. `where` as
/// above. Returns if the matching is complete.
void require_complete(const Matching& matching, const std::filesystem::path& where);

/// "4 mm to the right, 2 mm down, 8 mm further away; 9 mm and 0.54 degrees in all".
std::string in_words(const Offset& offset);

/// "middle=v01" into `names`. Throws Error naming `option` where there is no "=" or one side is empty, and where a name
/// is given twice.
void add_given_name(const std::string& option, const std::string& text, std::map<std::string, std::string>& names);

}  // namespace burin

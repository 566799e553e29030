#include "tools/match_views.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>

#include "burin/base/error.h"
#include "burin/base/files/json_file.h"
#include "burin/scene/parameter_name.h"
#include "tools/commands.h"

namespace burin {
namespace {

Eigen::Vector3d eye_of(const View& view) { return view.T_camera_board.inverse().translation(); }

Eigen::Vector3d middle_of(const Board& board) {
  const Eigen::Vector2d middle = (board.carve_min_mm + board.carve_max_mm) / 2;
  return {middle.x(), middle.y(), 0};
}

// Reach of a match in each direction.
struct Reach {
  double sideways_mm, up_mm, along_mm;
};

Reach reach_of(const PlaceTolerance& t, double distance_mm) {
  return {kReach * t.sideways.least(), kReach * t.up.least(),
          std::min(kReach * t.depth.least(), kMostDepth * distance_mm)};
}

MoveRange both_ways(double mm) { return {mm, mm}; }

// Returns the smaller of two tolerances: several pictures may share a viewpoint or a lamp.
PlaceTolerance smaller(const PlaceTolerance& a, const PlaceTolerance& b) {
  const auto least = [](const MoveRange& x, const MoveRange& y) { return both_ways(std::min(x.least(), y.least())); };
  return {least(a.sideways, b.sideways), least(a.up, b.up), least(a.depth, b.depth)};
}

PlaceTolerance larger(const PlaceTolerance& a, const PlaceTolerance& b) {
  const auto most = [](const MoveRange& x, const MoveRange& y) { return both_ways(std::max(x.least(), y.least())); };
  return {most(a.sideways, b.sideways), most(a.up, b.up), most(a.depth, b.depth)};
}

PlaceTolerance read_place(JsonObject json) {
  const auto range = [&](const char* key) {
    const std::vector<double> ends = json.numbers(key, 2);
    if (!(ends[0] < 0 && ends[1] > 0))
      json.fail_field(key, "does not reach to both sides of 0", "make the design again with --report-tolerance");
    return MoveRange{-ends[0], ends[1]};
  };
  const PlaceTolerance out{range("sideways"), range("up"), range("depth")};
  return out;
}

// Adds one measured place to the candidates.
void sort_in(Match& match, const std::string& name, const Offset& offset) {
  auto& list = offset.reaches <= 1 ? match.near : match.other;
  list.push_back({name, offset});
}

void decide(Match& match, const std::map<std::string, std::string>& given, bool only_lamp, double distance_mm) {
  const auto nearest_first = [](const Candidate& a, const Candidate& b) { return a.offset.reaches < b.offset.reaches; };
  std::stable_sort(match.near.begin(), match.near.end(), nearest_first);
  std::stable_sort(match.other.begin(), match.other.end(), nearest_first);
  const auto said = given.find(match.designed);
  if (said != given.end()) {
    match.measured = said->second;
    match.given = true;
  } else if (match.near.size() == 1) {
    match.measured = match.near.front().name;
  } else if (only_lamp && match.near.empty() && match.other.front().offset.mm <= kOnlyLamp * distance_mm) {
    match.measured = match.other.front().name;
  }
}

// Clears matches of one photo to two designed places, unless the user gave them.
void undo_shared(std::vector<Match>& matches) {
  std::map<std::string, int> times;
  for (const Match& match : matches) ++times[match.measured];
  for (Match& match : matches)
    if (!match.given && times[match.measured] > 1) match.measured.clear();
}

template <typename Exists>
void require_names(const std::map<std::string, std::string>& given, const std::vector<Match>& matches, Exists exists,
                   const char* option, const std::string& measured_names) {
  for (const auto& [designed, measured] : given) {
    const std::string said = fmt::format("{} {}={}", option, designed, measured);
    std::string names;
    bool known = false;
    for (const Match& match : matches) {
      names += (names.empty() ? "" : ", ") + match.designed;
      known = known || match.designed == designed;
    }
    if (!known) fail(said, fmt::format("the design has no \"{}\"", designed), "choose one of: " + names);
    if (!exists(measured))
      fail(said, fmt::format("the measured bench has no \"{}\"", measured), "choose one of: " + measured_names);
  }
}

std::string free_name(const std::string& wanted, const std::set<std::string>& taken) {
  std::string name = wanted;
  while (taken.count(name) > 0) name += "-photo";
  return name;
}

bool has_far_light(const Bench& bench) {
  return std::any_of(bench.lights.begin(), bench.lights.end(), [](const Light& light) { return !light.is_near(); });
}

// Photos measure lamps only: a measured bench without sun and surroundings does not contradict theirs.
std::vector<DesignedLamp> lamps_to_match(const DesignSpec& design, const Bench& designed, const Bench& measured,
                                         const Board& board, const std::vector<MatchTolerance>& tolerances) {
  std::vector<DesignedLamp> lamps = designed_lamps(design, designed, board, tolerances);
  if (has_far_light(measured)) return lamps;
  lamps.erase(std::remove_if(lamps.begin(), lamps.end(),
                             [&](const DesignedLamp& lamp) {
                               return !find_light(designed, lamp.id, "the designed bench").is_near();
                             }),
              lamps.end());
  return lamps;
}

// Adds the design's lights that need no match, unchanged.
void add_far_lights(const DesignSpec& design, const Bench& designed, Matching& matching) {
  for (const DesignView& view : design.views)
    for (const std::string& id : light_names(view.light)) {
      const auto is_it = [&](const auto& one) { return one.id == id; };
      const auto is_matched = [&](const Match& match) { return match.designed == id; };
      std::vector<Light>& lights = matching.bench.lights;
      if (std::any_of(matching.lamps.begin(), matching.lamps.end(), is_matched) ||
          std::any_of(lights.begin(), lights.end(), is_it))
        continue;
      lights.push_back(find_light(designed, id, "the designed bench"));
    }
}

// Renames `items`: matched ones get designed names, and others keep theirs unless it is taken. An item with several
// matches is duplicated.
template <typename Item, typename NameOf>
std::vector<std::pair<std::string, std::string>> rename(std::vector<Item>& items, NameOf name_of,
                                                        const std::vector<Match>& matches) {
  std::vector<std::pair<std::string, std::string>> renamed;
  std::set<std::string> taken;
  for (const Match& match : matches)
    if (!match.measured.empty()) taken.insert(match.designed);
  std::vector<Item> out;
  for (const Item& item : items) {
    const std::string& old = name_of(item);
    bool used = false;
    for (const Match& match : matches) {
      if (match.measured != old) continue;
      out.push_back(item);
      name_of(out.back()) = match.designed;
      renamed.emplace_back(old, match.designed);
      used = true;
    }
    if (used) continue;
    const std::string name = free_name(old, taken);
    taken.insert(name);
    out.push_back(item);
    name_of(out.back()) = name;
    renamed.emplace_back(old, name);
  }
  items = std::move(out);
  return renamed;
}

Bench renamed_bench(const Bench& measured, const Matching& matching) {
  Bench bench = measured;
  const auto view_name = [](auto& view) -> auto& { return view.name; };
  const auto light_id = [](auto& light) -> auto& { return light.id; };
  const auto views = rename(bench.views, view_name, matching.views);
  const auto lights = rename(bench.lights, light_id, matching.lamps);
  std::map<std::string, Verdict> verdict;
  std::set<std::string> moved;
  const auto move_verdict = [&](const std::string& from, const std::string& to) {
    const auto found = measured.verdict.find(from);
    if (found == measured.verdict.end()) return;
    verdict[to] = found->second;
    moved.insert(from);
  };
  for (const auto& [from, to] : views) move_verdict(parameter::pose(from), parameter::pose(to));
  for (const auto& [from, to] : lights)
    for (const auto name_of : parameter::kOfOneLight) move_verdict(name_of(from), name_of(to));
  for (const auto& [name, value] : measured.verdict)
    if (moved.count(name) == 0) verdict.emplace(name, value);
  for (auto& [name, value] : verdict)
    for (Cause& cause : value.causes) {
      if (cause.kind != Cause::Kind::of_camera_distance) continue;
      const auto named = std::find_if(views.begin(), views.end(), [&](const auto& v) { return v.first == cause.text; });
      if (named != views.end()) cause.text = named->second;
    }
  bench.verdict = std::move(verdict);
  return bench;
}

const Candidate* candidate_named(const Match& match, const std::string& name) {
  for (const auto* list : {&match.near, &match.other})
    for (const Candidate& candidate : *list)
      if (candidate.name == name) return &candidate;
  return nullptr;
}

// Words for views or for lamps.
struct NameKind {
  const char *what, *measured_as, *option, *go_there;
};
constexpr NameKind kView{"view", "a photo was taken", "--view",
                         "photograph the board from there too, or change that view in the project's bench.json"};
constexpr NameKind kLamp{
    "lamp", "a lamp was found", "--lamp",
    "put the lamp back and photograph the board again, or change that lamp in the project's bench.json"};

std::string option_for(const NameKind& kind, const Match& match, const Candidate& candidate) {
  return std::string(kind.option) + " " + shell_word(match.designed + "=" + candidate.name);
}

// Returns the question about one designed view or lamp.
std::string question(const NameKind& kind, const Match& match) {
  std::string out = fmt::format("{} \"{}\": ", kind.what, match.designed);
  if (match.near.empty()) {
    out += std::string("no ") + (kind.what == kView.what ? "photo was taken" : "lamp was found") + " near its place";
    if (match.other.empty()) return out + "; " + kind.go_there;
    const Candidate& nearest = match.other.front();
    return out + fmt::format(", the nearest is {} ({}); {}, or say {} if that is where it is to be", nearest.name,
                             in_words(nearest.offset), kind.go_there, option_for(kind, match, nearest));
  }
  if (match.near.size() == 1)
    return out +
           fmt::format("{} lies near it ({}), and near another one of the design as well; say {} if it is this one",
                       match.near.front().name, in_words(match.near.front().offset),
                       option_for(kind, match, match.near.front()));
  out += fmt::format("{} places lie near it: ", match.near.size());
  for (std::size_t i = 0; i < match.near.size(); ++i)
    out += fmt::format("{}{} ({})", i == 0 ? "" : ", ", match.near[i].name, in_words(match.near[i].offset));
  out += "; name it: ";
  for (std::size_t i = 0; i < match.near.size(); ++i)
    out += (i == 0 ? "" : " or ") + option_for(kind, match, match.near[i]);
  return out;
}

}  // namespace

MatchTolerance default_tolerance(const DesignView& picture, const Bench& designed, const Board& board) {
  constexpr double kHalfLight = 0.766;  // (1 + t^2)^(-3/2) = 1/2
  constexpr double kPicture = 0.35;     // share of this distance at which pictures lose 3 dB
  constexpr double kDepthToSideways = 8;
  const Eigen::Vector3d middle = middle_of(board);
  const Eigen::Vector3d eye = eye_of(find_view(designed, picture.view, "design")) - middle;
  std::optional<MatchTolerance> out;
  for (const std::string& id : light_names(picture.light)) {
    const Eigen::Vector3d lamp = find_light(designed, id, "design").position_mm - middle;
    const double across =
        kPicture * kHalfLight * designed.material.alpha * (eye.normalized() + lamp.normalized()).norm();
    const auto place = [&](double distance_mm) {
      const double aside = across * distance_mm;
      return PlaceTolerance{both_ways(aside), both_ways(aside),
                            both_ways(std::min(kDepthToSideways * aside, distance_mm / 2))};
    };
    const PlaceTolerance of_eye = place(eye.norm()), of_lamp = place(lamp.norm());
    out = out ? MatchTolerance{picture.view, picture.light, smaller(out->eye, of_eye), larger(out->lamp, of_lamp)}
              : MatchTolerance{picture.view, picture.light, of_eye, of_lamp};
  }
  return *out;
}

std::vector<DesignedLamp> designed_lamps(const DesignSpec& design, const Bench& designed, const Board& board,
                                         const std::vector<MatchTolerance>& tolerances) {
  if (tolerances.size() != design.views.size())
    fail("designed_lamps", "there is not one tolerance a picture", "call match_tolerances()");
  std::vector<DesignedLamp> out;
  for (std::size_t k = 0; k < design.views.size(); ++k) {
    const std::vector<std::string> ids = light_names(design.views[k].light);
    for (const std::string& id : ids) {
      PlaceTolerance tolerance = tolerances[k].lamp;
      if (ids.size() > 1)  // measured for all lamps moving together, but at most this lamp's own tolerance
        tolerance = smaller(tolerance, default_tolerance({design.views[k].view, id, {}, 1}, designed, board).lamp);
      const auto known = std::find_if(out.begin(), out.end(), [&](const DesignedLamp& lamp) { return lamp.id == id; });
      if (known == out.end())
        out.push_back({id, find_light(designed, id, "the design").position_mm, tolerance});
      else
        known->tolerance = smaller(known->tolerance, tolerance);
    }
  }
  return out;
}

namespace {

// Combines measured tolerances of a design's report with the default ones by `choose`.
template <typename Choose>
std::vector<MatchTolerance> tolerances_of(const DesignSpec& design, const Bench& designed, const Board& board,
                                          const std::filesystem::path& design_report, const Choose& choose) {
  std::vector<MatchTolerance> out;
  for (const DesignView& picture : design.views) out.push_back(default_tolerance(picture, designed, board));
  if (design_report.empty() || !std::filesystem::exists(design_report)) return out;
  const Json json = read_json(design_report, "burin/design-report", 1);
  JsonObject report(json, design_report.string());
  for (JsonObject& view : report.objects("views")) {
    if (!view.has("tolerance")) continue;
    const std::string name = view.text("view"), light = view.text("light");
    for (MatchTolerance& t : out) {
      if (t.view != name || t.light != light) continue;
      JsonObject tolerance = view.object("tolerance");
      t.eye = choose(t.eye, read_place(tolerance.object("eye_mm")));
      t.lamp = choose(t.lamp, read_place(tolerance.object("lamp_mm")));
    }
  }
  return out;
}

}  // namespace

std::vector<MatchTolerance> match_tolerances(const DesignSpec& design, const Bench& designed, const Board& board,
                                             const std::filesystem::path& design_report) {
  // A coarse picture has a large tolerance, which does not make a distant place the designed one.
  return tolerances_of(
      design, designed, board, design_report,
      [](const PlaceTolerance& usual, const PlaceTolerance& measured) { return smaller(usual, measured); });
}

std::vector<MatchTolerance> shown_tolerances(const DesignSpec& design, const Bench& designed, const Board& board,
                                             const std::filesystem::path& design_report) {
  return tolerances_of(design, designed, board, design_report,
                       [](const PlaceTolerance&, const PlaceTolerance& measured) { return measured; });
}

Offset offset_of(const Eigen::Vector3d& designed_mm, const Eigen::Vector3d& measured_mm, const Board& board,
                 const PlaceTolerance& tolerance) {
  const Eigen::Vector3d from = designed_mm - middle_of(board), to = measured_mm - middle_of(board);
  const Eigen::Vector3d away = from.normalized(), level = Eigen::Vector3d::UnitZ().cross(away);
  const Eigen::Vector3d right = level.norm() > 1e-6 ? level.normalized() : Eigen::Vector3d::UnitX();
  Offset out;
  // Sideways and up at the designed distance: moving along the same line of sight changes neither.
  const double along = to.dot(away), scale = along > 0 ? from.norm() / along : 1;
  out.sideways_mm = scale * to.dot(right);
  out.up_mm = scale * to.dot(away.cross(right));
  out.along_mm = to.norm() - from.norm();
  out.degrees = std::atan2(from.cross(to).norm(), from.dot(to)) * 180 / std::numbers::pi;
  out.mm = (to - from).norm();
  const Reach reach = reach_of(tolerance, from.norm());
  out.reaches = along > 0 ? std::hypot(out.sideways_mm / reach.sideways_mm, out.up_mm / reach.up_mm,
                                       out.along_mm / reach.along_mm)
                          : INFINITY;
  return out;
}

bool Matching::complete() const {
  const auto decided = [](const Match& match) { return !match.measured.empty(); };
  return std::all_of(views.begin(), views.end(), decided) && std::all_of(lamps.begin(), lamps.end(), decided);
}

Matching match_bench(const DesignSpec& design, const Bench& designed, const Bench& measured, const Board& board,
                     const std::vector<MatchTolerance>& tolerances, const GivenNames& given) {
  if (tolerances.size() != design.views.size())
    fail("match_bench", "there is not one tolerance a picture", "call match_tolerances()");
  std::map<std::string, PlaceTolerance> eyes;
  std::vector<std::string> view_names;
  for (std::size_t k = 0; k < design.views.size(); ++k) {
    const auto [at, first] = eyes.emplace(design.views[k].view, tolerances[k].eye);
    if (first) view_names.push_back(design.views[k].view);
    at->second = smaller(at->second, tolerances[k].eye);
  }
  const std::vector<DesignedLamp> lamps = lamps_to_match(design, designed, measured, board, tolerances);
  Matching out;
  for (const std::string& name : view_names) {
    const Eigen::Vector3d place = eye_of(find_view(designed, name, "the designed bench"));
    Match& match = out.views.emplace_back(Match{name, {}, false, {}, {}});
    for (const View& view : measured.views)
      sort_in(match, view.name, offset_of(place, eye_of(view), board, eyes.at(name)));
    decide(match, given.views, false, 0);
  }
  const bool one_lamp = lamps.size() == 1 && measured.lights.size() == 1;
  for (const DesignedLamp& lamp : lamps) {
    Match& match = out.lamps.emplace_back(Match{lamp.id, {}, false, {}, {}});
    for (const Light& light : measured.lights)
      sort_in(match, light.id, offset_of(lamp.at_mm, light.position_mm, board, lamp.tolerance));
    decide(match, given.lamps, one_lamp, (lamp.at_mm - middle_of(board)).norm());
  }
  undo_shared(out.views);
  undo_shared(out.lamps);
  std::string views, lights;
  for (const View& view : measured.views) views += (views.empty() ? "" : ", ") + view.name;
  for (const Light& light : measured.lights) lights += (lights.empty() ? "" : ", ") + light.id;
  const auto is_view = [&](const std::string& name) {
    return std::any_of(measured.views.begin(), measured.views.end(), [&](const View& v) { return v.name == name; });
  };
  const auto is_lamp = [&](const std::string& id) {
    return std::any_of(measured.lights.begin(), measured.lights.end(), [&](const Light& l) { return l.id == id; });
  };
  require_names(given.views, out.views, is_view, kView.option, views);
  require_names(given.lamps, out.lamps, is_lamp, kLamp.option, lights);
  out.bench = renamed_bench(measured, out);
  add_far_lights(design, designed, out);
  return out;
}

std::vector<Finding> matched_findings(const Matching& matching, const std::filesystem::path& where) {
  constexpr double kInPlace_mm = 1;
  std::vector<Finding> out;
  for (const auto& [kind, matches] : {std::pair{&kView, &matching.views}, {&kLamp, &matching.lamps}}) {
    std::string in_place;
    for (const Match& match : *matches) {
      const Candidate* taken = match.measured.empty() ? nullptr : candidate_named(match, match.measured);
      if (taken == nullptr) continue;
      const bool near = taken->offset.reaches <= 1;
      if (near && taken->offset.mm < kInPlace_mm) {
        in_place += fmt::format("{}\"{}\" is \"{}\"", in_place.empty() ? "" : ", ", match.designed, match.measured);
        continue;
      }
      Finding finding{
          FindingCode::position_changed, near ? Finding::Severity::note : Finding::Severity::warning, where, {}, {}};
      finding.what = fmt::format("{} \"{}\" of the design is \"{}\"{}, {}", kind->what, match.designed, match.measured,
                                 match.given ? " as given" : "", in_words(taken->offset));
      if (!near) finding.remedy = "the next board is designed for where it was measured";
      out.push_back(std::move(finding));
    }
    if (!in_place.empty())
      out.push_back({FindingCode::position_changed,
                     Finding::Severity::note,
                     where,
                     std::string(kind->what) + "s in their places: " + in_place,
                     {}});
  }
  return out;
}

void require_complete(const Matching& matching, const std::filesystem::path& where) {
  std::string questions;
  int count = 0;
  for (const auto& [kind, matches] : {std::pair{&kView, &matching.views}, {&kLamp, &matching.lamps}})
    for (const Match& match : *matches)
      if (match.measured.empty())
        questions += fmt::format("{}({}) {}", count == 0 ? "" : "; ", count + 1, question(*kind, match)), ++count;
  if (questions.empty()) return;
  fail(where.string(), "which of the measured places are those of the design is not certain, and it is not guessed",
       "decide: " + questions);
}

std::string in_words(const Offset& offset) {
  const auto mm = [](double value) { return fmt::format("{:.{}f}", value, value < 9.95 ? 1 : 0); };
  std::string parts;
  const auto add = [&](double value_mm, const char* below, const char* above) {
    const std::string size = mm(std::abs(value_mm));
    if (size != "0.0")
      parts += fmt::format("{}{} mm {}", parts.empty() ? "" : ", ", size, value_mm < 0 ? below : above);
  };
  add(offset.sideways_mm, "to the left", "to the right");
  add(offset.up_mm, "down", "up");
  add(offset.along_mm, "nearer", "further away");
  if (parts.empty()) return "in its place";
  return fmt::format("{}; {} mm and {:.2f} degrees in all", parts, mm(offset.mm), offset.degrees);
}

void add_given_name(const std::string& option, const std::string& text, std::map<std::string, std::string>& names) {
  const std::size_t at = text.find('=');
  if (at == std::string::npos || at == 0 || at + 1 == text.size())
    fail(option + " " + text, "is not DESIGNED=MEASURED", "write it as in " + option + " middle=v01");
  if (!names.emplace(text.substr(0, at), text.substr(at + 1)).second)
    fail(option + " " + text, "\"" + text.substr(0, at) + "\" is given twice", "keep one of them");
}

}  // namespace burin

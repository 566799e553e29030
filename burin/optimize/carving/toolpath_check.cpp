#include "burin/optimize/carving/toolpath_check.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <unordered_map>

#include "burin/render/error.h"

namespace burin {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// One line's words, by letter; a letter may come several times only if it is G or M.
struct Words {
  std::vector<double> g, m;
  std::array<double, 26> value;
  std::array<bool, 26> given{};

  bool has(char letter) const { return given[letter - 'A']; }
  double operator[](char letter) const { return value[letter - 'A']; }
};

class Machine {
 public:
  Machine(const MachineProfile& profile, std::string name, const Face* face)
      : profile_(profile), name_(std::move(name)), face_(face != nullptr && face->followed() ? face : nullptr) {
    replay_.min_mm.setConstant(kUnknown);
    replay_.max_mm.setConstant(kUnknown);
    // A head that never goes below the face presses: its feed moves are its scratches.
    by_servo_ = profile.depth_by == DepthBy::servo;
    carves_below_face_ =
        !by_servo_ && std::any_of(profile.per_scratch.begin(), profile.per_scratch.end(),
                                  [](const std::string& line) { return line.find("{z_carve}") != std::string::npos; });
  }

  void line(std::string_view text) {
    ++replay_.lines;
    const Words words = parse(text);
    for (const double g : words.g) modal(g);
    spindle(words);
    if (words.has('F')) feed_mm_min_ = words['F'] * unit_mm_;
    if (elsewhere_) {
      go_elsewhere(words);
    } else if (dwelling_) {
      dwell(words);
    } else if (words.has('X') || words.has('Y') || words.has('Z')) {
      move(words);
    }
  }

  Replay finish() {
    if (carves_below_face_ && clearance_mm(at_) < 0)
      error("the file ends with the tool in the metal", "lift it at the end");
    if (by_servo_ && head_depth_mm_ > 0) error("the file ends with the head pressed down", "lift it at the end");
    return std::move(replay_);
  }

 private:
  [[noreturn]] void error(const std::string& what, const std::string& remedy) const {
    fail(name_ + ":" + std::to_string(replay_.lines), what, remedy);
  }

  Words parse(std::string_view text) const {
    Words words;
    bool message = false;
    std::size_t i = 0;
    while (i < text.size()) {
      const char c = static_cast<char>(std::toupper(static_cast<unsigned char>(text[i])));
      if (c == '(') {
        const std::size_t end = text.find(')', i);
        if (end == std::string_view::npos) error("a comment is not closed", "add )");
        i = end + 1;
      } else if (c == ';' || c == '%' || c == '$' || c == '/' || c == '*') {
        break;
      } else if (c == ' ' || c == '\t' || c == '\r') {
        ++i;
      } else if (c >= 'A' && c <= 'Z') {
        ++i;
        while (i < text.size() && text[i] == ' ') ++i;
        if (i < text.size() && text[i] == '+') ++i;
        double value = 0;
        const auto result =
            std::from_chars(text.data() + i, text.data() + text.size(), value, std::chars_format::fixed);
        if (result.ec != std::errc{} && message) break;
        if (result.ec != std::errc{}) error(std::string("no number after ") + c, "correct the line");
        i = static_cast<std::size_t>(result.ptr - text.data());
        if (c == 'G') {
          words.g.push_back(value);
        } else if (c == 'M') {
          words.m.push_back(value);
          message = true;  // M117 and its like are followed by text
        } else {
          if (words.has(c)) error(std::string(1, c) + " stands twice in a line", "keep one of them");
          words.given[c - 'A'] = true;
          words.value[c - 'A'] = value;
        }
      } else {
        error(std::string("cannot read \"") + text[i] + "\"", "correct the line");
      }
    }
    return words;
  }

  void modal(double g) {
    const int code = static_cast<int>(std::lround(g * 10));
    switch (code) {
      case 0:
        rapid_ = true, moving_ = true;
        break;
      case 10:
        rapid_ = false, moving_ = true;
        break;
      case 40:
        dwelling_ = true;
        break;
      case 200:
        unit_mm_ = 25.4;
        break;
      case 210:
        unit_mm_ = 1;
        break;
      case 900:
        absolute_ = true;
        break;
      case 280:
      case 300:
      case 530:
        elsewhere_ = true;
        break;
      case 20:
      case 30:
        error("has an arc (G2, G3)", "write straight moves only");
      case 910:
        error("has relative coordinates (G91)", "write absolute ones (G90)");
      case 100:
      case 510:
      case 520:
      case 680:
      case 920:
        error("shifts or turns the coordinates (G" + std::to_string(code / 10) + ")", "set offsets on the machine");
      default:
        // Planes, compensation off, work offsets, path modes, feed modes: they move nothing.
        static constexpr std::array kHarmless{170, 180, 190, 400, 430, 431, 490, 540, 550, 560, 570,
                                              580, 590, 610, 611, 640, 690, 800, 901, 911, 940, 970};
        if (std::find(kHarmless.begin(), kHarmless.end(), code) == kHarmless.end())
          error("has an unknown code G" + std::to_string(code / 10), "remove it or check the file on the machine");
    }
  }

  /// What turns a spindle, a beam or a servo. S in other lines is a dwell's or a firmware's setting.
  void spindle(const Words& words) {
    bool on = false, off = false, set = false;
    double command = 0;
    for (const double m : words.m) {
      const int code = static_cast<int>(std::lround(m));
      on = on || code == 3 || code == 4;
      off = off || code == 5;
      set = set || code == 67 || code == 68 || code == 280;
      if (code == 67 || code == 68) command = words.has('Q') ? words['Q'] : 0;
      if (code == 280) command = words.has('S') ? words['S'] : 0;
    }
    if ((on || off || words.m.empty()) && words.has('S') && !dwelling_) spindle_s_ = words['S'];
    if (on || off) spindle_on_ = on;
    if (profile_.laser && (on || (set && command != 0) || (spindle_s_ != 0 && !std::isnan(spindle_s_))))
      error("turns the laser on", "take M3, M4 and S away: the tool on its axis carves with the beam off");
    if (!by_servo_ || !(on || off || set || (spindle_on_ && words.has('S')))) return;
    if (!set) command = spindle_on_ ? spindle_s_ : profile_.servo_up;
    const double depth_um = depth_for_command(profile_.depth_table, command, false);
    if (std::isnan(depth_um) && !(std::abs(command - profile_.servo_up) < 1e-9))
      error("sets the servo to S" + std::to_string(command) + ", which neither lifts it nor is a depth",
            "correct it, or depth_table and servo_up of the machine profile");
    head_depth_mm_ = std::isnan(depth_um) ? 0 : 1e-3 * depth_um;
  }

  /// How far a place lies above the face.
  double clearance_mm(const Eigen::Vector3d& p) const {
    return face_ == nullptr || !p.allFinite() ? p.z() : p.z() - height_mm(*face_, p.head<2>());
  }

  /// Home, or a place in the machine's own coordinates: where that is the file does not tell.
  void go_elsewhere(const Words& words) {
    elsewhere_ = false;
    const bool all = !words.has('X') && !words.has('Y') && !words.has('Z');
    for (int axis = 0; axis < 3; ++axis)
      if (all || words.has("XYZ"[axis])) at_[axis] = kUnknown;
  }

  void dwell(const Words& words) {
    dwelling_ = false;
    if (words.has('S') && profile_.dialect == GcodeDialect::marlin)
      replay_.duration_s += words['S'];
    else if (words.has('P'))
      replay_.duration_s += words['P'] * (profile_.dialect == GcodeDialect::marlin ? 1e-3 : 1);
    else
      error("a dwell (G4) without a time", "add one");
  }

  void move(const Words& words) {
    if (unit_mm_ == 0 || !absolute_)
      error("moves before units and absolute coordinates are set", "begin the file with G21 G90");
    if (!moving_) error("moves without saying how", "write G0 or G1 first");
    Eigen::Vector3d to = at_;
    for (int axis = 0; axis < 3; ++axis)
      if (const char letter = "XYZ"[axis]; words.has(letter)) to[axis] = words[letter] * unit_mm_;
    const Eigen::Vector2d along = to.head<2>() - at_.head<2>();
    const bool along_board = words.has('X') || words.has('Y');
    if (along_board && std::isnan(at_.z()) && carves_below_face_)
      error("moves along the board before the tool was lifted", "go to a safe height first");
    if (along_board && by_servo_ && std::isnan(head_depth_mm_))
      error("moves along the board before the head was lifted", "lift it first");
    if (along_board && by_servo_ && head_depth_mm_ > 0 && !along.allFinite())
      error("carves from a place that the file does not tell", "go to its beginning first, lifted");
    for (int axis = 0; axis < 3; ++axis) {
      if (std::isnan(to[axis])) continue;
      replay_.min_mm[axis] = std::fmin(replay_.min_mm[axis], to[axis]);
      replay_.max_mm[axis] = std::fmax(replay_.max_mm[axis], to[axis]);
    }

    // From an unknown place the length of the way is not known: it is left out.
    const double along_mm = along.allFinite() ? along.norm() : 0;
    const double up_mm = std::isnan(to.z() - at_.z()) ? 0 : std::abs(to.z() - at_.z());
    const bool in_metal = along_mm > 0 && goes_through_metal(to, up_mm);
    if (!rapid_ && feed_mm_min_ <= 0) error("a G1 without a feed rate", "add F");
    replay_.duration_s += duration_s(along_mm, up_mm);
    if (in_metal)
      carve(to, along_mm);
    else
      travel(to, along_mm);
    goes_on_ = in_metal;
    at_ = to;
  }

  /// Whether a move along the board carves. Throws for one that must not be.
  bool goes_through_metal(const Eigen::Vector3d& to, double up_mm) const {
    if (by_servo_) {
      if (head_depth_mm_ > 0 && rapid_) error("moves with G0 through the metal", "carve with G1");
      return head_depth_mm_ > 0;
    }
    if (!carves_below_face_) return !rapid_;
    const double from_mm = clearance_mm(at_), to_mm = clearance_mm(to);
    if (std::max(from_mm, to_mm) >= 0) {
      if (std::min(from_mm, to_mm) < 0) error("goes into or out of the metal at a slant", "plunge and lift straight");
      if (face_ != nullptr && depth_along(to).second > 0)
        error("goes through a high place of the face", "travel higher: raise safe_z_mm");
      return false;
    }
    if (rapid_) error("moves with G0 through the metal", "carve with G1");
    if (up_mm > 0 && face_ == nullptr) error("changes depth within a scratch", "carve at one depth");
    return true;
  }

  /// How far below the face the tool comes on its way from here, least and most.
  std::pair<double, double> depth_along(const Eigen::Vector3d& to) const {
    constexpr int kLooks = 32;
    double least = -clearance_mm(at_), most = least;
    for (int k = 1; k <= kLooks && face_ != nullptr; ++k) {
      const double below = -clearance_mm(at_ + k * (to - at_) / kLooks);
      least = std::min(least, below);
      most = std::max(most, below);
    }
    return {least, most};
  }

  void travel(const Eigen::Vector3d& to, double along_mm) {
    replay_.travel_mm += along_mm;
    if (along_mm > 0 && to.allFinite() && at_.allFinite())
      replay_.lowest_travel_mm = std::min(replay_.lowest_travel_mm, -depth_along(to).second);
  }

  void carve(const Eigen::Vector3d& to, double along_mm) {
    replay_.carve_mm += along_mm;
    ReplayedScratch s{at_.head<2>(), to.head<2>(), by_servo_ ? head_depth_mm_ : kUnknown, replay_.lines};
    if (carves_below_face_) {
      const auto [least_mm, most_mm] = depth_along(to);
      const double least = depth_of_plunge_mm(profile_, least_mm), most = depth_of_plunge_mm(profile_, most_mm);
      if (std::isnan(most))
        error("presses harder than the machine's depth_table tells", "correct the file or the table");
      s.depth_mm = (least + most) / 2;
      s.depth_spread_mm = (most - least) / 2;
    }
    if (face_ == nullptr || !goes_on_ || !in_line(replay_.scratches.back(), s)) {
      replay_.scratches.push_back(s);
      return;
    }
    // A scratch that follows the face bends on its way.
    ReplayedScratch& whole = replay_.scratches.back();
    const double least = std::min(whole.depth_mm - whole.depth_spread_mm, s.depth_mm - s.depth_spread_mm);
    const double most = std::max(whole.depth_mm + whole.depth_spread_mm, s.depth_mm + s.depth_spread_mm);
    whole.to_mm = s.to_mm;
    whole.line = s.line;
    whole.depth_mm = (least + most) / 2;
    whole.depth_spread_mm = (most - least) / 2;
  }

  /// Whether one stroke goes straight on from another: as straight as a file's decimals are.
  static bool in_line(const ReplayedScratch& before, const ReplayedScratch& after) {
    const Eigen::Vector2d u = (after.to_mm - before.from_mm).normalized();
    const Eigen::Vector2d bend = after.from_mm - before.from_mm;
    constexpr double kStraight_mm = 0.02;
    return std::abs(u.x() * bend.y() - u.y() * bend.x()) < kStraight_mm &&
           (after.to_mm - after.from_mm).dot(before.to_mm - before.from_mm) > 0;
  }

  double duration_s(double along_mm, double up_mm) const {
    const double length = std::hypot(along_mm, up_mm);
    if (length == 0) return 0;
    const double slowest = up_mm > 0
                               ? (along_mm > 0 ? std::min(profile_.acceleration_mm_s2, profile_.acceleration_z_mm_s2)
                                               : profile_.acceleration_z_mm_s2)
                               : profile_.acceleration_mm_s2;
    const double rapid = along_mm > 0 ? profile_.rapid_mm_min : profile_.rapid_z_mm_min;
    return move_time_s(length, rapid_ ? rapid : feed_mm_min_, slowest);
  }

  const MachineProfile& profile_;
  std::string name_;
  const Face* face_;  ///< null where it is even
  Replay replay_;
  bool carves_below_face_ = true, by_servo_ = false;
  bool goes_on_ = false;  ///< the move before carved
  bool spindle_on_ = false;
  double spindle_s_ = kUnknown, head_depth_mm_ = kUnknown;
  bool rapid_ = true, moving_ = false, absolute_ = false, dwelling_ = false, elsewhere_ = false;
  double unit_mm_ = 0, feed_mm_min_ = 0;
  Eigen::Vector3d at_ = Eigen::Vector3d::Constant(kUnknown);
};

/// Strokes by the place of their middle, for looking up within a tolerance.
class StrokeIndex {
 public:
  StrokeIndex(std::span<const PlannedScratch> planned, double tolerance_mm, double depth_share)
      : planned_(planned),
        tolerance_mm_(tolerance_mm),
        depth_share_(depth_share),
        cell_mm_(4 * tolerance_mm),
        hits_(planned.size(), 0) {
    for (std::size_t i = 0; i < planned.size(); ++i)
      cells_[key(cell(planned[i].from_mm + planned[i].to_mm))].push_back(i);
  }

  /// The planned stroke with these ends and depth that was hit least often so far, and counts the hit; -1 if none.
  std::ptrdiff_t hit(const ReplayedScratch& s) {
    std::ptrdiff_t best = -1;
    const auto [column, row] = cell(s.from_mm + s.to_mm);
    for (std::int64_t c = column - 1; c <= column + 1; ++c)
      for (std::int64_t r = row - 1; r <= row + 1; ++r) {
        const auto found = cells_.find(key({c, r}));
        if (found == cells_.end()) continue;
        for (const std::size_t i : found->second)
          if (same(planned_[i], s) && (best < 0 || hits_[i] < hits_[best])) best = static_cast<std::ptrdiff_t>(i);
      }
    if (best >= 0) ++hits_[best];
    return best;
  }

  const std::vector<std::size_t>& hits() const { return hits_; }

 private:
  using Cell = std::pair<std::int64_t, std::int64_t>;

  bool same(const PlannedScratch& p, const ReplayedScratch& s) const {
    const auto near = [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
      return (a - b).norm() <= tolerance_mm_;
    };
    const double depth_tolerance_mm = tolerance_mm_ + depth_share_ * p.depth_mm;
    return (std::isnan(s.depth_mm) || std::abs(p.depth_mm - s.depth_mm) + s.depth_spread_mm <= depth_tolerance_mm) &&
           ((near(p.from_mm, s.from_mm) && near(p.to_mm, s.to_mm)) ||
            (near(p.from_mm, s.to_mm) && near(p.to_mm, s.from_mm)));
  }
  Cell cell(const Eigen::Vector2d& sum_of_ends) const {  // ends within the tolerance move their sum by at most twice it
    return {static_cast<std::int64_t>(std::floor(sum_of_ends.x() / cell_mm_)),
            static_cast<std::int64_t>(std::floor(sum_of_ends.y() / cell_mm_))};
  }
  static std::int64_t key(const Cell& cell) { return cell.first * 0x1000003 + cell.second; }

  std::span<const PlannedScratch> planned_;
  double tolerance_mm_, depth_share_, cell_mm_;
  std::vector<std::size_t> hits_;
  std::unordered_map<std::int64_t, std::vector<std::size_t>> cells_;
};

/// How many of the carved strokes are planned ones once x (or y) is turned round about the middle of what they cover.
std::size_t found_when_mirrored(std::span<const ReplayedScratch> carved, std::span<const PlannedScratch> planned,
                                int axis, double tolerance_mm, double depth_share) {
  const auto middle = [axis](const auto& strokes) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const auto& s : strokes) {
      low = std::min({low, s.from_mm[axis], s.to_mm[axis]});
      high = std::max({high, s.from_mm[axis], s.to_mm[axis]});
    }
    return (low + high) / 2;
  };
  const double from_middle = middle(carved), to_middle = middle(planned);
  StrokeIndex index(planned, 4 * tolerance_mm, depth_share);
  std::size_t count = 0;
  for (ReplayedScratch s : carved) {
    s.from_mm[axis] = to_middle + (from_middle - s.from_mm[axis]);
    s.to_mm[axis] = to_middle + (from_middle - s.to_mm[axis]);
    const std::ptrdiff_t i = index.hit(s);
    if (i >= 0 && index.hits()[i] == 1) ++count;
  }
  return count;
}

}  // namespace

Replay replay_gcode(std::string_view text, const MachineProfile& machine, const std::string& name, const Face* face) {
  Machine replayed(machine, name, face);
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    replayed.line(text.substr(0, end));
    text = end == std::string_view::npos ? std::string_view{} : text.substr(end + 1);
  }
  return replayed.finish();
}

ToolpathCheck check_toolpath(std::span<const ReplayedScratch> carved, std::span<const PlannedScratch> planned,
                             double tolerance_mm, double depth_share) {
  ToolpathCheck check;
  StrokeIndex index(planned, tolerance_mm, depth_share);
  for (const ReplayedScratch& stroke : carved)
    if (index.hit(stroke) < 0 && check.foreign++ == 0) check.first_foreign_line = stroke.line;
  for (std::size_t i = 0; i < planned.size(); ++i) {
    const std::size_t hits = index.hits()[i];
    if (hits == 0 && check.lost++ == 0) check.first_lost = planned[i].scratch;
    if (hits > 1) ++check.doubled;
  }
  if (check.lost > 0 && check.foreign > 0)
    check.mirrored = std::min(check.lost, std::max(found_when_mirrored(carved, planned, 0, tolerance_mm, depth_share),
                                                   found_when_mirrored(carved, planned, 1, tolerance_mm, depth_share)));
  return check;
}

std::vector<std::ptrdiff_t> find_planned(std::span<const ReplayedScratch> carved,
                                         std::span<const PlannedScratch> planned, double tolerance_mm,
                                         double depth_share) {
  StrokeIndex index(planned, tolerance_mm, depth_share);
  std::vector<std::ptrdiff_t> found;
  found.reserve(carved.size());
  for (const ReplayedScratch& s : carved) found.push_back(index.hit(s));
  return found;
}

void fail_unless_good(const ToolpathCheck& check, const std::string& name) {
  if (check.good()) return;
  if (check.mirrored > 0 && check.mirrored * 2 >= check.lost)
    fail(name, "is mirrored: " + std::to_string(check.mirrored) + " scratches lie where their mirror image should",
         "turn one axis of the program that made it");
  std::string what;
  const auto add = [&](std::size_t count, const std::string& text) {
    if (count > 0) what += (what.empty() ? "" : ", ") + std::to_string(count) + " " + text;
  };
  add(check.lost, "scratches lost (the first in row " + std::to_string(check.first_lost + 1) + ")");
  add(check.doubled, "carved twice");
  add(check.foreign, "that were never asked for (the first in line " + std::to_string(check.first_foreign_line) + ")");
  fail(name, what, "check the machine profile's per_scratch block, or write the file again");
}

}  // namespace burin

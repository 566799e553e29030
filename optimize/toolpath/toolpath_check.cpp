#include "burin/optimize/toolpath/toolpath_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <unordered_map>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"

namespace burin {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

// Limits of plausible numbers: a board of a hundred meters, a feed of a kilometer per minute, a dwell of ten minutes.
constexpr double kFarthest_mm = 1e5, kFastest_mm_min = 1e6, kLongestDwell_s = 600, kMostSpindle = 1e6;
constexpr double kSlowest_mm_min = 1;  // grbl's least feed (MINIMUM_FEED_RATE); it ignores smaller ones

// A lower way in the air scrapes along the face: coordinates have no more decimals.
constexpr double kLeastTravel_mm = 0.01;

constexpr double kSameServo = 1e-4;  // tolerance of S by a file's decimals and a controller's digits

constexpr double kMostBlend_mm = 0.005;  // largest deviation of LinuxCNC from the path: well below a groove's width

constexpr double kTravelRounding_mm = 1e-3;  // of the machine's bounds

class Machine {
 public:
  Machine(const MachineProfile& profile, std::string name, const Face* face,
          const std::function<void(const ToolWay&)>& each_way)
      : profile_(profile),
        name_(std::move(name)),
        face_(face != nullptr && face->followed() ? face : nullptr),
        each_way_(each_way) {
    replay_.min_mm.setConstant(kUnknown);
    replay_.max_mm.setConstant(kUnknown);
    by_servo_ = profile.depth_by == DepthBy::servo;
    if (by_servo_) head_output_ = head_output();
    presses_ = presses_by_itself(profile);
  }

  void line(std::string_view text) {
    ++replay_.lines;
    const GcodeLine words = read_gcode_line(text, profile_, name_, replay_.lines);
    if (words.percent) return percent();
    if (words.empty()) return;
    commanded_ = true;
    if (replay_.ended) error("goes on after its end (M2, M30 or %)", "take away what follows the end");
    if (words.home) return go_home();
    for (const int g : words.g) modal(g);
    if (words.has_g(640)) blend(words);
    outputs(words);
    spindle(words);
    if (words.has('F')) feed(words['F'] * unit_mm_);
    if (words.has('T') && !(words['T'] >= 0 && words['T'] <= 255)) error("names no tool", "correct T");
    if (words.has_g(280) || words.has_g(300))
      go_home(words);
    else if (words.has_g(530))
      go_in_machine_coordinates(words);
    else if (words.has_g(40))
      dwell(words);
    else if (words.has_axis() && !settings(words))
      move(words);
    // Motors without power hold no position.
    if (profile_.dialect == GcodeDialect::marlin && (words.has_m(840) || words.has_m(180))) go_home();
    if (words.has_m(2110)) software_endstops(words);
    if (words.has_m(20) || words.has_m(300)) end(words);
  }

  Replay finish() {
    if (clearance_mm(at_) < 0) error("the file ends with the tool in the metal", "lift it at the end");
    if (by_servo_ && head_depth_mm_ > 0) error("the file ends with the head pressed down", "lift it at the end");
    if (spindle_on_ && !by_servo_ && !replay_.ended) error("the file ends with the spindle on", "add M5 at the end");
    return std::move(replay_);
  }

 private:
  [[noreturn]] void error(const std::string& what, const std::string& remedy) const {
    fail(name_ + ":" + std::to_string(replay_.lines), what, remedy);
  }

  /// True if X, Y and Z are numbers of a setting (Marlin's M201 and similar), and no move.
  static bool settings(const GcodeLine& words) {
    return std::any_of(words.m.begin(), words.m.end(), [](int m) { return m >= 2010 && m <= 2050; });
  }

  /// Begins a program if it comes first, else ends one.
  void percent() {
    if (replay_.ended && percent_ != 1) error("has a % too many", "keep one before the program and one behind it");
    if (percent_ == 0 && commanded_)
      error("has a % within the program, which ends it", "take it away, or put one before the first line");
    if (++percent_ > 2) error("has a % too many", "keep one before the program and one behind it");
    if (percent_ == 2) replay_.ended = true;
  }

  void end(const GcodeLine& words) {
    if (words.has_axis()) error("moves in the line of its end", "give the move its own line");
    if (by_servo_ && head_output_ == kSpindle && spindle_on_ && !lifts_servo(profile_, 0))
      error("ends by a code that turns S off, and S0 presses the head",
            profile_.dialect == GcodeDialect::grbl
                ? "take M2 and M30 away: grbl's files need none"
                : "turn the servo's horn so that a low S lifts, or end the file by % (and begin it so)");
    replay_.ended = true;
    spindle_on_ = false;
  }

  void feed(double mm_min) {
    if (unit_mm_ == 0) error("sets a feed before units are set", "begin the file with G21 G90");
    if (!(mm_min >= kSlowest_mm_min && mm_min <= kFastest_mm_min))
      error("has a feed of " + shortest(mm_min) + " mm/min, which no controller obeys",
            "write one from 1 to 1000000 mm/min");
    feed_mm_min_ = mm_min;
  }

  void modal(int code) {
    switch (code) {
      case 0:
        rapid_ = true, moving_ = true;
        break;
      case 10:
        rapid_ = false, moving_ = true;
        break;
      case 800:
        moving_ = false;
        break;
      case 200:
      case 210: {
        const double unit_mm = code == 200 ? 25.4 : 1;
        if (unit_mm_ != 0 && unit_mm != unit_mm_)
          error("changes the units", "keep millimeters (G21), or inches (G20), from beginning to end");
        unit_mm_ = unit_mm;
        break;
      }
      case 900:
        absolute_ = true;
        break;
      case 610:
      case 611:
      case 640:  // within blend()
        exact_path_ = true;
        break;
      case 430:
      case 490:
      case 540:
      case 550:
      case 560:
      case 570:
      case 580:
      case 590:
      case 591:
      case 592:
      case 593:
        // Offsets define zero; they may come only on the machine, before any move.
        if (moved_ && code != offset_[code >= 540])
          error("changes where zero is after the first move (G" + std::to_string(code / 10) + ")",
                "choose the offset before the first move");
        offset_[code >= 540] = code;
        break;
      default:
        break;  // no motion; read_gcode_line() rejects others
    }
  }

  /// G64: LinuxCNC's tolerance of the path.
  void blend(const GcodeLine& words) {
    if (unit_mm_ == 0) error("sets a path tolerance before units are set", "begin the file with G21 G90");
    if (words.has_g(40)) error("has one P for a dwell (G4) and a path (G64)", "give each its own line");
    const auto allowed = [&](char letter) { return words[letter] >= 0 && words[letter] * unit_mm_ <= kMostBlend_mm; };
    if (!words.has('P') || !allowed('P') || (words.has('Q') && !allowed('Q')))
      error("lets the machine leave the path" +
                (words.has('P') ? " by " + shortest(std::max(words['P'], words['Q']) * unit_mm_) + " mm"
                                : std::string(" by any distance")) +
                " (G64)",
            "write G61, or G64 with a P of at most " + shortest(kMostBlend_mm) + " mm");
  }

  /// M211: Marlin's software endstop of Z at zero.
  void software_endstops(const GcodeLine& words) {
    if (!words.has('S')) return;  // a query
    if (words['S'] != 0 && words['S'] != 1) error("has an M211 that is neither on nor off", "write S0 or S1");
    below_zero_ = words['S'] == 0;
  }

  /// Outputs that move a servo's head: a spindle's S, an analog output or one of Marlin's servos.
  static constexpr int kSpindle = 0, kOutput = 1000, kServo = 2000;  // the latter two plus their number

  static int output_of(const GcodeLine& words) {
    if (words.has_m(670) || words.has_m(680)) return kOutput + static_cast<int>(words['E']);
    return words.has_m(2800) ? kServo + static_cast<int>(words['P']) : kSpindle;
  }

  /// The output by which the profile's block for a scratch presses.
  int head_output() const {
    for (std::string line : profile_.per_scratch) {
      if (line.find("{servo}") == std::string::npos) continue;
      for (std::size_t open = 0; (open = line.find('{')) != std::string::npos;) {
        const std::size_t close = line.find('}', open);
        if (close == std::string::npos) break;
        line.replace(open, close + 1 - open, "1");
      }
      return output_of(read_gcode_line(line, profile_, name_, replay_.lines));
    }
    return kSpindle;
  }

  /// On a laser any output may be the beam, on a servo another head. Only commands known to switch nothing on are
  /// permitted, and those of the head itself.
  void outputs(const GcodeLine& words) {
    if (!profile_.laser && !by_servo_) return;
    for (const int m : words.m) {
      const bool spindle = m == 30 || m == 40, head = spindle || m == 670 || m == 680 || m == 2800;
      if (switches_nothing_on(m)) continue;
      if (profile_.laser && spindle) continue;  // spindle() has the message for it
      if (by_servo_ && head && output_of(words) == head_output_) continue;
      error("has M" + std::to_string(m / 10) + ", which may switch " +
                (by_servo_ ? "another output than the one that moves the head" : "an output, perhaps the beam's"),
            "take it away");
    }
    if (!profile_.laser) return;
    spindle_off_ = spindle_off_ || words.has_m(50);
    fan_off_ = fan_off_ || words.has_m(1070);
    beam_off_ = spindle_off_ && (fan_off_ || profile_.dialect != GcodeDialect::marlin);
  }

  /// Commands of a spindle, a beam or a servo. S in other lines belongs to a dwell or a firmware's setting.
  void spindle(const GcodeLine& words) {
    const bool on = words.has_m(30) || words.has_m(40), off = words.has_m(50);
    const bool set = words.has_m(670) || words.has_m(680) || words.has_m(2800);
    // grbl and LinuxCNC apply S in any line to the spindle; Marlin applies it to the line's code.
    const bool has_s = words.has('S') && (profile_.dialect != GcodeDialect::marlin || on || off);
    if (words.has('S') && !(words['S'] >= 0 && words['S'] <= kMostSpindle))
      error("has an S that no spindle knows", "correct it");
    if (has_s) spindle_s_ = words['S'];
    if (on || off) spindle_on_ = on;
    if (profile_.laser && (on || (spindle_s_ != 0 && !std::isnan(spindle_s_))))
      error("turns the laser on", "take M3, M4 and S away: the tool on its axis carves with the beam off");
    if (!by_servo_) return;
    const bool by_spindle = head_output_ == kSpindle;
    if (!(by_spindle ? on || off || (spindle_on_ && has_s) : set)) return;
    const char letter = words.has_m(2800) ? 'S' : 'Q';
    const double command = !by_spindle ? (words.has(letter) ? words[letter] : kUnknown) : spindle_on_ ? spindle_s_ : 0;
    press(command, by_spindle && !spindle_on_);
  }

  /// A servo's new command; `turned_off`: by M5, which equals S0.
  void press(double command, bool turned_off) {
    if (turned_off && !lifts_servo(profile_, 0))
      error("turns S off (M5), and S0 presses the head",
            "lift it by S" + shortest(profile_.servo_up) + ", the servo_up of the machine profile");
    const double depth_um = turned_off ? kUnknown : depth_for_command(profile_.depth_table, command, false);
    if (!turned_off && std::isnan(depth_um) && !(std::abs(command - profile_.servo_up) < kSameServo))
      error("sets the servo to " + (std::isnan(command) ? "no value" : "S" + shortest(command)) +
                ", which neither lifts it nor is a depth",
            "correct it, or depth_table and servo_up of the machine profile");
    if (head_depth_mm_ > 0 && !carved_since_)
      error("presses the head down and carves nothing", "take these lines away");
    head_depth_mm_ = std::isnan(depth_um) ? 0 : 1e-3 * depth_um;
    carved_since_ = false;
  }

  /// Before any move, the beam must be off and the head up, for any earlier state.
  void require_safe_head() const {
    if (profile_.laser && !beam_off_)
      error("moves before the laser's beam was turned off", profile_.dialect == GcodeDialect::marlin
                                                                ? "write M5 and M107 first, each in a line of its own"
                                                                : "write M5 S0 first");
    if (by_servo_ && std::isnan(head_depth_mm_))
      error("moves before the head was lifted",
            "lift it first, by S" + shortest(profile_.servo_up) + ", the servo_up of the machine profile");
  }

  /// Height of a place above the face.
  double clearance_mm(const Eigen::Vector3d& p) const {
    return face_ == nullptr || !p.allFinite() ? p.z() : p.z() - height_mm(*face_, p.head<2>());
  }

  bool in_metal() const { return by_servo_ ? head_depth_mm_ > 0 : clearance_mm(at_) < 0; }

  /// Home, or another place stored on the machine: the file does not contain it.
  void go_home(const GcodeLine& words = {}) {
    require_safe_head();
    if (in_metal()) error("goes home with the tool in the metal", "lift it first");
    // All but Marlin take the words as an intermediate place on the board.
    if (words.has_axis() && profile_.dialect != GcodeDialect::marlin)
      error("goes home by a place of the board", "lift the tool by a line of its own, and take X, Y and Z away");
    if (profile_.dialect == GcodeDialect::marlin && words.has_g(280)) {
      // On most machines down to the table, where the sheet is; and Z 0 is there from then on.
      if (!words.has_axis() || words.has('Z'))
        error("homes Z (G28), by which Marlin goes down to the table and forgets where Z zero was set",
              "home before you set zero; G28 X0 Y0 at the end of a file homes X and Y alone");
      zero_is_lost_ = true;
    }
    leave_for_unknown(words);
  }

  /// Move to a place unknown to the file, along the named axes, or all.
  void leave_for_unknown(const GcodeLine& words) {
    const Eigen::Vector3d from = at_;
    for (int axis = 0; axis < 3; ++axis)
      if (!words.has_axis() || words.has("XYZ"[axis])) at_[axis] = kUnknown;
    moved_ = true;
    if (each_way_) each_way_({from, at_, replay_.lines, false});
  }

  /// G53: a place in the machine's own coordinates.
  void go_in_machine_coordinates(const GcodeLine& words) {
    require_safe_head();
    if (in_metal()) error("leaves for a place of the machine with the tool in the metal", "lift it first");
    const bool along = words.has('X') || words.has('Y');
    if (along && (words.has('Z') || (!by_servo_ && !clear_of_face(at_))))
      error("moves along the board in machine coordinates before the tool was lifted", "lift it by a line of its own");
    if (words.has('Z') && words['Z'] < 0)
      error("goes down to a place of the machine (G53 Z), and the file does not show its surroundings",
            "write G53 G0 Z0, the highest place that it has");
    if (!moving_ || !words.has_axis()) error("has a G53 without a move", "write G0 and a place, or take it away");
    leave_for_unknown(words);
  }

  /// True if a place is high enough for a way along the board. A head that presses by itself needs no Z.
  bool clear_of_face(const Eigen::Vector3d& p) const {
    const double mm = clearance_mm(p);
    return presses_ ? !(mm < 0) : mm >= kLeastTravel_mm;
  }

  void dwell(const GcodeLine& words) {
    if (words.has_axis() || words.has_g(0) || words.has_g(10))
      error("moves in the line of a dwell (G4)", "give each its own line");
    double seconds = kUnknown;
    if (words.has('S') && profile_.dialect == GcodeDialect::marlin)
      seconds = words['S'];
    else if (words.has('P'))
      seconds = words['P'] * (profile_.dialect == GcodeDialect::marlin ? 1e-3 : 1);
    else
      error("a dwell (G4) without a time", "add one");
    if (!(seconds >= 0 && seconds <= kLongestDwell_s))
      error("rests for " + shortest(seconds) + " s (G4)", "write a time from 0 to 600 s");
    replay_.duration_s += seconds;
  }

  /// Throws Error for an invalid place, or for one beyond the machine's reach.
  void check_place(const GcodeLine& words, const Eigen::Vector3d& to) const {
    for (int axis = 0; axis < 3; ++axis) {
      if (!words.has("XYZ"[axis])) continue;
      if (!(std::abs(to[axis]) <= kFarthest_mm))
        error(std::string("goes to ") + "XYZ"[axis] + shortest(to[axis]) + " mm, where no machine is", "correct it");
      if (axis == 2 || !profile_.travel) continue;
      if (to[axis] < profile_.travel->min_mm[axis] - kTravelRounding_mm ||
          to[axis] > profile_.travel->max_mm[axis] + kTravelRounding_mm)
        error(std::string("goes to ") + "XYZ"[axis] + fixed(to[axis], 3) + ", out of the machine's travel (" +
                  fixed(profile_.travel->min_mm[axis], 3) + " to " + fixed(profile_.travel->max_mm[axis], 3) + ")",
              "move the board, or correct travel_mm of the machine profile");
    }
  }

  /// Vertical moves: into the metal once for each scratch, and not deeper in between.
  void check_plunge(const Eigen::Vector3d& to, double along_mm, double up_mm) {
    if (by_servo_ || along_mm > 0) return;
    const double from_mm = clearance_mm(at_), to_mm = clearance_mm(to);
    if (to_mm < 0 && !(from_mm < 0)) {
      if (rapid_) error("goes into the metal with G0", "plunge with G1");
      if (std::isnan(from_mm)) error("goes into the metal from a height that is not in the file", "lift it first");
      if (!to.allFinite())
        error("goes into the metal at a place that is not in the file", "go to the scratch's beginning first");
      carved_since_ = false;
    } else if (to_mm < 0 && up_mm > 0) {
      error("changes its depth in the metal without a way along the board", "plunge to the depth at once");
    } else if (from_mm < 0 && to_mm >= 0 && !carved_since_) {
      error("goes into the metal and carves nothing: a hole", "take these lines away");
    }
  }

  void move(const GcodeLine& words) {
    if (unit_mm_ == 0 || !absolute_)
      error("moves before units and absolute coordinates are set", "begin the file with G21 G90");
    const bool said = profile_.dialect != GcodeDialect::marlin || words.has_g(0) || words.has_g(10);
    if (!moving_ || !said) error("moves without saying how", "write G0 or G1 first");
    Eigen::Vector3d to = at_;
    for (int axis = 0; axis < 3; ++axis)
      if (const char letter = "XYZ"[axis]; words.has(letter)) to[axis] = words[letter] * unit_mm_;
    if (zero_is_lost_ && (words.has('X') || words.has('Y')))
      error("moves after G28, by which Marlin forgets where X and Y zero were set",
            "home before you set zero, or at the end of the file");
    check_place(words, to);
    require_safe_head();
    if (profile_.dialect == GcodeDialect::marlin && to.z() < 0 && !below_zero_)
      error("goes below Z0, where Marlin's software endstops stop the tool without a word",
            "write M211 S0 before it, and M211 S1 at the end");
    moved_ = true;
    const Eigen::Vector2d along = to.head<2>() - at_.head<2>();
    const bool along_board = words.has('X') || words.has('Y');
    if (along_board && std::isnan(at_.z()) && !by_servo_ && !presses_)
      error("moves along the board before the tool was lifted", "go to a safe height first");
    if (along_board && by_servo_ && head_depth_mm_ > 0 && !along.allFinite())
      error("carves from a place that is not in the file", "go to its beginning first, lifted");
    if (by_servo_ && clearance_mm(to) < 0)
      error("goes below the face to Z" + fixed(to.z(), 4) + ", and a servo presses the head, not Z",
            "keep Z at the safe height");
    if (along_board && !by_servo_ && !along.allFinite() && !(clear_of_face(to) && clear_of_face(at_)))
      error("moves along the board before the tool was lifted", "go to a safe height first");
    if (presses_ && along_board && !rapid_ && !along.allFinite())
      error("carves from a place that is not in the file", "go to its beginning first, lifted");
    for (int axis = 0; axis < 3; ++axis) {
      if (std::isnan(to[axis])) continue;
      replay_.min_mm[axis] = std::fmin(replay_.min_mm[axis], to[axis]);
      replay_.max_mm[axis] = std::fmax(replay_.max_mm[axis], to[axis]);
    }

    // From an unknown place the length of the way is unknown and left out.
    const double along_mm = along.allFinite() ? along.norm() : 0;
    const double up_mm = std::isnan(to.z() - at_.z()) ? 0 : std::abs(to.z() - at_.z());
    const bool in_metal = along_mm > 0 && goes_through_metal(to, up_mm);
    check_plunge(to, along_mm, up_mm);
    if (each_way_) each_way_({at_, to, replay_.lines, in_metal});
    if (!rapid_ && feed_mm_min_ <= 0) error("a G1 without a feed rate", "add F");
    replay_.duration_s += duration_s(along_mm, up_mm);
    if (in_metal)
      carve(to, along_mm);
    else
      travel(to, along_mm);
    goes_on_ = in_metal;
    at_ = to;
  }

  /// True if a move along the board carves. Throws Error for a forbidden move.
  bool goes_through_metal(const Eigen::Vector3d& to, double up_mm) const {
    if (by_servo_) {
      if (head_depth_mm_ > 0 && rapid_) error("moves with G0 through the metal", "carve with G1");
      return head_depth_mm_ > 0;
    }
    const double from_mm = clearance_mm(at_), to_mm = clearance_mm(to);
    if (presses_ && !(from_mm < 0) && !(to_mm < 0) && !(height_along(to).least_mm < 0)) return !rapid_;
    if (std::max(from_mm, to_mm) >= 0) {
      if (std::min(from_mm, to_mm) < 0) error("goes into or out of the metal at a slant", "plunge and lift straight");
      const double least_mm = height_along(to).least_mm;
      if (least_mm < 0) error("goes through a high place of the face", "travel higher: raise safe_z_mm");
      if (least_mm < kLeastTravel_mm)
        error("travels on the face, " + fixed(least_mm, 4) + " mm above it", "raise safe_z_mm");
      return false;
    }
    if (rapid_) error("moves with G0 through the metal", "carve with G1");
    if (up_mm > 0 && face_ == nullptr) error("changes depth within a scratch", "carve at one depth");
    return true;
  }

  /// Heights above the face on the way from the current place.
  HeightRange height_along(const Eigen::Vector3d& to) const {
    if (face_ != nullptr && at_.allFinite() && to.allFinite()) return height_above(*face_, at_, to);
    return {std::fmin(clearance_mm(at_), clearance_mm(to)), std::fmax(clearance_mm(at_), clearance_mm(to))};
  }

  void travel(const Eigen::Vector3d& to, double along_mm) {
    replay_.travel_mm += along_mm;
    if (along_mm > 0 && to.allFinite() && at_.allFinite())
      replay_.lowest_travel_mm = std::fmin(replay_.lowest_travel_mm, height_along(to).least_mm);
  }

  void carve(const Eigen::Vector3d& to, double along_mm) {
    if (profile_.dialect == GcodeDialect::linuxcnc && !exact_path_)
      error("carves before a path mode is set, and LinuxCNC's own one rounds corners", "write G61 first");
    replay_.carve_mm += along_mm;
    carved_since_ = true;
    ReplayedScratch s{at_.head<2>(), to.head<2>(), by_servo_ ? head_depth_mm_ : kUnknown, replay_.lines};
    if (!by_servo_ && clearance_mm(at_) < 0) {
      const HeightRange height = height_along(to);
      const double least = depth_of_plunge_mm(profile_, -height.most_mm),
                   most = depth_of_plunge_mm(profile_, -height.least_mm);
      if (std::isnan(most))
        error("presses harder than the machine's depth_table covers", "correct the file or the table");
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

  /// True if one stroke continues another in a straight line, up to a file's decimals.
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
  const Face* face_;  ///< null for an even face
  Replay replay_;
  const std::function<void(const ToolWay&)>& each_way_;
  bool by_servo_ = false;
  bool presses_ = false;  ///< by itself, above the face: its feed moves are its scratches
  bool goes_on_ = false;  ///< the previous move carved
  bool spindle_on_ = false;
  bool spindle_off_ = false, fan_off_ = false, beam_off_ = false;  ///< a laser's, set by this file
  int head_output_ = kSpindle;                                     ///< output of a servo's head
  bool exact_path_ = false;                                        ///< LinuxCNC has a command to keep to the path
  bool below_zero_ = false;                                        ///< Marlin has a command that permits Z below zero
  double spindle_s_ = kUnknown, head_depth_mm_ = kUnknown;
  bool carved_since_ = false;  ///< since the tool entered the metal
  bool rapid_ = true, moving_ = false, absolute_ = false, moved_ = false, zero_is_lost_ = false;
  bool commanded_ = false;               ///< the file had lines other than comments
  int percent_ = 0;                      ///< number of % lines
  std::array<int, 2> offset_{490, 540};  ///< of the tool's length, and of the work
  double unit_mm_ = 0, feed_mm_min_ = 0;
  Eigen::Vector3d at_ = Eigen::Vector3d::Constant(kUnknown);
};

/// Strokes by the place of their middle, for searches within a tolerance.
class StrokeIndex {
 public:
  StrokeIndex(std::span<const PlannedScratch> planned, double tolerance_mm, double depth_share,
              double depth_tolerance_mm = 0)
      : planned_(planned),
        tolerance_mm_(tolerance_mm),
        depth_tolerance_mm_(depth_tolerance_mm > 0 ? depth_tolerance_mm : tolerance_mm),
        depth_share_(depth_share),
        cell_mm_(4 * tolerance_mm),
        hits_(planned.size(), 0) {
    for (std::size_t i = 0; i < planned.size(); ++i)
      cells_[key(cell(planned[i].from_mm + planned[i].to_mm))].push_back(i);
  }

  /// Returns the planned stroke with these ends and depth and the fewest hits so far, and counts the hit; -1 if none.
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
    const double depth_tolerance_mm = depth_tolerance_mm_ + depth_share_ * p.depth_mm;
    return (std::isnan(s.depth_mm) || std::abs(p.depth_mm - s.depth_mm) + s.depth_spread_mm <= depth_tolerance_mm) &&
           ((near(p.from_mm, s.from_mm) && near(p.to_mm, s.to_mm)) ||
            (near(p.from_mm, s.to_mm) && near(p.to_mm, s.from_mm)));
  }
  Cell cell(const Eigen::Vector2d& sum_of_ends) const {  // ends within the tolerance move their sum by at most twice it
    // Farther places share the outermost cell; same() separates them.
    constexpr double kOutermost = 1e15;
    const auto index = [&](double mm) {
      const double at = std::floor(mm / cell_mm_);
      return static_cast<std::int64_t>(std::isnan(at) ? kOutermost : std::clamp(at, -kOutermost, kOutermost));
    };
    return {index(sum_of_ends.x()), index(sum_of_ends.y())};
  }
  static std::uint64_t key(const Cell& cell) {
    return static_cast<std::uint64_t>(cell.first) * 0x1000003 + static_cast<std::uint64_t>(cell.second);
  }

  std::span<const PlannedScratch> planned_;
  double tolerance_mm_, depth_tolerance_mm_, depth_share_, cell_mm_;
  std::vector<std::size_t> hits_;
  std::unordered_map<std::uint64_t, std::vector<std::size_t>> cells_;
};

/// Number of carved strokes that are planned ones after mirroring x (or y) about the middle of their extent.
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

Replay replay_gcode(std::string_view text, const MachineProfile& machine, const std::string& name, const Face* face,
                    const std::function<void(const ToolWay&)>& each_way) {
  Machine replayed(machine, name, face, each_way);
  const std::optional<GcodeHead> head = read_gcode_head(text);
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    replayed.line(text.substr(0, end));
    text = end == std::string_view::npos ? std::string_view{} : text.substr(end + 1);
  }
  Replay replay = replayed.finish();
  replay.head = head;
  return replay;
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
                                         double depth_share, double depth_tolerance_mm) {
  StrokeIndex index(planned, tolerance_mm, depth_share, depth_tolerance_mm);
  std::vector<std::ptrdiff_t> found;
  found.reserve(carved.size());
  for (const ReplayedScratch& s : carved) found.push_back(index.hit(s));
  return found;
}

void fail_unless_ended(const Replay& replay, const MachineProfile& machine, const std::string& name) {
  const std::size_t carved = replay.scratches.size(),
                    named = replay.head ? replay.head->last + 1 - replay.head->first : 0;
  if (replay.head && carved != named)
    fail(name,
         "carves " + counted(carved, "scratch") + " of the " + std::to_string(named) + " that its head names (" +
             head_text(*replay.head) + "): " +
             (carved < named ? counted(named - carved, "scratch") + " lost, it was cut off or changed"
                             : std::to_string(carved - named) + " too many, it was changed"),
         "write it again, or copy it again from where it is whole");
  if (replay.ended || machine.dialect == GcodeDialect::marlin) return;
  // If the profile ends its files so, a file without it was cut off; LinuxCNC accepts none without it.
  const bool its_own = std::any_of(machine.end.begin(), machine.end.end(), [](const std::string& line) {
    return line.find("M2") != std::string::npos || line.find("M30") != std::string::npos;
  });
  if (its_own || machine.dialect == GcodeDialect::linuxcnc)
    fail(name, "has no end (M2 or M30): it was cut off, or never whole", "write it again, or add M2 as its last line");
}

void fail_unless_good(const ToolpathCheck& check, const std::string& name) {
  if (check.good()) return;
  if (check.mirrored > 0 && check.mirrored * 2 >= check.lost)
    fail(name, "is mirrored: for " + counted(check.mirrored, "scratch") + " the mirror image is carved",
         "turn one axis of the program that made it");
  std::string what;
  const auto add = [&](std::size_t count, const std::string& text) {
    if (count > 0) what += (what.empty() ? "" : ", ") + counted(count, "scratch") + " " + text;
  };
  add(check.lost, "lost (the first in row " + std::to_string(check.first_lost + 1) + ")");
  add(check.doubled, "carved twice");
  add(check.foreign, "never asked for (the first in line " + std::to_string(check.first_foreign_line) + ")");
  fail(name, what, "check the machine profile's per_scratch block, or write the file again");
}

}  // namespace burin

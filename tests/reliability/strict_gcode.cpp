#include "tests/reliability/strict_gcode.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <set>

namespace burin::strict {
namespace {

using Int = std::int64_t;
using Kind = Controller::Kind;

constexpr Int kNm = 1'000'000;       // in a millimeter
constexpr Int kUnknown = INT64_MIN;  // a place that the file does not tell
constexpr Int kFar = 100'000 * kNm;  // no board is 100 m long
constexpr Int kScrape = kNm / 100;   // travel lower than 0.01 mm scrapes
constexpr Int kSlowest = kNm, kFastest = Int{1'000'000} * kNm;

struct Alarm {
  std::string why;
};

struct Word {
  char letter;
  Int value;  // in millionths of what it says
};

// "-12.345" in millionths; digits behind the sixth decimal round to nothing that matters (1e-6 mm).
Int number(std::string_view text, std::size_t& at, Kind kind) {
  while (at < text.size() && text[at] == ' ') ++at;
  bool negative = false;
  if (at < text.size() && (text[at] == '-' || text[at] == '+')) negative = text[at++] == '-';
  Int whole = 0, part = 0, scale = kNm;
  int digits = 0;
  bool point = false;
  for (; at < text.size(); ++at) {
    const char c = text[at];
    if (c == '.' && !point) {
      point = true;
    } else if (c >= '0' && c <= '9') {
      ++digits;
      if (digits > 15) throw Alarm{"more digits than a double has"};
      if (!point) {
        whole = 10 * whole + (c - '0');
        if (whole >= 10'000'000) throw Alarm{"a number of eight digits"};
      } else if (scale > 1 && !(kind == Kind::grbl && digits > 8)) {
        scale /= 10;
        part += scale * (c - '0');
      }
    } else {
      break;
    }
  }
  if (digits == 0) throw Alarm{"a letter without a number"};
  return (negative ? -1 : 1) * (whole * kNm + part);
}

// Comments away; what is left are words.
std::vector<Word> words_of(std::string_view line, const Controller& c) {
  std::vector<Word> words;
  if (line.size() > c.line_bytes) throw Alarm{"the line does not fit the buffer"};
  for (const char b : line)
    if (b != '\t' && (b < 0x20 || b > 0x7E)) throw Alarm{"a byte that is no character"};
  if (c.kind == Kind::grbl && line.find_first_of("!?~") != std::string_view::npos) throw Alarm{"a real-time command"};
  const auto active = [&](std::string_view comment) {
    if (c.kind != Kind::linuxcnc) return;
    std::string upper;
    for (const char b : comment)
      if (b != ' ' && b != '\t') upper += static_cast<char>(b >= 'a' && b <= 'z' ? b - 32 : b);
    for (const char* word : {"LOG", "PROBEOPEN", "PROBECLOSE", "PY,", "ABORT"})
      if (upper.starts_with(word)) throw Alarm{"a comment that acts"};
  };
  for (std::size_t at = 0; at < line.size();) {
    const char b = line[at];
    if (b == ';') {
      active(line.substr(at + 1));
      break;
    }
    if (b == ' ' || (b == '\t' && c.kind != Kind::marlin)) {
      ++at;
      continue;
    }
    if (b == '(' && c.kind != Kind::marlin) {
      const std::size_t end = line.find(')', at), inner = line.find('(', at + 1);
      if (end == std::string_view::npos || inner < end) throw Alarm{"parentheses"};
      active(line.substr(at + 1, end - at - 1));
      at = end + 1;
      continue;
    }
    const char letter = b >= 'a' && b <= 'z' && c.kind != Kind::marlin ? static_cast<char>(b - 32) : b;
    if (letter < 'A' || letter > 'Z') throw Alarm{std::string("the character ") + b};
    ++at;
    const Int value = number(line, at, c.kind);
    if (c.kind == Kind::marlin && letter == 'M' && (value == 117 * kNm || value == 118 * kNm)) {
      if (!words.empty() && !(words.size() == 1 && words[0].letter == 'N')) throw Alarm{"text behind a command"};
      return {};
    }
    words.push_back({letter, value});
  }
  return words;
}

constexpr double kSlack = 0.03;  // mm: what a file's decimals leave

bool lies_in(const Standing& s, double x, double y) {
  if (s.corners.empty()) return (x - s.x) * (x - s.x) + (y - s.y) * (y - s.y) < s.radius * s.radius;
  // Turns round the place: a whole one if it lies inside.
  double turned = 0;
  for (std::size_t i = 0; i < s.corners.size(); ++i) {
    const auto &p = s.corners[i], &q = s.corners[(i + 1) % s.corners.size()];
    const double ax = p[0] - x, ay = p[1] - y, bx = q[0] - x, by = q[1] - y;
    turned += std::atan2(ax * by - ay * bx, ax * bx + ay * by);
  }
  return std::abs(turned) > 3;
}

// A way looked at every quarter of a millimeter.
void look_along(const Sheet& sheet, const double from[3], const double to[3], bool carves) {
  const double length = std::hypot(to[0] - from[0], to[1] - from[1]);
  const int looks = std::clamp(static_cast<int>(length / 0.25) + 2, 2, 4000);
  for (int k = 0; k <= looks; ++k) {
    const double t = static_cast<double>(k) / looks;
    const double x = from[0] + t * (to[0] - from[0]), y = from[1] + t * (to[1] - from[1]);
    const double above = from[2] + t * (to[2] - from[2]) - (sheet.face ? sheet.face(x, y) : 0);
    if (above < -sheet.deepest - kSlack) throw Alarm{"deeper than the tip"};
    const double bx = sheet.map[0] * x + sheet.map[1] * y + sheet.map[2],
                 by = sheet.map[3] * x + sheet.map[4] * y + sheet.map[5];
    for (const Standing& s : sheet.standing) {
      if (!lies_in(s, bx, by)) continue;
      if (carves && k > 0 && k < looks) throw Alarm{"carves what stands there"};
      if (!carves && above < s.height - kSlack) throw Alarm{"through what stands there"};
    }
  }
}

struct State {
  const Controller& c;
  Executed& out;
  Int at[3] = {kUnknown, kUnknown, kUnknown};
  Int feed = 0, s = kUnknown;
  int motion = -1, units = 0, percents = 0, length = 490, work = 540;
  bool absolute = false, spindle = false, ended = false, moved = false, carved = false;
  bool spindle_off = false, fan_off = false;    // of a laser: told so by this file
  bool exact_path = false, below_zero = false;  // LinuxCNC's G61 or G64 P; Marlin's M211 S0

  Int height() const { return at[2]; }
  bool pressed() const { return c.by_s && spindle_known && now_s() != c.lifted_s; }
  bool spindle_known = false;
  Int pressed_s = 0;  // what presses the head now
  Int now_s() const { return pressed_s; }
  bool down() const { return c.by_s ? pressed() : at[2] != kUnknown && at[2] < 0; }

  void place(int axis, Int to) const {
    if (std::llabs(to) > kFar) throw Alarm{"a place far away"};
    if (axis < 2 && c.bounded && (to < c.low[axis] - kNm / 500 || to > c.high[axis] + kNm / 500))
      throw Alarm{"a place out of reach"};
  }

  // Height above the face, nanometers; where the file does not tell the place, above its highest one.
  Int above(const Int p[3]) const {
    if (p[2] == kUnknown || c.sheet == nullptr || !c.sheet->face) return p[2];
    const double face = p[0] == kUnknown || p[1] == kUnknown ? c.sheet->face_top
                                                             : c.sheet->face(1e-6 * double(p[0]), 1e-6 * double(p[1]));
    return p[2] - std::llround(1e6 * face);
  }

  void meet_sheet(const Int to[3], bool goes, bool carves) const {
    const Sheet& sheet = *c.sheet;
    for (int axis = 0; axis < 2; ++axis)
      if (to[axis] != kUnknown &&
          (1e-6 * double(to[axis]) < -sheet.beside - kSlack ||
           1e-6 * double(to[axis]) > (axis == 0 ? sheet.width : sheet.height) + sheet.beside + kSlack))
        throw Alarm{"off the sheet"};
    const auto height = [&](const Int p[3]) {
      const double z = p[2] == kUnknown ? NAN : 1e-6 * double(p[2]);
      return c.by_s && !pressed() ? std::fmax(z, c.servo_lift) : z;
    };
    if (c.by_s && to[2] != kUnknown && above(to) < 0) throw Alarm{"a servo below the face"};
    double top = 0;
    for (const Standing& s : sheet.standing) top = std::max(top, s.height);
    const bool known = at[0] != kUnknown && at[1] != kUnknown && to[0] != kUnknown && to[1] != kUnknown;
    if (!known) {
      if (!goes) return;
      const bool by_z = at[2] != kUnknown || to[2] != kUnknown;
      if (std::fmin(height(at), height(to)) < (by_z ? sheet.face_top + std::max(top, sheet.first) : top) - kSlack)
        throw Alarm{"a first way too low"};
      return;
    }
    // A head that S presses is at its stroke's height, whatever Z is.
    const double z1 = c.by_s && carves ? 0 : height(to);
    const double z0 = c.by_s && carves ? 0 : std::isnan(height(at)) ? z1 : height(at);
    const double from[3] = {1e-6 * double(at[0]), 1e-6 * double(at[1]), z0},
                 end[3] = {1e-6 * double(to[0]), 1e-6 * double(to[1]), z1};
    if (!std::isnan(z1)) look_along(sheet, from, end, carves);
  }

  void leave() const {  // whatever moves
    if (c.laser && !(spindle_off && (fan_off || c.kind != Kind::marlin))) throw Alarm{"a beam that may be on"};
    if (c.by_s && !spindle_known) throw Alarm{"a head that nobody lifted"};
  }

  void move(const std::map<char, Int>& value) {
    if (units == 0 || !absolute || motion < 0) throw Alarm{"a move before its modes"};
    leave();
    Int to[3] = {at[0], at[1], at[2]};
    bool sideways = false;
    for (int axis = 0; axis < 3; ++axis) {
      const auto found = value.find("XYZ"[axis]);
      if (found == value.end()) continue;
      to[axis] = units == 20 ? found->second * 254 / 10 : found->second;
      place(axis, to[axis]);
      sideways = sideways || axis < 2;
    }
    if (motion == 1 && feed == 0) throw Alarm{"no feed"};
    if (c.kind == Kind::marlin && to[2] != kUnknown && to[2] < 0 && !below_zero) throw Alarm{"Z stops at zero"};
    const bool goes = (at[0] != to[0] || at[1] != to[1]);
    const std::size_t strokes = out.strokes.size();
    const bool followed = c.sheet != nullptr && c.sheet->face;
    const Int above0 = above(at), above1 = above(to);
    if (c.by_s) {
      if (goes && pressed()) {
        if (c.kind == Kind::linuxcnc && !exact_path) throw Alarm{"a path that is rounded"};
        if (motion == 0) throw Alarm{"G0 in the metal"};
        if (at[0] == kUnknown || at[1] == kUnknown || to[0] == kUnknown || to[1] == kUnknown)
          throw Alarm{"from nowhere"};
        out.strokes.push_back({at[0], at[1], to[0], to[1], now_s()});
        carved = true;
      }
    } else {
      const bool below0 = at[2] != kUnknown && above0 < 0, below1 = to[2] != kUnknown && above1 < 0;
      if (sideways && at[2] == kUnknown) throw Alarm{"along the board at no known height"};
      if (goes && (below0 || below1)) {
        if (motion == 0) throw Alarm{"G0 in the metal"};
        if (c.kind == Kind::linuxcnc && !exact_path) throw Alarm{"a path that is rounded"};
        if (followed ? below0 != below1 : at[2] != to[2]) throw Alarm{"a slant"};
        if (at[0] == kUnknown || at[1] == kUnknown || to[0] == kUnknown || to[1] == kUnknown)
          throw Alarm{"from nowhere"};
        out.strokes.push_back({at[0], at[1], to[0], to[1], -to[2]});
        carved = true;
      } else if (goes && (above0 < kScrape || above1 < kScrape)) {
        throw Alarm{"scrapes along the face"};
      } else if (!goes && below1 && !below0) {
        if (motion == 0 || at[2] == kUnknown || to[0] == kUnknown || to[1] == kUnknown) throw Alarm{"a wild plunge"};
        carved = false;
      } else if (!goes && below0 && below1 && at[2] != to[2]) {
        throw Alarm{"deeper and deeper"};
      } else if (!goes && below0 && !below1 && !carved) {
        throw Alarm{"a hole"};
      }
    }
    if (c.sheet != nullptr) meet_sheet(to, goes, out.strokes.size() > strokes);
    moved = true;
    for (int axis = 0; axis < 3; ++axis) at[axis] = to[axis];
  }
};

// Which codes there are, and which exclude each other (in tenths).
const std::map<int, int>& g_codes(Kind kind) {
  static const std::map<int, int> grbl{{0, 1},    {10, 1},   {800, 1},  {40, 99},  {280, 99}, {300, 99},
                                       {530, 98}, {170, 2},  {900, 3},  {911, 4},  {940, 5},  {200, 6},
                                       {210, 6},  {400, 7},  {490, 8},  {540, 12}, {550, 12}, {560, 12},
                                       {570, 12}, {580, 12}, {590, 12}, {610, 13}};
  static const std::map<int, int> linuxcnc = [] {
    std::map<int, int> all = grbl;
    for (const auto& [code, group] : std::map<int, int>{
             {430, 8}, {611, 13}, {640, 13}, {901, 4}, {690, 16}, {970, 14}, {591, 12}, {592, 12}, {593, 12}})
      all[code] = group;
    return all;
  }();
  static const std::map<int, int> marlin{{0, 1}, {10, 1}, {40, 99}, {280, 99}, {170, 2}, {210, 6}, {900, 3}, {540, 12}};
  return kind == Kind::grbl ? grbl : kind == Kind::linuxcnc ? linuxcnc : marlin;
}

const std::map<int, int>& m_codes(Kind kind) {
  static const std::map<int, int> grbl{{0, 4}, {1, 4}, {2, 4}, {30, 4}, {3, 7}, {4, 7}, {5, 7}, {8, 8}, {9, 8}};
  static const std::map<int, int> linuxcnc = [] {
    std::map<int, int> all = grbl;
    for (const int code : {50, 51, 52, 53, 62, 63, 64, 65, 67, 68}) all[code] = 100 + code;
    all[48] = all[49] = 9;
    all[7] = 8;
    return all;
  }();
  static const std::map<int, int> marlin = [] {
    std::map<int, int> all;
    for (const int code : {0,  1,   3,   4,   5,   7,   8,   9,   17,  18,  84,  73,  75, 76,
                           77, 105, 106, 107, 114, 201, 203, 204, 205, 211, 280, 300, 400})
      all[code] = 100 + code;
    return all;
  }();
  return kind == Kind::grbl ? grbl : kind == Kind::linuxcnc ? linuxcnc : marlin;
}

struct Line {
  std::set<int> g, m;
  std::map<char, Int> value;
};

Line sorted(const std::vector<Word>& words, Kind kind) {
  Line line;
  std::set<int> groups;
  for (const Word& w : words) {
    if (w.letter == 'G' || w.letter == 'M') {
      const bool is_g = w.letter == 'G';
      if (w.value < 0 || w.value % (is_g ? kNm / 10 : kNm) != 0) throw Alarm{"a code that is none"};
      const int code = static_cast<int>(w.value / (is_g ? kNm / 10 : kNm));
      const auto& known = is_g ? g_codes(kind) : m_codes(kind);
      const auto found = known.find(code);
      if (found == known.end()) throw Alarm{std::string("unknown ") + w.letter + std::to_string(code)};
      if (!groups.insert((is_g ? 0 : 1000) + found->second).second) throw Alarm{"two of a group"};
      (is_g ? line.g : line.m).insert(code);
    } else if (!line.value.emplace(w.letter, w.value).second) {
      throw Alarm{"a word twice"};
    }
  }
  if (kind == Kind::marlin && line.g.size() + line.m.size() > 1) throw Alarm{"two commands in a line"};
  return line;
}

void check_words(const Line& line, Kind kind) {
  const bool marlin = kind == Kind::marlin;
  bool setting = false, bits = false, output = line.m.contains(67) || line.m.contains(68);
  for (const int code : line.m) {
    setting = setting || (code >= 201 && code <= 205);
    bits = bits || (code >= 62 && code <= 65);
  }
  if (setting) return;
  for (const auto& [letter, value] : line.value) {
    bool fits = letter == 'N' && !marlin && value >= 0 && value % kNm == 0;
    if (letter == 'X' || letter == 'Y' || letter == 'Z') fits = !marlin || !line.g.empty();
    if (letter == 'F') fits = !marlin || line.g.contains(0) || line.g.contains(10);
    if (letter == 'S') fits = !marlin || !line.m.empty() || line.g.contains(40);
    if (letter == 'P') fits = line.g.contains(40) || line.g.contains(640) || bits || (marlin && !line.m.empty());
    if (letter == 'Q') fits = output || line.g.contains(640);
    if (letter == 'E') fits = output;
    if (letter == 'H') fits = line.g.contains(430);
    if (letter == 'T') fits = !marlin && value >= 0 && value <= 255 * kNm;
    if (!fits) throw Alarm{std::string("a stray ") + letter};
  }
}

void spindle(State& state, const Line& line) {
  const Controller& c = state.c;
  const bool on = line.m.contains(3) || line.m.contains(4), off = line.m.contains(5);
  const auto s = line.value.find('S');
  if (s != line.value.end() && (std::llabs(s->second) > 1'000'000 * kNm || (!c.by_s && s->second < 0)))
    throw Alarm{"an S that is none"};
  const bool was_pressed = state.pressed();
  const bool has_s = s != line.value.end() && (c.kind != Kind::marlin || on || off);
  if (has_s) state.s = s->second;
  if (on || off) state.spindle = on;
  const bool output = line.m.contains(67) || line.m.contains(68) || line.m.contains(280);
  Int value = 0;
  if (const auto q = line.value.find('Q'); q != line.value.end()) value = q->second;
  if (line.m.contains(280) && s != line.value.end()) value = s->second;
  if (c.laser || c.by_s)
    for (const int code : line.m) {
      const bool quiet = code <= 2 || code == 5 || code == 9 || code == 17 || code == 18 || code == 30 ||
                         (code >= 48 && code <= 53) || (code >= 73 && code <= 84) || code == 105 || code == 107 ||
                         code == 114 || (code >= 201 && code <= 211) || code == 400;
      const bool head = c.by_s && (code == 3 || code == 4);
      if (!quiet && !head) throw Alarm{"an output"};
    }
  state.spindle_off = state.spindle_off || off;
  state.fan_off = state.fan_off || line.m.contains(107);
  if (c.by_s && (on || off || output || (state.spindle && has_s))) {
    if (was_pressed && !state.carved) throw Alarm{"a dent"};
    if (!output && state.spindle && state.s == kUnknown) throw Alarm{"a spindle without S"};
    state.pressed_s = output ? value / 1000 : state.spindle ? state.s / 1000 : c.low_s_presses ? 0 : c.lifted_s;
    state.spindle_known = true;
    state.carved = false;
  }
  if (c.laser && (on || (output && value != 0) || (state.s != kUnknown && state.s != 0))) throw Alarm{"the beam is on"};
}

void execute_line(State& state, std::string_view text) {
  const Kind kind = state.c.kind;
  std::string bare;
  for (const char b : text)
    if (b != ' ' && b != '\t') bare += b;
  if (bare == "%" && kind == Kind::linuxcnc) {
    if (++state.percents > 2) throw Alarm{"a third %"};
    if (state.percents == 1 && (state.moved || state.units != 0 || state.absolute || state.motion >= 0 || state.ended))
      throw Alarm{"a % in the midst"};
    if (state.percents == 2) state.ended = true;
    return;
  }
  if ((bare == "$H" || bare == "$h") && kind == Kind::grbl) {
    if (state.ended || state.down()) throw Alarm{"home from the metal"};
    state.leave();
    state.at[0] = state.at[1] = state.at[2] = kUnknown;
    state.moved = true;
    return;
  }
  const std::vector<Word> words = words_of(text, state.c);
  if (words.empty() || (words.size() == 1 && words[0].letter == 'N' && kind != Kind::marlin)) {
    for (const Word& w : words)
      if (w.value < 0 || w.value % kNm != 0) throw Alarm{"a line number"};
    return;
  }
  if (state.ended) throw Alarm{"behind the end"};
  const Line line = sorted(words, kind);
  check_words(line, kind);
  bool goes_home = false, machine = false;
  for (const int g : line.g) {
    if (g == 0 || g == 10) state.motion = g / 10;
    if (g == 800) state.motion = -1;
    if (g == 200 || g == 210) {
      if (state.units != 0 && state.units != g / 10) throw Alarm{"other units"};
      state.units = g / 10;
    }
    if (g == 900) state.absolute = true;
    if (g == 610 || g == 611) state.exact_path = true;
    if (g == 640) {
      const Int inch = state.units == 20 ? 254 : 10;
      for (const char letter : {'P', 'Q'}) {
        const auto leaves = line.value.find(letter);
        if (letter == 'P' && leaves == line.value.end()) throw Alarm{"a path that is rounded"};
        if (leaves != line.value.end() && (leaves->second < 0 || leaves->second * inch / 10 > kNm / 200))
          throw Alarm{"a path that is rounded"};
      }
      state.exact_path = true;
    }
    if (g == 430 || g == 490) {
      if (state.moved && state.length != g) throw Alarm{"another tool length"};
      state.length = g;
    }
    if (g >= 540 && g <= 593) {
      if (state.moved && state.work != g) throw Alarm{"another zero"};
      state.work = g;
    }
    goes_home = goes_home || g == 280 || g == 300;
    machine = machine || g == 530;
  }
  spindle(state, line);
  if (line.m.contains(211) && line.value.contains('S')) state.below_zero = line.value.at('S') == 0;
  const auto axis = [&](char letter) { return line.value.contains(letter); };
  const bool axes = axis('X') || axis('Y') || axis('Z');
  if (const auto f = line.value.find('F'); f != line.value.end()) {
    const Int feed = state.units == 20 ? f->second * 254 / 10 : f->second;
    if (state.units == 0 || feed < kSlowest || feed > kFastest) throw Alarm{"no feed"};
    state.feed = feed;
  }
  if (kind == Kind::marlin && (line.m.contains(84) || line.m.contains(18))) {
    if (state.down()) throw Alarm{"motors off in the metal"};
    state.at[0] = state.at[1] = state.at[2] = kUnknown;
  }
  if (goes_home || machine) {
    state.leave();
    if (state.down()) throw Alarm{"away from the metal"};
    if (goes_home && axes && kind != Kind::marlin) throw Alarm{"home by a place"};
    if (machine && (!axes || state.motion < 0)) throw Alarm{"G53 alone"};
    if (machine && (axis('X') || axis('Y')) &&
        (axis('Z') || (!state.c.by_s && (state.at[2] == kUnknown || state.at[2] < kScrape))))
      throw Alarm{"G53 along the board"};
    for (int k = 0; k < 3; ++k)
      if ((goes_home && !axes) || axis("XYZ"[k])) state.at[k] = kUnknown;
    state.moved = true;
  } else if (line.g.contains(40)) {
    const bool by_s = kind == Kind::marlin && axis('S');
    if (axes || line.g.contains(0) || line.g.contains(10) || (!by_s && !axis('P'))) throw Alarm{"a dwell"};
    const Int time = by_s ? line.value.at('S') : line.value.at('P') / (kind == Kind::marlin ? 1000 : 1);
    if (time < 0 || time > 600 * kNm) throw Alarm{"a dwell for ever"};
  } else if (axes && !(kind == Kind::marlin && !line.m.empty())) {
    if (kind == Kind::marlin && !line.g.contains(0) && !line.g.contains(10)) throw Alarm{"no command"};
    state.move(line.value);
  }
  if (line.m.contains(2) || line.m.contains(30)) {
    if (axes) throw Alarm{"a move at the end"};
    state.ended = true;
    state.spindle = false;
  }
}

}  // namespace

std::string words_off_sheet(std::string_view text, const Sheet& sheet) {
  int open = 0;
  bool rest_is_comment = false, of_machine = false;  // G53: what is sent is a place of the machine
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '\n') rest_is_comment = of_machine = false, open = 0;
    if (text.substr(i, 3) == "G53") of_machine = true;
    if (c == ';') rest_is_comment = true;
    if (c == '(') ++open;
    if (c == ')') --open;
    if (rest_is_comment || open > 0 || (c != 'X' && c != 'Y' && c != 'Z')) continue;
    if (of_machine && c != 'Z') continue;
    const std::string number(text.substr(i + 1, 24));
    const double mm = std::atof(number.c_str());
    const double most = c == 'X' ? sheet.width + sheet.beside : c == 'Y' ? sheet.height + sheet.beside : 150;
    // A face that is followed lies lower somewhere, by what a clamped sheet may tilt.
    const double least = of_machine ? 0
                         : c == 'Z' ? -sheet.deepest - (sheet.face ? 0.03 * std::hypot(sheet.width, sheet.height) : 0)
                                    : -sheet.beside;
    if (!(mm >= least - kSlack && mm <= most + kSlack)) return std::string(1, c) + number.substr(0, number.find('\n'));
  }
  return "";
}

Executed execute(std::string_view text, const Controller& controller) {
  Executed out;
  State state{controller, out};
  try {
    while (!text.empty()) {
      ++out.line;
      const std::size_t end = text.find('\n');
      std::string_view line = text.substr(0, end);
      if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
      const bool pressed = state.pressed();
      execute_line(state, line);
      // The end lifts nothing that is pressed by S.
      if (state.ended && pressed) throw Alarm{"the end, pressed down"};
      text = end == std::string_view::npos ? std::string_view{} : text.substr(end + 1);
    }
    if (state.down()) throw Alarm{"left in the metal"};
    if (state.spindle && !controller.by_s && !state.ended) throw Alarm{"left turning"};
  } catch (const Alarm& alarm) {
    out.alarm = alarm.why;
  }
  return out;
}

}  // namespace burin::strict

#include "burin/optimize/toolpath/gcode_line.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <span>
#include <string>

#include "burin/base/error.h"

namespace burin {
namespace {

// More digits than any coordinate has; beyond this, some controllers misread a number.
constexpr std::size_t kMostDigits = 15;
constexpr std::size_t kMostDigitsBeforePoint = 7;
constexpr std::size_t kGrblDigits = 8;  // grbl's read_float() drops digits behind them

constexpr double kMostLineNumber = 9999999;  // grbl's

struct Code {
  int tenths, group;  // 0: a group of its own
};

// Modal groups by NIST RS274/NGC; 100: codes that act once.
constexpr Code kGrblG[] = {{0, 1},    {10, 1},   {800, 1},  {40, 100}, {280, 100}, {300, 100}, {530, 0}, {170, 2},
                           {900, 3},  {911, 4},  {940, 5},  {200, 6},  {210, 6},   {400, 7},   {490, 8}, {540, 12},
                           {550, 12}, {560, 12}, {570, 12}, {580, 12}, {590, 12},  {610, 13}};
constexpr Code kLinuxcncG[] = {{430, 8},  {611, 13}, {640, 13}, {901, 4}, {690, 16},
                               {970, 14}, {591, 12}, {592, 12}, {593, 12}};
constexpr Code kMarlinG[] = {{0, 1}, {10, 1}, {40, 100}, {280, 100}, {170, 2}, {210, 6}, {900, 3}, {540, 12}};

constexpr Code kGrblM[] = {{0, 4}, {10, 4}, {20, 4}, {300, 4}, {30, 7}, {40, 7}, {50, 7}, {80, 8}, {90, 8}};
constexpr Code kLinuxcncM[] = {{70, 8},  {480, 9}, {490, 9}, {500, 0}, {510, 0}, {520, 0}, {530, 0},
                               {620, 0}, {630, 0}, {640, 0}, {650, 0}, {670, 0}, {680, 0}};
constexpr int kMarlinM[] = {0,    10,   30,   40,   50,   70,   80,   90,   170,  180,  730,  750,  760,  770, 840,
                            1050, 1060, 1070, 1140, 1170, 1180, 2010, 2030, 2040, 2050, 2110, 2800, 3000, 4000};

const Code* find(std::span<const Code> codes, int tenths) {
  const auto found = std::find_if(codes.begin(), codes.end(), [&](const Code& c) { return c.tenths == tenths; });
  return found == codes.end() ? nullptr : &*found;
}

bool same_letters(std::string_view text, std::string_view upper) {
  return text.size() >= upper.size() && std::equal(upper.begin(), upper.end(), text.begin(), [](char u, char c) {
           return u == (c >= 'a' && c <= 'z' ? c - 'a' + 'A' : c);
         });
}

std::string code_text(char letter, int tenths) {
  return letter + std::to_string(tenths / 10) + (tenths % 10 == 0 ? "" : "." + std::to_string(tenths % 10));
}

// Text of a comment without words of G-code, messages to a sender program, or real-time characters.
std::string without_code(std::string_view text) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  const auto upper = [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; };
  std::string out;
  for (const char c : text) {
    const bool stays = letter(c) || digit(c) || std::string_view(" .,:_+-").find(c) != std::string_view::npos;
    const char safe = stays ? c : c == ';' ? ',' : '_';
    const std::size_t last = out.find_last_not_of(' ');
    if (digit(safe) && last != std::string::npos) {
      // "M30" anywhere, and "M 30" if the letter stands alone.
      const bool code = std::string_view("GMTNOSF").find(upper(out[last])) != std::string_view::npos;
      const bool alone = last == 0 || !(letter(out[last - 1]) || digit(out[last - 1]));
      if (code && (last + 1 == out.size() || alone)) out.resize(last + 1), out += '_';
    }
    if (upper(safe) == 'G' && out.size() > 1 && upper(out.back()) == 'S' && upper(out[out.size() - 2]) == 'M')
      out += '_';  // MSG
    out += safe;
  }
  return out;
}

class Reader {
 public:
  Reader(std::string_view text, const MachineProfile& machine, const std::string& name, std::size_t number)
      : text_(text), machine_(machine), dialect_(machine.dialect), name_(name), number_(number) {}

  GcodeLine read() {
    if (!text_.empty() && text_.back() == '\r') text_.remove_suffix(1);
    check_bytes();
    while (i_ < text_.size()) {
      const char c = text_[i_];
      if (c == ' ' || c == '\t') {
        ++i_;
      } else if (c == ';') {
        comment(text_.substr(i_ + 1));
        break;
      } else if (c == '(') {
        enclosed_comment();
      } else if (c == '%' || c == '$') {
        alone(c);
      } else if ((c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z' && dialect_ != GcodeDialect::marlin)) {
        word(c >= 'a' ? static_cast<char>(c - 'a' + 'A') : c);
      } else {
        error(std::string("cannot read \"") + c + "\"", c == '/'
                                                            ? "take it away: not every controller leaves out a line "
                                                              "that begins with /"
                                                            : "correct the line");
      }
    }
    check_codes();
    check_words();
    return line_;
  }

 private:
  [[noreturn]] void error(const std::string& what, const std::string& remedy) const {
    fail(name_ + ":" + std::to_string(number_), what, remedy);
  }

  void check_bytes() const {
    const int longest = longest_line(machine_);
    if (text_.size() > static_cast<std::size_t>(longest))
      error("has " + std::to_string(text_.size()) + " characters, and the machine reads " + std::to_string(longest) +
                " a line",
            "shorten it, or correct max_line_characters of the machine profile");
    for (const char c : text_) {
      const auto byte = static_cast<unsigned char>(c);
      const bool blank = c == '\t' && dialect_ != GcodeDialect::marlin;
      if ((byte < 0x20 && !blank) || byte > 0x7E) {
        char hex[8];
        std::snprintf(hex, sizeof hex, "0x%02X", byte);
        error(std::string("holds the byte ") + hex, "write plain ASCII characters only");
      }
      if (dialect_ == GcodeDialect::grbl && (c == '!' || c == '?' || c == '~'))
        error(std::string("holds \"") + c + "\", which grbl obeys at once wherever it stands", "take it away");
    }
  }

  void comment(std::string_view text) const {
    if (dialect_ != GcodeDialect::linuxcnc) return;
    std::string words;  // LinuxCNC ignores blanks everywhere
    std::copy_if(text.begin(), text.end(), std::back_inserter(words), [](char c) { return c != ' ' && c != '\t'; });
    for (const char* active : {"LOG", "PROBEOPEN", "PROBECLOSE", "PY,", "ABORT"})
      if (same_letters(words, active))
        error("has a comment that LinuxCNC executes (" + std::string(active) + ")", "take it away");
  }

  void enclosed_comment() {
    if (dialect_ == GcodeDialect::marlin) error("has a comment in ( ), which Marlin would execute", "write it after ;");
    const std::size_t end = text_.find(')', i_);
    if (end == std::string_view::npos) error("a comment is not closed", "add )");
    const std::string_view inside = text_.substr(i_ + 1, end - i_ - 1);
    if (inside.find('(') != std::string_view::npos) error("a comment holds another one", "take the inner ( ) away");
    comment(inside);
    i_ = end + 1;
  }

  // "%" and "$H" need a line of their own.
  void alone(char c) {
    std::string_view rest = text_;
    while (!rest.empty() && (rest.back() == ' ' || rest.back() == '\t')) rest.remove_suffix(1);
    while (!rest.empty() && (rest.front() == ' ' || rest.front() == '\t')) rest.remove_prefix(1);
    line_.percent = c == '%' && rest == "%" && dialect_ == GcodeDialect::linuxcnc;
    line_.home = c == '$' && same_letters(rest, "$H") && rest.size() == 2 && dialect_ == GcodeDialect::grbl;
    if (!line_.percent && !line_.home)
      error(std::string("cannot read \"") + c + "\"",
            c == '$' ? "change the controller's settings before carving, not in the file" : "take it away");
    i_ = text_.size();
  }

  double number(char letter) {
    while (i_ < text_.size() && text_[i_] == ' ') ++i_;
    const std::size_t begin = i_;
    if (i_ < text_.size() && (text_[i_] == '+' || text_[i_] == '-')) ++i_;
    std::size_t digits = 0, before_point = 0, keep = 0;
    bool point = false, leading = true;
    for (; i_ < text_.size(); ++i_) {
      const char c = text_[i_];
      if (c == '.' && !point) {
        point = true;
        continue;
      }
      if (c < '0' || c > '9') break;
      ++digits;
      leading = leading && c == '0';
      if (!point && !leading) ++before_point;
      if (digits <= kGrblDigits) keep = i_ + 1;
    }
    if (digits == 0) error(std::string("no number after ") + letter, "correct the line");
    if (digits > kMostDigits || before_point > kMostDigitsBeforePoint)
      error(std::string("the number after ") + letter + " has more digits than controllers read", "round it");
    // A point may follow the last kept digit; it has no effect.
    const std::size_t end = dialect_ == GcodeDialect::grbl && digits > kGrblDigits ? keep : i_;
    std::size_t from = begin;
    if (text_[from] == '+') ++from;
    // from_chars reads no number that begins with its point.
    const bool negative = text_[from] == '-';
    if (negative) ++from;
    double value = 0;
    if (text_[from] == '.') {
      const std::string whole = "0" + std::string(text_.substr(from, end - from));
      std::from_chars(whole.data(), whole.data() + whole.size(), value, std::chars_format::fixed);
    } else {
      std::from_chars(text_.data() + from, text_.data() + end, value, std::chars_format::fixed);
    }
    return negative ? -value : value;
  }

  int code(char letter) {
    const double value = number(letter);
    const double tenths = std::round(value * 10);
    constexpr double kMostCode = 10000;
    if (!(value >= 0) || tenths > kMostCode || std::abs(value * 10 - tenths) > 1e-9)
      error(std::string("has no such code after ") + letter, "correct the line");
    return static_cast<int>(tenths);
  }

  void word(char letter) {
    ++i_;
    if (letter == 'G') {
      line_.g.push_back(code('G'));
    } else if (letter == 'M') {
      line_.m.push_back(code('M'));
      // A message for the display: text to the end of the line.
      if (dialect_ == GcodeDialect::marlin && (line_.m.back() == 1170 || line_.m.back() == 1180)) {
        if (line_.g.size() + line_.m.size() > 1) error("has a message behind another command", "give it its own line");
        line_.m.clear();
        i_ = text_.size();
      }
    } else {
      const double value = number(letter);
      if (line_.has(letter)) error(std::string(1, letter) + " stands twice in a line", "keep one of them");
      line_.given[static_cast<std::size_t>(letter - 'A')] = true;
      line_.value[static_cast<std::size_t>(letter - 'A')] = value;
    }
  }

  // Modal group of a code; -1 for a code unknown to this controller.
  int group_of(char letter, int code) const {
    const bool is_g = letter == 'G';
    if (dialect_ == GcodeDialect::marlin) {
      if (is_g) {
        const Code* known = find(kMarlinG, code);
        return known == nullptr ? -1 : known->group;
      }
      return std::find(std::begin(kMarlinM), std::end(kMarlinM), code) == std::end(kMarlinM) ? -1 : 0;
    }
    const std::span<const Code> grbl = is_g ? std::span<const Code>(kGrblG) : std::span<const Code>(kGrblM);
    const Code* known = find(grbl, code);
    if (known == nullptr && dialect_ == GcodeDialect::linuxcnc)
      known = find(is_g ? std::span<const Code>(kLinuxcncG) : std::span<const Code>(kLinuxcncM), code);
    return known == nullptr ? -1 : known->group;
  }

  void refuse_unknown(char letter, int code) const {
    const std::string text = code_text(letter, code);
    if (letter == 'M') {
      if (code % 10 == 0 && std::find(machine_.other_m_codes.begin(), machine_.other_m_codes.end(), code / 10) !=
                                machine_.other_m_codes.end())
        return;
      if (machine_.laser)
        error("has the code " + text + ", which may switch an output, perhaps the beam's", "take it away");
      if (dialect_ == GcodeDialect::grbl && find(kLinuxcncM, code) != nullptr)
        error("has the code " + text + ", which grbl answers by an error",
              "remove it, or, on grblHAL or FluidNC, name it in other_m_codes of the machine profile");
      error("has the code " + text + ", and what it does on this machine is not known",
            "remove it, or name it in other_m_codes of the machine profile if it moves nothing");
    }
    switch (code) {
      case 20:
      case 30:
        error("has an arc (G2, G3)", "write straight moves only");
      case 910:
        error("has relative coordinates (G91)", "write absolute ones (G90)");
      case 180:
      case 190:
        error("changes the plane (" + text + ")", "keep G17");
      case 100:
      case 431:
      case 510:
      case 520:
      case 680:
      case 920:
        error("shifts or turns the coordinates (" + text + ")", "set offsets on the machine");
      case 200:
        error("sets inches (G20), which most Marlins do not know", "write millimeters (G21)");
      default:
        error("has an unknown code " + text, "remove it or check the file on the machine");
    }
  }

  void check_codes() const {
    if (dialect_ == GcodeDialect::marlin && line_.g.size() + line_.m.size() > 1)
      error("has several commands, and Marlin obeys the first one alone", "give each its own line");
    for (const char letter : {'G', 'M'}) {
      const std::vector<int>& codes = letter == 'G' ? line_.g : line_.m;
      std::array<bool, 128> taken{};
      for (std::size_t k = 0; k < codes.size(); ++k) {
        const int group = group_of(letter, codes[k]);
        if (group < 0) refuse_unknown(letter, codes[k]);
        const bool again = std::find(codes.begin(), codes.begin() + static_cast<std::ptrdiff_t>(k), codes[k]) !=
                           codes.begin() + static_cast<std::ptrdiff_t>(k);
        if (again || (group > 0 && taken[static_cast<std::size_t>(group)]))
          error("has two codes that exclude each other (" + code_text(letter, codes[k]) + ")",
                "give each its own line");
        if (group > 0) taken[static_cast<std::size_t>(group)] = true;
      }
    }
  }

  // Accepts words that some code of the line needs; others would be an error or unpredictable on the machine.
  void check_words() const {
    // A machine's own codes, and firmware settings, define their words themselves.
    const bool settings = std::any_of(line_.m.begin(), line_.m.end(), [&](int m) { return m >= 2010 && m <= 2050; }) ||
                          std::any_of(line_.m.begin(), line_.m.end(), [&](int m) { return group_of('M', m) < 0; });
    const bool output = line_.has_m(670) || line_.has_m(680),
               bits = line_.has_m(620) || line_.has_m(630) || line_.has_m(640) || line_.has_m(650);
    const bool marlin = dialect_ == GcodeDialect::marlin;
    for (char letter = 'A'; letter <= 'Z'; ++letter) {
      if (!line_.has(letter) || settings) continue;
      bool wanted = false;
      switch (letter) {
        case 'X':
        case 'Y':
        case 'Z':
          wanted = line_.m.empty() || !marlin;
          break;
        case 'F':
          wanted = !marlin || line_.has_g(0) || line_.has_g(10);
          break;
        case 'S':
          wanted = !marlin || !line_.m.empty() || line_.has_g(40);
          break;
        case 'P':
          wanted = line_.has_g(40) || line_.has_g(640) || bits || (marlin && !line_.m.empty());
          break;
        case 'Q':
          wanted = output || line_.has_g(640);
          break;
        case 'E':
          wanted = output;
          break;
        case 'H':
          wanted = line_.has_g(430);
          break;
        case 'N':
          if (marlin)
            error("has a line number, and Marlin requests such a line again without end if it has no checksum",
                  "leave line numbers away; the program that sends the file adds its own");
          if (line_['N'] < 0 || line_['N'] > kMostLineNumber || line_['N'] != std::floor(line_['N']))
            error("has no such line number", "count from 1, or leave line numbers away");
          wanted = true;
          break;
        case 'T':
          wanted = !marlin;
          break;
        default:
          break;
      }
      if (!wanted) error(std::string("has a word ") + letter + " that no code of the line uses", "take it away");
    }
  }

  std::string_view text_;
  const MachineProfile& machine_;
  GcodeDialect dialect_;
  const std::string& name_;
  std::size_t number_, i_ = 0;
  GcodeLine line_;
};

}  // namespace

bool GcodeLine::has_g(int code) const { return std::find(g.begin(), g.end(), code) != g.end(); }

bool GcodeLine::has_m(int code) const { return std::find(m.begin(), m.end(), code) != m.end(); }

bool GcodeLine::empty() const {
  if (!g.empty() || !m.empty() || percent || home) return false;
  for (char letter = 'A'; letter <= 'Z'; ++letter)
    if (letter != 'N' && has(letter)) return false;
  return true;
}

GcodeLine read_gcode_line(std::string_view text, const MachineProfile& machine, const std::string& name,
                          std::size_t number) {
  return Reader(text, machine, name, number).read();
}

int longest_line(const MachineProfile& machine) {
  if (machine.max_line_characters > 0) return machine.max_line_characters;
  switch (machine.dialect) {
    case GcodeDialect::grbl:
      return 79;  // LINE_BUFFER_SIZE 80, its end included
    case GcodeDialect::marlin:
      return 95;  // MAX_CMD_SIZE 96
    case GcodeDialect::linuxcnc:
      return 255;  // LINELEN
  }
  return 79;
}

std::string comment_word(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  std::string word;
  for (const char c : text.substr(0, kLongest)) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == ' ' ||
                       c == '-' || c == '_' || c == '.';
    word += plain ? c : '_';
  }
  return word;
}

std::string comment_lines(const MachineProfile& machine, std::string_view text) {
  constexpr std::size_t kWidth = 70;
  const bool marlin = machine.dialect == GcodeDialect::marlin;
  const std::size_t room = std::min(kWidth, static_cast<std::size_t>(longest_line(machine))) - 2;  // of ( ) or "; "
  const auto end_line = [&](std::string& lines, const std::string& line) {
    lines += marlin ? "; " + line + "\n" : "(" + line + ")\n";
  };
  const std::string safe = without_code(text);
  std::string lines, line;
  for (std::size_t at = 0; at < safe.size();) {
    const std::size_t begin = safe.find_first_not_of(' ', at);
    if (begin == std::string::npos) break;
    std::size_t end = std::min(safe.find(' ', begin), safe.size());
    const std::size_t taken = line.empty() ? 0 : line.size() + 1;
    if (taken + (end - begin) > room && !line.empty() && line != "-") {
      end_line(lines, line);
      line = "-";
      continue;
    }
    end = std::min(end, begin + room - taken);  // a word longer than a line
    line += (line.empty() ? "" : " ") + safe.substr(begin, end - begin);
    at = end;
  }
  end_line(lines, line);
  return lines;
}

std::string head_text(const GcodeHead& head) {
  return "part " + std::to_string(head.part) + " of " + std::to_string(head.parts) + ", scratches " +
         std::to_string(head.first) + " to " + std::to_string(head.last) + " of " + std::to_string(head.of);
}

std::optional<GcodeHead> read_gcode_head(std::string_view text) {
  constexpr std::size_t kMostLines = 300;  // a profile's own head precedes it
  std::string comments;
  for (std::size_t line = 0; line < kMostLines && !text.empty(); ++line) {
    std::string_view words = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(words.size() + 1, text.size()));
    if (words.empty() || (words.front() != '(' && words.front() != ';')) continue;
    words.remove_prefix(std::min(words.find_first_not_of("(; "), words.size()));
    words = words.substr(0, words.find_last_not_of(")\r ") + 1);
    if (words.starts_with("- "))
      comments.append(words.substr(1));  // continuation
    else
      comments.append("\n").append(words);
  }
  const std::size_t ours = comments.find("\nBurin tool path for ");
  if (ours == std::string::npos) return std::nullopt;
  std::size_t at = comments.find("\npart ", ours);
  if (at == std::string::npos) return std::nullopt;
  GcodeHead head;
  const auto take = [&](std::string_view before, std::size_t& value) {
    if (std::string_view(comments).substr(at, before.size()) != before) return false;
    at += before.size();
    const auto [end, error] = std::from_chars(comments.data() + at, comments.data() + comments.size(), value);
    at = static_cast<std::size_t>(end - comments.data());
    return error == std::errc();
  };
  if (!take("\npart ", head.part) || !take(" of ", head.parts) || !take(", scratches ", head.first) ||
      !take(" to ", head.last) || !take(" of ", head.of) || head.first < 1 || head.last < head.first)
    return std::nullopt;
  return head;
}

}  // namespace burin

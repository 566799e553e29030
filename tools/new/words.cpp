#include "tools/new/words.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <string_view>
#include <vector>

#include "burin/base/degrees.h"
#include "burin/base/error.h"
#include "burin/base/files/file_names.h"
#include "burin/base/files/table.h"
#include "burin/capture/exif.h"

namespace burin {
namespace {

std::string trimmed_lower(std::string_view text) {
  const std::string out = lower_case(std::string(text));
  const std::size_t first = out.find_first_not_of(" \t"), last = out.find_last_not_of(" \t");
  return first == std::string::npos ? "" : out.substr(first, last - first + 1);
}

// Splits "1.2m" into number and unit; either may be missing.
struct Measure {
  std::optional<double> number;
  std::string unit;
};

Measure measure_in(std::string_view text) {
  const std::string word = trimmed_lower(text);
  const std::size_t end = std::min(word.find_first_not_of("0123456789.+-"), word.size());
  return {number_in(word.substr(0, end)), trimmed_lower(word.substr(end))};
}

// 6 inches are 152.4 mm, not 152.39999999999998.
double to_a_nanometer(double mm) { return std::round(mm * 1e6) / 1e6; }

std::optional<double> unit_mm(const std::string& unit) {
  if (unit == "mm") return 1;
  if (unit == "cm") return 10;
  if (unit == "m") return 1000;
  if (unit == "in" || unit == "inch" || unit == "inches" || unit == "\"") return 25.4;
  if (unit == "ft" || unit == "'") return 304.8;
  return std::nullopt;
}

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> parts{""};
  for (const char c : text) {
    if (c == at)
      parts.emplace_back();
    else
      parts.back() += c;
  }
  return parts;
}

void replace_all(std::string& text, std::string_view from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
}

// Resolves "file:///home/a%20b.png" and "~/a.png" to file names.
std::string as_file_name(const std::string& word, bool bare_tilde) {
  constexpr std::string_view kAddress = "file://";
  if (word.starts_with(kAddress)) {
    std::string out;
    for (std::size_t i = kAddress.size(); i < word.size(); ++i) {
      unsigned byte = 0;
      const char* at = word.data() + i + 1;
      const bool escaped = word[i] == '%' && i + 2 < word.size() && std::from_chars(at, at + 2, byte, 16).ptr == at + 2;
      out += escaped ? static_cast<char>(byte) : word[i];
      if (escaped) i += 2;
    }
    return out;
  }
  const char* home = std::getenv("HOME");
  if (bare_tilde && home != nullptr && (word == "~" || word.starts_with("~/"))) return home + word.substr(1);
  return word;
}

constexpr const char* kLengthRemedy = "write a number and its unit: 1.2m, 60cm, 600mm or 48in (a bare number is mm)";

}  // namespace

std::vector<std::string> files_in_words(const std::string& line) {
  std::vector<std::string> files;
  std::string word;
  char quote = 0;
  // the word exists; it is unquoted as a whole; its first letter is unquoted
  bool any = false, bare = true, bare_start = true;
  const auto end = [&] {
    const bool is_there = std::filesystem::exists(word);
    if (any && bare && !is_there && word.find(',') != std::string::npos) {
      for (const std::string& part : split(word, ','))
        if (!part.empty()) files.push_back(as_file_name(part, true));
    } else if (any) {
      files.push_back(as_file_name(word, bare_start));
    }
    word.clear();
    any = false;
    bare = bare_start = true;
  };
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    const bool escape = c == '\\' && quote != '\'' && i + 1 < line.size();
    const bool quotes = quote == 0 ? c == '"' || c == '\'' : c == quote;
    if (quote == 0 && (c == ' ' || c == '\t')) {
      end();
      continue;
    }
    if ((escape || quotes) && !any) bare_start = false;
    if (escape || quotes) bare = false;
    any = true;
    if (escape)
      word += line[++i];
    else if (quotes)
      quote = quote == 0 ? c : '\0';
    else
      word += c;
    // A quoted name before a comma.
    if (quote == 0 && !bare && !escape && !quotes && c == ',' && (i + 1 == line.size() || line[i + 1] == ' '))
      word.pop_back();
  }
  end();
  return files;
}

std::string file_in_words(const std::string& line) {
  const std::vector<std::string> files = files_in_words(line);
  return files.size() == 1 ? files.front() : as_file_name(line, true);
}

double length_in_words(const std::string& text, const std::string& what) {
  const Measure m = measure_in(text);
  const std::optional<double> unit = m.unit.empty() ? 1.0 : unit_mm(m.unit);
  if (!m.number || !unit) fail(what, "\"" + text + "\" is no length", kLengthRemedy);
  const double mm = to_a_nanometer(*m.number * *unit);
  constexpr double kFurthest_mm = 100e3;
  if (!(mm > 0 && mm <= kFurthest_mm))
    fail(what, "\"" + text + "\" is no length above 0 and below 100 m", kLengthRemedy);
  return mm;
}

Eigen::Vector2d size_in_words(const std::string& text, const std::string& what) {
  const std::string remedy = "write width x height: 200x150 (mm), 20x15cm or 8x6in";
  std::string word = trimmed_lower(text);
  replace_all(word, "\xC3\x97", "x");  // the multiplication sign
  replace_all(word, "*", "x");
  replace_all(word, "by", "x");
  const std::vector<std::string> sides = split(word, 'x');
  if (sides.size() != 2) fail(what, "\"" + text + "\" is no width and height", remedy);
  const Measure width = measure_in(sides[0]), height = measure_in(sides[1]);
  const std::string& shared = height.unit;  // "20x15cm" has one unit for both
  const std::optional<double> height_unit = shared.empty() ? 1.0 : unit_mm(shared),
                              width_unit = width.unit.empty() ? height_unit : unit_mm(width.unit);
  if (!width.number || !height.number || !width_unit || !height_unit || (shared.empty() && !width.unit.empty()))
    fail(what, "\"" + text + "\" is no width and height", remedy);
  Eigen::Vector2d mm(to_a_nanometer(*width.number * *width_unit), to_a_nanometer(*height.number * *height_unit));
  if (!(mm.minCoeff() > 0)) fail(what, "\"" + text + "\" has a side that is not above 0", remedy);
  return mm;
}

SaidLamp lamp_in_words(const std::string& text) {
  const std::string remedy =
      "write above, below, left or right (or above left, ...), with a distance from the board's middle if you like: "
      "\"above 600mm\"; or a place, X,Y,Z in mm from the board's lower left corner, Z in front of it: 100,700,800";
  const std::string word = trimmed_lower(text);
  SaidLamp lamp;
  if (const std::vector<std::string> parts = split(word, ','); parts.size() > 1) {
    std::vector<double> p;
    for (const std::string& part : parts)
      if (const std::optional<double> v = number_in(trimmed_lower(part))) p.push_back(*v);
    if (parts.size() != 3 || p.size() != 3) fail("lamp", "\"" + text + "\" is no place", remedy);
    if (!(p[2] > 0)) fail("lamp", "\"" + text + "\" lies behind the board's face", remedy);
    lamp.position_mm = Eigen::Vector3d(p[0], p[1], p[2]);
    return lamp;
  }
  Eigen::Vector2d direction(0, 0);
  std::string rest = word;
  const std::array<std::pair<std::string_view, Eigen::Vector2d>, 4> directions{
      {{"above", {0, 1}}, {"below", {0, -1}}, {"left", {-1, 0}}, {"right", {1, 0}}}};
  for (bool more = true; more;) {
    more = false;
    for (const auto& [name, way] : directions) {
      if (!rest.starts_with(name)) continue;
      direction += way;
      rest = trimmed_lower(rest.substr(name.size()));
      // "above-left"; "above -600mm" is a length below 0
      const std::string behind = rest.starts_with('-') ? trimmed_lower(rest.substr(1)) : "";
      if (!behind.empty() && std::string_view("0123456789.,").find(behind.front()) == std::string_view::npos)
        rest = behind;
      more = true;
    }
  }
  if (!(direction.norm() > 0.5)) fail("lamp", "\"" + text + "\" is not a direction", remedy);
  if (!rest.empty()) lamp.distance_mm = length_in_words(rest, "lamp \"" + text + "\"");
  lamp.azimuth_deg = std::atan2(direction.y(), direction.x()) * 180 / std::numbers::pi;
  return lamp;
}

Eigen::Vector3d lamp_position_mm(const SaidLamp& said, const Eigen::Vector2d& board_mm, double usual_mm) {
  if (said.position_mm) return *said.position_mm;
  constexpr double kTilt = 40 * kDegree_rad;
  const double distance = said.distance_mm > 0 ? said.distance_mm : usual_mm, azimuth = said.azimuth_deg * kDegree_rad;
  const Eigen::Vector3d p(board_mm.x() / 2 + distance * std::sin(kTilt) * std::cos(azimuth),
                          board_mm.y() / 2 + distance * std::sin(kTilt) * std::sin(azimuth),
                          distance * std::cos(kTilt));
  return p.array().round();
}

namespace {

SaidCamera nominal(double focal_35mm, int width, int height, const std::string& from) {
  return {nominal_lens(focal_35mm, width, height),
          focal_35mm,
          {},
          fmt::format("{}: {:.4g} mm as on film, {} x {} pixels", from, focal_35mm, width, height)};
}

SaidCamera camera_of_photo(const std::filesystem::path& file) {
  const Exif exif = read_exif(file);
  const std::string instead =
      "give the focal length as on film instead: --camera 26mm for a phone's main camera, 50mm, ...";
  std::optional<double> focal = exif.focal_35mm;
  if (!focal && exif.focal_mm && exif.sensor_width_mm) {
    // EXIF defines it by the diagonals.
    const double width = *exif.sensor_width_mm,
                 height = width * std::min(exif.width, exif.height) / std::max(exif.width, exif.height);
    focal = *exif.focal_mm * std::hypot(36.0, 24.0) / std::hypot(width, height);
  }
  if (!focal && exif.focal_mm)
    fail(file.string(),
         fmt::format("has a focal length of {:.3g} mm, but neither its value on film nor the sensor's size",
                     *exif.focal_mm),
         instead);
  if (!focal)
    fail(file.string(), "has no focal length in EXIF (many programs drop it)",
         "give a photo as the camera wrote it, or " + instead);
  const std::string name = exif.model.empty() ? file.filename().string() : exif.model;
  constexpr double kWidest = 3, kLongest = 3000;
  if (*focal < kWidest || *focal > kLongest || exif.width < 16 || exif.height < 16)
    fail(file.string(), fmt::format("has a focal length of {:.3g} mm as on film, which no camera has", *focal),
         instead);
  // bench.json has two decimals.
  return nominal(std::round(*focal * 100) / 100, exif.width, exif.height, name);
}

}  // namespace

SaidCamera camera_in_words(const std::string& text) {
  const std::string word = trimmed_lower(text);
  if (word == "phone") return nominal(26, 4032, 3024, "a phone");
  const Measure m = measure_in(word);
  if (m.number && (m.unit == "mm" || m.unit.empty()) && *m.number >= 3 && *m.number <= 3000)
    return nominal(*m.number, 6000, 4000, "a camera");
  std::error_code ignored;
  if (!std::filesystem::exists(text, ignored))
    fail("camera", "\"" + text + "\" is neither a word for a camera nor a file",
         "write phone, a focal length as on film (50mm), a photo that the camera took (photo.jpg), or a .cameramodel");
  const std::filesystem::path file = text;
  if (file.extension() != ".cameramodel") return camera_of_photo(file);
  const Lens lens = read_cameramodel(file);
  return {lens, 0, file, fmt::format("{}: {} x {} pixels", file.filename().string(), lens.width, lens.height)};
}

}  // namespace burin

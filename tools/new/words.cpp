#include "tools/new/words.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string_view>
#include <vector>

#include "burin/capture/exif.h"
#include "burin/render/degrees.h"
#include "burin/render/error.h"
#include "burin/render/files/file_names.h"
#include "burin/render/files/table.h"

namespace burin {
namespace {

std::string trimmed_lower(std::string_view text) {
  const std::string out = lower_case(std::string(text));
  const std::size_t first = out.find_first_not_of(" \t"), last = out.find_last_not_of(" \t");
  return first == std::string::npos ? "" : out.substr(first, last - first + 1);
}

// "1.2m" in its number and its unit, either of which may be missing.
struct Measure {
  std::optional<double> number;
  std::string unit;
};

Measure measure_in(std::string_view text) {
  const std::string word = trimmed_lower(text);
  const std::size_t end = std::min(word.find_first_not_of("0123456789.+-"), word.size());
  return {number_in(word.substr(0, end)), trimmed_lower(word.substr(end))};
}

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

constexpr const char* kLengthRemedy = "write a number and its unit: 1.2m, 60cm, 600mm or 48in (a bare number is mm)";

}  // namespace

double length_in_words(const std::string& text, const std::string& what) {
  const Measure m = measure_in(text);
  const std::optional<double> unit = m.unit.empty() ? 1.0 : unit_mm(m.unit);
  if (!m.number || !unit) fail(what, "\"" + text + "\" is no length", kLengthRemedy);
  const double mm = *m.number * *unit;
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
  const std::string& shared = height.unit;  // "20x15cm" means both
  const std::optional<double> height_unit = shared.empty() ? 1.0 : unit_mm(shared),
                              width_unit = width.unit.empty() ? height_unit : unit_mm(width.unit);
  if (!width.number || !height.number || !width_unit || !height_unit || (shared.empty() && !width.unit.empty()))
    fail(what, "\"" + text + "\" is no width and height", remedy);
  Eigen::Vector2d mm(*width.number * *width_unit, *height.number * *height_unit);
  if (!(mm.minCoeff() > 0)) fail(what, "\"" + text + "\" has a side that is not above 0", remedy);
  return mm;
}

SaidLamp lamp_in_words(const std::string& text) {
  const std::string remedy =
      "say above, below, left or right (or above left, ...), with a distance from the board's middle if you like: "
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
      if (rest.starts_with('-')) rest = trimmed_lower(rest.substr(1));  // "above-left"
      more = true;
    }
  }
  if (!(direction.norm() > 0.5)) fail("lamp", "\"" + text + "\" says no direction", remedy);
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
      "say the focal length as on film instead: --camera 26mm for a phone's main camera, 50mm, ...";
  std::optional<double> focal = exif.focal_35mm;
  if (!focal && exif.focal_mm && exif.sensor_width_mm) {
    // As EXIF counts it: by the diagonals.
    const double width = *exif.sensor_width_mm,
                 height = width * std::min(exif.width, exif.height) / std::max(exif.width, exif.height);
    focal = *exif.focal_mm * std::hypot(36.0, 24.0) / std::hypot(width, height);
  }
  if (!focal && exif.focal_mm)
    fail(file.string(),
         fmt::format("says a focal length of {:.3g} mm, but neither what that is on film nor how large the sensor is",
                     *exif.focal_mm),
         instead);
  if (!focal)
    fail(file.string(), "says no focal length (many programs drop EXIF)",
         "give a photo as the camera wrote it, or " + instead);
  const std::string name = exif.model.empty() ? file.filename().string() : exif.model;
  constexpr double kWidest = 3, kLongest = 3000;
  if (*focal < kWidest || *focal > kLongest || exif.width < 16 || exif.height < 16)
    fail(file.string(), fmt::format("says a focal length of {:.3g} mm as on film, which no camera has", *focal),
         instead);
  // To a hundredth, as bench.json has it.
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
         "say phone, a focal length as on film (50mm), a photo that the camera took (photo.jpg), or a .cameramodel");
  const std::filesystem::path file = text;
  if (file.extension() != ".cameramodel") return camera_of_photo(file);
  const Lens lens = read_cameramodel(file);
  return {lens, 0, file, fmt::format("{}: {} x {} pixels", file.filename().string(), lens.width, lens.height)};
}

}  // namespace burin

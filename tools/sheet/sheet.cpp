#include "tools/sheet/sheet.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "burin/calib/verdict/camera_place.h"

namespace burin {
namespace {

std::string rounded(double mm) { return fmt::format("{:.{}f}", mm, std::abs(mm) < 9.95 ? 1 : 0); }

std::string beside(double value, double size, const char* low, const char* high) {
  constexpr double kAt = 0.5;
  if (std::abs(value) < kAt) return fmt::format("at the {} edge", low);
  if (std::abs(value - size) < kAt) return fmt::format("at the {} edge", high);
  if (value < 0) return fmt::format("{:.0f} mm beyond the {} edge", -value, low);
  if (value > size) return fmt::format("{:.0f} mm beyond the {} edge", value - size, high);
  return value <= size / 2 ? fmt::format("{:.0f} mm in from the {} edge", value, low)
                           : fmt::format("{:.0f} mm in from the {} edge", size - value, high);
}

std::string tolerance_words(const PlaceTolerance& t) {
  return fmt::format("{}, {}, {} mm", rounded(t.sideways.least()), rounded(t.up.least()), rounded(t.depth.least()));
}

MoveRange smaller(const MoveRange& a, const MoveRange& b) { return a.least() <= b.least() ? a : b; }

double above_floor(const Sheet& sheet, double y_mm) {
  return sheet.hang_height_mm + y_mm - sheet.board.size_mm.y() / 2;
}

// y of the lowest and of the highest eye, board frame.
std::pair<double, double> eye_range_mm(const std::vector<SheetPlace>& places) {
  double low = INFINITY, high = -INFINITY;
  for (const SheetPlace& place : places) {
    if (place.lamp) continue;
    low = std::min(low, place.at_mm.y());
    high = std::max(high, place.at_mm.y());
  }
  return {low, high};
}

// Reports the eyes' heights, with a remedy.
Finding eyes_and_floor(const Sheet& sheet) {
  constexpr double kKnees_mm = 200;  // allowance for bent knees, shoes, and people's heights
  const auto [low_y, high_y] = eye_range_mm(sheet.places);
  const double low = above_floor(sheet, low_y), high = above_floor(sheet, high_y);
  const std::string eyes =
      high - low < 10 ? fmt::format("eyes {:.2f} m above the floor", low / 1000)
                      : fmt::format("eyes between {:.2f} and {:.2f} m above the floor", low / 1000, high / 1000);
  const std::string standing = fmt::format("a standing adult's are at about {:.1f} m", kStandingEye_mm / 1000);
  const double usual = usual_hang_height_mm(sheet.board, sheet.places);
  if (std::abs((low + high) / 2 - kStandingEye_mm) > kKnees_mm && sheet.hang_height_mm != usual)
    return make_warning(
        FindingCode::hang_height, eyes,
        fmt::format("{}: hang the board's middle at {:.0f} mm (--hang-height {:.0f})", standing, usual, usual));
  return {FindingCode::hang_height,
          Finding::Severity::note,
          {},
          eyes,
          standing + (high - low < 10 ? "" : ", and knees bend from one place to the next")};
}

std::string full_name(const SheetPlace& place) {
  return place.lamp ? fmt::format("lamp \"{}\"", place.name) : fmt::format("{}: view \"{}\"", place.label, place.name);
}

}  // namespace

std::vector<SheetPlace> sheet_places(const WantedBench& wanted) {
  std::vector<SheetPlace> lamps, eyes;
  for (const DesignedLamp& lamp : designed_lamps(wanted.design, wanted.bench, wanted.board, wanted.tolerances))
    lamps.push_back({"L", lamp.id, true, lamp.at_mm, lamp.tolerance});
  const std::vector<Eigen::Vector3d> centers = designed_eyes(wanted);
  for (std::size_t k = 0; k < wanted.design.views.size(); ++k) {
    const DesignView& v = wanted.design.views[k];
    const MatchTolerance& tolerance = wanted.tolerances[k];
    // A view under two lamps is one viewpoint.
    const auto eye =
        std::find_if(eyes.begin(), eyes.end(), [&](const SheetPlace& place) { return place.name == v.view; });
    if (eye == eyes.end()) {
      eyes.push_back({std::to_string(eyes.size() + 1), v.view, false, centers[k], tolerance.eye});
    } else {
      PlaceTolerance& t = eye->tolerance;
      t = {smaller(t.sideways, tolerance.eye.sideways), smaller(t.up, tolerance.eye.up),
           smaller(t.depth, tolerance.eye.depth)};
    }
  }
  if (lamps.size() > 1)
    for (std::size_t i = 0; i < lamps.size(); ++i) lamps[i].label = "L" + std::to_string(i + 1);
  lamps.insert(lamps.end(), eyes.begin(), eyes.end());
  return lamps;
}

double usual_hang_height_mm(const Board& board, const std::vector<SheetPlace>& places) {
  constexpr double kWhole_mm = 10;
  const auto [low, high] = eye_range_mm(places);
  const double middle = std::isfinite(low) ? (low + high) / 2 - board.size_mm.y() / 2 : 0;
  const double least = std::ceil(board.size_mm.y() / 2 / kWhole_mm) * kWhole_mm;
  return std::max(least, std::round((kStandingEye_mm - middle) / kWhole_mm) * kWhole_mm);
}

std::vector<PlaceInWords> on_table(const Sheet& sheet) {
  std::vector<PlaceInWords> out;
  const Eigen::Vector2d& size = sheet.board.size_mm;
  for (const SheetPlace& place : sheet.places)
    out.push_back({full_name(place), beside(place.at_mm.x(), size.x(), "left", "right"),
                   beside(place.at_mm.y(), size.y(), "lower", "upper"),
                   fmt::format("{:.0f} mm above the face", place.at_mm.z()), tolerance_words(place.tolerance)});
  return out;
}

std::vector<PlaceInWords> on_wall(const Sheet& sheet) {
  std::vector<PlaceInWords> out;
  const Eigen::Vector2d& size = sheet.board.size_mm;
  for (const SheetPlace& place : sheet.places) {
    const double height = above_floor(sheet, place.at_mm.y());
    out.push_back({full_name(place), beside(place.at_mm.x(), size.x(), "left", "right"),
                   height >= 0 ? fmt::format("{} {:.0f} mm above the floor", place.lamp ? "lamp" : "eye", height)
                               : fmt::format("{:.0f} mm below the floor", -height),
                   fmt::format("{:.0f} mm in front of the face", place.at_mm.z()), tolerance_words(place.tolerance)});
  }
  return out;
}

std::vector<PhotoInWords> photos_in_words(const Sheet& sheet) {
  std::vector<PhotoInWords> out;
  for (std::size_t i = 0; i < sheet.plan.shots.size(); ++i) {
    const PlannedShot& shot = sheet.plan.shots[i];
    out.push_back({shot.view.empty() ? std::to_string(i + 1) : fmt::format("{}: view \"{}\"", i + 1, shot.view),
                   place_in_words(shot.camera, sheet.board), sheet.plan.bench.lights[shot.light].id,
                   exposures_in_words(sheet.plan, shot)});
  }
  return out;
}

std::string introduction(const Sheet& sheet) {
  std::string from = sheet.measured_rounds > 0
                         ? fmt::format("Places as measured from the photos of round {}.", sheet.measured_rounds)
                         : "Places as designed; nothing is measured yet.";
  return from +
         " A picture is lost (3 dB) where its eye or its lamp stands further off than what it tolerates: the shaded "
         "ellipses.";
}

std::string begun_as_sentence(std::string words) {
  if (!words.empty() && words[0] >= 'a' && words[0] <= 'z') words[0] = static_cast<char>(words[0] - 'a' + 'A');
  return words;
}

std::vector<Finding> findings(const Sheet& sheet) {
  std::vector<Finding> out;
  if (std::isfinite(eye_range_mm(sheet.places).first)) out.push_back(eyes_and_floor(sheet));
  for (const SheetPlace& place : sheet.places)
    if (const double height = above_floor(sheet, place.at_mm.y()); height < 0)
      out.push_back(
          make_warning(FindingCode::hang_height,
                       fmt::format("{} is {:.0f} mm below the floor when the board's middle hangs at {:.0f} mm",
                                   full_name(place), -height, sheet.hang_height_mm),
                       fmt::format("hang it at least {:.0f} mm higher (--hang-height {:.0f})", -height,
                                   std::ceil((sheet.hang_height_mm - height) / 50) * 50)));
  return out;
}

}  // namespace burin

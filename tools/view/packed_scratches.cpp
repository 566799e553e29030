#include "tools/view/packed_scratches.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "burin/base/files/json_file.h"
#include "tools/base64.h"

namespace burin {
namespace {

constexpr double kMost = 65535;

void append(std::string& bytes, double value) {
  const auto v = static_cast<std::uint16_t>(std::clamp(std::lround(value), 0L, 65535L));
  bytes += static_cast<char>(v & 255);
  bytes += static_cast<char>(v >> 8);
}

double in_range(double value, double low, double high) { return high > low ? kMost * (value - low) / (high - low) : 0; }

struct Piece {
  double x, y, turn, length;
  std::size_t source;
};

std::vector<Piece> pieces_of(const Scratches& s, double longest_mm) {
  std::vector<Piece> pieces;
  pieces.reserve(s.size());
  for (std::size_t i = 0; i < s.size(); ++i) {
    const double dx = s.x1_mm[i] - s.x0_mm[i], dy = s.y1_mm[i] - s.y0_mm[i], length = std::hypot(dx, dy);
    if (!(length > 0)) continue;
    const int parts = std::max(1, static_cast<int>(std::ceil(length / longest_mm)));
    double turn = std::atan2(dy, dx) / std::numbers::pi;  // a groove's direction has no sign: 0 to 1 for 180 degrees
    turn -= std::floor(turn);
    for (int k = 0; k < parts; ++k) {
      const double at = (k + 0.5) / parts;
      pieces.push_back({s.x0_mm[i] + at * dx, s.y0_mm[i] + at * dy, turn, length / parts, i});
    }
  }
  return pieces;
}

Json column(const std::vector<double>& values, double shared, const std::vector<Piece>& pieces) {
  if (values.empty() || pieces.empty()) return {{"min", shared}, {"max", shared}};
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  Json json{{"min", *low}, {"max", *high}};
  if (*high == *low) return json;
  std::string bytes;
  for (const Piece& p : pieces) append(bytes, in_range(values[p.source], *low, *high));
  json["rows"] = base64(bytes);
  return json;
}

}  // namespace

std::string packed_scratches(const Carved& carved, const SharedGroove& shared, double longest_mm) {
  const std::vector<Piece> pieces = pieces_of(carved.scratches, longest_mm);
  Piece low{0, 0, 0, 0, 0}, high{1, 1, 0, 1e-3, 0};
  if (!pieces.empty()) low = high = pieces.front();
  for (const Piece& p : pieces) {
    low.x = std::min(low.x, p.x), low.y = std::min(low.y, p.y);
    high.x = std::max(high.x, p.x), high.y = std::max(high.y, p.y);
    high.length = std::max(high.length, p.length);
  }
  std::string bytes;
  bytes.reserve(8 * pieces.size());
  for (const Piece& p : pieces) {
    append(bytes, in_range(p.x, low.x, high.x));
    append(bytes, in_range(p.y, low.y, high.y));
    const double turn = std::round(p.turn * 65536);
    append(bytes, turn > kMost ? 0 : turn);
    append(bytes, kMost * p.length / high.length);
  }
  const Scratches& s = carved.scratches;
  const Json json{{"count", pieces.size()},
                  {"min_mm", {low.x, low.y}},
                  {"max_mm", {high.x, high.y}},
                  {"longest_mm", high.length},
                  {"rows", base64(bytes)},
                  {"width_um", column(s.width_um, shared.width_um, pieces)},
                  {"depth_um", column(s.depth_um, shared.depth_um, pieces)},
                  {"alpha", column(s.alpha, shared.alpha, pieces)}};
  return json.dump();
}

}  // namespace burin

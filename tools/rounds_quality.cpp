#include "tools/rounds_quality.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "burin/base/files/json_file.h"

namespace burin {
namespace {

Json number_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

double number_or_none(JsonObject& item, const char* key) {
  return item.raw(key).is_null() ? std::numeric_limits<double>::quiet_NaN() : item.number(key);
}

}  // namespace

std::string rounds_text(const RoundsQuality& rounds, const std::filesystem::path& file) {
  Json json{{"format", "burin/rounds"}, {"version", 1}};
  json["rounds"] = Json::array();
  for (const std::vector<ViewQuality>& round : rounds) {
    Json views = Json::array();
    for (const ViewQuality& v : round)
      views.push_back({{"view", v.view},
                       {"promised_db", number_or_null(v.promised_db)},
                       {"photographed_db", number_or_null(v.photographed_db)}});
    json["rounds"].push_back({{"round", json["rounds"].size() + 1}, {"views", views}});
  }
  return json_text(json, file);
}

std::optional<RoundsQuality> read_rounds(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) return std::nullopt;
  const Json json = read_json(file, "burin/rounds", 1);
  JsonObject root(json, file.string());
  RoundsQuality out;
  for (JsonObject& round : root.objects("rounds")) {
    std::vector<ViewQuality>& views = out.emplace_back();
    for (JsonObject& view : round.objects("views"))
      views.push_back(
          {view.text("view"), number_or_none(view, "promised_db"), number_or_none(view, "photographed_db")});
  }
  return out;
}

std::optional<NextBoard> next_board(const RoundsQuality& rounds) {
  if (rounds.size() < 2) return std::nullopt;
  const std::vector<ViewQuality>&now = rounds[rounds.size() - 2], &next = rounds.back();
  if (now.empty() || now.size() != next.size()) return std::nullopt;
  NextBoard out;
  out.round = static_cast<int>(rounds.size()) - 1;
  out.most_gain_db = -std::numeric_limits<double>::infinity();
  const auto count = static_cast<double>(now.size());
  for (std::size_t k = 0; k < now.size(); ++k) {
    const double promised = now[k].promised_db, seen = now[k].photographed_db, then = next[k].promised_db;
    if (!std::isfinite(promised) || !std::isfinite(seen) || !std::isfinite(then)) return std::nullopt;
    // the last board is photographed, so there is no next one
    if (std::isfinite(next[k].photographed_db)) return std::nullopt;
    out.promised_db += promised / count;
    out.photographed_db += seen / count;
    out.next_db += then / count;
    out.most_gain_db = std::max(out.most_gain_db, then - seen);
  }
  return out;
}

bool is_last(const NextBoard& next) {
  return std::abs(next.promised_db - next.photographed_db) < kSeen_db && next.gain_db() < kSeen_db &&
         next.most_gain_db < 2 * kSeen_db;
}

std::string hang_in_words(const NextBoard& next) {
  const std::string gain = next.gain_db() < 0.05
                               ? "another board would be no better"
                               : fmt::format("another board would gain {:.1f} dB (less than {} dB is hardly seen)",
                                             next.gain_db(), kSeen_db);
  return fmt::format("hang the board of round {}: it shows {:.1f} dB, {:.1f} dB were promised, and {}", next.round,
                     next.photographed_db, next.promised_db, gain);
}

}  // namespace burin

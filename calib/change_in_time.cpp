#include "burin/calib/change_in_time.h"

#include <algorithm>

namespace burin {

std::optional<ChangeInTime> change_in_time(const Session& session, const std::vector<std::string>& odd,
                                           const std::vector<std::string>& unknown) {
  const auto is_in = [](const std::vector<std::string>& list, const std::string& name) {
    return std::find(list.begin(), list.end(), name) != list.end();
  };
  std::vector<std::string> views;
  for (const Photo& photo : session.photos)
    if (!is_in(views, photo.view)) views.push_back(photo.view);
  std::vector<bool> is_odd;
  std::vector<std::string> known;
  for (const std::string& view : views)
    if (!is_in(unknown, view) || is_in(odd, view)) {
      known.push_back(view);
      is_odd.push_back(is_in(odd, view));
    }
  const auto count = std::count(is_odd.begin(), is_odd.end(), true);
  if (count < 2 || static_cast<std::size_t>(count) + 2 > known.size()) return std::nullopt;
  const auto changes = [&] {
    std::size_t n = 0;
    for (std::size_t i = 1; i < is_odd.size(); ++i) n += is_odd[i] != is_odd[i - 1];
    return n;
  }();
  if (changes != 1) return std::nullopt;
  const auto at = static_cast<std::size_t>(std::find(is_odd.begin(), is_odd.end(), !is_odd.front()) - is_odd.begin());
  ChangeInTime out;
  out.view_before = known[at - 1];
  out.view_after = known[at];
  out.odd_after = is_odd[at];
  for (const Photo& photo : session.photos) {
    const std::string name = photo.file.filename().string();
    if (photo.view == out.view_before) out.photo_before = name;
    if (photo.view == out.view_after && out.photo_after.empty()) out.photo_after = name;
  }
  return out;
}

std::optional<ChangeInTime> change_of_lamp(const Session& session,
                                           const std::vector<std::pair<std::string, double>>& residuals,
                                           std::vector<std::string>& odd) {
  std::vector<std::pair<double, std::string>> others;
  for (const auto& [view, residual] : residuals)
    if (std::find(odd.begin(), odd.end(), view) == odd.end()) others.emplace_back(-residual, view);
  std::sort(others.begin(), others.end());
  std::vector<std::string> wider = odd;
  for (std::size_t i = 0;; ++i) {
    if (auto change = change_in_time(session, wider)) {
      odd = wider;
      return change;
    }
    if (i == others.size() || 2 * (i + 1) > odd.size()) return std::nullopt;
    wider.push_back(others[i].second);
  }
}

}  // namespace burin

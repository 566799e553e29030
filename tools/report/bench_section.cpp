#include "tools/report/bench_section.h"

#include <fmt/format.h>

#include <algorithm>

#include "tools/report/html.h"
#include "tools/view/bench_scene.h"

namespace burin {

std::string bench_section(const Bench& bench, const Board& board, const std::vector<MatchTolerance>& tolerances,
                          const std::string& heading) {
  const bool uncertain = std::ranges::any_of(bench.views, [](const View& v) { return v.center_sigma_mm.has_value(); });
  const std::string alt = fmt::format("{} in space: {}, {} and the board{}", heading,
                                      grouped(static_cast<long long>(bench.views.size()), "camera"),
                                      grouped(static_cast<long long>(bench.lights.size()), "lamp"),
                                      uncertain ? ", with ellipsoids that show how uncertain each place is" : "");
  return "<section class=\"scene\"><h2>" + html(heading) + "</h2>\n" + bench_scene_html(board, bench, tolerances, alt) +
         "</section>\n";
}

}  // namespace burin

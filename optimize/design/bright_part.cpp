#include "burin/optimize/design/bright_part.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "burin/optimize/design/color_views.h"
#include "burin/optimize/design/glint.h"
#include "burin/optimize/toolpath/ends.h"
#include "burin/scene/groove.h"
#include "burin/scene/scratches.h"

namespace burin {
namespace {

constexpr double kBright = 0.005;   // of the light in the best direction
constexpr double kDarkFace = 0.05;  // of the groove's light

void add_rows(const std::vector<double>& of_part, const std::vector<std::size_t>& rows, std::vector<double>& to) {
  for (std::size_t k = 0; k < of_part.size(); ++k) to[rows[k]] += of_part[k];
}

}  // namespace

bool glints_along_lines(const WorkView& view, const Bench& bench) {
  for (const std::string& id : lights_served(view.spec)) {
    const Light light = find_lit(bench, id, "design");
    if (!light.is_lamp() || !light.size.is_point()) return false;
  }
  return !view.lamps.empty() && std::all_of(view.lamps.begin(), view.lamps.end(), [](const WorkLamp& lamp) {
    return lamp.glint.of_one_lamp_on_a_flat_face();
  });
}

bool bright_part_shows(const WorkView& view, const Bench& bench, const Board& board) {
  if (!glints_along_lines(view, bench)) return false;
  // Light of a groove in its best direction, per mm; the covered face light must be small in comparison.
  double sent = 0;
  for (const WorkLamp& lamp : view.lamps) sent = std::max(sent, mean_value(lamp.unit));
  const double width_mm = 2e-3 * half_width_um(bench.material.profile, board.tool_width_um, bench.material.depth_um);
  const double brightest = *std::max_element(view.face.data.begin(), view.face.data.end());
  return brightest * width_mm / (view.pitch_mm * view.pitch_mm) < kDarkFace * sent;
}

std::vector<std::size_t> bright_rows(const WorkView& view, const Bench& bench, const Scratches& grooves) {
  const double q2_most = std::pow(kBright, -2.0 / 3) - 1;  // lobe() = (1 + q^2)^(-3/2)
  std::vector<char> bright(grooves.size(), 0);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, grooves.size(), 1024), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      const Ends e = ends_of(grooves, i);
      const Eigen::Vector2d middle = (e.a + e.b) / 2, u = (e.b - e.a).normalized();
      const double alpha = grooves.alpha.empty() ? bench.material.alpha : grooves.alpha[i];
      for (const WorkLamp& lamp : view.lamps) {
        const double q = lobe_place(lamp.glint, middle, u, alpha);
        if (q * q <= q2_most) bright[i] = 1;
      }
    }
  });
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < bright.size(); ++i)
    if (bright[i] != 0) rows.push_back(i);
  return rows;
}

void render_view(WorkView& view, BrightPart& part, const Bench& bench, const LyingGrooves& grooves,
                 bool with_jacobian) {
  const auto render = [&](const Carved& shown) {
    if (with_jacobian)
      view.renderer.forward_with_jacobian(shown, view.radiance);
    else
      view.renderer.forward(shown, view.radiance);
  };
  if (!part.apart) {
    part.grooves = seen_by(view, grooves);
    render(part.grooves);
    return;
  }
  part.rows = bright_rows(view, bench, grooves.whole.scratches);
  part.grooves = seen_by(view, grooves, part.rows);
  const bool anew = part.others.data.empty();
  if (anew) view.renderer.forward(seen_by(view, grooves), part.others);
  render(part.grooves);
  if (anew)
    for (std::size_t i = 0; i < part.others.data.size(); ++i) part.others.data[i] -= view.radiance.data[i];
  for (std::size_t i = 0; i < part.others.data.size(); ++i) view.radiance.data[i] += part.others.data[i];
}

Image uncut_radiance(WorkView& view, const BrightPart& part, const Bench& bench, const Carved& whole) {
  Image out;
  if (!part.apart) {
    view.renderer.forward(whole, out);
    return out;
  }
  Carved bright;
  bright.scratches = selected(whole.scratches, bright_rows(view, bench, whole.scratches));
  view.renderer.forward(bright, out);
  for (std::size_t i = 0; i < part.others.data.size(); ++i) out.data[i] += part.others.data[i];
  return out;
}

void view_backward(const WorkView& view, BrightPart& part, const Metal& metal, const LyingGrooves& grooves,
                   const Image& dE_dradiance, ScratchGradients& by_whole) {
  if (!part.apart && !grooves.cuts) {
    view.renderer.backward(dE_dradiance, by_whole);
    return;
  }
  ScratchGradients& own = part.gradients;
  own.resize(part.grooves.size());
  view.renderer.backward(dE_dradiance, own);
  std::vector<std::size_t> rows = part.rows;
  if (grooves.cuts) {
    own = pull_back(part.grooves, Designed(grooves.whole.scratches), metal.bench, metal.board, std::move(own));
    rows.resize(grooves.whole.size());
    std::iota(rows.begin(), rows.end(), std::size_t{0});
  }
  add_rows(own.x0_mm, rows, by_whole.x0_mm);
  add_rows(own.y0_mm, rows, by_whole.y0_mm);
  add_rows(own.x1_mm, rows, by_whole.x1_mm);
  add_rows(own.y1_mm, rows, by_whole.y1_mm);
  add_rows(own.width_um, rows, by_whole.width_um);
  add_rows(own.depth_um, rows, by_whole.depth_um);
  add_rows(own.alpha, rows, by_whole.alpha);
  by_whole.shared_width_um += own.shared_width_um;
  by_whole.shared_depth_um += own.shared_depth_um;
  by_whole.shared_alpha += own.shared_alpha;
  by_whole.shared_base_alpha += own.shared_base_alpha;
}

}  // namespace burin

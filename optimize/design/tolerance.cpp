#include "burin/optimize/design/tolerance.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "burin/base/files/decimals.h"
#include "burin/optimize/design/design_views.h"
#include "burin/optimize/loss/color_metrics.h"
#include "burin/scene/carve.h"

namespace burin {
namespace {

constexpr int kMapPixels = 128, kMapPlaces = 9;

// A view rendered with moved eye and lamp.
class MovedView {
 public:
  MovedView(const DesignSpec& spec, std::size_t index, const Board& board, const Bench& bench,
            const ToleranceTarget& target, int pixels, const Carved& grooves)
      : spec_(spec),
        index_(index),
        board_(board),
        bench_(bench),
        exposure_(target.exposure),
        gains_(target.gains),
        grooves_(grooves),
        target_(target.target),
        mask_(target.mask) {
    const int longer = std::max(target_.width, target_.height);
    grid_ = design_grid(board, bench, std::min(pixels, longer));
    if (pixels >= longer) return;
    target_ = resized(target_, grid_->width(), grid_->height());
    if (!mask_.data.empty()) mask_ = resized(mask_, grid_->width(), grid_->height());
  }

  double psnr(const Eigen::Vector3d& eye_moved_mm, const Eigen::Vector3d& lamp_moved_mm) const {
    RenderOptions options;
    options.channels = target_.channels;
    ViewRenderer renderer(scene(eye_moved_mm, lamp_moved_mm), options);
    Image radiance;
    renderer.forward(grooves_, radiance);
    for (std::size_t i = 0; i < radiance.data.size() && radiance.channels == 3; ++i)
      radiance.data[i] *= static_cast<float>(gains_[i % 3]);
    const double exposure = color_best_exposure(radiance, target_, exposure_, mask_);
    return color_psnr_db(shown_picture(radiance, exposure), target_, mask_);
  }

 private:
  ViewScene scene(const Eigen::Vector3d& eye_moved_mm, const Eigen::Vector3d& lamp_moved_mm) const {
    return design_scene(spec_, index_, board_, bench_, grid_, eye_moved_mm, lamp_moved_mm);
  }

  const DesignSpec& spec_;
  std::size_t index_;
  const Board& board_;
  const Bench& bench_;
  double exposure_;
  std::array<double, 3> gains_;
  const Carved& grooves_;
  std::shared_ptr<const FootprintGrid> grid_;
  Image target_, mask_;
};

struct Axes {
  Eigen::Vector3d sideways, up, depth;
  double distance_mm;
};

Axes axes_at(const Eigen::Vector3d& place_mm, const Board& board) {
  const Eigen::Vector2d middle = (board.carve_min_mm + board.carve_max_mm) / 2;
  const Eigen::Vector3d way = place_mm - Eigen::Vector3d(middle.x(), middle.y(), 0);
  Axes axes;
  axes.distance_mm = way.norm();
  axes.depth = way / axes.distance_mm;
  const Eigen::Vector3d level = Eigen::Vector3d::UnitZ().cross(axes.depth);
  axes.sideways = level.norm() > 1e-6 ? level.normalized() : Eigen::Vector3d::UnitX();
  axes.up = axes.depth.cross(axes.sideways);
  return axes;
}

// The distance at which `lost` (dB, by distance) reaches kLostDb: doubling or halving gives a bracket, then the secant
// method stays inside it.
template <typename Lost>
double range_of(const Lost& lost, double first_mm, double most_mm) {
  double inside = 0, outside = 0, lost_inside = 0, lost_outside = 0;
  double at = std::min(first_mm, most_mm);
  for (int k = 0; k < 12 && (inside == 0 || outside == 0); ++k) {
    const double l = lost(at);
    if (l < kLostDb) {
      inside = at;
      lost_inside = l;
      if (at >= most_mm) return most_mm;
      at = std::min(2 * at, most_mm);
    } else {
      outside = at;
      lost_outside = l;
      at /= 2;
    }
  }
  if (outside == 0) return inside;
  for (int k = 0; k < 3 && outside - inside > 0.02 * outside; ++k) {
    const double part = std::clamp((kLostDb - lost_inside) / (lost_outside - lost_inside), 0.1, 0.9);
    at = inside + part * (outside - inside);
    const double l = lost(at);
    if (l < kLostDb) {
      inside = at;
      lost_inside = l;
    } else {
      outside = at;
      lost_outside = l;
    }
  }
  return inside + (kLostDb - lost_inside) / (lost_outside - lost_inside) * (outside - inside);
}

}  // namespace

std::vector<ViewTolerance> measure_tolerance(const DesignSpec& spec, const Board& board, const Bench& bench,
                                             const std::vector<ToleranceTarget>& targets, const Scratches& scratches,
                                             const Progress& progress, const std::function<bool()>& stop) {
  const auto stopped = [&stop] { return stop && stop(); };
  const Carved grooves = carve(Designed(scratches), bench, board);
  std::vector<ViewTolerance> out(spec.views.size());
  for (std::size_t k = 0; k < spec.views.size(); ++k) {
    ViewTolerance& t = out[k];
    const MovedView moved(spec, k, board, bench, targets[k], kTolerancePixels, grooves);
    const Eigen::Vector3d still(0, 0, 0);
    t.psnr_db = moved.psnr(still, still);
    int done = 0;
    const auto tell = [&] {
      if (progress)
        progress("measuring tolerance",
                 (static_cast<double>(k) + done++ / 14.0) / static_cast<double>(spec.views.size()));
    };
    const auto range = [&](const Eigen::Vector3d& axis, double distance_mm, bool lamp) {
      const auto one_way = [&](double way) {
        if (stopped()) return 0.0;  // this view is left out
        tell();
        return range_of(
            [&](double d) {
              if (stopped()) return kLostDb;
              const Eigen::Vector3d shift = way * d * axis;
              return t.psnr_db - (lamp ? moved.psnr(still, shift) : moved.psnr(shift, still));
            },
            0.02 * distance_mm, 0.5 * distance_mm);
      };
      const double minus = one_way(-1);
      return MoveRange{minus, one_way(1)};
    };
    const DesignView& v = spec.views[k];
    const Axes eye = axes_at(find_view(bench, v.view, "design").T_camera_board.inverse().translation(), board),
               lamp = axes_at(find_light(bench, v.light, "design").position_mm, board);
    t.eye = {range(eye.sideways, eye.distance_mm, false), range(eye.up, eye.distance_mm, false),
             range(eye.depth, eye.distance_mm, false)};
    t.lamp = {range(lamp.sideways, lamp.distance_mm, true), range(lamp.up, lamp.distance_mm, true),
              range(lamp.depth, lamp.distance_mm, true)};
    if (!stopped()) tell();
    // The map shows twice the eye's range.
    const MovedView small(spec, k, board, bench, targets[k], kMapPixels, grooves);
    const double here = small.psnr(still, still);
    t.map_half_mm = 2 * std::min(t.eye.sideways.least(), t.eye.up.least());
    t.lost_db = Image(kMapPlaces, kMapPlaces, 1);
    for (int y = 0; y < kMapPlaces; ++y)
      for (int x = 0; x < kMapPlaces && !stopped(); ++x) {
        const double right = (2.0 * x / (kMapPlaces - 1) - 1) * t.map_half_mm,
                     up = (1 - 2.0 * y / (kMapPlaces - 1)) * t.map_half_mm;
        t.lost_db.at(x, y) = static_cast<float>(here - small.psnr(right * eye.sideways + up * eye.up, still));
      }
    if (!stopped()) continue;
    out.resize(k);
    break;
  }
  return out;
}

std::string tolerance_text(const std::string& view, const ViewTolerance& t) {
  return "view " + view + " holds within " + coarse(t.eye.sideways.least()) + " mm sideways, " +
         coarse(t.eye.up.least()) + " mm up or down, " + coarse(t.eye.depth.least()) +
         " mm in depth; its lamp within " + coarse(t.lamp.sideways.least()) + ", " + coarse(t.lamp.up.least()) +
         " and " + coarse(t.lamp.depth.least()) + " mm";
}

}  // namespace burin

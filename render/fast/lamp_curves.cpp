#include "burin/render/fast/lamp_curves.h"

#include <tbb/parallel_for.h>

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "burin/render/exact/exact_view.h"
#include "burin/render/scene_parts.h"

namespace burin {
namespace {

constexpr double kLeanAStep = 0.8;  // of the roughness: largest change of lean between nodes
constexpr int kMostNodes = 400;     // on either side

// Gauss-Legendre nodes of order four on 0 .. 1.
constexpr std::array<double, SectionLeans::kGauss> kPlaces{0.06943184420297371, 0.33000947820757187,
                                                           0.66999052179242813, 0.93056815579702629};

}  // namespace

SectionNodes section_nodes(const GrooveProfile& profile, double width_um, double rim, double lean_step) {
  SectionNodes out;
  const double half_um = width_um / 2;
  const double flank = flank_begin_um(profile, width_um) / half_um, curved = std::min(flank, rim);
  const double highest = std::max(profile.burr_left_um, profile.burr_right_um);
  const double burr_steps = 2 * burr_lean(highest, profile.burr_width_um, -0.5 * profile.burr_width_um) / lean_step;
  double steps = std::ceil(std::max(2.0, wall_lean(profile, width_um, curved * half_um) / lean_step));
  if (profile.has_burrs()) steps = std::ceil(std::max(steps, 0.5 * burr_steps * curved / rim));
  out.half_count = std::min(kMostNodes, static_cast<int>(std::ceil(steps * rim / curved * (1 - 1e-9))));
  out.step = out.half_count < kMostNodes ? curved / steps : rim / out.half_count;
  return out;
}

double lean_at_node(const GrooveProfile& profile, double width_um, SectionPart part, const SectionNodes& nodes,
                    double k) {
  if (part == SectionPart::groove) return wall_lean(profile, width_um, 0.5 * k * nodes.step * width_um);
  const double height_um = part == SectionPart::left_burr ? profile.burr_left_um : profile.burr_right_um;
  return burr_lean(height_um, profile.burr_width_um, k / nodes.half_count * 0.5 * profile.burr_width_um);
}

bool has_part(const GrooveProfile& profile, SectionPart part) {
  return part == SectionPart::groove ||
         (part == SectionPart::left_burr ? profile.burr_left_um : profile.burr_right_um) != 0;
}

SectionLeans section_leans(const GrooveProfile& profile, double width_um, double rim, double alpha) {
  SectionLeans out;
  const SectionNodes all = section_nodes(profile, width_um, rim, kLeanAStep * alpha);
  out.half_count = all.half_count;
  out.step = static_cast<float>(all.step);
  out.stride = (2 * out.half_count + 1 + 15) / 16 * 16;
  for (int p = 0; p < kSectionParts; ++p) {
    const auto part = static_cast<SectionPart>(p);
    if (!has_part(profile, part)) continue;
    SectionLeans::Part& to = out.part[p];
    const std::size_t size = static_cast<std::size_t>(SectionLeans::kRows) * out.stride;
    to.sine.assign(size, 0);
    to.cosine.assign(size, 1);
    for (int row = 0; row < SectionLeans::kRows; ++row) {
      const bool nodes = row == SectionLeans::kGauss;
      for (int k = 0; k < 2 * out.half_count + (nodes ? 1 : 0); ++k) {
        const double lean = lean_at_node(profile, width_um, part, all, k + (nodes ? 0 : kPlaces[row]) - out.half_count);
        to.sine[static_cast<std::size_t>(row) * out.stride + k] = static_cast<float>(std::sin(lean));
        to.cosine[static_cast<std::size_t>(row) * out.stride + k] = static_cast<float>(std::cos(lean));
      }
    }
  }
  return out;
}

LampFits lamp_fits(const ViewScene& scene, const TiledGrid& grid) {
  constexpr double kMiddle = 0.5 * (kTile - 1), kHalf = 0.5 * kTile;
  constexpr int kEvery = 5;  // pixels between samples of the fit
  std::vector<ScenePart> parts = scene_parts(scene);
  for (ScenePart& part : parts) part.scene.hidden_from_light.clear();  // the pixels already include it
  LampFits out;
  out.points = static_cast<int>(parts.size());
  out.fits.assign(grid.tiles() * parts.size(), {});
  std::vector<double> error(grid.tiles(), 0);
  tbb::parallel_for(std::size_t{0}, grid.tiles(), [&](std::size_t t) {
    struct Seen {
      std::size_t pixel;
      double column, row;
    };
    std::vector<Seen> all, some;
    grid.each_pixel(t, [&](int x, int y, std::size_t place) {
      const std::size_t pixel = static_cast<std::size_t>(y) * grid.width + x;
      if (!grid.index.has_footprint()[pixel]) return;
      const int column = static_cast<int>(place % kTile), row = static_cast<int>(place / kTile);
      const Seen seen{pixel, (column - kMiddle) / kHalf, (row - kMiddle) / kHalf};
      all.push_back(seen);
      if (column % kEvery == 0 && row % kEvery == 0) some.push_back(seen);
    });
    const bool is_whole = all.size() == kTilePixels;
    for (std::size_t k = 0; k < parts.size(); ++k) {
      std::vector<std::array<double, 7>> rows;  // position, and the view of the lamp there
      for (const Seen& seen : is_whole ? some : all) {
        const PixelShading p = shade_pixel(parts[k].scene, seen.pixel);
        if (!p.visible || !p.lit) continue;
        const double light = channel_factors(parts[k].scene, p.cos_ho, 1)[0];
        rows.push_back({seen.column, seen.row, p.h_face.x(), p.h_face.y(), parts[k].share * light * p.direct,
                        (1 - p.cos_i * p.cos_i) / (p.cos_i * p.cos_i), (1 - p.cos_o * p.cos_o) / (p.cos_o * p.cos_o)});
      }
      if (rows.empty()) continue;
      Eigen::MatrixXd places(rows.size(), 6), seen(rows.size(), 5);
      for (std::size_t i = 0; i < rows.size(); ++i) {
        const auto [c, r, h_x, h_y, strength, tan2_i, tan2_o] = rows[i];
        const auto row = static_cast<Eigen::Index>(i);
        places.row(row) << 1, c, r, c * c, c * r, r * r;
        seen.row(row) << h_x, h_y, strength, tan2_i, tan2_o;
      }
      // With few pixels, the minimum-norm polynomial through them.
      const Eigen::MatrixXd fit = places.completeOrthogonalDecomposition().solve(seen);
      error[t] = std::max(error[t], (places * fit.leftCols<2>() - seen.leftCols<2>()).cwiseAbs().maxCoeff());
      LampFit& to = out.fits[t * parts.size() + k];
      float* const numbers[5] = {to.h_x, to.h_y, to.strength, to.tan2_i, to.tan2_o};
      for (int n = 0; n < 5; ++n)
        for (int i = 0; i < 6; ++i) numbers[n][i] = static_cast<float>(fit(i, n));
    }
  });
  out.error = *std::max_element(error.begin(), error.end());
  return out;
}

}  // namespace burin

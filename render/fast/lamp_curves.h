// burin/render/fast/lamp_curves.h - inputs of curves (burin/render/fast/curve_tables.h) for grooves of any
// cross-section under a lamp: the section's leans, and each tile's view of the lamp. Curves are made at a few positions
// along each groove. docs/model.md 8.6.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "burin/render/fast/curve_tables.h"
#include "burin/render/fast/groove_strips.h"
#include "burin/render/fast/tiled_grid.h"
#include "burin/render/view_scene.h"

namespace burin {

/// Leans of the walls of a section's parts at the nodes of curves. t runs from -half_count * step to half_count * step.
/// A burr's middle is at t = 0 and its edges are at those ends.
struct SectionLeans {
  static constexpr int kGauss = 4, kRows = kGauss + 1;
  int half_count = 0, stride = 0;
  float step = 1;
  /// Sines and cosines of leans: kGauss rows for the Gauss-Legendre nodes of each step, and one for the steps' ends.
  /// Rows are `stride` apart, a whole number of SIMD vectors, and finite throughout.
  struct Part {
    CurveFloats sine, cosine;
  };
  std::array<Part, kSectionParts> part;
};

/// Evenly spaced nodes of curves over a section's parts, from t = -half_count * step to half_count * step. Leans differ
/// by at most `lean_step` between nodes, and one node is at the start of the flanks.
struct SectionNodes {
  int half_count = 0;
  double step = 1;
};
/// For grooves up to |t| = rim at width `width_um`.
SectionNodes section_nodes(const GrooveProfile& profile, double width_um, double rim, double lean_step);
/// The wall's lean at node k, counted from the middle; k may be fractional.
double lean_at_node(const GrooveProfile& profile, double width_um, SectionPart part, const SectionNodes& nodes,
                    double k);
/// True if a section has this part.
bool has_part(const GrooveProfile& profile, SectionPart part);

/// For grooves as in section_nodes(). `alpha` is a lower bound of the roughness.
SectionLeans section_leans(const GrooveProfile& profile, double width_um, double rim, double alpha);

/// A tile's view of one point of the lamp: quadratic polynomials in (column, row) from the tile's middle, in half
/// tiles: 1, c, r, c^2, c r, r^2.
struct LampFit {
  float h_x[6], h_y[6];        ///< half vector, in the frame of the face
  float strength[6];           ///< factor of D G: the mean of the channels
  float tan2_i[6], tan2_o[6];  ///< as in TileShading
};

/// Fits per tile and point of the lamp (lamp_points()): fits.of(tile)[point].
struct LampFits {
  int points = 0;
  double error = 0;  ///< largest error of the fitted half vectors; large on faces with edges
  std::vector<LampFit> fits;

  const LampFit* of(std::size_t tile) const { return fits.data() + tile * points; }
};
LampFits lamp_fits(const ViewScene& scene, const TiledGrid& grid);

/// All inputs of a kernel.
struct LampCurves {
  SectionLeans leans;
  LampFits fits;
  float across = 1;  ///< GrooveProfile::across
};

}  // namespace burin

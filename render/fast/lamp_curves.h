// burin/render/fast/lamp_curves.h - what the fast path needs to find the light of grooves of any cross-section under a
// lamp as curves across them (burin/render/fast/curve_tables.h), where curves are made anew at a few places along each
// groove: the section's leans, and how each tile's places see the lamp. docs/model.md 8.6.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "burin/render/fast/curve_tables.h"
#include "burin/render/fast/groove_strips.h"
#include "burin/render/fast/tiled_grid.h"
#include "burin/render/view_scene.h"

namespace burin {

/// How the walls of a section's parts lean at the places that curves are made of. t reaches from -half_count * step to
/// half_count * step; a burr's middle is at t = 0 and its edges are at those ends.
struct SectionLeans {
  static constexpr int kGauss = 4, kRows = kGauss + 1;
  int half_count = 0, stride = 0;
  float step = 1;
  /// Sines and cosines of leans: kGauss rows with the places of Gauss and Legendre's rule of each step, and one with
  /// the steps' ends. Rows are `stride` apart, a whole number of packets, and hold numbers throughout.
  struct Part {
    CurveFloats sine, cosine;
  };
  std::array<Part, kSectionParts> part;
};

/// Evenly spread nodes of curves over a section's parts, from t = -half_count * step to half_count * step, between
/// which walls lean by `lean_step` at most; one is where flanks begin.
struct SectionNodes {
  int half_count = 0;
  double step = 1;
};
/// For grooves that reach up to |t| = rim where they are `width_um` wide.
SectionNodes section_nodes(const GrooveProfile& profile, double width_um, double rim, double lean_step);
/// The wall's lean at a node k from the middle, which may lie between two.
double lean_at_node(const GrooveProfile& profile, double width_um, SectionPart part, const SectionNodes& nodes,
                    double k);
/// Whether a section has that part.
bool has_part(const GrooveProfile& profile, SectionPart part);

/// For grooves as in section_nodes(), and a roughness that is nowhere less.
SectionLeans section_leans(const GrooveProfile& profile, double width_um, double rim, double alpha);

/// How a tile's places see one point of the lamp: polynomials of the second degree in (column, row) from the tile's
/// middle, in half tiles: 1, c, r, c^2, c r, r^2.
struct LampFit {
  float h_x[6], h_y[6];        ///< half vector, in the frame of the face
  float strength[6];           ///< what D G is to be multiplied with: the mean of the channels
  float tan2_i[6], tan2_o[6];  ///< as in TileShading
};

/// Of each tile, for each of the lamp's points (lamp_points()): fits.of(tile)[point].
struct LampFits {
  int points = 0;
  double error =
      0;  ///< by how much half vectors differ from what was fitted to them, at most: large on faces with edges
  std::vector<LampFit> fits;

  const LampFit* of(std::size_t tile) const { return fits.data() + tile * points; }
};
LampFits lamp_fits(const ViewScene& scene, const TiledGrid& grid);

/// All of it, as a kernel reads it.
struct LampCurves {
  SectionLeans leans;
  LampFits fits;
  float across = 1;  ///< GrooveProfile::across
};

}  // namespace burin

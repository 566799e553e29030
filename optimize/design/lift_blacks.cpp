#include "burin/optimize/design/lift_blacks.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "burin/base/files/decimals.h"

namespace burin {

double black_for(double contrast) {
  constexpr double kBlackEnough = 0.22;  // its light is 1/28 of white's
  constexpr double kShare = 0.8;         // docs/results/light.md: more costs PSNR, less helps less
  constexpr double kLeast = 0.03;        // a smaller lift is negligible
  const double black = kShare * (std::pow(std::max(1.0, contrast), -1 / 2.2) - kBlackEnough);
  return black < kLeast ? 0 : black;
}

std::vector<Finding> lift_blacks(std::vector<WorkView>& views, double share, const LossWeights& weights) {
  std::vector<Finding> out;
  std::vector<double> blacks;  // of the spec's views: off-axis viewpoints come later and have the same picture
  for (WorkView& v : views) {
    if (blacks.size() <= v.of) blacks.resize(v.of + 1, 0.0);
    double& black = blacks[v.of];
    if (!v.aside) black = v.channels == 1 && v.contrast > 0 ? share * black_for(v.contrast) : 0;
    if (!(black > 0)) continue;
    v.wanted = v.target.picture;
    for (float& tone : v.target.picture.data) tone = static_cast<float>(black + (1 - black) * tone);
    v.loss = PictureLoss(with_gamma_offset(v.target.picture), v.target.mask, times(v.spec.weight * v.share, weights));
    if (v.aside) continue;
    out.push_back({FindingCode::blacks_lifted, Finding::Severity::note, "design",
                   "view " + v.spec.view + ": nothing is dark under its light, so the picture's black was taken for " +
                       fixed(100 * black, 0) + " % of white's tone, and the tones above it to scale",
                   "set --lift-blacks 0 for black"});
  }
  return out;
}

}  // namespace burin

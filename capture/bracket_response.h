// burin/capture/bracket_response.h - a camera's curve, white balance and shutter from its brackets: the same place, lit
// alike, exposed several times. docs/model.md 9.22. After Debevec and Malik (SIGGRAPH 1997) and Mitsunaga and Nayar
// (CVPR 1999), with few numbers for the curve.
//
// Blocks of pixels that are flat in two exposures of a bracket say, for each color c,
//
//   L(s_longer) - L(s_shorter) = log(ratio of the exposures) + e_longer + w_longer,c - e_shorter - w_shorter,c,
//
// L being the logarithm of the linear value of a stored one (Response and the file's encoding), e how much a photo was
// exposed otherwise than its EXIF says, w its own white balance (of R and B; G is what others are balanced to), both
// with a prior about 0. A response counts only where it predicts brackets that it was not fitted to better than none
// does.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "burin/base/finding.h"
#include "burin/capture/session.h"
#include "burin/scene/response.h"

namespace burin {

/// What brackets tell of a camera.
struct BracketResponse {
  Response response;        ///< none where the brackets do not ask for one
  double change = 0;        ///< by which it moves ratios of light, standard deviation over stored levels 0.1 to 0.9
  double change_sigma = 0;  ///< of that
  double error_before = 0, error_after = 0;  ///< of the logarithm of a ratio of light: what brackets disagree by
  /// Factors on R, G, B for each of the session's photos, about 1 within each bracket. Empty: none can be told from 1.
  std::vector<Eigen::Vector3d> balance;
  std::size_t brackets = 0;       ///< that were compared; 0: no view has two exposures
  std::vector<Finding> findings;  ///< brackets that contradict their EXIF or the others
};

/// Looks at a few brackets first, and at all where those show something. `session`'s photos are read with the response
/// and balance that they have; `fit_curve` false asks for balance alone, under the response that the first one has. A
/// curve that would not be monotonic is not returned but named.
BracketResponse bracket_response(const Session& session, bool fit_curve = true);

}  // namespace burin

// burin/capture/bracket_response.h - camera response function, white balance and shutter errors from exposure brackets.
// docs/model.md 9.22. After Debevec and Malik (SIGGRAPH 1997) and Mitsunaga and Nayar (CVPR 1999), with few parameters
// for the curve.
//
// Each block of pixels gives one equation per color c if it is flat in two exposures of a bracket:
//
//   L(s_longer) - L(s_shorter) = log(ratio of the exposures) + e_longer + w_longer,c - e_shorter - w_shorter,c,
//
// L is the logarithm of the linear value of a stored one (Response and the file's encoding). e is the error of a
// photo's exposure against its EXIF. w is its white balance of R and B against G. Both have a prior about 0. A response
// is kept only if it predicts held-out brackets better than no response does.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "burin/base/finding.h"
#include "burin/capture/session.h"
#include "burin/scene/response.h"

namespace burin {

/// Camera response and white balances from brackets.
struct BracketResponse {
  Response response;        ///< none if the brackets do not ask for one
  double change = 0;        ///< standard deviation of its changes to ratios of light, over stored levels 0.1 to 0.9
  double change_sigma = 0;  ///< standard error of `change`
  double error_before = 0, error_after = 0;  ///< error of the logarithm of a ratio of light, without and with the fit
  /// Factors on R, G, B for each of the session's photos, about 1 within each bracket. Empty: all are consistent with
  /// 1.
  std::vector<Eigen::Vector3d> balance;
  std::size_t brackets = 0;       ///< number of compared brackets; 0: no view has two exposures
  std::vector<Finding> findings;  ///< brackets in contradiction to their EXIF or the others
};

/// Estimates response and balance from a few brackets first, and from all if these show an effect. Reads photos with
/// the response and balance in `session`. `fit_curve` false fits the balance only, under the first photo's response. A
/// non-monotonic curve becomes a finding and is not returned.
BracketResponse bracket_response(const Session& session, bool fit_curve = true);

}  // namespace burin

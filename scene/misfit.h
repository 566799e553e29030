// burin/scene/misfit.h - contradictions between photos and model, as facts. The tests of refine
// (burin/calib/verdict/model_tests.h) find them, and reports draw them. docs/calibration.md, 'Where the model is not
// enough'.
#pragma once

#include <string>
#include <vector>

namespace burin {

/// One test of residuals, grouped into classes of pixels by one quantity.
struct Misfit {
  /// Mean of one class: photos minus model, relative to the model. The standard error treats neighboring pixels as
  /// correlated.
  struct Class {
    std::string name;
    double residual = 0, sigma = 0;
  };
  std::string test;   ///< "along", "across", "azimuth", "highlight", "brightness", "frame"; or "photo NAME"
  double sigmas = 0;  ///< between the classes' answers; of a photo: ratio of its residuals to the others'. See docs
  double alpha_percent = 0;  ///< possible error of alpha, like depth and base_alpha: half of the difference
  double depth_percent = 0;
  double base_alpha_percent = 0;
  std::vector<Class> classes;
};

/// True for a test of one photo against the others instead of pixels in classes: `sigmas` is then a ratio.
bool is_of_photo(const Misfit& misfit);
/// The test in words: "how far a half vector leans along the grooves".
std::string quantity_in_words(const Misfit& misfit);
/// The usual cause of such a misfit, and its remedy.
std::string remedy_in_words(const Misfit& misfit);

}  // namespace burin

// burin/scene/misfit.h - where photos and model contradict each other, as facts: what refine's tests found
// (burin/calib/verdict/model_tests.h) and reports draw. docs/calibration.md, 'Where the model is not enough'.
#pragma once

#include <string>
#include <vector>

namespace burin {

/// One test of residuals: pixels in classes by one quantity, and what is left of them.
struct Misfit {
  /// Of one class: the mean of what the photos show less what the model says, relative to what it says, and its
  /// standard error with neighbors taken for alike.
  struct Class {
    std::string name;
    double residual = 0, sigma = 0;
  };
  std::string test;          ///< "along", "across", "azimuth", "highlight", "brightness", "frame"; or "photo NAME"
  double sigmas = 0;         ///< between the classes' answers; of a photo: its residuals over the others'. See docs
  double alpha_percent = 0;  ///< by how much alpha, depth and base_alpha may be off: half of what is between
  double depth_percent = 0;
  double base_alpha_percent = 0;
  std::vector<Class> classes;
};

/// Whether the test is of one photo against the others, not of pixels in classes: `sigmas` is then a ratio.
bool is_of_photo(const Misfit& misfit);
/// The test in words: "how far a half vector leans along the grooves".
std::string quantity_in_words(const Misfit& misfit);
/// What usually makes such a misfit, and what helps.
std::string remedy_in_words(const Misfit& misfit);

}  // namespace burin

// tools/drawing/pdf.h - drawings as pages of a PDF, or as images, by cairo. The same drawings give the same bytes: the
// file has no date.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>

#include "burin/base/image.h"
#include "tools/drawing/drawing.h"

namespace burin {

/// Common properties of all pages.
struct PdfPaper {
  Eigen::Vector2d size_mm{210, 297};
  /// mm of paper per mm of the drawing, across and upright; a page's size times this is the paper's.
  Eigen::Vector2d stretch{1, 1};
  std::string title;  ///< in the file's properties
  /// Requests the true size from the printing program, so that fitting to the page is not its default.
  bool true_size = false;
};

/// Returns the file's bytes. Throws Error if cairo fails.
std::string pdf(std::span<const Drawing> pages, const PdfPaper& paper);

/// Renders a drawing as a gray image on black, encoded as in a file. Throws Error if cairo fails.
Image drawn(const Drawing& drawing, double px_per_mm);

}  // namespace burin

// tools/drawing/pdf.h - drawings as pages of a PDF, or as pictures, by cairo. Same drawings, same bytes: no date of the
// clock in it.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>

#include "burin/base/image.h"
#include "tools/drawing/drawing.h"

namespace burin {

/// What all pages share.
struct PdfPaper {
  Eigen::Vector2d size_mm{210, 297};
  /// A drawing's mm become so many mm of paper, across and upright; its size times this is the paper's.
  Eigen::Vector2d stretch{1, 1};
  std::string title;  ///< in the file's properties
  /// Asks the program that prints it for its true size: fitting it to the page is then not what it offers first.
  bool true_size = false;
};

/// The file's bytes. Throws Error where cairo cannot make it.
std::string pdf(std::span<const Drawing> pages, const PdfPaper& paper);

/// A drawing as a gray picture, encoded as in a file, on black. Throws as above.
Image drawn(const Drawing& drawing, double px_per_mm);

}  // namespace burin

// tools/report/pictures.h - pictures in a page: alone, in rows, and several of one place with a common wipe and zoom
// (tools/report/page.js). Without a script and on paper, they are side by side.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "burin/base/image.h"

namespace burin {

/// JPEG for photographs, PNG for exact values.
enum class PictureKind { jpeg, png };

/// Returns a data: address of a picture with encoded values 0..1 and 1 or 3 channels.
std::string data_address(const Image& shown, PictureKind kind);

/// A picture with alternative text and caption.
struct Figure {
  Image shown;          ///< as for data_address()
  std::string alt;      ///< text: content, view and quality of the picture
  std::string caption;  ///< HTML
  std::string name{};   ///< text: its name among pictures of the same place: "Target"
  PictureKind kind = PictureKind::jpeg;
  std::string overlay{};  ///< SVG elements over it, in the picture's pixels
};

/// Throws Error for a picture that cannot be encoded, and std::logic_error for a missing alt text.
std::string figure(const Figure& figure);

enum class FigureSize { small, large, single };

/// Returns a row of figures, wrapped on a narrow page.
std::string figure_row(std::span<const Figure> figures, FigureSize size = FigureSize::small);

/// Compares pictures of one place. `title` is text; `left` and `right` are the indices with which the wipe starts.
std::string compared(const std::string& title, std::span<const Figure> figures, std::size_t left, std::size_t right);

/// Joins several compared() of the same place of the board, named `place`: they zoom together.
std::string compared_in_lockstep(const std::string& place, const std::string& compared_html);

/// Reads a picture and reduces it to at most `longer_side_px` on its longer side. Throws Error.
Image picture_within(const std::filesystem::path& file, int longer_side_px);

}  // namespace burin

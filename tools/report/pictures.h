// tools/report/pictures.h - pictures inside a page: alone, in rows, and several of one place to be wiped and zoomed
// together (tools/report/page.js; without a script and on paper they stand side by side).
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "burin/base/image.h"

namespace burin {

/// JPEG for photographs, PNG for what must keep every value.
enum class PictureKind { jpeg, png };

/// A picture, values 0..1 as they are shown (already encoded), 1 or 3 channels, as a data: address.
std::string data_address(const Image& shown, PictureKind kind);

/// A picture with what it says to who cannot see it, and to who can.
struct Figure {
  Image shown;          ///< as data_address() takes it
  std::string alt;      ///< text: what it shows, of which view, how good
  std::string caption;  ///< HTML
  std::string name{};   ///< text: what it is called beside others of its place: "Target"
  PictureKind kind = PictureKind::jpeg;
  std::string overlay{};  ///< SVG elements in the picture's pixels, drawn over it
};

/// Throws Error if the picture cannot be encoded, std::logic_error for one without an alt text.
std::string figure(const Figure& figure);

enum class FigureSize { small, large, single };

/// Side by side, wrapping where the page is narrow.
std::string figure_row(std::span<const Figure> figures, FigureSize size = FigureSize::small);

/// Pictures of one place that are compared: `title` is text; `left` and `right` index those that the wipe begins with.
std::string compared(const std::string& title, std::span<const Figure> figures, std::size_t left, std::size_t right);

/// Several compared() that show the same place of the board, named `place`: zooming into one zooms into all.
std::string compared_in_lockstep(const std::string& place, const std::string& compared_html);

/// A picture's file, made smaller to that many pixels on its longer side where it is larger. Throws Error.
Image picture_within(const std::filesystem::path& file, int longer_side_px);

}  // namespace burin

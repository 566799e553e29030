// tools/view/view_page.h - the viewer's page: one file with everything in it, that needs no network and asks for
// nothing.
#pragma once

#include <string>

#include "burin/base/progress.h"
#include "tools/view/board_view.h"

namespace burin {

/// The page's text. Each picture is rendered once for browsers without WebGL2, and for its exposure.
std::string view_page(const BoardView& view, const Progress& progress);

/// Whether the page bends pictures as this lens does: OpenCV's models up to twelve numbers. Other lenses are shown as
/// pinholes.
bool is_lens_drawn(const Lens& lens);

}  // namespace burin

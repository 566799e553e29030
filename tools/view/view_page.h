// tools/view/view_page.h - the viewer's page: one self-contained file without network access.
#pragma once

#include <string>

#include "burin/base/progress.h"
#include "tools/view/board_view.h"

namespace burin {

/// Returns the page's text. Each picture is rendered once, for its exposure and for browsers without WebGL2.
std::string view_page(const BoardView& view, const Progress& progress);

/// Returns true if the page draws this lens's distortion: OpenCV's models with up to twelve parameters. Other lenses
/// appear as pinholes.
bool is_lens_drawn(const Lens& lens);

}  // namespace burin

// tools/automatic_exposure.h - how bright a rendered picture is shown where nobody said.
#pragma once

#include <optional>

#include "burin/base/image.h"

namespace burin {

/// The exposure, times `radiance`, that puts all but the brightest half per cent of the lit values below white; nothing
/// for a black picture.
std::optional<double> automatic_exposure(const Image& radiance);

}  // namespace burin

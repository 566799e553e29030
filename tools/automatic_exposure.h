// tools/automatic_exposure.h - automatic exposure of rendered pictures.
#pragma once

#include <optional>

#include "burin/base/image.h"

namespace burin {

/// Returns the factor on `radiance` at which the brightest half per cent of the lit values clips. Returns nothing for a
/// black picture.
std::optional<double> automatic_exposure(const Image& radiance);

}  // namespace burin

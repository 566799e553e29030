// burin/optimize/design/design_memory.h - whether there is memory for a design of the asked size: said before hours of
// work, not after them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace burin {

/// About how many bytes a design takes, pictures of all views together having so many pixels. Measured: docs/speed.md.
double design_bytes(double pixels, double scratches);

/// Bytes that this process may still take: what the system, its control group and its own limit (ulimit -v) leave.
/// Nothing where the system does not say.
std::optional<double> free_bytes();

/// Throws Error where the design needs more than `free`: what it needs, and which size fits. `longer_px`: along the
/// pictures' longer side.
void require_memory(double pixels, int longer_px, double scratches, std::optional<double> free);

}  // namespace burin

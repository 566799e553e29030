// burin/optimize/design/design_memory.h - memory of a design, checked before hours of work.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace burin {

/// Approximate memory of a design in bytes; `pixels` counts the pictures of all views. Measured: docs/speed.md.
double design_bytes(double pixels, double scratches);

/// Bytes available to this process, by the limits of the system, its control group and the process (ulimit -v). Nothing
/// if the system does not report them.
std::optional<double> free_bytes();

/// Throws Error, with the needed memory and a suitable size, if the design needs more than `free`. `longer_px`: along
/// the pictures' longer side.
void require_memory(double pixels, int longer_px, double scratches, std::optional<double> free);

}  // namespace burin

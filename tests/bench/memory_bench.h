#pragma once

namespace burin {

/// What PeakMemory asks a process of its own for: prints GB resident with the views' scenes alone, GB at the peak,
/// pairs of all views, and 1, or 0 where memory ran out before the end. Returns the exit code.
int print_peak_memory();

}  // namespace burin

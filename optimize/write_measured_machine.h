// burin/optimize/write_measured_machine.h - a machine's file with what a coupon told of it (machine_measured.h).
// docs/file-formats.md, "A carving machine".
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "burin/optimize/machine_measured.h"

namespace burin {

/// Writes `machine` (a built-in name or a file) with what was measured, and the depth table that follows, to `out`, a
/// JSON file; atomically, and read again before it counts. Where `out` is the machine's own file, what it was is kept
/// beside it, and that file's path returned. Throws Error for an `out` that is something else's, or no .json.
std::optional<std::filesystem::path> write_measured_machine(const std::string& machine, const MachineMeasured& measured,
                                                            const std::filesystem::path& out);

}  // namespace burin

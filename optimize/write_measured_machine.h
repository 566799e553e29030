// burin/optimize/write_measured_machine.h - a machine's file with a coupon's measurement (machine_measured.h).
// docs/file-formats.md, "A carving machine".
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "burin/optimize/machine_measured.h"

namespace burin {

/// Writes `machine` (a built-in name or a file) with the measurement and the resulting depth table to the JSON file
/// `out`. The write is atomic, and the file is read again before it gets its name. If `out` is the machine's own file,
/// a copy of its former content stays next to it, and the function returns the copy's path. Throws Error for an
/// existing `out` of another machine, and for a name without .json.
std::optional<std::filesystem::path> write_measured_machine(const std::string& machine, const MachineMeasured& measured,
                                                            const std::filesystem::path& out);

}  // namespace burin

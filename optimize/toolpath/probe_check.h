// burin/optimize/toolpath/probe_check.h - reads a probing file as the machine would before anyone runs it.
// Frame: the machine's (burin/optimize/machine_profile.h), mm.
#pragma once

#include <string>
#include <string_view>

#include "burin/optimize/machine_profile.h"
#include "burin/optimize/toolpath/probe.h"

namespace burin {

/// Throws Error naming `name` and the line unless the file does what the plan says and nothing else: millimeters and
/// absolute coordinates are set before any move, the probe travels along the board only lifted clear of tags and only
/// where the machine can go, it goes down by probing moves (G38.2) alone and up after each, Z zero is set only on the
/// face at the first point, every point of the plan is touched once in its order, and the file ends lifted.
void fail_unless_probes(std::string_view gcode, const ProbePlan& plan, const MachineProfile& machine,
                        const std::string& name);

}  // namespace burin

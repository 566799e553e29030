// burin/optimize/toolpath/probe_check.h - replay of a probing file before a machine runs it. Frame: the machine's
// (burin/optimize/machine_profile.h), mm.
#pragma once

#include <string>
#include <string_view>

#include "burin/optimize/machine_profile.h"
#include "burin/optimize/toolpath/probe.h"

namespace burin {

/// Throws Error naming `name` and the line unless the file follows the plan exactly. Millimeters and absolute
/// coordinates must be set before any move. The probe must travel along the board only lifted, clear of tags and within
/// the machine's reach. It must go down by probing moves (G38.2) alone, and up after each. Z zero must be set only on
/// the face at the first point. Every point of the plan must be touched once in its order, and the file must end
/// lifted.
void fail_unless_probes(std::string_view gcode, const ProbePlan& plan, const MachineProfile& machine,
                        const std::string& name);

}  // namespace burin

// burin/optimize/machine_measured_json.h - MachineMeasured as JSON. Include it in .cpp files only.
#pragma once

#include "burin/base/files/json_file.h"
#include "burin/optimize/machine_measured.h"

namespace burin {

/// Throws Error naming file and field of an invalid entry.
MachineMeasured read_measured(JsonObject json);
Json measured_json(const MachineMeasured& measured);

}  // namespace burin

// tools/report/misfits.h - contradictions between the model and the photos of a measured bench, as a folded part of a
// report. Each test has a sentence and a picture.
#pragma once

#include <string>

#include "burin/scene/bench.h"

namespace burin {

/// Returns HTML; empty without misfits.
std::string misfits_in_pictures(const Bench& bench);

}  // namespace burin

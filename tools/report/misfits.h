// tools/report/misfits.h - where the photos that a bench was measured from contradict the model, as a folded part of a
// report: each test in words with its picture.
#pragma once

#include <string>

#include "burin/scene/bench.h"

namespace burin {

/// HTML; empty where there are no misfits.
std::string misfits_in_pictures(const Bench& bench);

}  // namespace burin

// burin/scene/files/misfit_json.h - misfits in bench.json. docs/file-formats.md. Include it in .cpp files only: it
// pulls in nlohmann-json.
#pragma once

#include <vector>

#include "burin/base/files/json_file.h"
#include "burin/scene/misfit.h"

namespace burin {

std::vector<Misfit> read_misfits(JsonObject& bench);

/// An array with one object per misfit. "words" and "remedy" are for people; the other keys are facts.
Json misfits_json(const std::vector<Misfit>& misfits);

}  // namespace burin

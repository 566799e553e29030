// tools/loop/round_design.h - what one round designs for.
#pragma once

#include <filesystem>

#include "tools/project.h"

namespace burin {

/// Writes a round's design.json: the project's pictures, for the bench as it is known before that round. Throws Error
/// where a designed view was not photographed.
void write_round_design(const Project& project, int number, const std::filesystem::path& file);

}  // namespace burin

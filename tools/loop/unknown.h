// tools/loop/unknown.h - what the photos of a round left open although the next design rests on it.
#pragma once

#include <string>
#include <vector>

#include "burin/render/verdict.h"
#include "tools/project.h"

namespace burin {

/// One parameter that is not determined.
struct UnknownParameter {
  std::string name;  ///< as in bench.json: "depth_um"
  Verdict verdict;
};

/// Of a measured round: depth and roughness of the grooves, the machine's map, and the places of the lamps. Throws
/// Error where its bench.json cannot be read.
std::vector<UnknownParameter> unknown_after(const Project& project, int round);

/// What is not known, why, and which photo would tell: one parameter a line, each with a line for the photo.
std::string in_words(const std::vector<UnknownParameter>& unknown);

}  // namespace burin

// tools/version.h - the program's version, from the git commit that it was built from (cmake/git_version.cmake).
#pragma once

#include <string>

namespace burin {

/// "0.2.0" for a release; "0.2.0-dev.0+g1a2b3c4d" between releases.
std::string version();

}  // namespace burin

// burin/capture/finding.h - something about the photos that a person should know before hours of work rest on them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace burin {

/// Errors stop, warnings do not, notes say what was assumed.
struct Finding {
  enum class Severity { note, warning, error };
  Severity severity = Severity::warning;
  std::filesystem::path file;  ///< the photo; empty if it concerns the session
  std::string what, remedy;    ///< half sentences without a full stop
};

/// "photos/IMG_1.JPG: what; remedy"
std::string sentence(const Finding& finding);

bool has_errors(const std::vector<Finding>& findings);

}  // namespace burin

// burin/base/finding.h - something that a person should know: the one form in which all rooms tell it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace burin {

/// Errors stop, warnings do not, notes say what was assumed.
struct Finding {
  /// How bad it is.
  enum class Severity { note, warning, error };
  Severity severity = Severity::warning;
  std::filesystem::path file;  ///< the photo, or another file; empty if it concerns the whole
  std::string what, remedy;    ///< half sentences without a full stop
};

/// A warning about the whole of what is worked on.
Finding make_warning(std::string what, std::string remedy = "");

/// "photos/IMG_1.JPG: what; remedy"
std::string sentence(const Finding& finding);

bool has_errors(const std::vector<Finding>& findings);

/// Appends `more` to `findings`.
void append(std::vector<Finding>& findings, const std::vector<Finding>& more);

}  // namespace burin

// burin/base/finding.h - a diagnostic for people; all libraries return diagnostics in this form.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace burin {

/// Errors stop the work, warnings do not, notes report assumptions.
struct Finding {
  /// Severity of a diagnostic.
  enum class Severity { note, warning, error };
  Severity severity = Severity::warning;
  std::filesystem::path file;  ///< the photo, or another file; empty for the whole work
  std::string what, remedy;    ///< clauses without a full stop
};

/// A warning about the whole work.
Finding make_warning(std::string what, std::string remedy = "");

/// "photos/IMG_1.JPG: what; remedy"
std::string sentence(const Finding& finding);

bool has_errors(const std::vector<Finding>& findings);

/// Appends `more` to `findings`.
void append(std::vector<Finding>& findings, const std::vector<Finding>& more);

}  // namespace burin

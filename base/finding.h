// burin/base/finding.h - a diagnostic for people; all libraries return diagnostics in this form.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace burin {

/// Note: nothing to do. Warning: the result may be worse. Error: the work stopped, or its result must not be carved.
struct Finding {
  /// Severity of a diagnostic.
  enum class Severity { note, warning, error };
  Severity severity = Severity::warning;
  std::filesystem::path file;  ///< the photo, or another file; empty for the whole work
  std::string what, remedy;    ///< clauses without a full stop
};

/// "note", "warning" or "error", as people and programs read it.
const char* in_words(Finding::Severity severity);

/// A warning about the whole work.
Finding make_warning(std::string what, std::string remedy = "");

/// "photos/IMG_1.JPG: what; remedy"
std::string sentence(const Finding& finding);

bool has_errors(const std::vector<Finding>& findings);

/// Appends `more` to `findings`.
void append(std::vector<Finding>& findings, const std::vector<Finding>& more);

}  // namespace burin

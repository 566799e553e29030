#include "burin/capture/finding.h"

#include <algorithm>

namespace burin {

std::string sentence(const Finding& finding) {
  return (finding.file.empty() ? "" : finding.file.string() + ": ") + finding.what +
         (finding.remedy.empty() ? "" : "; " + finding.remedy);
}

bool has_errors(const std::vector<Finding>& findings) {
  return std::any_of(findings.begin(), findings.end(),
                     [](const Finding& f) { return f.severity == Finding::Severity::error; });
}

}  // namespace burin

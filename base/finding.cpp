#include "burin/base/finding.h"

#include <algorithm>
#include <utility>

#include "burin/base/files/printable.h"

namespace burin {

const char* in_words(Finding::Severity severity) {
  switch (severity) {
    case Finding::Severity::note:
      return "note";
    case Finding::Severity::warning:
      return "warning";
    case Finding::Severity::error:
      break;
  }
  return "error";
}

Finding make_warning(std::string what, std::string remedy) {
  return {Finding::Severity::warning, {}, std::move(what), std::move(remedy)};
}

std::string sentence(const Finding& finding) {
  return printable((finding.file.empty() ? "" : finding.file.string() + ": ") + finding.what +
                   (finding.remedy.empty() ? "" : "; " + finding.remedy));
}

bool has_errors(const std::vector<Finding>& findings) {
  return std::any_of(findings.begin(), findings.end(),
                     [](const Finding& f) { return f.severity == Finding::Severity::error; });
}

void append(std::vector<Finding>& findings, const std::vector<Finding>& more) {
  findings.insert(findings.end(), more.begin(), more.end());
}

}  // namespace burin

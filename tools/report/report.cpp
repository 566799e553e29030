#include <fmt/core.h>

#include <string>
#include <utility>

#include "burin/render/error.h"
#include "burin/render/files/json_file.h"
#include "tools/report/html.h"
#include "tools/report/section.h"

namespace burin {
namespace {

// For the terminal: without tags, and with the entities that html() makes turned back.
std::string plain(const std::string& text) {
  std::string out;
  bool in_tag = false;
  for (const char c : text) {
    if (c == '<') in_tag = true;
    if (!in_tag) out += c;
    if (c == '>') in_tag = false;
  }
  for (const auto& [from, to] : {std::pair{"&lt;", "<"}, {"&gt;", ">"}, {"&quot;", "\""}, {"&amp;", "&"}})
    for (std::size_t at = 0; (at = out.find(from, at)) != std::string::npos;) {
      out.replace(at, std::string(from).size(), to);
      ++at;
    }
  return out;
}

}  // namespace

std::string write_report(const std::filesystem::path& folder, const std::filesystem::path& session,
                         const std::optional<Section>& first, const Progress& progress) {
  if (!std::filesystem::is_directory(folder))
    fail(folder.string(), "there is no such folder",
         "name the folder of a calibrated session, a design or a loop project");
  std::string outcome, body;
  for (const auto& section :
       {first, project_section(folder, progress), session_section(folder, session, progress), design_section(folder)}) {
    if (!section) continue;
    outcome += (outcome.empty() ? "" : " ") + section->outcome;
    body += section->body;
  }
  if (body.empty())
    fail(folder.string(), "it holds nothing to report: no bench.json with its session.json, no design, no round-01",
         "run burin calibrate, burin design or burin loop first, or name the session with --session");
  const auto absolute = std::filesystem::absolute(folder).lexically_normal();
  const std::string name =
      absolute.has_filename() ? absolute.filename().string() : absolute.parent_path().filename().string();
  write_text(page("Burin: " + name, outcome, body), folder / "report.html");
  return plain(outcome);
}

}  // namespace burin

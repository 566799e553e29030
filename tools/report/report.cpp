#include <string>
#include <vector>

#include "burin/render/error.h"
#include "burin/render/files/json_file.h"
#include "tools/report/html.h"
#include "tools/report/section.h"

namespace burin {
std::string write_report(const std::filesystem::path& folder, const std::filesystem::path& session,
                         const std::optional<Section>& first, const Progress& progress) {
  if (!std::filesystem::is_directory(folder))
    fail(folder.string(), "there is no such folder",
         "name the folder of a calibrated session, a design or a loop project");
  std::string outcome, body;
  std::vector<std::string> points;
  for (const auto& section :
       {first, project_section(folder, progress), session_section(folder, session, progress), design_section(folder)}) {
    if (!section) continue;
    outcome += (outcome.empty() ? "" : " ") + section->outcome;
    points.insert(points.end(), section->points.begin(), section->points.end());
    body += section->body;
  }
  if (body.empty())
    fail(folder.string(), "it holds nothing to report: no bench.json with its session.json, no design, no round-01",
         "run burin calibrate, burin design or burin loop first, or name the session with --session");
  const auto absolute = std::filesystem::absolute(folder).lexically_normal();
  const std::string name =
      absolute.has_filename() ? absolute.filename().string() : absolute.parent_path().filename().string();
  write_text(page("Burin: " + name, outcome, points, body), folder / "report.html");
  std::string told = plain_text(outcome);
  for (const std::string& point : points) told += "\n- " + plain_text(point);
  return told;
}

}  // namespace burin

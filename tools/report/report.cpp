#include <algorithm>
#include <string>
#include <vector>

#include "burin/base/error.h"
#include "burin/base/files/files_together.h"
#include "burin/base/files/json_file.h"
#include "tools/report/html.h"
#include "tools/report/section.h"
#include "tools/view/bench_scene.h"

namespace burin {

std::string whole_section(const Section& section) { return section.pictures + section.open + folds(section.parts); }

std::filesystem::path folder_on_page(const std::filesystem::path& folder) {
  return folder.lexically_normal() == "." ? std::filesystem::current_path() : folder;
}

WrittenReport write_report(const std::filesystem::path& folder, const std::filesystem::path& session,
                           const std::optional<Section>& first, const Progress& progress) {
  if (!std::filesystem::is_directory(folder))
    fail(folder.string(), "there is no such folder",
         "name the folder of a calibrated session, a design or a loop project");
  const auto absolute = std::filesystem::absolute(folder).lexically_normal();
  Page all{"Burin · " + (absolute.has_filename() ? absolute : absolute.parent_path()).filename().string(), ""};
  bool any = false, scene = false;
  std::string parts, rounds;
  for (const auto& section :
       {first, project_section(folder, progress), session_section(folder, session, progress), design_section(folder)}) {
    if (!section) continue;
    append(all.findings, section->findings);
    scene = scene || section->has_scene;
    if (!section->rounds.empty()) rounds = section->rounds;
    if (any) {
      parts += folded(html(section->title), section->outcome, whole_section(*section));
      continue;
    }
    any = true;
    all.outcome = section->outcome;
    all.next = section->next;
    all.pictures = (section->heading.empty() ? "" : "<h2>" + html(section->heading) + "</h2>\n") + section->pictures;
    all.body = section->open;
    parts = section->parts;
  }
  if (!any)
    fail(folder.string(), "it holds nothing to report: no bench.json with its session.json, no design, no round-01",
         "run burin calibrate, burin design or burin loop first, or name the session with --session");
  all.body += folds(parts);
  if (scene) {
    all.scripts.push_back(bench_scene_script());
    all.styles.push_back(bench_scene_style());
  }
  WrittenReport out{plain_text(all.outcome), folder / "report.html"};
  // A screen has room for the most severe ones.
  constexpr std::size_t kMostTold = 8;
  std::vector<Finding> told = all.findings;
  std::stable_sort(told.begin(), told.end(),
                   [](const Finding& a, const Finding& b) { return a.severity > b.severity; });
  for (std::size_t i = 0; i < std::min(told.size(), kMostTold); ++i)
    out.told += std::string("\n") + in_words(told[i].severity) + ": " + sentence(told[i]);
  if (told.size() > kMostTold) out.told += "\n" + std::to_string(told.size() - kMostTold) + " more on the page";
  const std::string text = page(all);
  FilesTogether both;
  write_text(text, out.page);
  if (!rounds.empty()) write_text(rounds, folder / "rounds.json");
  both.put();
  out.bytes = text.size();
  return out;
}

}  // namespace burin

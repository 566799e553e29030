// burin view - writes a page with the board in three dimensions, for inspection before carving.
#include <CLI/App.hpp>
#include <CLI/Error.hpp>
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/base/files/json_file.h"
#include "burin/scene/carve.h"
#include "tools/commands.h"
#include "tools/progress_bar.h"
#include "tools/project_settings.h"
#include "tools/view/view_page.h"
#include "tools/view/view_sources.h"
#include "tools/work_lock.h"

namespace burin {
namespace {

// Grooves that are cut at crossings consist of several pieces.
std::size_t grooves_of(const Carved& carved) {
  if (carved.source.empty()) return carved.size();
  return std::set<std::uint32_t>(carved.source.begin(), carved.source.end()).size();
}

namespace fs = std::filesystem;

constexpr std::size_t kMostBytes = 3'000'000;

struct ViewArguments {
  fs::path folder, out;
  ViewFiles files;
};

void require_command_line(const ViewArguments& o) {
  const bool any = !o.files.board.empty() || !o.files.bench.empty() || !o.files.scratches.empty() ||
                   !o.files.design.empty() || o.files.as_sent;
  if (!o.folder.empty() && any)
    throw CLI::ValidationError("PROJECT_DIR", "give a project, or --board and --bench of their own, not both");
  if (o.folder.empty() && (o.files.board.empty() || o.files.bench.empty()))
    throw CLI::ValidationError("PROJECT_DIR", "give a project, or --board and --bench (and --scratches, --design)");
}

Report run(ViewArguments o) {
  const bool no_files = o.files.board.empty() && o.files.bench.empty() && o.files.scratches.empty();
  if (!o.folder.empty() || (no_files && project_of(".").has_value()))
    o.folder = project_folder(o.folder, "PROJECT_DIR");
  require_command_line(o);
  const fs::path out = !o.out.empty() ? o.out : o.folder.empty() ? fs::path("view.html") : o.folder / "view.html";
  const WorkLock lock(out.parent_path(), "burin view", WorkLock::Where::projects);
  std::vector<Finding> findings;
  ProgressBar bar;
  bar.progress()("reading", 0);
  BoardView view = o.folder.empty() ? view_of_files(o.files, findings) : view_of_project(o.folder, findings);
  for (const ViewedBoard& board : view.boards)
    if (!is_lens_drawn(board.bench.lens)) {
      findings.push_back(make_warning(FindingCode::page_shortened,
                                      "the lens is " + board.bench.lens.model +
                                          ", which the viewer shows as a pinhole: \"As a photo\" is bent otherwise"));
      break;
    }
  std::string page = view_page(view, bar.progress());
  if (page.size() > kMostBytes && view.boards.size() > 2) {
    findings.push_back(make_warning(FindingCode::page_shortened,
                                    fmt::format("with the next design the page would have {:.1f} MB; it is left out",
                                                static_cast<double>(page.size()) * 1e-6)));
    view.boards.resize(2);
    page = view_page(view, bar.progress());
  }
  write_text(page, out);
  bar.clear();
  for (const Finding& finding : findings) tell(finding);
  std::size_t most = 0;
  for (const ViewedBoard& board : view.boards) most = std::max(most, grooves_of(board.carved));
  Report report;
  report.data["grooves"] = most;
  report.data["places"] = view.boards.front().pictures.size();
  report.line(
      "Wrote {}: {}, {} to look from, {:.1f} MB, all in one file; next: open it in a browser, "
      "or send it to a phone and tilt it.\n",
      out.string(), counted(most, "groove"), counted(view.boards.front().pictures.size(), "place"),
      fact("size", static_cast<double>(page.size()) * 1e-6, "MB"));
  return report;
}

}  // namespace

void add_view_command(CLI::App& burin) {
  auto o = std::make_shared<ViewArguments>();
  CLI::App* c = burin.add_subcommand("view", "Write an interactive page of the board, with eye and lamp that move");
  c->add_option(
      "PROJECT_DIR", o->folder,
      "Show this project's newest design before and after measurement [default: the working directory's project]");
  c->add_option("--out", o->out, "Write this page [default: view.html in PROJECT_DIR]");
  c->add_option("--board", o->files.board, "Show this board (board.json), without a project");
  c->add_option("--bench", o->files.bench, "Use views and lamps of this setup (bench.json), without a project");
  c->add_option("--scratches", o->files.scratches, "Show these scratches (CSV) [default: the board's]");
  c->add_option("--design", o->files.design,
                "Show the targets of this design.json [default: all views, without targets]");
  c->add_flag("--as-carved", o->files.as_sent,
              "Treat the scratches as commanded positions (sent.csv) and apply the machine's calibration");
  c->footer(example("burin view samples/small-bench --out view.html"));
  c->callback([o] { print(run(*o)); });
}

}  // namespace burin

#include <CLI/App.hpp>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/base/files/json_file.h"
#include "burin/scene/board.h"
#include "tools/commands.h"
#include "tools/drawing/pdf.h"
#include "tools/print/print_pages.h"
#include "tools/project_settings.h"

namespace burin {
namespace {

namespace fs = std::filesystem;

struct PrintArguments {
  fs::path project, out;
  std::optional<std::string> paper;
  double across_mm = 100;
  std::optional<double> upright_mm;
  bool no_template = false, no_chessboard = false;
};

// Returns the name of the board's folder.
std::string name_of(const fs::path& board) {
  const fs::path folder = fs::absolute(board).lexically_normal().parent_path();
  return folder.filename().empty() ? "burin" : folder.filename().string();
}

std::string pages_text(std::size_t first, std::size_t count, const std::string& what) {
  return count == 1 ? fmt::format("  page {}: {}\n", first, what)
                    : fmt::format("  pages {} to {}: {}\n", first, first + count - 1, what);
}

Report run(PrintArguments options) {
  options.project = project_folder(options.project, "PROJECT");
  const fs::path file = fs::is_directory(options.project) ? options.project / "board.json" : options.project;
  const Board board = read_board(file);
  const fs::path out = options.out.empty() ? file.parent_path() / "tags.pdf" : options.out;
  if (out.extension() != ".pdf")
    fail(out.string(), "is not the name of a PDF",
         "write --out " + shell_word(fs::path(out).replace_extension(".pdf").string()));
  PrintSetup setup;
  const UsualPaper usual = usual_paper();
  setup.paper = find_paper(options.paper.value_or(usual.name));
  setup.across_mm = options.across_mm;
  setup.upright_mm = options.upright_mm.value_or(options.across_mm);
  constexpr double kName_mm = 80;  // of a page's title, which ends with the page's number
  setup.name = shortened(name_of(file), 4.2, kName_mm, true);
  require_good(setup);

  const TagPages tags = tag_pages(board, setup);
  std::vector<Drawing> pages;
  std::string told;
  for (const PrintedPage& page : tags.pages) pages.push_back(page.drawing);
  told += pages_text(1, tags.pages.size(),
                     fmt::format("{} of {}, to cut out", counted(tags.tags.size(), "tag"), board.tags.family));
  if (!options.no_template) {
    const TemplatePages places = template_pages(board, setup);
    told += pages_text(pages.size() + 1, places.pages.size(),
                       fmt::format("where each of them goes on the board of {:g} x {:g} mm, 1:1", board.size_mm.x(),
                                   board.size_mm.y()));
    for (const PrintedPage& page : places.pages) pages.push_back(page.drawing);
  }
  if (!options.no_chessboard) {
    const ChessboardPage board_page = chessboard_page(setup);
    told += pages_text(pages.size() + 1, 1,
                       fmt::format("a chessboard for a lens of your own (burin lens --chessboard {}x{} --square {:g})",
                                   board_page.columns, board_page.rows, board_page.square_mm));
    pages.push_back(board_page.page.drawing);
  }
  if (out.has_parent_path()) make_output_folder(out.parent_path());
  write_text(pdf(pages, {setup.paper.size_mm, stretch(setup), setup.name + ": tags, template, chessboard", true}), out);
  const std::string other = setup.paper.name == "letter" ? "a4" : "letter";
  told += fmt::format("  on {} paper, {:g} x {:g} mm{}\n", setup.paper.name, setup.paper.size_mm.x(),
                      setup.paper.size_mm.y(),
                      options.paper       ? ""
                      : usual.why.empty() ? fmt::format(" (else: --paper {})", other)
                                          : fmt::format(" ({}; else: --paper {})", usual.why, other));
  Report report;
  report.data = {
      {"tags", tags.tags.size()}, {"family", board.tags.family}, {"pages", pages.size()}, {"paper", setup.paper.name}};
  report.line("{}", told);
  std::string again = "burin print " + shell_word(options.project.string());
  if (!options.out.empty()) again += " --out " + shell_word(options.out.string());
  if (options.paper) again += " --paper " + *options.paper;
  if (options.no_template) again += " --no-template";
  if (options.no_chessboard) again += " --no-chessboard";
  if (is_compensated(setup))
    report.line(
        "Wrote {}, with sizes put right for a printer whose ruler measured {:g} mm: print it with the same settings; "
        "its rulers must now measure 100 mm (if they measure L: {} --ruler-measured {:g} x L{})\n",
        out.string(), setup.across_mm, again, setup.across_mm / 100,
        setup.upright_mm == setup.across_mm
            ? ""
            : fmt::format(" --upright-ruler-measured {:g} x L", setup.upright_mm / 100));
  else
    report.line(
        "Wrote {}: print it at 100 %, and measure its rulers; if 100 mm are not 100 mm: {} --ruler-measured MM\n",
        out.string(), again);
  return report;
}

}  // namespace

void add_print_command(CLI::App& burin) {
  auto options = std::make_shared<PrintArguments>();
  CLI::App* command =
      burin.add_subcommand("print", "Write a PDF of the board's tags at true scale, their placement, and a chessboard");
  command->add_option("PROJECT", options->project,
                      "Print the tags of this project folder or board.json [default: the working directory's project]");
  command->add_option("--out", options->out, "Write this PDF [default: tags.pdf next to board.json]");
  command->add_option("--paper", options->paper,
                      "Print on this paper: a4, letter, a3 or tabloid [default: the locale's (LC_PAPER)]");
  command->add_option("--ruler-measured", options->across_mm,
                      "Correct the scale by the measured length of the printed 100 mm ruler, mm [default: 100]");
  command->add_option("--upright-ruler-measured", options->upright_mm,
                      "Correct the vertical scale by the upright ruler's length, mm [default: --ruler-measured's]");
  command->add_flag("--no-template", options->no_template, "Omit the pages that show the tags' placement");
  command->add_flag("--no-chessboard", options->no_chessboard, "Omit the chessboard");
  command->footer(example("burin print my-board --out tags.pdf --paper a4"));
  command->callback([options] { print(run(*options)); });
}

}  // namespace burin

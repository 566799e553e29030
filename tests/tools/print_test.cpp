// Proves: what `burin print` prints has the sizes that board.json says, wherever it is printed. Its PDF is rendered at
// 300 dpi by another program (poppler's pdftoppm) and looked at as paper would be: our detector finds every tag on its
// page and, with the template's tiles joined as a person joins them, in its place on the board, within 0.05 mm; the
// ruler's marks are where 0 and 100 mm are; `burin lens` finds the chessboard. On a printer that errs (100 mm come out
// as 97.5) all of that holds again for a PDF made with --ruler-measured.
// Oracle: board.json's numbers, and pixels.
#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "burin/base/error.h"
#include "burin/base/image.h"
#include "burin/calib/geometry/chessboard.h"
#include "burin/capture/tags/tag_detector.h"
#include "burin/capture/tags/tag_family.h"
#include "burin/pictures/picture.h"
#include "tests/places.h"
#include "tests/tools/program.h"
#include "tools/drawing/pdf.h"
#include "tools/print/print_pages.h"

namespace burin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr const char* kMissing = "needs pdftoppm: tools/install-packages poppler-utils";
constexpr double kDpi = 300, kGood_mm = 0.05;

bool has_pdftoppm() { return std::system("command -v pdftoppm >/dev/null 2>&1") == 0; }

Image read_pgm(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string magic;
  int width = 0, height = 0, most = 0;
  in >> magic >> width >> height >> most;
  in.get();
  Image image(width, height, 1, 0);
  std::string bytes(static_cast<std::size_t>(width) * height, '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  EXPECT_EQ(magic, "P5");
  EXPECT_TRUE(in.good());
  for (std::size_t i = 0; i < bytes.size(); ++i)
    image.data[i] = static_cast<float>(static_cast<unsigned char>(bytes[i])) / 255.0F;
  return image;
}

// Pages as they come out of a printer that makes 100 mm so long.
struct Printer {
  double across_mm = 100, upright_mm = 100;
  Eigen::Vector2d mm(const Eigen::Vector2d& px) const {
    return ((px + Eigen::Vector2d(0.5, 0.5)) * 25.4 / kDpi).cwiseProduct(Eigen::Vector2d(across_mm, upright_mm) / 100);
  }
  Eigen::Vector2d px(const Eigen::Vector2d& mm) const {
    return (mm * kDpi / 25.4).cwiseQuotient(Eigen::Vector2d(across_mm, upright_mm) / 100) - Eigen::Vector2d(0.5, 0.5);
  }
};

std::vector<Image> rendered(const TemporaryFolder& folder, const std::string& pdf_bytes) {
  folder.write("print.pdf", pdf_bytes);
  const Outcome run = run_shell(
      folder, "cd " + quoted(folder.path().string()) + " && rm -f page*.pgm && pdftoppm -r 300 -gray print.pdf page");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
    if (entry.path().extension() == ".pgm") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::vector<Image> pages;
  for (const auto& file : files) pages.push_back(read_pgm(file));
  return pages;
}

float bilinear(const Image& image, const Eigen::Vector2d& px) {
  const int x = std::clamp(static_cast<int>(std::floor(px.x())), 0, image.width - 2),
            y = std::clamp(static_cast<int>(std::floor(px.y())), 0, image.height - 2);
  const auto u = static_cast<float>(px.x() - x), v = static_cast<float>(px.y() - y);
  return (1 - v) * ((1 - u) * image.at(x, y, 0) + u * image.at(x + 1, y, 0)) +
         v * ((1 - u) * image.at(x, y + 1, 0) + u * image.at(x + 1, y + 1, 0));
}

// Where dark marks cross a line, as distances from its start: their middles, weighted by darkness.
std::vector<double> dark_marks(const Image& image, const Printer& printer, const Eigen::Vector2d& from_mm,
                               const Eigen::Vector2d& to_mm) {
  constexpr double kStep = 0.01;
  const double length = (to_mm - from_mm).norm();
  std::vector<double> out;
  double weight = 0, sum = 0;
  for (double at = 0; at <= length + kStep; at += kStep) {
    const double dark = at > length ? 0 : 1 - bilinear(image, printer.px(from_mm + at / length * (to_mm - from_mm)));
    if (dark > 0.02) {
      weight += dark;
      sum += dark * at;
    } else if (weight > 0) {
      out.push_back(sum / weight);
      weight = sum = 0;
    }
  }
  return out;
}

void expect_rulers(const Image& image, const Printer& printer, const PrintedPage& page) {
  for (const auto& [ruler, aside] :
       {std::pair<Ruler, Eigen::Vector2d>{page.across, {0, 3.4}}, {page.upright, {-3.4, 0}}}) {
    const Eigen::Vector2d along = (ruler.hundred - ruler.zero).normalized();
    // That far aside only the marks of whole centimeters reach.
    const auto marks = dark_marks(image, printer, ruler.zero + aside - along, ruler.hundred + aside + along);
    ASSERT_EQ(marks.size(), 11U);
    EXPECT_NEAR(marks.back() - marks.front(), 100, kGood_mm);
    EXPECT_NEAR(marks[5] - marks[0], 50, kGood_mm);
  }
}

Board board_of(const Eigen::Vector2d& size, const std::string& family) {
  Board board;
  board.size_mm = size;
  board.carve_min_mm = 0.25 * size;
  board.carve_max_mm = 0.75 * size;
  board.tags.family = family;
  return board;
}

// 200 x 150 mm, ten tags of 12 mm.
Board small_board(const std::string& family) {
  Board board = board_of({200, 150}, family);
  for (int k = 0; k < 10; ++k)
    board.tags.list.push_back({k, {25 + 37.0 * (k % 5), k < 5 ? 20 : 130}, 12, k == 3 ? 90.0 : 0.0});
  return board;
}

// 600 x 400 mm: tags of 40 mm, some turned, across seams; and of 8 mm.
Board large_board() {
  Board board = board_of({600, 400}, "tagStandard41h12");
  for (int k = 0; k < 10; ++k)
    board.tags.list.push_back({k, {50 + 125.0 * (k / 2), k % 2 == 0 ? 52 : 348}, 40, k % 3 == 0 ? 37.0 * k : 0.0});
  for (int k = 0; k < 10; ++k)
    board.tags.list.push_back({10 + k, {k % 2 == 0 ? 20 : 580, 120 + 40.0 * (k / 2)}, 8, 90});
  board.keep_out.push_back({"hole", {}, {300, 200}, 15});
  return board;
}

struct Case {
  std::string name;
  Board board;
  PrintSetup setup;
};

PrintSetup setup_of(const std::string& paper, double across = 100, double upright = 100) {
  PrintSetup setup;
  setup.paper = find_paper(paper);
  setup.across_mm = across;
  setup.upright_mm = upright;
  setup.name = "test";
  return setup;
}

std::vector<Case> cases() {
  std::vector<Case> out;
  out.push_back({"sample_a4", read_board(places::source() + "/samples/small-bench/board.json"), setup_of("a4")});
  out.push_back({"sample_letter_97", out[0].board, setup_of("letter", 97.5, 97.5)});
  out.push_back({"large_a4", large_board(), setup_of("a4")});
  out.push_back({"large_letter_103", large_board(), setup_of("letter", 103, 98)});
  for (const char* family : tag_families())
    out.push_back({family, small_board(family), setup_of(out.size() % 2 == 0 ? "a4" : "letter")});
  return out;
}

class Printed : public ::testing::TestWithParam<Case> {};

TEST_P(Printed, TagsAndRulersHaveTheirSizesOnPaper) {
  if (!has_pdftoppm()) GTEST_SKIP() << kMissing;
  const auto& [name, board, setup] = GetParam();
  const Printer printer{setup.across_mm, setup.upright_mm};
  const TagPages pages = tag_pages(board, setup);
  std::vector<Drawing> drawings;
  for (const PrintedPage& page : pages.pages) drawings.push_back(page.drawing);
  const TemporaryFolder folder;
  const std::vector<Image> paper = rendered(folder, pdf(drawings, {setup.paper.size_mm, stretch(setup), name}));
  ASSERT_EQ(paper.size(), pages.pages.size());
  ASSERT_EQ(pages.tags.size(), board.tags.list.size());
  TagDetector detector(board.tags.family);
  std::size_t found = 0;
  double worst = 0;
  for (std::size_t page = 0; page < paper.size(); ++page) {
    expect_rulers(paper[page], printer, pages.pages[page]);
    for (const TagDetection& tag : detector.detect(paper[page], {}, {}).tags) {
      const auto at = std::find_if(pages.tags.begin(), pages.tags.end(),
                                   [&](const PrintedTag& p) { return p.page == page && p.id == tag.id; });
      ASSERT_NE(at, pages.tags.end()) << tag.id << " on page " << page;
      ++found;
      EXPECT_EQ(at->size_mm, board.tags.list[static_cast<std::size_t>(at - pages.tags.begin())].size_mm);
      for (int k = 0; k < 4; ++k) {
        const double right = k == 1 || k == 2 ? 0.5 : -0.5, down = k < 2 ? 0.5 : -0.5;
        const Eigen::Vector2d expected = at->center_mm + at->size_mm * Eigen::Vector2d(right, down);
        const double error = (printer.mm(tag.corner_px[k]) - expected).norm();
        EXPECT_LT(error, kGood_mm) << tag.id;
        worst = std::max(worst, error);
      }
    }
  }
  EXPECT_EQ(found, board.tags.list.size());
  RecordProperty("worst_mm", std::to_string(worst));
}

// All tiles joined along the middles of their seams, 300 pixels an inch of board, row 0 at the board's upper edge.
Image joined(const std::vector<Image>& paper, const TemplatePages& pages, const Board& board, const Printer& printer) {
  constexpr double kAround_mm = 6;
  const double px_mm = 25.4 / kDpi;
  const Eigen::Vector2d size = board.size_mm + Eigen::Vector2d::Constant(2 * kAround_mm);
  Image out(static_cast<int>(size.x() / px_mm), static_cast<int>(size.y() / px_mm), 1, 0);
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x) {
      const Eigen::Vector2d p((x + 0.5) * px_mm - kAround_mm, size.y() - kAround_mm - (y + 0.5) * px_mm);
      // Of the tiles that show it the one whose edge is furthest.
      const Tile* best = nullptr;
      double furthest = 0;
      for (const Tile& tile : pages.tiles) {
        const double inside = std::min((p - tile.low_mm).minCoeff(), (tile.high_mm - p).minCoeff());
        if (inside > furthest) {
          furthest = inside;
          best = &tile;
        }
      }
      if (best == nullptr) {
        ADD_FAILURE() << "no tile shows " << p.transpose();
        return out;
      }
      out.at(x, y, 0) = bilinear(paper[best->page], printer.px(best->on_page(p)));
    }
  return out;
}

TEST_P(Printed, TemplatePutsEveryTagInItsPlaceOnTheBoard) {
  if (!has_pdftoppm()) GTEST_SKIP() << kMissing;
  const auto& [name, board, setup] = GetParam();
  const Printer printer{setup.across_mm, setup.upright_mm};
  const TemplatePages pages = template_pages(board, setup);
  std::vector<Drawing> drawings;
  for (const PrintedPage& page : pages.pages) drawings.push_back(page.drawing);
  const TemporaryFolder folder;
  const std::vector<Image> paper = rendered(folder, pdf(drawings, {setup.paper.size_mm, stretch(setup), name}));
  ASSERT_EQ(paper.size(), pages.tiles.size());
  for (std::size_t page = 0; page < paper.size(); ++page) expect_rulers(paper[page], printer, pages.pages[page]);
  // Every cross lies on two tiles at least, and there are crosses where there are seams.
  EXPECT_EQ(pages.marks.empty(), pages.tiles.size() == 1);
  for (const RegistrationMark& mark : pages.marks) {
    const Eigen::Vector2d at = pages.tiles[mark.page].on_page(mark.board_mm);
    EXPECT_LT(bilinear(paper[mark.page], printer.px(at)), 0.7);
    EXPECT_GT(std::count_if(pages.marks.begin(), pages.marks.end(),
                            [&](const RegistrationMark& other) { return other.board_mm == mark.board_mm; }),
              1);
  }
  const Image whole = joined(paper, pages, board, printer);
  const auto on_board = [height_mm = board.size_mm.y()](const Eigen::Vector2d& px) {
    const Eigen::Vector2d mm = (px + Eigen::Vector2d(0.5, 0.5)) * 25.4 / kDpi;
    return Eigen::Vector2d(mm.x() - 6, height_mm + 6 - mm.y());
  };
  TagDetector detector(board.tags.family);
  const auto found = detector.detect(whole, {}, {}).tags;
  EXPECT_EQ(found.size(), board.tags.list.size());
  double worst = 0;
  for (const TagDetection& tag : found) {
    const auto at =
        std::find_if(board.tags.list.begin(), board.tags.list.end(), [&](const Tag& t) { return t.id == tag.id; });
    ASSERT_NE(at, board.tags.list.end());
    const auto corners = tag_corners_mm(*at);
    for (int k = 0; k < 4; ++k) {
      const double error = (on_board(tag.corner_px[k]) - corners[k]).norm();
      EXPECT_LT(error, kGood_mm) << tag.id;
      worst = std::max(worst, error);
    }
  }
  RecordProperty("worst_mm", std::to_string(worst));
  // The board's outline, at a height where there is no tag: first and last dark line across.
  const Printer exact;
  const double y_mm = 6 + 0.45 * board.size_mm.y();
  const auto lines = dark_marks(whole, exact, {2, y_mm}, {10 + board.size_mm.x(), y_mm});
  ASSERT_GE(lines.size(), 2U);
  EXPECT_NEAR(lines.front() + 2, 6, kGood_mm);
  EXPECT_NEAR(lines.back() - lines.front(), board.size_mm.x(), kGood_mm);
}

INSTANTIATE_TEST_SUITE_P(Boards, Printed, ::testing::ValuesIn(cases()),
                         [](const auto& info) { return info.param.name; });

TEST(Print, LensFindsTheChessboardInItsSize) {
  if (!has_pdftoppm()) GTEST_SKIP() << kMissing;
  const PrintSetup setup = setup_of("letter", 97.5, 97.5);
  const Printer printer{97.5, 97.5};
  const ChessboardPage page = chessboard_page(setup);
  EXPECT_EQ(page.square_mm, std::floor(page.square_mm));
  const TemporaryFolder folder;
  const std::vector<Image> paper =
      rendered(folder, pdf({&page.page.drawing, 1}, {setup.paper.size_mm, stretch(setup), "c", true}));
  ASSERT_EQ(paper.size(), 1U);
  std::filesystem::create_directory(folder / "photos");
  write_picture(paper[0], folder / "photos" / "page.png");
  Chessboard board;
  board.columns = page.columns;
  board.rows = page.rows;
  board.square_mm = page.square_mm;
  const ChessboardViews found = find_chessboards(folder / "photos", board);
  ASSERT_EQ(found.views.size(), 1U);
  const auto& q = found.views[0].q_px;
  ASSERT_EQ(q.size(), 54U);
  for (std::size_t i = 0; i < q.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) {
      const Eigen::Vector2d a(i % 9, i / 9), b(k % 9, k / 9);
      // OpenCV's corners; 0.1 mm are a pixel.
      EXPECT_NEAR((printer.mm(q[i]) - printer.mm(q[k])).norm(), page.square_mm * (a - b).norm(), 0.1);
    }
}

TEST(Print, LongNamesStayOnThePage) {
  const std::string name(200, 'w');
  EXPECT_LE(words_width_mm(shortened(name, 4, 100, true), 4, true), 100);
  EXPECT_TRUE(shortened(name, 4, 100, true).ends_with("..."));
  EXPECT_EQ(shortened("short", 4, 100), "short");
  const std::string letters = "\xC3\xA4\xC3\xB6\xC3\xBC";  // three letters of two bytes
  for (const std::string& line : wrapped(letters + letters + letters, 4, 9)) EXPECT_EQ(line.size() % 2, 0U);
  std::string together;
  for (const std::string& line : wrapped("a " + name + " b", 4, 60)) {
    EXPECT_LE(words_width_mm(line, 4), 60);
    together += line;
  }
  EXPECT_EQ(std::count(together.begin(), together.end(), 'w'), 200);
}

// Read as PDF is read: from the end, by the tables of objects. (That poppler takes it is seen above.)
TEST(Print, AsksForItsTrueSize) {
  const Drawing empty;
  const std::string bytes = pdf({&empty, 1}, {{210, 297}, {1, 1}, "c", true});
  const auto number_at = [&](std::size_t at) { return std::stoul(bytes.substr(at, 20)); };
  const std::size_t table = number_at(bytes.rfind("startxref") + 9);
  ASSERT_EQ(bytes.substr(table, 5), "xref\n");
  const std::size_t row = bytes.find('\n', table + 5) + 1, object = number_at(row);
  const std::string number = std::to_string(number_at(table + 5));
  ASSERT_TRUE(bytes.substr(object).starts_with(number + " 0 obj"));
  const std::string catalog = bytes.substr(object, bytes.find("endobj", object) - object);
  EXPECT_THAT(catalog, AllOf(HasSubstr("/Type /Catalog"), HasSubstr("/Pages "),
                             HasSubstr("/ViewerPreferences << /PrintScaling /None >>")));
  const std::string trailer = bytes.substr(bytes.rfind("trailer"));
  EXPECT_THAT(trailer, HasSubstr("/Root " + number + " 0 R"));
  const std::size_t before = number_at(trailer.find("/Prev ") + bytes.rfind("trailer") + 6);
  EXPECT_EQ(bytes.substr(before, 5), "xref\n");
  EXPECT_LT(before, table);
  EXPECT_EQ(pdf({&empty, 1}, {{210, 297}, {1, 1}, "c"}).find("PrintScaling"), std::string::npos);
}

TEST(PrintCommand, TakesThePaperOfTheLocale) {
  const TemporaryFolder folder;
  write_board(small_board("tag36h11"), folder / "board.json");
  const auto printed = [&](const std::string& environment, const std::string& options) {
    return run_shell(folder, "cd " + quoted(folder.path().string()) + " && env -u LC_ALL -u LC_PAPER -u LANG " +
                                 environment + " " + quoted(places::program()) +
                                 " print board.json --no-template --no-chessboard " + options)
        .out;
  };
  EXPECT_THAT(printed("", ""), HasSubstr("on a4 paper, 210 x 297 mm (else: --paper letter)\n"));
  EXPECT_THAT(printed("LANG=en_US.UTF-8", ""),
              HasSubstr("on letter paper, 215.9 x 279.4 mm (LANG=en_US.UTF-8; else: --paper a4)\n"));
  EXPECT_THAT(printed("LANG=en_US.UTF-8 LC_PAPER=de_DE.UTF-8", ""),
              HasSubstr("on a4 paper, 210 x 297 mm (LC_PAPER=de_DE"));
  EXPECT_THAT(printed("LANG=de_DE LC_PAPER=fr_CA", ""), HasSubstr("on letter paper"));
  EXPECT_THAT(printed("LANG=es_MX LC_ALL=C", ""), HasSubstr("on a4 paper"));
  EXPECT_THAT(printed("LANG=en_US.UTF-8", "--paper a4"), HasSubstr("on a4 paper, 210 x 297 mm\n"));
  EXPECT_THAT(file_text(folder / "tags.pdf"), HasSubstr("/PrintScaling /None"));
}

TEST(Print, RefusesWhatCannotBePrinted) {
  EXPECT_THROW(find_paper("b4"), Error);
  for (const double wrong : {79.9, 125.1, 0.0, -100.0, std::nan("")})
    EXPECT_THROW(require_good(setup_of("a4", wrong)), Error);
  EXPECT_NO_THROW(require_good(setup_of("a4", 80, 125)));
  EXPECT_THROW(tag_pages(board_of({100, 100}, "tag36h11"), setup_of("a4")), Error);
  Board board = board_of({500, 500}, "tagStandard41h12");
  board.tags.list = {{0, {250, 250}, 110, 0}};  // its paper is 198 mm wide
  try {
    tag_pages(board, setup_of("a4"));
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("tag 0"), HasSubstr("198.0 mm"), HasSubstr("--paper a3")));
  }
  EXPECT_NO_THROW(tag_pages(board, setup_of("a3")));
  EXPECT_THROW(template_pages(board_of({9000, 9000}, "tag36h11"), setup_of("a4")), Error);
}

TEST(PrintCommand, WritesTheSameBytesAgainWithFontsAndWithout) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder / "my board");
  std::filesystem::copy_file(places::source() + "/samples/small-bench/board.json", folder / "my board" / "board.json");
  const Outcome first = run_burin(folder, {"print", "my board"});
  ASSERT_EQ(first.exit_code, 0) << first.err;
  EXPECT_THAT(first.out, AllOf(HasSubstr("16 tags of tagStandard41h12"), HasSubstr("Wrote my board/tags.pdf"),
                               HasSubstr("burin print 'my board' --ruler-measured MM")));
  const std::string bytes = file_text(folder / "my board" / "tags.pdf");
  EXPECT_TRUE(bytes.starts_with("%PDF-"));
  ASSERT_EQ(run_burin(folder, {"print", "my board/board.json", "--out", "again.pdf"}).exit_code, 0);
  EXPECT_EQ(file_text(folder / "again.pdf"), bytes);
  folder.write("none.conf", "<?xml version=\"1.0\"?><fontconfig></fontconfig>");
  const Outcome bare =
      run_shell(folder, "cd " + quoted(folder.path().string()) + " && FONTCONFIG_FILE=$PWD/none.conf " +
                            quoted(places::program()) + " print 'my board' --out bare.pdf");
  EXPECT_EQ(bare.exit_code, 0) << bare.err;
  const Outcome right = run_burin(folder, {"print", "my board", "--ruler-measured", "97.5", "--out", "right.pdf"});
  EXPECT_EQ(right.exit_code, 0) << right.err;
  EXPECT_THAT(right.out, HasSubstr("must now measure 100 mm"));
  EXPECT_EQ(run_burin(folder, {"print", "my board", "--ruler-measured", "9.75"}).exit_code, 1);
  EXPECT_EQ(run_burin(folder, {"print", "my board", "--upright-ruler-measured=-5"}).exit_code, 1);
  const Outcome other = run_burin(folder, {"print", "my board", "--out", "my board/board.json"});
  EXPECT_EQ(other.exit_code, 1);
  EXPECT_THAT(other.err, HasSubstr("is not the name of a PDF"));
  EXPECT_EQ(file_text(folder / "my board" / "board.json"),
            file_text(places::source() + "/samples/small-bench/board.json"));
}

}  // namespace
}  // namespace burin

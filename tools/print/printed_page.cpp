#include "tools/print/printed_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <string_view>

#include "burin/base/error.h"

namespace burin {
namespace {

// Unprintable margin of printers, and the strips of the two rulers within it.
constexpr double kPageMargin_mm = 10, kRulerStrip_mm = 10;
constexpr double kFull_mm = 100;

// A filled bar instead of a line: some programs round a line's width to pixels, but no bar's edges.
void add_bar(Drawing& drawing, const Eigen::Vector2d& center, double half_x, double half_y) {
  const Eigen::Vector2d half(half_x, half_y);
  add_rectangle(drawing, center - half, center + half, Tint::black);
}

// Draws a mark at every mm, longer ones at 5 and 10, and numbers; `along` and `aside` are unit vectors.
void add_ruler(Drawing& drawing, const Ruler& ruler, const Eigen::Vector2d& aside) {
  const Eigen::Vector2d along = (ruler.hundred - ruler.zero).normalized();
  const bool level = std::abs(along.x()) > 0.5;
  constexpr double kHalfLine = 0.06;
  const auto bar = [&](const Eigen::Vector2d& middle, double half_along, double half_aside) {
    add_bar(drawing, middle, level ? half_along : half_aside, level ? half_aside : half_along);
  };
  bar((ruler.zero + ruler.hundred) / 2, kFull_mm / 2 + kHalfLine, kHalfLine);
  for (int mm = 0; mm <= static_cast<int>(kFull_mm); ++mm) {
    const double length = mm % 10 == 0 ? 4 : mm % 5 == 0 ? 2.8 : 1.8;
    const Eigen::Vector2d foot = ruler.zero + mm * along;
    bar(foot + length / 2 * aside, kHalfLine, length / 2);
    if (mm % 20 == 0)
      add_words(drawing, {.at_mm = foot + 5.6 * aside,
                          .text = mm == static_cast<int>(kFull_mm) ? "100 mm" : std::to_string(mm),
                          .size_mm = 2.4,
                          .tint = Tint::black,
                          .anchor = Anchor::middle,
                          .centered = true,
                          .turn_deg = level ? 0.0 : 90.0});
  }
}

std::string scale_text(const PrintSetup& setup) {
  if (!is_compensated(setup))
    return "Print at 100 % (\"actual size\", not \"fit to page\"). Then measure the rulers: if 100 mm are not 100 mm, "
           "make the file anew with --ruler-measured and what you measured.";
  std::string measured = fmt::format("{:g} mm", setup.across_mm);
  if (setup.across_mm != setup.upright_mm) measured += fmt::format(" across and {:g} mm upright", setup.upright_mm);
  return fmt::format(
      "Pre-compensated for one printer, whose 100 mm ruler came out {} long: print with the same settings, and the "
      "rulers of this page must now measure 100 mm.",
      measured);
}

}  // namespace

std::vector<Paper> papers() {
  return {{"a4", {210, 297}}, {"letter", {215.9, 279.4}}, {"a3", {297, 420}}, {"tabloid", {279.4, 431.8}}};
}

Paper find_paper(const std::string& name) {
  std::string known;
  for (const Paper& paper : papers()) {
    if (paper.name == name) return paper;
    known += (known.empty() ? "" : ", ") + paper.name;
  }
  fail("--paper", "\"" + name + "\" is no paper that Burin knows", "use one of " + known);
}

UsualPaper usual_paper() {
  constexpr std::array<std::string_view, 15> kLetter{"BZ", "CA", "CL", "CO", "CR", "GT", "MX", "NI",
                                                     "PA", "PH", "PR", "SV", "US", "VE", "UM"};
  for (const char* name : {"LC_ALL", "LC_PAPER", "LANG"}) {
    const char* value = std::getenv(name);
    if (value == nullptr || *value == '\0') continue;
    const std::string_view locale(value);
    const std::size_t at = locale.find('_');
    const std::string_view region = at == std::string_view::npos ? std::string_view() : locale.substr(at + 1, 2);
    const bool letter = std::find(kLetter.begin(), kLetter.end(), region) != kLetter.end();
    return {letter ? "letter" : "a4", fmt::format("{}={}", name, value)};
  }
  return {"a4", ""};
}

void require_good(const PrintSetup& setup) {
  constexpr double kLeast = 80, kMost = 125;
  for (const auto& [option, measured] :
       {std::pair{"--ruler-measured", setup.across_mm}, {"--upright-ruler-measured", setup.upright_mm}})
    if (!(measured >= kLeast && measured <= kMost))
      fail(option, fmt::format("{:g} mm is not what a printer makes of 100 mm", measured),
           "print the PDF at 100 %, measure its ruler from 0 to 100, and give its length in mm (80 to 125)");
}

bool is_compensated(const PrintSetup& setup) { return setup.across_mm != kFull_mm || setup.upright_mm != kFull_mm; }

Eigen::Vector2d stretch(const PrintSetup& setup) { return {kFull_mm / setup.across_mm, kFull_mm / setup.upright_mm}; }

Eigen::Vector2d printed_size_mm(const PrintSetup& setup) { return setup.paper.size_mm.cwiseQuotient(stretch(setup)); }

FreeArea free_area(const PrintSetup& setup, double head_mm) {
  const Eigen::Vector2d size = printed_size_mm(setup);
  // A page larger than the paper may be cut on any side.
  const Eigen::Vector2d cut = (size - setup.paper.size_mm).cwiseMax(0);
  const Eigen::Vector2d margin = Eigen::Vector2d::Constant(kPageMargin_mm) + cut;
  return {margin + Eigen::Vector2d(kRulerStrip_mm, head_mm), size - margin - Eigen::Vector2d(0, kRulerStrip_mm)};
}

PrintedPage new_page(const PrintSetup& setup, const std::string& title, const std::vector<std::string>& lines,
                     double head_mm) {
  PrintedPage page;
  page.drawing.size_mm = printed_size_mm(setup);
  page.free = free_area(setup, head_mm);
  const Eigen::Vector2d low = page.free.low - Eigen::Vector2d(kRulerStrip_mm, head_mm);
  const double width = page.free.high.x() - low.x();
  add_words(page.drawing, {.at_mm = low + Eigen::Vector2d(0, 3.6),
                           .text = shortened(title, 4.2, width, true),
                           .size_mm = 4.2,
                           .bold = true});
  double y = low.y() + 8;
  constexpr double kSize = 2.5, kLine = 3.4;
  std::vector<std::string> told = lines;
  told.push_back(scale_text(setup));
  for (const std::string& sentence : told)
    for (const std::string& line : wrapped(sentence, kSize, width)) {
      add_words(page.drawing, {.at_mm = {low.x(), y}, .text = line, .size_mm = kSize, .tint = Tint::soft});
      y += kLine;
    }
  page.across.zero = {page.free.low.x() + 4, page.free.high.y() + kRulerStrip_mm - 7};
  page.across.hundred = page.across.zero + Eigen::Vector2d(kFull_mm, 0);
  page.upright.zero = {low.x() + 7, page.free.high.y() - 4};
  page.upright.hundred = page.upright.zero - Eigen::Vector2d(0, kFull_mm);
  add_ruler(page.drawing, page.across, {0, 1});
  add_ruler(page.drawing, page.upright, {-1, 0});
  return page;
}

}  // namespace burin

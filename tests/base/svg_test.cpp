// Drawings are well-formed XML whatever their words are, y and x stand where they belong, and numbers in files are
// plain decimals. The oracle is SVG's own grammar, written out.
#include "burin/base/files/svg.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "burin/base/files/decimals.h"

namespace burin {
namespace {

TEST(Svg, ElementsStandAsTheGrammarWantsThem) {
  EXPECT_EQ(svg_line({1, 2.26}, {3, -0.01}, "stroke=\"#ccc\""),
            "<line x1=\"1.0\" y1=\"2.3\" x2=\"3.0\" y2=\"0.0\" stroke=\"#ccc\"/>\n");
  EXPECT_EQ(svg_line({1, 2.2604}, {3, 4}, "", 3), "<line x1=\"1.000\" y1=\"2.260\" x2=\"3.000\" y2=\"4.000\"/>\n");
  const std::vector<Eigen::Vector2d> points{{0, 0}, {10, 0}, {10, 5.55}};
  EXPECT_EQ(svg_polygon(points, "fill=\"red\""), "<polygon points=\"0.0,0.0 10.0,0.0 10.0,5.5\" fill=\"red\"/>\n");
  EXPECT_EQ(svg_polyline({}, ""), "<polyline points=\"\"/>\n");
  EXPECT_EQ(svg_drawing({640, 400.5}, "font-size=\"12\"", "<g/>\n"),
            "<svg xmlns=\"http://www.w3.org/2000/svg\" font-size=\"12\" viewBox=\"0 0 640 400.5\">\n<g/>\n</svg>\n");
}

TEST(Svg, WordsOfAPersonCannotBreakADrawing) {
  EXPECT_EQ(svg_words({1, 2}, "a<b> & \"c\"", "end", "fill=\"red\""),
            "<text x=\"1.0\" y=\"2.0\" text-anchor=\"end\" fill=\"red\">a&lt;b&gt; &amp; &quot;c&quot;</text>\n");
  EXPECT_EQ(xml_text("µm, ±"), "µm, ±");
}

TEST(Decimals, NothingHasNoSignAndNoFeedHasAnExponent) {
  EXPECT_EQ(fixed(-0.0004, 3), "0.000");
  EXPECT_EQ(fixed(-0.0006, 3), "-0.001");
  EXPECT_EQ(fixed(-0.4, 0), "0");
  EXPECT_EQ(fixed(12.3456, 2), "12.35");
  EXPECT_EQ(shortest(1200), "1200");
  EXPECT_EQ(shortest(100000), "100000");  // G-code knows no 1e+05
  EXPECT_EQ(shortest(0.1), "0.1");
  const double third = 1.0 / 3;
  EXPECT_EQ(std::stod(shortest(third)), third);
}

TEST(Decimals, SentencesHaveTheDigitsThatMeanSomething) {
  EXPECT_EQ(significant(0.0123), "0.012");
  EXPECT_EQ(significant(1e300, 3), "1e+300") << "no sentence of 300 digits";
  EXPECT_EQ(counted(1, "scratch"), "1 scratch");
  EXPECT_EQ(counted(0, "scratch"), "0 scratches");
  EXPECT_EQ(counted(2, "more line"), "2 more lines");
  EXPECT_EQ(significant(-0.5), "-0.5");
  EXPECT_EQ(significant(5.64), "5.6");
  EXPECT_EQ(significant(562.4), "562");
  EXPECT_EQ(significant(100000), "100000");
  EXPECT_EQ(significant(1.23456, 4), "1.235");
  EXPECT_EQ(significant(3), "3");
  EXPECT_EQ(significant(0), "0");
  EXPECT_EQ(significant(1e-12), "0");
  EXPECT_EQ(general(0.5, 5), "0.5");
  EXPECT_EQ(general(35, 4), "35");
  EXPECT_EQ(general(123456, 3), "1.23e+05");
  EXPECT_EQ(general(0.00001234, 3), "1.23e-05");
  EXPECT_EQ(coarse(9.94), "9.9");
  EXPECT_EQ(coarse(9.96), "10");
}

}  // namespace
}  // namespace burin

#include "image/svg.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <vector>

#include "support_code/markup.hpp"

namespace greenray {
namespace {

/// libxml2's opinion, where xmllint is installed.
void expect_xmllint_agrees(const std::string &svg) {
  if (std::system("command -v xmllint >/dev/null 2>&1") != 0) return;
  FILE *pipe = popen("xmllint --noout - 2>&1", "w");
  ASSERT_NE(pipe, nullptr);
  std::fwrite(svg.data(), 1, svg.size(), pipe);
  EXPECT_EQ(pclose(pipe), 0);
}

void expect_sound(const Plot &plot) {
  const std::string svg = draw_svg(plot);
  EXPECT_EQ(complaint(svg), "");
  expect_xmllint_agrees(svg);
  for (const char *bad : {"nan", "NaN", "inf\"", "-inf", "1e+"}) EXPECT_EQ(svg.find(bad), std::string::npos) << bad;
}

// oracle: XML 1.0, by a checker of a few lines and by libxml2
// tolerance: none
TEST(Svg, is_well_formed_whatever_the_words_and_numbers) {
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  Plot plot;
  plot.title = "R&D <b> \"quotes\" 'and' \x01 \xff control";
  plot.subtitle = "n − 1 ⁻⁸ ✓";
  plot.panels.push_back(
      {{"x & y", "<m>"}, {"h", "m"}, {{"a<b", "#112233", {0, nan, 2, inf, 4}, {0, 1, 2, 3, nan}}}, {}, {}});
  plot.panels.push_back(
      {{"log", "Pa", true}, {"h", "m"}, {{"p", "#112233", {0, -1, 1e-3, 1e5}, {0, 1, 2, 3}}}, {}, {}});
  plot.panels.push_back({{"nothing", ""}, {"", ""}, {}, {{nan, 1}, {0.2, inf}}, {{nan, "eye"}}});
  plot.panels.push_back({{"constant", "K"}, {"h", "m"}, {{"c", "#112233", {288, 288}, {5, 5}}}, {}, {}});
  plot.panels.push_back({{"zero", "K"}, {"h", "m", true}, {{"c", "#112233", {0, 0}, {0, 0}}}, {}, {}});
  plot.panels.push_back({{"huge", ""}, {"h", ""}, {{"c", "#112233", {-1e308, 1e308}, {1e-308, 2e-308}}}, {}, {}});
  plot.panels.push_back(
      {{"limits", "", false, 5.0, 5.0}, {"h", "", true, -1.0, inf}, {{"", "", {1, 2}, {1, 2}}}, {}, {}});
  expect_sound(plot);
  expect_sound(Plot{});
  EXPECT_NE(draw_svg(plot).find("R&amp;D &lt;b&gt;"), std::string::npos);
}

// oracle: counted by hand: a line broken once has two moves; one legend entry for two lines of one name and colour
// tolerance: none
TEST(Svg, breaks_lines_and_merges_legend_entries) {
  Plot plot;
  const double nan = std::nan("");
  plot.panels.push_back(
      {{"x", ""},
       {"y", ""},
       {{"550 nm", "#00aa00", {0, 1, nan, 3, 4}, {0, 1, 2, 3, 4}}, {"550 nm", "#00aa00", {0, 1}, {1, 0}}},
       {{1, 2, "duct"}},
       {{3, "eye"}}});
  const std::string svg = draw_svg(plot);
  EXPECT_EQ(count(svg, "<path "), 2u);
  EXPECT_EQ(count(svg, "M"), 3u);
  EXPECT_EQ(count(svg, ">550 nm<"), 1u);
  EXPECT_EQ(count(svg, ">eye<"), 1u);
  EXPECT_EQ(count(svg, "fill-opacity"), 1u);
  EXPECT_EQ(svg, draw_svg(plot));
}

// oracle: counted by hand: three points of which one is not finite and one lies outside the frame; a legend entry has a
//   marker, too; a line of width 0 has no path
// tolerance: none
TEST(Svg, marks_the_points_inside_the_frame_and_says_what_they_are) {
  Plot plot;
  PlotLine line{"rk45 <float>", "#c8502b", {1, 10, std::nan(""), 1e6}, {1, 2, 3, 4}};
  line.marker = PlotMarker::disc, line.width = 0, line.notes = {"a & b", "second"};
  plot.panels.push_back({{"x", "", true, 0.5, 100.0}, {"y", ""}, {line}, {}, {}});
  expect_sound(plot);
  EXPECT_EQ(count(draw_svg(plot), "<circle "), 3u);
  EXPECT_EQ(count(draw_svg(plot), "<path "), 0u);
  EXPECT_EQ(count(draw_svg(plot), "<title>a &amp; b</title>"), 1u);
  plot.legend = false;
  EXPECT_EQ(count(draw_svg(plot), "<circle "), 2u);
  for (const PlotMarker marker : {PlotMarker::square, PlotMarker::diamond, PlotMarker::triangle}) {
    plot.panels[0].lines[0].marker = marker;
    expect_sound(plot);
    EXPECT_EQ(count(draw_svg(plot), "<polygon "), 2u);
  }
}

// oracle: in one page the clip paths of two plots must not share a name
// tolerance: none
TEST(Svg, plots_of_one_page_are_told_apart) {
  Plot a, b;
  a.panels.push_back({{"x", ""}, {"y", ""}, {}, {}, {}});
  b = a;
  a.id = "first", b.id = "second";
  EXPECT_EQ(count(draw_svg(a), "id=\"firstpanel0\""), 1u);
  EXPECT_EQ(count(draw_svg(a), "url(#firstpanel0)"), 1u);
  EXPECT_EQ(count(draw_svg(b), "firstpanel0"), 0u);
}

// oracle: ticks are 1, 2 or 5 times a power of ten, as on any printed graph
// tolerance: rounding
TEST(Svg, ticks_are_round_numbers) {
  EXPECT_EQ(linear_ticks(0, 10), (std::vector<double>{0, 2, 4, 6, 8, 10}));
  EXPECT_EQ(linear_ticks(-1, 1, 4), (std::vector<double>{-1, -0.5, 0, 0.5, 1}));
  const std::vector<double> small = linear_ticks(2.71e-4, 2.79e-4);
  ASSERT_GE(small.size(), 4u);
  EXPECT_NEAR((small[1] - small[0]) / 2e-6, 1, 1e-9);
  EXPECT_TRUE(linear_ticks(1, 1).empty());
  EXPECT_TRUE(linear_ticks(0, std::nan("")).empty());
}

// oracle: hue of monochromatic light: red is reddest, green greenest, blue bluest
// tolerance: order only
TEST(Svg, light_has_its_colour) {
  const auto part = [](const std::string &colour, std::size_t i) {
    return std::stoi(colour.substr(1 + 2 * i, 2), nullptr, 16);
  };
  const std::string red = wavelength_colour(650), green = wavelength_colour(530), blue = wavelength_colour(450);
  EXPECT_GT(part(red, 0), part(red, 1));
  EXPECT_GT(part(green, 1), part(green, 0));
  EXPECT_GT(part(blue, 2), part(blue, 0));
  EXPECT_EQ(wavelength_colour(300).size(), 7u);
  EXPECT_EQ(wavelength_colour(2000), wavelength_colour(670));
}

}  // namespace
}  // namespace greenray

#include "report/svg_chart.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <regex>

#include "innermap/core/error.h"

namespace innermap {
namespace {

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos; ++at) ++n;
  return n;
}

// The points of the first curve.
std::vector<std::pair<double, double>> curve(const std::string& svg) {
  std::vector<std::pair<double, double>> out;
  std::smatch found;
  if (!std::regex_search(svg, found, std::regex("<polyline points=\"([^\"]*)\""))) return out;
  const std::string points = found[1];
  const std::regex pair("([-0-9.]+),([-0-9.]+)");
  for (std::sregex_iterator i(points.begin(), points.end(), pair), end; i != end; ++i)
    out.push_back({std::stod((*i)[1]), std::stod((*i)[2])});
  return out;
}

SvgPanel panel(bool logarithmic) {
  SvgPanel p{.title = "errors"};
  p.xLogarithmic = p.yLogarithmic = logarithmic;
  p.series.push_back({"a", {1, 10, 100}, {1e-3, 1e-2, 1e-1}, true});
  return p;
}

SvgChart chartOf(SvgPanel p) {
  SvgChart chart;
  chart.panels.push_back(std::move(p));
  return chart;
}

TEST(SvgChart, EqualRatiosAreEqualSteps) {
  const auto points = curve(svgChart(chartOf(panel(true))));
  ASSERT_EQ(points.size(), 3u);
  EXPECT_NEAR(points[1].first - points[0].first, points[2].first - points[1].first, 0.2);
  EXPECT_NEAR(points[1].second - points[0].second, points[2].second - points[1].second, 0.2);
  EXPECT_GT(points[1].first, points[0].first + 50);
  EXPECT_LT(points[1].second, points[0].second - 50);  // up is less
  const auto linear = curve(svgChart(chartOf(panel(false))));
  EXPECT_NEAR((linear[2].first - linear[1].first) / (linear[1].first - linear[0].first), 10, 0.5);
}

TEST(SvgChart, LeavesOutWhatHasNoPlace) {
  SvgPanel p = panel(true);
  p.series[0].y = {0, std::numeric_limits<double>::quiet_NaN(), 1e-2};
  const std::string svg = svgChart(chartOf(p));
  EXPECT_EQ(curve(svg).size(), 1u);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(svg.find("inf"), std::string::npos);
}

TEST(SvgChart, ACurveHasGaps) {
  SvgPanel p = panel(true);
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  p.series[0].x = {1, 2, 3, 4, 5};
  p.series[0].y = {1, 2, unknown, 2, 1};
  EXPECT_EQ(count(svgChart(chartOf(p)), "<polyline"), 2u);
}

TEST(SvgChart, ManyPointsAreALineAlone) {
  SvgPanel p = panel(false);
  const std::size_t few = count(svgChart(chartOf(p)), "<circle");
  for (int i = 4; i < 1000; ++i) {
    p.series[0].x.push_back(100 + i);
    p.series[0].y.push_back(0.1);
  }
  EXPECT_EQ(count(svgChart(chartOf(p)), "<circle"), few - 3);
}

TEST(SvgChart, NoiseIsNotMagnified) {
  SvgPanel p = panel(false);
  p.series[0].y = {1e-16, 3e-16, 2e-16};
  p.yLeastSpan = 1e-9;
  const auto points = curve(svgChart(chartOf(p)));
  ASSERT_EQ(points.size(), 3u);
  EXPECT_NEAR(points[0].second, points[1].second, 0.2);
}

TEST(SvgChart, OneValueHasAnAxis) {
  for (const double value : {0.0, 3.0, -1e-200, 1e200}) {
    SvgPanel p = panel(false);
    p.series[0].y = {value, value, value};
    const std::string svg = svgChart(chartOf(p));
    EXPECT_EQ(curve(svg).size(), 3u);
    EXPECT_EQ(svg.find("nan"), std::string::npos) << value;
    EXPECT_EQ(svg.find("e-31"), std::string::npos) << value;
  }
}

TEST(SvgChart, CellsAreColouredByTheirValues) {
  SvgPanel p;
  p.columns = {"1", "2", "3"};
  p.rows = {"a", "b"};
  p.yLogarithmic = true;
  p.cells = Matrix(2, 3);
  for (std::size_t i = 0; i < 6; ++i) p.cells.data()[i] = std::pow(10.0, static_cast<double>(i));
  p.cells(1, 1) = std::numeric_limits<double>::quiet_NaN();
  const std::string svg = svgChart(chartOf(p));
  EXPECT_EQ(count(svg, "<rect"), 1u + 5u);  // the paper, and the cells that have a value
}

TEST(SvgChart, TextIsEscaped) {
  SvgChart chart = chartOf(panel(true));
  chart.title = "<script>";
  EXPECT_EQ(svgChart(chart).find("<script>"), std::string::npos);
}

TEST(SvgChart, RefusesWhatDoesNotFit) {
  EXPECT_THROW(svgChart({}), DataError);
  SvgPanel p = panel(true);
  p.series[0].y.pop_back();
  EXPECT_THROW(svgChart(chartOf(p)), DataError);
  SvgPanel cells;
  cells.rows = {"a"};
  cells.columns = {"b"};
  EXPECT_THROW(svgChart(chartOf(cells)), DataError);
  SvgChart small = chartOf(panel(true));
  small.panelWidth = 10;
  EXPECT_THROW(svgChart(small), SettingError);
  SvgChart none = chartOf(panel(true));
  none.panelsAcross = 0;
  EXPECT_THROW(svgChart(none), SettingError);
}

}  // namespace
}  // namespace innermap

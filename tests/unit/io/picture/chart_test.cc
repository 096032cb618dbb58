#include "innermap/io/picture/chart.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>

#include "innermap/core/error.h"
#include "io/test_files.h"

namespace innermap {
namespace {

using test::TemporaryFolder;

struct Pixels {
  int width = 0, height = 0;
  std::vector<unsigned char> rgb;
  const unsigned char* at(int x, int y) const { return &rgb[std::size_t(y * width + x) * 3]; }
};

Pixels readPicture(const std::string& path) {
  Pixels p;
  const auto input = OIIO::ImageInput::open(path);
  if (!input) return p;
  p.width = input->spec().width;
  p.height = input->spec().height;
  p.rgb.resize(std::size_t(p.width * p.height) * 3);
  EXPECT_TRUE(input->read_image(0, 0, 0, 3, OIIO::TypeDesc::UINT8, p.rgb.data()));
  return p;
}

bool isBlue(const unsigned char* c) { return c[2] > 150 && c[0] < 30; }
bool isOrange(const unsigned char* c) { return c[0] > 180 && c[2] < 40; }

// Rows of the curve in each column, below the legends: -1 where there is none.
std::vector<double> curveRows(const Pixels& p, bool (*ours)(const unsigned char*), int from,
                              int to) {
  std::vector<double> rows(std::size_t(p.width), -1);
  for (int x = 0; x < p.width; ++x) {
    double sum = 0;
    int count = 0;
    for (int y = from; y < to; ++y)
      if (ours(p.at(x, y))) {
        sum += y;
        ++count;
      }
    if (count) rows[std::size_t(x)] = sum / count;
  }
  return rows;
}

Chart twoPanels() {
  Chart chart;
  chart.title = "Energy";
  chart.xLabel = "frame";
  chart.width = 900;
  chart.panelHeight = 300;
  ChartPanel upper{"harmonic energy", 0, {{"harmonic", {}}}}, lower{"deformation", 0, {{"d", {}}}};
  for (int i = 0; i <= 100; ++i) {
    chart.x.push_back(i);
    upper.series[0].values.push_back(std::abs(i - 30.0) + 3);
    lower.series[0].values.push_back(i < 40 || i > 60 ? std::abs(i - 80.0) * 1e-5
                                                      : std::numeric_limits<double>::quiet_NaN());
  }
  chart.panels = {upper, lower};
  return chart;
}

// Panels start 120 and 464 pixels from the top.
constexpr int kUpper = 121, kLower = 465, kHeight = 298, kLeft = 92, kWidth = 900 - 92 - 40;

int columnOf(double x) { return static_cast<int>(kLeft + kWidth * (x + 1.5) / 103); }

TEST(Chart, CurvesStandWhereTheirValuesAre) {
  const TemporaryFolder folder;
  writeChart(folder.file("c.png"), twoPanels());
  const Pixels p = readPicture(folder.file("c.png"));
  ASSERT_EQ(p.width, 900);
  const std::vector<double> blue = curveRows(p, isBlue, kUpper, kUpper + kHeight),
                            orange = curveRows(p, isOrange, kLower, kLower + kHeight);
  const auto lowest = [](const std::vector<double>& rows) {
    return static_cast<double>(std::max_element(rows.begin(), rows.end()) - rows.begin());
  };
  EXPECT_NEAR(lowest(blue), columnOf(30), 3);
  EXPECT_NEAR(lowest(orange), columnOf(80), 3);
  // Straight where the values are: halfway down at half the value.
  const double top = blue[std::size_t(columnOf(100))], bottom = blue[std::size_t(columnOf(30))];
  EXPECT_NEAR(blue[std::size_t(columnOf(65))], (top + bottom) / 2, 3);
  EXPECT_GT(bottom - top, 200);
}

TEST(Chart, ValuesThatAreMissingLeaveAGap) {
  const TemporaryFolder folder;
  writeChart(folder.file("c.png"), twoPanels());
  const Pixels p = readPicture(folder.file("c.png"));
  const std::vector<double> orange = curveRows(p, isOrange, kLower, kLower + kHeight);
  for (int x = columnOf(39) + 4; x < columnOf(61) - 4; ++x) EXPECT_LT(orange[std::size_t(x)], 0);
  for (int x = columnOf(0) + 2; x < columnOf(39); ++x) EXPECT_GT(orange[std::size_t(x)], 0) << x;
}

TEST(Chart, CurvesAreSmooth) {
  const TemporaryFolder folder;
  writeChart(folder.file("c.png"), twoPanels());
  const Pixels p = readPicture(folder.file("c.png"));
  // Across a slanted line there are shades between the ground and the colour.
  int between = 0;
  for (int x = columnOf(60); x < columnOf(90); ++x)
    for (int y = kUpper; y < kUpper + kHeight; ++y) {
      const unsigned char* c = p.at(x, y);
      if (c[0] > 40 && c[0] < 200 && c[2] > c[0] + 20) ++between;
    }
  EXPECT_GT(between, columnOf(90) - columnOf(60));
}

TEST(Chart, ConstantsAndSinglePointsAreShown) {
  const TemporaryFolder folder;
  Chart chart;
  chart.x = {7};
  chart.panels = {{"harmonic", 1e-3, {{"harmonic", {3.0}}}}, {"zero", 0, {{"zero", {0.0}}}}};
  writeChart(folder.file("one.png"), chart);
  const Pixels one = readPicture(folder.file("one.png"));
  int blue = 0;
  for (int y = 120; y < 430; ++y)
    for (int x = 100; x < 1200; ++x) blue += isBlue(one.at(x, y));
  EXPECT_GT(blue, 15);
  chart.x = {1, 2, 3};
  chart.panels = {{"harmonic", 1e-3, {{"harmonic", {3, 3, 3}}}},
                  {"none", 0, {{"none", std::vector<double>(3, std::nan(""))}}}};
  writeChart(folder.file("flat.png"), chart);
  EXPECT_EQ(folder.count(), 2u);
}

TEST(Chart, RefusesWhatCannotBeDrawn) {
  const TemporaryFolder folder;
  const auto refused = [&](auto change) {
    Chart chart = twoPanels();
    change(chart);
    EXPECT_THROW(writeChart(folder.file("c.png"), chart), Error);
    EXPECT_EQ(folder.count(), 0u);
  };
  refused([](Chart& c) { c.x.clear(); });
  refused([](Chart& c) { c.panels.clear(); });
  refused([](Chart& c) { c.x[5] = c.x[4]; });
  refused([](Chart& c) { c.x[5] = std::nan(""); });
  refused([](Chart& c) { c.panels[1].series[0].values.pop_back(); });
  refused([](Chart& c) { c.width = 1'000'000; });
  refused([](Chart& c) { c.panelHeight = -1; });
  EXPECT_THROW(writeChart(folder.file("missing/c.png"), twoPanels()), FileError);
}

}  // namespace
}  // namespace innermap

#include "innermap/io/picture/chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <ostream>

#include "innermap/core/error.h"
#include "innermap/io/picture/detail/picture.h"
#include "innermap/io/picture/detail/stroke.h"

namespace innermap {
namespace {

constexpr Rgb kPaper{1, 1, 1}, kPanel{0.965f, 0.967f, 0.972f}, kGrid{0.87f, 0.875f, 0.885f},
    kInk{0.13f, 0.14f, 0.16f}, kFaint{0.42f, 0.44f, 0.47f}, kFrame{0.72f, 0.73f, 0.75f};
// Told apart by all common kinds of colour blindness: Okabe and Ito, "Color Universal Design"
// (2008).
constexpr Rgb kColours[] = {{0.0f, 0.447f, 0.698f},   {0.835f, 0.369f, 0.0f},
                            {0.0f, 0.620f, 0.451f},   {0.8f, 0.475f, 0.655f},
                            {0.337f, 0.706f, 0.914f}, {0.902f, 0.624f, 0.0f}};
constexpr int kColourCount = 6;
constexpr int kMargin = 28, kTitle = 76, kPanelHead = 44, kLabels = 92, kRight = 40, kFooter = 66;
constexpr double kLine = 2.4, kDot = 3.4, kRoomForDots = 11;  // pixels

struct Span {
  double lower = 0, upper = 1;
  double share(double v) const { return (v - lower) / (upper - lower); }
};

// Of the values with some room above and below; never empty.
Span spanOf(const ChartPanel& panel) {
  Span span{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (const ChartSeries& series : panel.series)
    for (const double v : series.values)
      if (std::isfinite(v)) {
        span.lower = std::min(span.lower, v);
        span.upper = std::max(span.upper, v);
      }
  if (!(span.lower <= span.upper)) return {};
  const double largest = std::max(std::abs(span.lower), std::abs(span.upper));
  // Below that, labels of four digits would all be alike.
  const double least =
      std::max({panel.leastSpan, 2e-3 * largest, std::numeric_limits<double>::min()});
  double room = 0.08 * (span.upper - span.lower);
  if (span.upper - span.lower < least) room = 0.5 * (least - (span.upper - span.lower));
  const bool positive = span.lower >= 0;
  span.lower -= room;
  span.upper += room;
  if (positive && span.lower < 0) span.lower = 0;
  return span;
}

// Where one panel's curves stand in the picture.
struct Frame {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  Span x, y;

  PicturePoint place(double px, double py) const {
    return {x0 + 0.5 + x.share(px) * (x1 - x0 - 1), y1 - 0.5 - y.share(py) * (y1 - y0 - 1)};
  }
};

bool wholeNumbers(const std::vector<double>& x) {
  return std::all_of(x.begin(), x.end(),
                     [](double v) { return std::abs(v - std::round(v)) < 1e-9; });
}

void drawGrid(const Chart& chart, const Frame& f, bool last, Picture& picture) {
  picture.fill(f.x0, f.y0, f.x1, f.y1, kPanel);
  const int lines = std::max(2, (f.y1 - f.y0) / 56);
  for (const double tick : tickValues(f.y.lower, f.y.upper, lines)) {
    const int y = static_cast<int>(std::floor(f.place(f.x.lower, tick).y));
    picture.fill(f.x0, y, f.x1, y + 1, kGrid);
    picture.text(f.x0 - 10, y + 5, shortNumber(tick), 15, kFaint, Align::right);
  }
  const bool whole = wholeNumbers(chart.x);
  for (const double tick : tickValues(f.x.lower, f.x.upper, std::max(2, (f.x1 - f.x0) / 90))) {
    if (whole && std::abs(tick - std::round(tick)) > 1e-9) continue;
    const int x = static_cast<int>(std::floor(f.place(tick, f.y.lower).x));
    picture.fill(x, f.y0, x + 1, f.y1, kGrid);
    if (!last) continue;
    picture.fill(x, f.y1, x + 1, f.y1 + 6, kInk);
    // Frame numbers are told in full, however long they are.
    picture.text(x, f.y1 + 24, whole ? fmt::format("{:.0f}", tick) : shortNumber(tick), 15, kFaint,
                 Align::centre);
  }
  picture.frame(f.x0, f.y0, f.x1, f.y1, kFrame);
}

void drawSeries(const Chart& chart, const Frame& f, const ChartSeries& series, Rgb colour,
                Picture& picture) {
  std::vector<PicturePoint> run;
  const bool dots =
      static_cast<double>(f.x1 - f.x0) > kRoomForDots * static_cast<double>(chart.x.size());
  const auto finish = [&] {
    if (!run.empty()) strokeLine(picture, run, kLine, colour);
    if (dots)
      for (const PicturePoint& p : run) strokeDot(picture, p, kDot, colour);
    run.clear();
  };
  for (std::size_t i = 0; i < chart.x.size(); ++i)
    if (std::isfinite(series.values[i]))
      run.push_back(f.place(chart.x[i], series.values[i]));
    else
      finish();
  finish();
}

// To the right above the panel.
void drawLegend(const ChartPanel& panel, const Frame& f, std::size_t firstColour,
                Picture& picture) {
  int x = f.x1;
  for (std::size_t s = panel.series.size(); s-- > 0;) {
    const int y = f.y0 - 14;
    picture.text(x, y, panel.series[s].name, 15, kInk, Align::right);
    x -= textWidth(panel.series[s].name, 15) + 10;
    const PicturePoint from{x - 26.0, y - 5.0}, to{x - 2.0, y - 5.0};
    const Rgb colour = kColours[(firstColour + s) % kColourCount];
    strokeLine(picture, {from, to}, kLine, colour);
    strokeDot(picture, {x - 14.0, y - 5.0}, kDot, colour);
    x -= 26 + 22;
  }
}

void check(const Chart& chart) {
  if (chart.width < 320 || chart.width > 8192)
    throw SettingError("width", "is out of range; give 320 to 8192 pixels");
  if (chart.panelHeight < 120 || chart.panelHeight > 4096)
    throw SettingError("panel height", "is out of range; give 120 to 4096 pixels");
  if (chart.x.empty() || chart.panels.empty()) throw DataError("the chart has nothing to show");
  for (std::size_t i = 0; i < chart.x.size(); ++i)
    if (!std::isfinite(chart.x[i]) || (i > 0 && !(chart.x[i] > chart.x[i - 1])))
      throw DataError("the chart's horizontal places do not ascend");
  for (const ChartPanel& panel : chart.panels)
    for (const ChartSeries& series : panel.series)
      if (series.values.size() != chart.x.size())
        throw DataError(fmt::format("the chart's series '{}' has {} values for {} places",
                                    series.name, series.values.size(), chart.x.size()));
}

Span horizontalSpan(const std::vector<double>& x) {
  const double room = x.size() > 1 ? 0.015 * (x.back() - x.front()) : 1;
  return {x.front() - room, x.back() + room};
}

Picture draw(const Chart& chart) {
  const int count = static_cast<int>(chart.panels.size());
  Picture picture(chart.width, kTitle + count * (kPanelHead + chart.panelHeight) + kFooter, kPaper);
  picture.text(kMargin, 38, chart.title, 24, kInk);
  picture.text(kMargin, 62, chart.subtitle, 15, kFaint);
  std::size_t colour = 0;
  for (int p = 0; p < count; ++p) {
    const ChartPanel& panel = chart.panels[static_cast<std::size_t>(p)];
    Frame f;
    f.x0 = kLabels;
    f.x1 = chart.width - kRight;
    f.y0 = kTitle + p * (kPanelHead + chart.panelHeight) + kPanelHead;
    f.y1 = f.y0 + chart.panelHeight;
    f.x = horizontalSpan(chart.x);
    f.y = spanOf(panel);
    drawGrid(chart, f, p + 1 == count, picture);
    picture.text(f.x0, f.y0 - 14, panel.label, 16, kInk);
    drawLegend(panel, f, colour, picture);
    for (const ChartSeries& series : panel.series)
      drawSeries(chart, f, series, kColours[colour++ % kColourCount], picture);
  }
  const int bottom = picture.height() - 16;
  picture.text((kLabels + chart.width - kRight) / 2, bottom, chart.xLabel, 16, kInk, Align::centre);
  picture.text(chart.width - kMargin, bottom, "innermap", 14, kFaint, Align::right);
  return picture;
}

}  // namespace

void writeChart(const std::string& path, const Chart& chart) {
  check(chart);
  draw(chart).write(path);
}

}  // namespace innermap

// Curves over a common axis as a picture: panels one above the other, with ticks, labels and
// legends.
#pragma once

#include <string>
#include <vector>

namespace innermap {

struct ChartSeries {
  std::string name;            // in the legend
  std::vector<double> values;  // #x; the curve has a gap where a value is not finite
};

struct ChartPanel {
  std::string label;     // of the vertical axis, above the panel
  double leastSpan = 0;  // the vertical axis shows at least that much; not negative
  std::vector<ChartSeries> series;
};

struct Chart {
  std::string title, subtitle;
  std::string xLabel;
  std::vector<double> x;  // ascending; finite
  std::vector<ChartPanel> panels;
  int width = 1280, panelHeight = 320;  // pixels, in [320, 8192] and [120, 4096]
};

// Writes a PNG. Curves are anti-aliased, the first six of the chart each of a colour of its own.
// Points are marked while there is room. The file appears whole or not at all.
// Throws DataError when there are no points or panels, when a series has another number of values
// than x, or x is not ascending; SettingError for sizes out of range; FileError.
void writeChart(const std::string& path, const Chart& chart);

}  // namespace innermap

// Charts as SVG: panels of curves, with linear or logarithmic axes, or of coloured cells.
#pragma once

#include <string>
#include <vector>

#include "innermap/core/matrix.h"

namespace innermap {

struct SvgSeries {
  std::string name;          // in the panel's legend
  std::vector<double> x, y;  // of one size; what is not finite, or not positive on a logarithmic
                             // axis, is a gap
  bool line = true;          // else points alone; of many points the line alone
};

struct SvgPanel {
  std::string title;
  std::string xLabel, yLabel;
  bool xLogarithmic = false, yLogarithmic = false;
  double yLeastSpan = 0;  // the vertical axis shows at least that much; not negative
  std::vector<SvgSeries> series;
  // In place of series: cells[row, column] as numbers on colours from blue to yellow, rows from
  // below. What is not finite is left blank. The colours are of the logarithms with yLogarithmic.
  std::vector<std::string> columns, rows;
  Matrix cells;
};

struct SvgChart {
  std::string title, subtitle;
  std::vector<SvgPanel> panels;
  int panelsAcross = 2;                     // in [1, 8]
  int panelWidth = 480, panelHeight = 340;  // pixels, each in [160, 4096]
};

// One element <svg>, complete in itself, of text, lines and shapes alone; marks tell their values
// when pointed at. Text is escaped. Throws DataError when there are no panels or sizes disagree,
// SettingError for sizes out of range.
std::string svgChart(const SvgChart& chart);

// The same as a file, which appears whole or not at all. Throws FileError too.
void writeChart(const std::string& path, const SvgChart& chart);

}  // namespace innermap

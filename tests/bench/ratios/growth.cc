#include "growth.h"

#include <fmt/format.h>

#include <cmath>

#include "report/svg_chart.h"

namespace innermap::bench {
namespace {

struct Curve {
  const char *by, *name;
  const char* section;
  std::size_t table;
  const char *x, *y;
  const char* fixed = nullptr;  // only rows that have the same in this column as
  bool asLast = true;           // the last row, or the first
};

constexpr Curve kCurves[] = {
    {"charges", "placing", "placing", 0, "sources", "sources s", "mesh"},
    {"charges", "solving", "solve", 0, "sources", "fit s"},
    {"charges", "fit", "solve", 0, "sources", "process s"},
    {"voxels", "map", "jobs", 0, "voxels", "process s"},
    {"voxels", "push", "transfer", 0, "voxels", "push s"},
    {"voxels", "level set", "levelset", 0, "voxels", "level set s", "triangles", false},
    {"triangles", "level set", "levelset", 0, "triangles", "level set s", "across"},
    {"triangles", "meshToVolume", "levelset", 0, "triangles", "meshToVolume s", "across"},
    {"triangles", "solid", "levelset", 0, "triangles", "solid s", "across"},
};

SvgSeries pointsOf(const Curve& curve, const Json& sections) {
  SvgSeries out;
  out.name = curve.name;
  if (!sections.contains(curve.section)) return out;
  std::vector<std::pair<double, double>> points;
  const Json& rows = sections[curve.section][curve.table]["rows"];
  const Json& like = curve.asLast ? rows.back() : rows.front();
  for (const Json& row : rows)
    if (!curve.fixed || row[curve.fixed] == like[curve.fixed])
      points.emplace_back(row[curve.x].get<double>(), row[curve.y].get<double>());
  std::sort(points.begin(), points.end());
  for (const auto& [x, y] : points) {
    out.x.push_back(x);
    out.y.push_back(y);
  }
  return out;
}

double exponentOf(const SvgSeries& series) {
  const double n = static_cast<double>(series.x.size());
  double x = 0, y = 0, xx = 0, xy = 0;
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    const double u = std::log(series.x[i]), v = std::log(series.y[i]);
    x += u;
    y += v;
    xx += u * u;
    xy += u * v;
  }
  return (n * xy - x * y) / (n * xx - x * x);
}

}  // namespace

Json growth(const Json& sections, const std::string& file) {
  Json out = Json::array();
  SvgChart chart;
  chart.title = "Seconds by size";
  chart.subtitle = "logarithmic axes; after each name the exponent of its size";
  chart.panelsAcross = 3;
  chart.panelWidth = 460;
  for (const Curve& curve : kCurves) {
    SvgSeries series = pointsOf(curve, sections);
    if (series.x.size() < 2) continue;
    const double exponent = exponentOf(series);
    out.push_back({{"what", curve.name},
                   {"by", curve.by},
                   {"from", series.x.front()},
                   {"to", series.x.back()},
                   {"exponent", exponent}});
    if (chart.panels.empty() || chart.panels.back().xLabel != curve.by) {
      SvgPanel panel;
      panel.title = std::string("By ") + curve.by;
      panel.xLabel = curve.by;
      panel.yLabel = "seconds";
      panel.xLogarithmic = panel.yLogarithmic = true;
      chart.panels.push_back(panel);
    }
    series.name += fmt::format(": {:.2f}", exponent);
    chart.panels.back().series.push_back(std::move(series));
  }
  if (!file.empty()) writeChart(file, chart);
  return out;
}

}  // namespace innermap::bench

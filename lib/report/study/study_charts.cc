#include "report/study/study_charts.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "innermap/study/study.h"

namespace innermap {
namespace {

using Rows = std::vector<StudyRow>;
using Value = std::function<double(const StudyRow&)>;
constexpr ChargePlacement kOffset = ChargePlacement::offset, kSphere = ChargePlacement::sphere;

struct Axis {
  StudyAxis axis;
  ChargePlacement placement;
  std::string label;
  bool logarithmic;
  Value value;
};

Axis chargesAxis(ChargePlacement placement = kOffset) {
  return {StudyAxis::sources, placement, "charges", true,
          [](const StudyRow& r) { return static_cast<double>(r.sources); }};
}
Axis pointsAxis() {
  return {StudyAxis::collocation, kOffset, "boundary points a charge", true,
          [](const StudyRow& r) { return r.collocation; }};
}
Axis distanceAxis() {
  return {StudyAxis::place, kOffset, "distance of the charges, fraction of the diagonal", true,
          [](const StudyRow& r) { return r.at; }};
}
Axis radiusAxis() {
  return {StudyAxis::place, kSphere, "radius of the sphere, half diagonals", true,
          [](const StudyRow& r) { return r.at; }};
}

struct Curve {
  std::string name;
  Value value;
};

// The figure of a row as a value.
Value of(double StudyRow::*figure) {
  return [figure](const StudyRow& r) { return r.*figure; };
}

SvgSeries seriesOf(const Rows& rows, const std::string& name, const Value& x, const Value& y) {
  SvgSeries out;
  out.name = name;
  for (const StudyRow& row : rows) {
    out.x.push_back(x(row));
    out.y.push_back(y(row));
  }
  return out;
}

// A panel over one axis; nothing where that was not varied.
void addPanel(SvgChart& chart, const Study& study, const std::string& title, const Axis& axis,
              const std::string& yLabel, const std::vector<Curve>& curves,
              bool yLogarithmic = true) {
  const Rows rows = studySeries(study, axis.axis, axis.placement);
  if (rows.size() < 2) return;
  SvgPanel panel;
  panel.title = title;
  panel.xLabel = axis.label;
  panel.yLabel = yLabel;
  panel.xLogarithmic = axis.logarithmic;
  panel.yLogarithmic = yLogarithmic;
  for (const Curve& curve : curves)
    panel.series.push_back(seriesOf(rows, curve.name, axis.value, curve.value));
  chart.panels.push_back(std::move(panel));
}

std::string baseText(const Study& study) { return "else " + describeRun(study.base); }

SvgChart figureFive(const Study& study) {
  SvgChart chart;
  chart.title = "C-Error by the paper's settings";
  const double vertices = static_cast<double>(study.vertices);
  Axis charges = chargesAxis(), points = pointsAxis(), distance = distanceAxis(),
       radius = radiusAxis();
  charges.label = "S-Ratio: charges per vertex";
  charges.value = [=](const StudyRow& r) { return static_cast<double>(r.sources) / vertices; };
  points.label = "C-Ratio: boundary points per vertex";
  points.value = [=](const StudyRow& r) { return static_cast<double>(r.points) / vertices; };
  distance.label = "O-Distance: of the charges, fraction of the diagonal";
  radius.label = "R-Ratio: radius of the charges' sphere, half diagonals";
  const std::vector<Curve> curve{{"", of(&StudyRow::cError)}};
  const std::string y = "C-Error: sum of squares";
  addPanel(chart, study, "(a) number of charges", charges, y, curve);
  addPanel(chart, study, "(b) number of boundary points", points, y, curve);
  addPanel(chart, study, "(c) charges on an offset", distance, y, curve);
  addPanel(chart, study, "(d) charges on a sphere", radius, y, curve);
  return chart;
}

SvgChart errors(const Study& study) {
  SvgChart chart;
  chart.title = "Errors at fresh points and at those of the fit";
  const std::vector<Curve> curves{{"fresh, rms", of(&StudyRow::rms)},
                                  {"fresh, 99%", of(&StudyRow::p99)},
                                  {"largest", of(&StudyRow::max)},
                                  {"fit's own, rms", of(&StudyRow::collocationRms)}};
  const std::string y = "fraction of the diagonal";
  addPanel(chart, study, "number of charges", chargesAxis(), y, curves);
  addPanel(chart, study, "boundary points", pointsAxis(), y, curves);
  addPanel(chart, study, "charges on an offset", distanceAxis(), y, curves);
  addPanel(chart, study, "charges on a sphere", radiusAxis(), y, curves);
  return chart;
}

SvgChart stability(const Study& study) {
  SvgChart chart;
  chart.title = "Stability";
  const std::vector<Curve> sizes{{"weights' size", of(&StudyRow::weights)},
                                 {"condition", of(&StudyRow::condition)}};
  const std::vector<Curve> ratio{{"", [](const StudyRow& r) { return r.rms / r.collocationRms; }}};
  const std::vector<Curve> folded{{"", [](const StudyRow& r) { return 100 * r.folded; }}};
  addPanel(chart, study, "charges on an offset", distanceAxis(), "dimensionless", sizes);
  addPanel(chart, study, "charges on a sphere", radiusAxis(), "dimensionless", sizes);
  const std::string y = "error at fresh points / at the fit's own";
  addPanel(chart, study, "error between the fit's points: distance", distanceAxis(), y, ratio);
  addPanel(chart, study, "error between the fit's points: boundary points", pointsAxis(), y, ratio);
  addPanel(chart, study, "folds: distance", distanceAxis(), "% of the volume folded", folded,
           false);
  addPanel(chart, study, "folds: number of charges", chargesAxis(), "% of the volume folded",
           folded, false);
  return chart;
}

SvgChart energies(const Study& study) {
  SvgChart chart;
  chart.title = "Energies";
  const std::vector<Curve> harmonic{{"", of(&StudyRow::harmonicEnergy)}},
      deformation{{"", of(&StudyRow::deformationEnergy)}};
  for (const Axis& axis : {chargesAxis(), distanceAxis(), radiusAxis()}) {
    const std::string varied = axis.axis == StudyAxis::sources ? "number of charges"
                               : axis.placement == kSphere     ? "charges on a sphere"
                                                               : "charges on an offset";
    addPanel(chart, study, "harmonic energy (3: rigid): " + varied, axis, "unit volumes", harmonic,
             false);
    addPanel(chart, study, "deformation energy (0: rigid): " + varied, axis, "mean density",
             deformation);
  }
  return chart;
}

SvgChart cost(const Study& study) {
  SvgChart chart;
  chart.title = "Error against time";
  chart.panelWidth = 900;
  chart.panelHeight = 480;
  SvgPanel panel;
  panel.title = "all runs";
  panel.xLabel = "seconds of placing points and solving";
  panel.yLabel = "error at 99% of the fresh points, fraction of the diagonal";
  panel.xLogarithmic = panel.yLogarithmic = true;
  for (const auto& [placement, name] :
       {std::pair(kOffset, "offset"), std::pair(kSphere, "sphere")}) {
    Rows rows;
    for (const StudyRow& row : study.rows)
      if (row.placement == placement && row.failure.empty()) rows.push_back(row);
    if (rows.empty()) continue;
    panel.series.push_back(seriesOf(rows, name, of(&StudyRow::seconds), of(&StudyRow::p99)));
    panel.series.back().line = false;
  }
  if (!panel.series.empty()) chart.panels.push_back(std::move(panel));
  return chart;
}

// The errors of each two settings, the third at its base.
void addCells(SvgChart& chart, const Study& study, const std::string& title, const Axis& across,
              const Axis& up) {
  const StudyRun& base = across.placement == kSphere ? study.baseSphere : study.base;
  Rows rows;
  std::vector<double> xs, ys;
  for (const StudyRow& row : study.rows) {
    if (row.placement != across.placement || !row.failure.empty()) continue;
    StudyRun wanted = base;
    for (const Axis* axis : {&across, &up}) {
      if (axis->axis == StudyAxis::sources) wanted.sources = row.sources;
      if (axis->axis == StudyAxis::collocation) wanted.collocation = row.collocation;
      if (axis->axis == StudyAxis::place) wanted.at = row.at;
    }
    if (!sameRun(row, wanted)) continue;
    rows.push_back(row);
    xs.push_back(across.value(row));
    ys.push_back(up.value(row));
  }
  for (std::vector<double>* list : {&xs, &ys}) {
    std::sort(list->begin(), list->end());
    list->erase(std::unique(list->begin(), list->end()), list->end());
  }
  // Only a line of each: no grid was made.
  if (xs.size() < 2 || ys.size() < 2 || rows.size() < xs.size() + ys.size()) return;
  SvgPanel panel;
  panel.title = title;
  panel.xLabel = across.label;
  panel.yLabel = up.label;
  panel.yLogarithmic = true;
  panel.cells = Matrix(ys.size(), xs.size());
  std::fill_n(panel.cells.data(), xs.size() * ys.size(), StudyRow::kNone);
  for (const double x : xs) panel.columns.push_back(fmt::format("{:.3g}", x));
  for (const double y : ys) panel.rows.push_back(fmt::format("{:.4g}", y));
  const auto place = [](const std::vector<double>& list, double value) {
    return static_cast<std::size_t>(std::lower_bound(list.begin(), list.end(), value) -
                                    list.begin());
  };
  for (const StudyRow& row : rows)
    panel.cells(place(ys, up.value(row)), place(xs, across.value(row))) = row.rms;
  chart.panels.push_back(std::move(panel));
}

SvgChart grid(const Study& study) {
  SvgChart chart;
  chart.title = "Error at fresh points (rms), each two settings together";
  chart.panelWidth = 640;
  addCells(chart, study, "charges on an offset: distance, number", distanceAxis(), chargesAxis());
  addCells(chart, study, "charges on a sphere: radius, number", radiusAxis(), chargesAxis(kSphere));
  addCells(chart, study, "boundary points a charge, number of charges", pointsAxis(),
           chargesAxis());
  addCells(chart, study, "distance, boundary points a charge", distanceAxis(), pointsAxis());
  return chart;
}

}  // namespace

std::vector<std::string> studyChartNames() {
  return {"figure5.svg", "errors.svg", "stability.svg", "energies.svg", "cost.svg", "grid.svg"};
}

std::vector<StudyChart> studyCharts(const Study& study, const std::string& subtitle) {
  std::vector<StudyChart> all{
      {"figure5.svg",
       "The paper's measure: the sum of squared errors at the points of the fit. It grows with "
       "their number, as (b) shows, and (a) too, since each charge has its points.",
       figureFive(study)},
      {"errors.svg",
       "The error between the fit's points decides. If it is larger than the fit's own error, the "
       "fit swings between its points.",
       errors(study)},
      {"stability.svg",
       "Large weights cancel each other and cost digits. The C-Error hides errors between the "
       "fit's points.",
       stability(study)},
      {"energies.svg", "What the settings do to the energies, taken from voxels.", energies(study)},
      {"cost.svg", "The lower left is best.", cost(study)},
      {"grid.svg", "Dark is good.", grid(study)}};
  std::vector<StudyChart> out;
  for (StudyChart& c : all) {
    if (c.chart.panels.empty()) continue;
    c.chart.subtitle = subtitle + (c.file == "cost.svg" ? "" : "; " + baseText(study));
    out.push_back(std::move(c));
  }
  return out;
}

}  // namespace innermap

// `innermap compare-fem`: charges beside linear finite elements.
#include "innermap/tetra/compare_fem.h"

#include <fmt/format.h>
#include <openvdb/tools/Interpolation.h>

#include <algorithm>
#include <cmath>

#include "commands.h"
#include "innermap/evaluate/evaluate_map.h"
#include "innermap/io/solid_pictures.h"
#include "innermap/levelset/level_set.h"
#include "innermap/mesh/mesh_file.h"
#include "inputs.h"
#include "jobs/tetra/cell_needs.h"
#include "lists.h"
#include "report/figures.h"
#include "report/svg_chart.h"
#include "report/table.h"
#include "section_options.h"

namespace innermap::tool {
namespace {

struct CompareOptions {
  std::string source, target, output;
  bool functions = false;
  std::string resolutions = "16,32,64", charges = "250,500,1000", tolerances = "4e-3,1e-3,4e-4";
  CompareFemSettings settings;
  SectionOptions cut;
};

std::vector<double> numbers(const std::string& option, const std::string& list) {
  const std::size_t count = commaList(list).size();
  if (count == 0) throw UsageError(option + ": give one number at least");
  return parseNumbers(option, list, count, "a list of numbers");
}

CompareFemSettings settingsOf(const CompareOptions& options) {
  CompareFemSettings settings = options.settings;
  settings.resolutions.clear();
  for (const double n : numbers("--resolutions", options.resolutions))
    settings.resolutions.push_back(static_cast<int>(std::clamp(n, -1.0, 1e6)));
  settings.charges.clear();
  for (const double n : numbers("--charges", options.charges))
    settings.charges.push_back(static_cast<std::size_t>(std::clamp(n, 0.0, 1e9)));
  settings.tolerances = numbers("--tolerances", options.tolerances);
  return settings;
}

std::string nameOf(const ComparedRow& row) {
  return row.charges ? fmt::format("{} charges", row.size) : fmt::format("{} tets", row.size);
}

// A method's rows whose error is known, by seconds.
std::vector<const ComparedRow*> rowsOf(const CompareFem& result, bool charges,
                                       double ComparedRow::*error) {
  std::vector<const ComparedRow*> rows;
  for (const ComparedRow& r : result.rows)
    if (r.charges == charges && r.*error > 0) rows.push_back(&r);
  std::sort(rows.begin(), rows.end(),
            [](const ComparedRow* a, const ComparedRow* b) { return a->seconds < b->seconds; });
  return rows;
}

// A method's error after so many seconds: between those measured by straight lines of logarithms,
// after the last as that; NaN before the first.
double errorAfter(const CompareFem& result, bool charges, double ComparedRow::*error,
                  double seconds) {
  const ComparedRow* before = nullptr;
  for (const ComparedRow* row : rowsOf(result, charges, error)) {
    if (row->seconds <= seconds) {
      before = row;
      continue;
    }
    if (!before) return kUnknown;
    const double share =
        std::log(seconds / before->seconds) / std::log(row->seconds / before->seconds);
    return before->*error * std::pow(row->*error / before->*error, share);
  }
  return before ? before->*error : kUnknown;
}

// The other method at the same time.
std::string atEqualTime(const CompareFem& result, const ComparedRow& row) {
  const double value = errorAfter(result, !row.charges, &ComparedRow::value, row.seconds),
               gradient = errorAfter(result, !row.charges, &ComparedRow::gradient, row.seconds);
  const std::string other = row.charges ? "finite elements" : "charges";
  if (!std::isfinite(value)) return "there are no " + other + " yet";
  return fmt::format("{} have {:.2g} times its error in values, {:.2g} times that in gradients",
                     other, value / row.value, gradient / row.gradient);
}

void printTable(const CompareFem& result, bool map, Context& context) {
  context.print(fmt::format("{:>18} {:>8} {:>9} {:>9} {:>9} {:>9} {:>8}{}\n", "", "seconds",
                            "memory", "value", "gradient", "largest", "jump",
                            map ? "  harmonic  deformation   folded inverted" : ""));
  for (const ComparedRow& r : result.rows) {
    const auto error = [](double v) { return std::isfinite(v) ? fmt::format("{:.2e}", v) : "-"; };
    context.print(fmt::format("{:>18} {:>8.2f} {:>9} {:>9} {:>9} {:>9} {:>8.3f}", nameOf(r),
                              r.seconds, formatBytes(r.memory), error(r.value), error(r.gradient),
                              error(r.largest), r.jump));
    if (map)
      context.print(fmt::format("  {:>8.4f}  {:>11.5f} {:>7.3f}% {:>8}", r.harmonicEnergy,
                                r.deformationEnergy, 100 * r.folded,
                                r.charges ? "-" : std::to_string(r.inverted)));
    context.print("\n");
  }
  if (result.rows.size() > 1 && std::isfinite(result.valueOrder))
    context.print(
        fmt::format("finite elements converge with order {:.2f} (values) and {:.2f} "
                    "(gradients)\n",
                    result.valueOrder, result.gradientOrder));
  for (const ComparedRow& r : result.rows)
    if (r.value > 0)
      context.print(fmt::format("after the {:.2f} s of {} {}\n", r.seconds, nameOf(r),
                                atEqualTime(result, r)));
}

SvgChart chartOf(const CompareFem& result, const CompareOptions& options) {
  SvgChart chart;
  chart.title = "Error against time";
  chart.subtitle = options.functions ? "known harmonic functions in " + options.source
                                     : options.source + " to " + options.target;
  for (const auto& [label, error] :
       {std::pair("values", &ComparedRow::value), std::pair("gradients", &ComparedRow::gradient)}) {
    SvgPanel panel;
    panel.title = std::string("error of ") + label;
    panel.xLabel = "seconds";
    panel.xLogarithmic = panel.yLogarithmic = true;
    for (const bool charges : {false, true}) {
      SvgSeries series;
      series.name = charges ? "charges" : "finite elements";
      for (const ComparedRow* row : rowsOf(result, charges, error)) {
        series.x.push_back(row->seconds);
        series.y.push_back(row->*error);
      }
      panel.series.push_back(series);
    }
    chart.panels.push_back(panel);
  }
  return chart;
}

// |gradient|^2, of three functions the sum, in the middle's size.
void writeSection(const std::string& path, const CompareFem& result, const Solid& solid,
                  const CompareOptions& options) {
  LevelSetSettings grid;
  grid.resolution = 256;
  const openvdb::FloatGrid::Ptr distance = makeLevelSet(solid, grid);
  const auto density = [distance](const InsideFunction& function) {
    return [distance, function](const Points& points) {
      const openvdb::tools::GridSampler<openvdb::FloatGrid, openvdb::tools::BoxSampler> sampler(
          *distance);
      Points shown;
      std::vector<std::size_t> place;
      for (std::size_t i = 0; i < points.size(); ++i) {
        if (!(sampler.wsSample({points[i].x, points[i].y, points[i].z}) < 0)) continue;
        shown.push_back(points[i]);
        place.push_back(i);
      }
      std::vector<double> out(points.size(), kUnknown);
      const std::vector<InsideValues> inside = function(shown);
      for (std::size_t i = 0; i < inside.size(); ++i) {
        double sum = 0;
        for (const double g : inside[i].gradient) sum += g * g;
        out[place[i]] = sum;
      }
      return out;
    };
  };
  const ComparedRow *elements = nullptr, *charges = nullptr;
  for (const ComparedRow& r : result.rows) (r.charges ? charges : elements) = &r;
  std::vector<PlaneFunction> functions;
  functions.push_back({nameOf(result.rows.front()), density(result.rows.front().function)});
  if (elements != &result.rows.front())
    functions.push_back({nameOf(*elements), density(elements->function)});
  if (charges) functions.push_back({nameOf(*charges), density(charges->function)});
  // The range of what the last one has on the plane.
  Points probe;
  const Box3& box = solid.box();
  for (int i = 0; i < 64; ++i)
    for (int j = 0; j < 64; ++j) {
      Vec3 p;
      p[options.cut.axis()] =
          box.lower[options.cut.axis()] + options.cut.at() * box.extent()[options.cut.axis()];
      for (int k = 1; k < 3; ++k) {
        const int a = (options.cut.axis() + k) % 3;
        p[a] = box.lower[a] + ((k == 1 ? i : j) + 0.5) / 64 * box.extent()[a];
      }
      probe.push_back(p);
    }
  std::vector<double> values = functions.back().values(probe);
  values.erase(
      std::remove_if(values.begin(), values.end(), [](double v) { return !std::isfinite(v); }),
      values.end());
  std::sort(values.begin(), values.end());
  PlanePictureSettings settings;
  settings.colormap = options.cut.colormap;
  settings.axis = options.cut.axis();
  settings.at = options.cut.at();
  if (!values.empty()) {
    settings.blue = values[values.size() / 100];
    settings.red = std::max(values[values.size() - 1 - values.size() / 100],
                            settings.blue + 1e-9 * std::max(1.0, std::abs(settings.blue)));
  }
  settings.caption = fmt::format("energy density |gradient|^2: blue {:.3g}, red {:.3g}",
                                 settings.blue, settings.red);
  writePlanePicture(path, box, functions, settings);
}

void run(const CompareOptions& options, Context& context) {
  if (options.functions != options.target.empty())
    throw UsageError("give a TARGET to compare on its map, or --functions (not both)");
  const auto folder = context.outputFolder(
      options.output, {"comparison.csv", "curves.svg", "section.png", "report.json"});
  const CompareFemSettings settings = settingsOf(options);
  const Mesh source = readMeshFile(options.source, context);
  std::optional<BoundaryPair> pair;
  std::optional<Solid> alone;
  if (options.functions) {
    alone = context.timed("solid", [&] { return Solid(source); });
  } else {
    requireMeshMemory(options.target, context);
    const Mesh target = context.timed("read", [&] { return readMeshLike(options.target, source); });
    pair = makeBoundaryPair(source, target);
    context.tell(*pair);
  }
  const Solid& solid = pair ? pair->solid() : *alone;
  if (!context.begins(
          {fmt::format("compare finite elements at resolutions {} with charges",
                       options.resolutions),
           "write comparison.csv, curves.svg, section.png and report.json to " + options.output},
          compareFemNeed(solid, settings, pair ? source.vertices.size() : 0)))
    return;
  const CompareFem result = context.timed("compare", [&] {
    return pair ? compareFemOnMap(*pair, settings) : compareFemOnFunctions(solid, settings);
  });
  for (const std::string& note : result.notes) context.note(note);
  printTable(result, pair.has_value(), context);
  context.report().add("comparison", figures(result));
  context.timed("write", [&] {
    folder->write("comparison.csv",
                  [&](const std::string& path) { writeTable(path, rowFigures(result)); });
    folder->write("curves.svg",
                  [&](const std::string& path) { writeChart(path, chartOf(result, options)); });
    folder->write("section.png",
                  [&](const std::string& path) { writeSection(path, result, solid, options); });
  });
  context.finish(*folder);
}

}  // namespace

Command makeCompareFemCommand() {
  auto o = std::make_shared<CompareOptions>();
  Command c("compare-fem", "Compare maps by charges with maps by finite elements");
  c.description(
      "Maps the inside of SOURCE onto that of TARGET (of the same connectivity) in two ways: by "
      "linear finite elements on tetrahedra of several sizes (conjugate gradients with an "
      "incomplete Cholesky factor), and by charges to several tolerances. Both use the same "
      "boundary map, and one harmonic map, not steps. Errors are differences from a finer fit of "
      "charges, in fractions of TARGET's diagonal (values) and relative (gradients). With "
      "--functions it solves for three known harmonic functions instead; errors are then relative, "
      "for the worst of the three. Seconds are wall time from the solid to the function; memory is "
      "the need of each method. Writes comparison.csv, curves.svg, section.png and report.json.");
  c.positional("SOURCE", &o->source, "mesh file: .obj, .ply, .off or .stl");
  c.positional("TARGET", &o->target, "a pose of SOURCE; not with --functions").optional();
  c.outputFolder(&o->output);
  c.flag("--functions", &o->functions, "compare on known harmonic functions in SOURCE");
  c.option("--resolutions", "LIST", &o->resolutions,
           "cells of the tetrahedra's lattice along the longest side, each from 4 to 1024, "
           "ascending");
  c.option("--charges", "LIST", &o->charges, "with --functions: numbers of charges, 16 to 20000");
  c.option(
      "--tolerances", "LIST", &o->tolerances,
      "for a map: tolerances of the fits of charges, fractions of TARGET's diagonal, 1e-12 to 1");
  c.settings(describe(o->settings));
  addCut(c, o->cut);
  c.example("innermap compare-fem spot.obj --functions -o spot-fem");
  c.example("innermap compare-fem rest.obj pose.obj -o pose-fem --resolutions 24,48,96");
  return c.running(o, run);
}

}  // namespace innermap::tool

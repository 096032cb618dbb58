#include "innermap/tetra/compare_fem.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>

#include "core/random.h"
#include "core/require_number.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "innermap/evaluate/evaluate_map.h"
#include "innermap/fit/surface_problem.h"
#include "innermap/tetra/tetrahedralize.h"
#include "tetra/detail/elements.h"

namespace innermap {
namespace {

class Watch {
 public:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

// What both methods are given, and how their errors are told.
struct Task {
  const Solid& solid;
  // The values at a vertex of the tetrahedra's boundary.
  std::function<Vec3(const Vec3&)> boundary;
  InsideFunction exact;
  double unit = 0;   // of values' errors; 0: each channel its own size
  double scale = 1;  // of gradients, for energies of unit volumes
  bool map = false;
};

struct Samples {
  Points points;
  std::vector<InsideValues> exact;
};

// Uniform by volume, in the cells.
Points pointsInside(const CellMesh& mesh, std::size_t count, std::uint64_t seed) {
  std::vector<double> upTo(mesh.tetrahedra.size());
  double sum = 0;
  for (std::size_t t = 0; t < upTo.size(); ++t)
    upTo[t] = sum += signedVolume(mesh.vertices, mesh.tetrahedra[t]);
  const CounterRandom numbers(seed, 0x7e7a);
  Points points(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto random = [&](std::uint64_t k) { return numbers.uniform(4 * i + k); };
    const std::size_t t = std::min<std::size_t>(
        static_cast<std::size_t>(std::lower_bound(upTo.begin(), upTo.end(), random(0) * sum) -
                                 upTo.begin()),
        upTo.size() - 1);
    std::array<double, 5> cut{0, random(1), random(2), random(3), 1};
    std::sort(cut.begin(), cut.end());
    for (int k = 0; k < 4; ++k)
      points[i] += (cut[k + 1] - cut[k]) * mesh.vertices[mesh.tetrahedra[t][k]];
  }
  return points;
}

Mat3 jacobianOf(const std::array<double, 9>& g) {
  return {{{g[0], g[1], g[2]}, {g[3], g[4], g[5]}, {g[6], g[7], g[8]}}};
}

void measure(const Task& task, const Samples& samples, ComparedRow& row) {
  const std::vector<InsideValues> found = row.function(samples.points);
  Vec3 valueErrors, values, gradientErrors, gradients, largest, extent;
  double harmonic = 0, deformation = 0;
  std::size_t folded = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      const double error = found[i].value[k] - samples.exact[i].value[k];
      valueErrors[k] += error * error;
      values[k] += samples.exact[i].value[k] * samples.exact[i].value[k];
      largest[k] = std::max(largest[k], std::abs(error));
      extent[k] = std::max(extent[k], std::abs(samples.exact[i].value[k]));
      for (int a = 0; a < 3; ++a) {
        const double g = samples.exact[i].gradient[3 * k + a];
        gradientErrors[k] += std::pow(found[i].gradient[3 * k + a] - g, 2);
        gradients[k] += g * g;
      }
    }
    Mat3 jacobian = jacobianOf(found[i].gradient);
    folded += !(determinant(jacobian) > 0);
    for (auto& r : jacobian)
      for (double& v : r) v *= task.scale;
    harmonic += harmonicEnergyDensity(jacobian);
    deformation += deformationEnergyDensity(jacobian);
  }
  const auto count = static_cast<double>(found.size());
  row.gradient = relativeError(gradientErrors, gradients, task.map);
  if (task.map) {
    row.value = std::sqrt((valueErrors.x + valueErrors.y + valueErrors.z) / count) / task.unit;
    row.largest = norm(largest) / task.unit;
    row.harmonicEnergy = harmonic / count;
    row.deformationEnergy = deformation / count;
    row.folded = static_cast<double>(folded) / count;
  } else {
    row.value = relativeError(valueErrors, values, false);
    row.largest = std::max({largest.x / extent.x, largest.y / extent.y, largest.z / extent.z});
  }
}

InsideFunction functionOf(std::shared_ptr<const FiniteElements> e) {
  return [e](const Points& points) {
    std::vector<InsideValues> out(points.size());
    parallelBlocks(points.size(), 256, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const CellPoint at = e->locator->locate(points[i]);
        for (int c = 0; c < 4; ++c)
          for (int k = 0; k < 3; ++k)
            out[i].value[k] += at.barycentric[c] * e->values(e->mesh.tetrahedra[at.tetrahedron][c],
                                                             static_cast<std::size_t>(k));
        out[i].gradient = gradientIn(*e, at.tetrahedron);
      }
    });
    return out;
  };
}

std::vector<InsideValues> insideValues(const FieldSamples& samples, std::size_t count) {
  std::vector<InsideValues> out(count);
  for (std::size_t i = 0; i < count; ++i)
    for (int k = 0; k < 3; ++k) {
      out[i].value[k] = samples.values(i, static_cast<std::size_t>(k));
      for (int a = 0; a < 3; ++a)
        out[i].gradient[3 * k + a] = samples.gradients(i, static_cast<std::size_t>(3 * k + a));
    }
  return out;
}

template <class Field>
InsideFunction functionOf(const Field& field, double accuracy) {
  return [field, accuracy](const Points& points) {
    EvaluateFieldSettings evaluate;
    evaluate.accuracy = accuracy;
    evaluate.gradients = true;
    return insideValues(field.evaluate(points, evaluate), points.size());
  };
}

void checkSettings(const CompareFemSettings& settings) {
  if (settings.resolutions.empty() ||
      !std::is_sorted(settings.resolutions.begin(), settings.resolutions.end()) ||
      settings.resolutions.front() < 4 || settings.resolutions.back() > 1024)
    throw SettingError("resolutions", "must ascend, from 4 to 1024");
  for (const std::size_t n : settings.charges) requireNumber("charges", n, {16, 20000});
  for (const double t : settings.tolerances)
    requireNumber("tolerances", t, {kSmallestTolerance, 1});
  requireDescribed(settings);
}

// Rows of the finite elements; the points are in the finest mesh.
Samples compareElements(const Task& task, const CompareFemSettings& settings, CompareFem& result) {
  std::vector<std::shared_ptr<const FiniteElements>> all;
  for (const int resolution : settings.resolutions) {
    ElementsSettings solving;
    solving.resolution = resolution;
    const auto elements =
        std::make_shared<const FiniteElements>(solveElements(task.solid, task.boundary, solving));
    ComparedRow row;
    row.size = elements->mesh.tetrahedra.size();
    row.edge = elements->edge;
    row.unknowns = elements->unknowns;
    row.iterations = elements->iterations;
    row.seconds = elements->seconds;
    row.memory = elements->memory;
    row.jump = jumpOf(*elements, task.map);
    if (task.map)
      for (std::size_t t = 0; t < elements->mesh.tetrahedra.size(); ++t)
        row.inverted += !(determinant(jacobianOf(gradientIn(*elements, static_cast<int>(t)))) > 0);
    row.function = functionOf(elements);
    result.rows.push_back(std::move(row));
    all.push_back(elements);
  }
  Samples samples;
  samples.points = pointsInside(all.back()->mesh, settings.samples, settings.seed);
  samples.exact = task.exact(samples.points);
  for (ComparedRow& row : result.rows) measure(task, samples, row);
  if (result.rows.size() > 1) {
    const ComparedRow &coarse = result.rows[result.rows.size() - 2], &fine = result.rows.back();
    const double finer = std::log(coarse.edge / fine.edge);
    result.valueOrder = std::log(coarse.value / fine.value) / finer;
    result.gradientOrder = std::log(coarse.gradient / fine.gradient) / finer;
  }
  return samples;
}

}  // namespace

CompareFem compareFemOnFunctions(const Solid& solid, const CompareFemSettings& settings) {
  checkSettings(settings);
  const Vec3 e = solid.box().extent(), origin = solid.box().lower;
  const double size = std::max({e.x, e.y, e.z});
  // Outside the box, and so outside the solid.
  const Vec3 charge = Vec3{e.x / size + 0.1, 0.5 * e.y / size, 0.5 * e.z / size};
  const auto exactAt = [=](const Vec3& world) {
    const Vec3 p = (world - origin) / size, r = p - charge;
    const double d = norm(r), grown = std::exp(4 * p.x);
    InsideValues v;
    v.value = {p.x * p.x - p.y * p.y, grown * std::sin(4 * p.y), 0.1 / d};
    v.gradient = {2 * p.x,
                  -2 * p.y,
                  0,
                  4 * v.value.y,
                  4 * grown * std::cos(4 * p.y),
                  0,
                  -0.1 * r.x / (d * d * d),
                  -0.1 * r.y / (d * d * d),
                  -0.1 * r.z / (d * d * d)};
    for (double& g : v.gradient) g /= size;
    return v;
  };
  Task task{solid, [=](const Vec3& p) { return exactAt(p).value; },
            [=](const Points& points) {
              std::vector<InsideValues> out;
              for (const Vec3& p : points) out.push_back(exactAt(p));
              return out;
            }};
  CompareFem result;
  const Samples samples = compareElements(task, settings, result);
  for (const std::size_t count : settings.charges) {
    ComparedRow row;
    const Watch watch;
    SurfaceProblemSettings problem;
    problem.collocation = 4 * count;
    problem.heldOut = std::max<std::size_t>(500, count / 2);
    problem.seed = settings.seed;
    const SurfaceValues values = [&](const std::vector<SurfacePoint>& at) {
      Matrix m(at.size(), 3);
      for (std::size_t i = 0; i < at.size(); ++i) {
        const Vec3 v = exactAt(positionOf(solid.surface(), at[i])).value;
        for (int k = 0; k < 3; ++k) m(i, static_cast<std::size_t>(k)) = v[k];
      }
      return m;
    };
    FitSettings fitting;
    fitting.sources = count;
    fitting.interpolation = Interpolation::linear;  // the values are exact between vertices too
    const FitResult fit = fitField(surfaceProblem(solid, values, problem), fitting);
    row.seconds = watch.seconds();
    row.charges = true;
    row.size = row.unknowns = fit.field.sources().size();
    row.memory = fitMemory(problem.collocation, count, problem.heldOut, FitSolver::automatic);
    row.function = functionOf(fit.field, 0);
    measure(task, samples, row);
    result.rows.push_back(std::move(row));
  }
  return result;
}

CompareFem compareFemOnMap(const BoundaryPair& pair, const CompareFemSettings& settings) {
  checkSettings(settings);
  const Solid& solid = pair.solid();
  FitMapSettings fitting;
  fitting.oneToOne = OneToOne::off;
  fitting.interpolation = Interpolation::linear;
  fitting.seed = settings.seed;
  fitting.tolerance = settings.referenceTolerance;
  const Watch watch;
  const MapFit reference = fitMap(pair, fitting);
  CompareFem result;
  result.referenceSeconds = watch.seconds();
  result.referenceRms = reference.error.rms;
  const double diagonal = pair.target.diagonal;
  const InsideFunction exact = functionOf(reference.map, 1e-8 * diagonal);
  Task task{solid,
            [&](const Vec3& p) {
              const auto at = solid.closest(p, std::numeric_limits<double>::infinity());
              const Matrix m = pair.targetsOf({at.onSurface});
              return Vec3{m(0, 0), m(0, 1), m(0, 2)};
            },
            exact};
  task.unit = diagonal;
  task.map = true;
  if (pair.target.volume > 0) task.scale = std::cbrt(solid.volume() / pair.target.volume);
  const Samples samples = compareElements(task, settings, result);
  for (const double tolerance : settings.tolerances) {
    fitting.tolerance = tolerance;
    const MapFit fit = fitMap(pair, fitting);
    if (result.rows.back().charges && result.rows.back().size == fit.map.sources()) {
      result.notes.push_back(
          fmt::format("a tolerance of {:g} takes no more charges than the one before", tolerance));
      continue;
    }
    ComparedRow row;
    for (const auto& [stage, seconds] : fit.seconds)
      if (stage == "sample" || stage == "fit") row.seconds += seconds;
    row.charges = true;
    row.size = row.unknowns = fit.map.sources();
    row.memory = fitMemory(fit.solve.collocation, fit.solve.sources, fit.solve.heldOut,
                           FitSolver::iterative);
    row.boundaryRms = fit.error.rms;
    row.function = functionOf(fit.map, 1e-8 * diagonal);
    measure(task, samples, row);
    if (row.size == reference.map.sources())  // it is the reference itself
      row.value = row.gradient = row.largest = kUnknown;
    result.rows.push_back(std::move(row));
  }
  result.notes.push_back(fmt::format(
      "errors are differences from a fit of charges with a boundary error of rms {:.2e}: that "
      "favours charges, and differences below about twice that say little",
      result.referenceRms));
  return result;
}

std::uint64_t compareFemMemory(const Solid& solid, const CompareFemSettings& settings) {
  checkSettings(settings);
  // Of a tetrahedron: itself, and the search for points in it. All meshes are kept for the
  // pictures; while the finest is solved it has no search yet.
  constexpr std::uint64_t kBytesACell = 16 + 150;
  TetrahedralizeSettings cells;
  std::uint64_t coarser = 0, finest = 0;
  for (const int resolution : settings.resolutions) {
    cells.resolution = resolution;
    const StuffingNeed need = tetrahedralizeNeed(solid, cells);
    coarser += finest;
    finest = need.tetrahedra * kBytesACell + need.vertices * 48;
    if (resolution == settings.resolutions.back())
      finest =
          std::max({finest, need.memory,
                    need.tetrahedra * 16 + harmonicCellsMemory(need.vertices, need.tetrahedra)});
  }
  constexpr std::uint64_t kPicture = 170'000'000;
  return coarser + finest + finest / 8 + kPicture;
}

std::vector<Setting> describe(CompareFemSettings& s) {
  return {Setting("reference", "T", &s.referenceTolerance,
                  "tolerance of the fit that maps are compared with")
              .in("fraction of the target's diagonal")
              .from(kSmallestTolerance, 1)
              .rare(),
          Setting("samples", "N", &s.samples, "points inside at which errors are measured")
              .from(100, 1e6)
              .rare(),
          seedSetting(&s.seed)};
}

}  // namespace innermap

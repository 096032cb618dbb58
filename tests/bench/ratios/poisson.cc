// OpenVDB's own way to a harmonic function inside a solid, finite differences and conjugate
// gradients with incomplete Cholesky, beside fitting and evaluating a field of charges.
#include <openvdb/openvdb.h>
#include <openvdb/tools/PoissonSolver.h>

#include <cmath>

#include "evaluate/active_region.h"
#include "innermap/evaluate/evaluate_map.h"
#include "innermap/field/fit.h"
#include "innermap/levelset/level_set.h"
#include "innermap/mesh/mesh_file.h"
#include "sample/source_points.h"
#include "sample/surface_samples.h"
#include "section.h"

namespace innermap::bench {
namespace {

using openvdb::Coord;
using openvdb::FloatTree;
namespace pcg = openvdb::math::pcg;
namespace poisson = openvdb::tools::poisson;

constexpr std::size_t kSources = 500, kPointsPerSource = 4;
constexpr double kResidual = 1e-5;  // OpenVDB's relative one: less changes its error no more

// Three harmonic functions, about the centre in units of half the diagonal.
struct Known {
  Vec3 center;
  double unit = 1;

  explicit Known(const Solid& solid) : center(solid.box().center()), unit(0.5 * solid.diagonal()) {}

  Vec3 operator()(const Vec3& p) const {
    const Vec3 q = (p - center) / unit;
    return {q.x * q.x - q.y * q.y, q.x * q.y, q.x + 2 * q.y * q.z};
  }
};

struct Setting {
  const Solid& solid;
  const openvdb::FloatGrid& levelSet;
  const openvdb::MaskGrid& interior;
  Known known;

  Vec3 place(const Coord& ijk) const {
    const openvdb::Vec3d p = levelSet.transform().indexToWorld(ijk);
    return {p.x(), p.y(), p.z()};
  }
};

// Where the boundary stands between a voxel and its neighbour outside. Staircase: at the
// neighbour's centre, with the value at its closest surface point, as the solver's own interface
// suggests. Cut: where the distance changes sign, with the weights of the ghost-fluid method
// (Gibou, Fedkiw, Cheng, Kang, "A Second-Order-Accurate Symmetric Discretization of the Poisson
// Equation on Irregular Domains", J. Comput. Phys. 2002).
enum class Boundary { staircase, cut };

class BoundaryValues {
 public:
  BoundaryValues(const Setting& setting, Boundary boundary, int channel)
      : setting_(setting), boundary_(boundary), channel_(channel) {}

  void operator()(const Coord& voxel, const Coord& neighbour, double& source,
                  double& diagonal) const {
    const Vec3 to = setting_.place(neighbour);
    if (boundary_ == Boundary::staircase) {
      diagonal -= 1;
      source -= valueNear(to);
      return;
    }
    const double inside = setting_.levelSet.tree().getValue(voxel),
                 outside = setting_.levelSet.tree().getValue(neighbour);
    const double share = std::max(1e-3, inside / (inside - outside));
    const Vec3 from = setting_.place(voxel);
    diagonal -= 1 / share;
    source -= valueNear(from + share * (to - from)) / share;
  }

 private:
  double valueNear(const Vec3& p) const {
    return setting_.known(
        setting_.solid.closest(p, std::numeric_limits<double>::infinity()).position)[channel_];
  }

  const Setting& setting_;
  Boundary boundary_;
  int channel_;
};

struct Errors {
  double sum = 0, max = 0;
  std::size_t count = 0;

  void add(double error) {
    sum += error * error;
    max = std::max(max, std::abs(error));
    ++count;
  }
  double rms() const { return std::sqrt(sum / static_cast<double>(count)); }
};

struct Outcome {
  double seconds = 0;
  int iterations = 0;
  Errors errors;
};

Outcome finiteDifferences(const Setting& setting, Boundary boundary) {
  const FloatTree zero(setting.interior.tree(), 0.0f, openvdb::TopologyCopy());
  Outcome out;
  for (int channel = 0; channel < 3; ++channel) {
    pcg::State state = pcg::terminationDefaults<double>();
    state.iterations = 100000;
    state.relativeError = boundary == Boundary::cut ? 1e-3 * kResidual : kResidual;
    openvdb::util::NullInterrupter interrupter;
    Stopwatch watch;
    const FloatTree::Ptr solution = poisson::solveWithBoundaryConditionsAndPreconditioner<
        pcg::IncompleteCholeskyPreconditioner<poisson::LaplacianMatrix>>(
        zero, BoundaryValues(setting, boundary, channel), state, interrupter);
    out.seconds += watch.lap();
    out.iterations += state.iterations;
    for (auto value = solution->cbeginValueOn(); value; ++value)
      out.errors.add(*value - setting.known(setting.place(value.getCoord()))[channel]);
  }
  return out;
}

Matrix valuesAt(const Points& points, const Known& known) {
  Matrix values(points.size(), 3);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 v = known(points[i]);
    for (int k = 0; k < 3; ++k) values(i, static_cast<std::size_t>(k)) = v[k];
  }
  return values;
}

HarmonicMap fitted(const Solid& solid) {
  const Known known(solid);
  FitProblem problem;
  const Mesh& surface = solid.surface();
  const auto places = [&](const std::vector<SurfacePoint>& samples) {
    return interpolate(surface.vertices, surface.triangles, samples);
  };
  problem.surface.points = places(blueNoiseSamples(surface, kPointsPerSource * kSources));
  problem.surface.values = valuesAt(problem.surface.points, known);
  SampleSettings heldOut;
  heldOut.seed = 2;
  problem.surface.heldOut = places(randomSamples(surface, kSources, heldOut));
  problem.surface.heldOutValues = valuesAt(problem.surface.heldOut, known);
  problem.diagonal = solid.diagonal();
  problem.area = solid.area();
  problem.placeSources = [&](std::size_t count, double distance) {
    SourceSettings source;
    source.count = count;
    return sourceShell(solid, distance, source);
  };
  FitSettings settings;
  settings.sources = kSources;
  return HarmonicMap(fitField(problem, settings).field);
}

Outcome charges(const std::string& file, const Setting& setting, double& fitSeconds) {
  Outcome out;
  Stopwatch watch;
  const Solid solid(readMesh(file));
  const HarmonicMap map = fitted(solid);
  fitSeconds = watch.lap();
  EvaluateSettings settings;
  settings.jacobian = settings.harmonicEnergy = settings.deformationEnergy = false;
  settings.skin = 0;
  const MapGrids grids = evaluateMap(map, solid, setting.levelSet, settings);
  out.seconds = fitSeconds + watch.lap();
  for (auto value = grids.map->tree().cbeginValueOn(); value; ++value) {
    const Vec3 known = setting.known(setting.place(value.getCoord()));
    for (int k = 0; k < 3; ++k) out.errors.add((*value)[k] - known[k]);
  }
  return out;
}

Json row(int across, std::size_t voxels, const char* way, const Outcome& outcome,
         const Outcome& ours, const Limits& limits) {
  Json out{{"across", across},
           {"voxels", voxels},
           {"way", way},
           {"seconds", outcome.seconds},
           {"iterations", outcome.iterations},
           {"rms error", outcome.errors.rms()},
           {"max error", outcome.errors.max},
           {"time / ours", outcome.seconds / ours.seconds},
           {"rms / ours", outcome.errors.rms() / ours.errors.rms()},
           {"max / ours", outcome.errors.max / ours.errors.max}};
  Work work;  // three values a voxel; a conjugate gradient reads and writes some ten vectors
  work.bytes = static_cast<double>(voxels) * (12 + 80.0 * outcome.iterations);
  out.update(besideLimit(limits, work, outcome.seconds));
  return out;
}

}  // namespace

Tables poisson(const Options& options) {
  Table table("Beside OpenVDB's Poisson solver: spot, three channels of a known harmonic function");
  const std::string file = options.model("spot.obj");
  const Solid solid(readMesh(file));
  for (const int across : options.quick ? std::vector<int>{32} : std::vector<int>{256, 512}) {
    LevelSetSettings levels;
    levels.resolution = across;
    const auto levelSet = makeLevelSet(solid, levels);
    RegionSettings withoutSkin;
    withoutSkin.skin = 0;
    const auto interior = activeRegion(*levelSet, withoutSkin);
    const Setting setting{solid, *levelSet, *interior, Known(solid)};
    const std::size_t voxels = interior->activeVoxelCount();
    double fitSeconds = 0;
    const Outcome ours = charges(file, setting, fitSeconds);
    const auto add = [&](const char* way, const Outcome& outcome) {
      table.add(row(across, voxels, way, outcome, ours, options.limits));
    };
    add("innermap", ours);
    table.note("of which from the mesh to the weights: " + digits(fitSeconds) + " s");
    if (across > 256) continue;  // theirs takes 15 times as long at twice the resolution
    add("OpenVDB, staircase", finiteDifferences(setting, Boundary::staircase));
    add("OpenVDB, cut cells", finiteDifferences(setting, Boundary::cut));
  }
  table.note("innermap: " + std::to_string(kSources) +
             " charges, from the mesh file to the map's grid; all: level set and interior mask "
             "given; errors in units of the functions, which are of order 1");
  table.note("OpenVDB: incomplete Cholesky, residual to 1e-5 (staircase) or 1e-8 (cut cells)");
  return {table.json()};
}

}  // namespace innermap::bench

// Frames of one animation on one set-up of the solver.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "innermap/field/boundary_error.h"
#include "innermap/levelset/solid.h"
#include "innermap/mesh/read.h"
#include "innermap/mesh/repair.h"
#include "innermap/sample/source_points.h"
#include "innermap/sample/surface_samples.h"
#include "innermap/solve/iterative_solver.h"
#include "section.h"

namespace innermap::bench {
namespace {

constexpr std::size_t kFresh = 10000;
constexpr double kDistance = 1.25;  // spacings
constexpr double kProducts = 1e-6;  // accuracy; a hundredth of what the fits leave

using Samples = std::vector<SurfacePoint>;

SourceLevel shell(const Solid& solid, std::size_t count) {
  SourceLevel level;
  level.spacing = std::sqrt(solid.area() / static_cast<double>(count));
  level.distance = kDistance * level.spacing;
  SourceSettings settings;
  settings.count = count;
  level.sources = sourceShell(solid, level.distance / solid.diagonal(), settings);
  return level;
}

Points placesOf(const Solid& solid, const Samples& samples) {
  return interpolate(solid.surface().vertices, solid.surface().triangles, samples);
}

Matrix valuesOf(const Solid& solid, const Mesh& frame, const Samples& samples) {
  const RepairedMesh& repaired = solid.repaired();
  Samples addresses;
  for (const SurfacePoint& sample : samples) addresses.push_back(solid.address(sample));
  const Points points =
      interpolate(repairedPositions(repaired, frame.vertices), repaired.mesh.triangles, addresses);
  Matrix values(points.size(), 3);
  for (std::size_t i = 0; i < points.size(); ++i)
    for (int a = 0; a < 3; ++a) values(i, static_cast<std::size_t>(a)) = points[i][a];
  return values;
}

double freshRms(const IterativeSolution& solution, const Points& sources, const Solid& solid,
                const Mesh& frame) {
  SampleSettings settings;
  settings.seed = 77;
  const Samples fresh = randomSamples(solid.surface(), kFresh, settings);
  const HarmonicField field(sources, solution.weights, solution.affine);
  return measureBoundaryError(field, placesOf(solid, fresh), valuesOf(solid, frame, fresh),
                              boundingBox(frame).diagonal())
      .rms;
}

}  // namespace

Tables sequence(const Options& options) {
  const std::size_t sources = options.quick ? 600 : 8000;
  const int frames = options.quick ? 3 : 24;
  const Mesh reference = readMesh(options.model("horse-gallop/reference.obj"));
  const Solid solid(reference);
  Stopwatch watch;
  const Samples samples = blueNoiseSamples(solid.surface(), 3 * sources);
  const std::vector<SourceLevel> levels{shell(solid, sources / 8), shell(solid, sources)};
  const double placing = watch.lap();
  IterativeSettings settings;
  settings.accuracy = kProducts;
  const IterativeSolver solver(placesOf(solid, samples), levels, settings);
  const double setUp = watch.lap();

  Table table(fmt::format("A sequence: {} frames of the horse's gallop, {} sources", frames,
                          solver.sources().size()));
  double first = 0, slowest = 0, sum = 0;
  for (int f = 1; f <= frames; ++f) {
    const Mesh frame =
        readMeshLike(options.model(fmt::format("horse-gallop/frame.{:04}.obj", f)), reference);
    const Matrix values = valuesOf(solid, frame, samples);
    watch.lap();
    const IterativeSolution solution = solver.solve(values);
    const double seconds = watch.lap();
    if (f == 1) first = setUp + seconds;
    if (f > 1) slowest = std::max(slowest, seconds);
    if (f > 1) sum += seconds;
    table.add({{"frame", f},
               {"set-up s", f == 1 ? setUp : 0.0},
               {"solve s", seconds},
               {"iterations", solution.iterations},
               {"solve / first", f == 1 ? 1.0 : seconds / first},
               {"rms", freshRms(solution, solver.sources(), solid, frame)}});
  }
  const double mean = sum / (frames - 1);
  table.note(fmt::format(
      "placing once: {:.3g} s; set-up and solve of the first: {:.3g} s; further "
      "frames: {:.3g} s in the mean, {:.3g} s at most, which is {:.3g} and {:.3g} of it "
      "({:.3g} and {:.3g} with placing)",
      placing, first, mean, slowest, mean / first, slowest / first, mean / (placing + first),
      slowest / (placing + first)));
  table.note("rms: at 10,000 fresh points");
  return {table.json()};
}

}  // namespace innermap::bench

// What comes before the fit: reading, checking, the solid, points on and outside the surface.
#include <cmath>
#include <filesystem>

#include "innermap/levelset/solid.h"
#include "innermap/mesh/check.h"
#include "innermap/mesh/mesh_file.h"
#include "sample/source_points.h"
#include "sample/surface_samples.h"
#include "section.h"

namespace innermap::bench {
namespace {

constexpr double kDistance = 1.25;  // spacings

Json place(const std::string& file, std::size_t sources, const Options& options) {
  Stopwatch watch, whole;
  const Mesh mesh = readMesh(options.model(file));
  const double read = watch.lap();
  CheckSettings checking;
  checking.listed = 1;
  checkMesh(mesh, checking);
  const double check = watch.lap();
  const Solid solid(mesh);
  const double solidSeconds = watch.lap();
  blueNoiseSamples(solid.surface(), 3 * sources);
  const double surface = watch.lap();
  SourceSettings settings;
  settings.count = sources;
  const double spacing = std::sqrt(solid.area() / static_cast<double>(sources));
  sourceShell(solid, kDistance * spacing / solid.diagonal(), settings);
  const double shell = watch.lap();
  const double all = whole.lap();
  Json row{{"mesh", file},
           {"sources", sources},
           {"read s", read},
           {"check s", check},
           {"solid s", solidSeconds},
           {"surface points s", surface},
           {"sources s", shell},
           {"all s", all}};
  Work work;  // the file, and four points a source
  work.bytes = static_cast<double>(std::filesystem::file_size(options.model(file)) +
                                   4 * sizeof(Vec3) * sources);
  row.update(besideLimit(options.limits, work, all));
  return row;
}

}  // namespace

Tables placing(const Options& options) {
  Table table("Placing: three blue-noise points on the surface a source, sources at 1.25 spacings");
  for (const char* name : {"spot", "homer", "cheburashka", "fandisk", "rocker-arm"})
    table.add(place(std::string(name) + ".obj", 1500, options));
  std::vector<std::size_t> counts{1500, 8000};
  if (!options.quick) counts.insert(counts.end(), {50000, 200000});
  for (const std::size_t count : counts)
    table.add(place("horse-poses/reference.obj", count, options));
  return {table.json()};
}

}  // namespace innermap::bench

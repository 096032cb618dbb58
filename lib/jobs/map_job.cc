#include "jobs/map_job.h"

namespace innermap {

MapJob mapJob(Mesh source, Mesh target) {
  const bool related = sameConnectivity(source, target);
  if (related) {
    Mesh moved = source;
    moved.name = std::move(target.name);
    moved.vertices = std::move(target.vertices);
    target = std::move(moved);
  }
  return {std::move(source), std::move(target), related};
}

MeshCorrespondenceSettings layingSettings(MeshCorrespondenceSettings given, std::uint64_t seed) {
  given.seed = seed;
  given.carryBack = false;
  return given;
}

}  // namespace innermap

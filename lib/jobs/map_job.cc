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
  return mapJob(std::move(source), TargetMesh{std::move(target), related});
}

MapJob mapJob(Mesh source, TargetMesh target) {
  return {std::move(source), std::move(target.mesh), target.related, false};
}

MapJob laidMapJob(Mesh source, Mesh target) {
  return {std::move(source), std::move(target), true, true};
}

MeshCorrespondenceSettings layingSettings(MeshCorrespondenceSettings given, std::uint64_t seed) {
  given.seed = seed;
  given.carryBack = false;
  return given;
}

}  // namespace innermap

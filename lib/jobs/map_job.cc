#include "jobs/map_job.h"

#include "innermap/io/solid_pictures.h"

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

std::vector<MemoryNeed> mapNeeds(const MapJob& job, const Solid& solid,
                                 const FitMapSettings& fitting, const LatticeChoice& grid) {
  // Vertices that laying makes of one: 1 to 1.4 were measured.
  constexpr std::size_t kMostSplit = 2;
  const std::size_t vertices = job.source.vertices.size();
  std::vector<MemoryNeed> out{fitNeed(fitting, job.related ? vertices : kMostSplit * vertices),
                              mapGridNeed(solid, grid,
                                          {job.mayTakeSteps(fitting) ? std::size_t{2} : 1,
                                           needsLocalMap(job.target.vertices, fitting.tolerance)})};
  if (job.related) return out;
  out.push_back(correspondNeed(vertices, job.target.vertices.size()));
  out.push_back({"drawing the correspondence", meshPictureMemory()});
  return out;
}

MeshCorrespondenceSettings layingSettings(MeshCorrespondenceSettings given, std::uint64_t seed) {
  given.seed = seed;
  given.carryBack = false;
  return given;
}

}  // namespace innermap

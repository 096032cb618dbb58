#include <algorithm>
#include <memory>

#include "innermap/core/run.h"
#include "innermap/surface/correspond.h"
#include "mesh/triangle_tree.h"
#include "surface/detail/refining/joined_shells.h"
#include "surface/detail/refining/layout_map.h"

namespace innermap {
namespace {

constexpr char kCarrying[] = "carrying points over";

// One pair of shells with what asking needs.
struct ShellMap {
  explicit ShellMap(const ShellCorrespondence& shell)
      : onA(shell.surface.triangles, shell.image),
        onB(shell.targetSurface.triangles, shell.targetLayout),
        composed({shell.surface, shell.image, onA},
                 {shell.targetSurface, shell.targetLayout, onB}) {}
  ShellMap(const ShellMap&) = delete;
  ShellMap& operator=(const ShellMap&) = delete;

  Locator onA, onB;
  LayoutMap composed;
};

using ShellMaps = std::vector<std::unique_ptr<ShellMap>>;

ShellMaps mapsOf(const Correspondence& map) {
  ShellMaps maps;
  for (const ShellCorrespondence& shell : map.shells) {
    throwIfCancelled();
    maps.push_back(std::make_unique<ShellMap>(shell));
  }
  return maps;
}

}  // namespace

SurfaceImages imagesOf(const Points& points, const Correspondence& map,
                       const SurfaceShells& target) {
  const ShellMaps maps = mapsOf(map);
  JoinedShells shells;
  for (const ShellCorrespondence& shell : map.shells)
    shells.add(shell.surface.vertices, shell.surface.triangles);
  const TriangleTree tree(shells.vertices, shells.triangles);
  SurfaceImages result;
  result.positions.resize(points.size());
  result.onTarget.resize(points.size());
  std::vector<SurfacePoint> onShell(points.size());
  std::vector<std::size_t> shellOf(points.size());
  std::vector<double> distance(points.size(), 0);
  parallelBlocks(
      points.size(), 256,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          const ClosestPoint closest = tree.closest(points[i]);
          const JoinedShells::Place place = shells.placeOf(closest.address.triangle);
          const LayoutMap::Image image =
              maps[place.shell]->composed.at(place.triangle, closest.address.barycentric);
          result.positions[i] = image.position;
          onShell[i] = {image.triangle, image.barycentric};
          shellOf[i] = place.shell;
          distance[i] = closest.distance;
        }
      },
      kCarrying);
  for (std::size_t s = 0; s < map.shells.size(); ++s) {
    std::vector<std::size_t> members;
    std::vector<SurfacePoint> here;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (shellOf[i] != s) continue;
      members.push_back(i);
      here.push_back(onShell[i]);
    }
    here = onTargetMesh(map.shells[s], target, here);
    for (std::size_t k = 0; k < members.size(); ++k) result.onTarget[members[k]] = here[k];
  }
  for (const double d : distance) result.farthest = std::max(result.farthest, d);
  return result;
}

Points preimagesOf(const std::vector<SurfacePoint>& onTarget, const Correspondence& map,
                   const SurfaceShells& target) {
  const ShellMaps maps = mapsOf(map);
  JoinedShells shells;
  std::vector<JoinedShells::Place> places(target.mesh.triangles.size(), {0, -1});
  for (std::size_t s = 0; s < map.shells.size(); ++s) {
    const std::size_t b = static_cast<std::size_t>(map.shells[s].target);
    shells.add(map.shells[s].targetSurface.vertices, map.shells[s].targetSurface.triangles);
    if (map.shells[s].targetCut) continue;  // other triangles than the mesh's
    for (std::size_t t = 0; t < target.meshTriangle[b].size(); ++t)
      places[target.meshTriangle[b][t]] = {s, static_cast<int>(t)};
  }
  const TriangleTree tree(shells.vertices, shells.triangles);
  Points result(onTarget.size());
  parallelBlocks(
      onTarget.size(), 256,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          SurfacePoint point = onTarget[i];
          JoinedShells::Place place = places[point.triangle];
          if (place.triangle < 0) {
            point = tree.closest(positionOf(target.mesh, point)).address;
            place = shells.placeOf(point.triangle);
          }
          result[i] = maps[place.shell]->composed.preimage(place.triangle, point.barycentric);
        }
      },
      kCarrying);
  return result;
}

}  // namespace innermap

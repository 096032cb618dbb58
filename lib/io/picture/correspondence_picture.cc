#include <filesystem>

#include "innermap/correspond/mesh_correspondence.h"
#include "innermap/io/solid_pictures.h"
#include "io/picture/detail/place_colours.h"

namespace innermap {
namespace {

PictureSurface surfaceOf(const LaidOutMesh& input) {
  PictureSurface surface;
  surface.label = std::filesystem::path(input.mesh.name).filename().string();
  surface.vertices = input.shells().mesh.vertices;
  surface.triangles = input.shells().mesh.triangles;
  return surface;
}

}  // namespace

void writeCorrespondencePicture(const std::string& path, const MeshCorrespondence& map,
                                const MeshPictureSettings& settings) {
  const Mesh& meshA = map.a.shells().mesh;
  const Box3 box = boundingBox(meshA);
  std::vector<PictureSurface> surfaces{surfaceOf(map.a), surfaceOf(map.b)};
  surfaces[0].colours = [&](const std::vector<VisiblePoint>& seen) {
    return placeColours(interpolate(meshA.vertices, meshA.triangles, addresses(seen)), box);
  };
  surfaces[1].colours = [&](const std::vector<VisiblePoint>& seen) {
    return placeColours(preimagesOf(addresses(seen), map.map, map.b.shells()), box);
  };
  writeMeshPicture(path, surfaces, settings);
}

}  // namespace innermap

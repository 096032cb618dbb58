#include <algorithm>
#include <cmath>
#include <filesystem>

#include "innermap/boundary/mesh_correspondence.h"
#include "innermap/io/picture/mesh_picture.h"

namespace innermap {
namespace {

constexpr double kCells = 14;  // of the pattern, along the longest side of A's box

// A's box as colours, with a chequered pattern in which stretch can be seen.
Vec3 colourOf(const Vec3& p, const Box3& box) {
  const Vec3 extent = box.extent();
  const double longest = std::max({extent.x, extent.y, extent.z, 1e-300});
  Vec3 colour;
  int parity = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double along = p[axis] - box.lower[axis];
    const double share = std::clamp(along / std::max(extent[axis], 1e-300), 0.0, 1.0);
    colour[axis] = std::pow(0.12 + 0.88 * share, 1.8);
    parity += static_cast<int>(std::floor(kCells * along / longest));
  }
  return (parity & 1 ? 0.72 : 1.0) * colour;
}

std::vector<Vec3> coloursOf(const Points& points, const Box3& box) {
  std::vector<Vec3> colours;
  colours.reserve(points.size());
  for (const Vec3& p : points) colours.push_back(colourOf(p, box));
  return colours;
}

std::vector<SurfacePoint> addresses(const std::vector<VisiblePoint>& seen) {
  std::vector<SurfacePoint> points;
  points.reserve(seen.size());
  for (const VisiblePoint& p : seen) points.push_back({p.triangle, p.barycentric});
  return points;
}

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
  SurfaceImageSettings back;
  back.progress = settings.progress;
  std::vector<PictureSurface> surfaces{surfaceOf(map.a), surfaceOf(map.b)};
  surfaces[0].colours = [&](const std::vector<VisiblePoint>& seen) {
    return coloursOf(interpolate(meshA.vertices, meshA.triangles, addresses(seen)), box);
  };
  surfaces[1].colours = [&](const std::vector<VisiblePoint>& seen) {
    return coloursOf(preimagesOf(addresses(seen), map.map, map.b.shells(), back), box);
  };
  writeMeshPicture(path, surfaces, settings);
}

}  // namespace innermap

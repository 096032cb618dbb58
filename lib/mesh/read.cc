#include "core/text_scanner.h"
#include "innermap/core/error.h"
#include "innermap/mesh/mesh_file.h"
#include "mesh/detail/polygon_mesh.h"
#include "mesh/detail/scene_files.h"

namespace innermap {
namespace {

struct Format {
  const char* extension;
  PolygonMesh (*read)(const FileBytes&);
};

constexpr Format kFormats[] = {
    {".obj", readObj}, {".ply", readPly}, {".off", readOff}, {".stl", readStl}};

// A mesh of triangles.
PolygonMesh polygonsOf(Mesh&& mesh) {
  PolygonMesh out;
  out.vertices = std::move(mesh.vertices);
  for (const Triangle& triangle : mesh.triangles) {
    out.corners.insert(out.corners.end(), triangle.begin(), triangle.end());
    out.start.push_back(static_cast<int>(out.corners.size()));
  }
  return out;
}

PolygonMesh readPolygons(const std::string& path) {
  if (isGltf(path)) return polygonsOf(readRestPose(path));
  const std::string extension = extensionOf(path);
  for (const Format& format : kFormats)
    if (equalsIgnoringCase(extension, format.extension))
      return format.read(readFileBytes(path, "a mesh file"));
  requireNoScene(path);
  throw FileError(
      path, (!extension.empty() ? "unknown extension " + inQuotes(extension) : "has no extension") +
                "; meshes are read from .obj, .ply, .off, .stl, .glb and .gltf files");
}

}  // namespace

const std::vector<std::string>& meshExtensions() {
  static const std::vector<std::string> all = [] {
    std::vector<std::string> extensions;
    for (const Format& format : kFormats) extensions.push_back(format.extension);
    return extensions;
  }();
  return all;
}

Mesh readMesh(const std::string& path) {
  Mesh mesh = toMesh(readPolygons(path), path);
  requireNearOrigin(mesh);
  return mesh;
}

Mesh readMeshLike(const std::string& path, const Mesh& reference) {
  Mesh mesh = toMeshLike(readPolygons(path), path, reference);
  requireNearOrigin(mesh);
  return mesh;
}

TargetMesh readTarget(const std::string& path, const Mesh& source) {
  try {
    return {readMeshLike(path, source), true};
  } catch (const DataError&) {
    return {readMesh(path), false};
  }
}

}  // namespace innermap

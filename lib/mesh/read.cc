#include "core/file_bytes.h"
#include "innermap/core/error.h"
#include "innermap/mesh/mesh_file.h"
#include "mesh/detail/polygon_mesh.h"

namespace innermap {
namespace {

using Reader = PolygonMesh (*)(const FileBytes&);

Reader readerOf(const std::string& path) {
  const std::string extension = extensionOf(path);
  if (equalsIgnoringCase(extension, ".obj")) return readObj;
  if (equalsIgnoringCase(extension, ".ply")) return readPly;
  if (equalsIgnoringCase(extension, ".off")) return readOff;
  if (equalsIgnoringCase(extension, ".stl")) return readStl;
  throw FileError(
      path, (!extension.empty() ? "unknown extension " + inQuotes(extension) : "has no extension") +
                "; meshes are read from .obj, .ply, .off and .stl files");
}

PolygonMesh readPolygons(const std::string& path) {
  const Reader reader = readerOf(path);
  return reader(readFileBytes(path, "a mesh file"));
}

}  // namespace

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

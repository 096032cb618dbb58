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

PolygonMesh readPolygons(const std::string& path) {
  const std::string extension = extensionOf(path);
  for (const Format& format : kFormats)
    if (equalsIgnoringCase(extension, format.extension))
      return format.read(readFileBytes(path, "a mesh file"));
  requireNoScene(path);
  throw FileError(
      path, (!extension.empty() ? "unknown extension " + inQuotes(extension) : "has no extension") +
                "; meshes are read from .obj, .ply, .off and .stl files");
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

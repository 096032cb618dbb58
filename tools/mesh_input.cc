#include "mesh_input.h"

#include "innermap/mesh/read.h"

namespace innermap::tool {

Mesh readMeshFile(const std::string& path, Context& context) {
  ReadSettings settings;
  settings.progress = context.progress();
  Mesh mesh;
  context.timed("read", [&] { mesh = readMesh(path, settings); });
  return mesh;
}

}  // namespace innermap::tool

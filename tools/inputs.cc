#include "inputs.h"

#include "innermap/io/vdb/vdb_file.h"
#include "innermap/mesh/read.h"
#include "map_report.h"

namespace innermap::tool {

Mesh readMeshFile(const std::string& path, Context& context) {
  return context.timed("read", [&] { return readMesh(path, context.settings<ReadSettings>()); });
}

openvdb::GridPtrVec readGridFile(const std::string& path, const std::vector<std::string>& names,
                                 Context& context) {
  auto settings = context.settings<VdbReadSettings>();
  settings.names = names;
  return context.timed("read", [&] { return readVdb(path, settings).grids; });
}

MappedSolid readMapFile(const std::string& path, Context& context) {
  throwIfCancelled(context.progress());
  MappedSolid mapped = readMap(path, context.settings<BoundarySettings>());
  reportBoundaries(mapped.boundary, context);
  return mapped;
}

Solid targetSolid(const MappedSolid& mapped, Context& context) {
  return context.timed("solid", [&] {
    return makeTargetSolid(mapped.boundary, context.settings<BoundarySettings>());
  });
}

}  // namespace innermap::tool

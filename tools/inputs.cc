#include "inputs.h"

#include "html/contents.h"
#include "innermap/io/vdb/vdb_file.h"
#include "innermap/mesh/read.h"
#include "map_report.h"

namespace innermap::tool {

Mesh readMeshFile(const std::string& path, Context& context) {
  Mesh mesh =
      context.timed("read", [&] { return readMesh(path, context.settings<ReadSettings>()); });
  if (context.page()) addMesh(*context.page(), mesh);
  return mesh;
}

openvdb::GridPtrVec readGridFile(const std::string& path, const std::vector<std::string>& names,
                                 Context& context) {
  auto settings = context.settings<VdbReadSettings>();
  settings.names = names;
  openvdb::GridPtrVec grids = context.timed("read", [&] { return readVdb(path, settings).grids; });
  if (context.page()) addGrids(*context.page(), grids);
  return grids;
}

MappedSolid readMapFile(const std::string& path, Context& context) {
  throwIfCancelled(context.progress());
  MappedSolid mapped = readMap(path, context.settings<BoundarySettings>());
  reportBoundaries(mapped.boundary, context);
  if (context.page()) showMap(*context.page(), mapped, context.settings<PageSettings>());
  return mapped;
}

Solid targetSolid(const MappedSolid& mapped, Context& context) {
  return context.timed("solid", [&] {
    return makeTargetSolid(mapped.boundary, context.settings<BoundarySettings>());
  });
}

}  // namespace innermap::tool

#include "inputs.h"

#include <filesystem>

#include "innermap/core/run.h"
#include "innermap/io/vdb_file.h"
#include "innermap/mesh/mesh_file.h"
#include "map_report.h"
#include "report/page/contents.h"

namespace innermap::tool {

void requireMeshMemory(const std::string& path, const Context& context) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) return;  // the reader says why
  context.requireMemory("reading " + path,
                        static_cast<std::uint64_t>(kMeshByte * static_cast<double>(size)),
                        "use a coarser mesh or raise --max-memory");
}

Mesh readMeshFile(const std::string& path, Context& context) {
  requireMeshMemory(path, context);
  Mesh mesh = context.timed("read", [&] { return readMesh(path); });
  if (context.page()) addMesh(*context.page(), mesh);
  return mesh;
}

openvdb::GridPtrVec readGridFile(const std::string& path, const std::vector<std::string>& names,
                                 Context& context) {
  VdbReadSettings settings;
  settings.names = names;
  context.requireMemory("reading " + path, readMemory(readVdbInfo(path), names),
                        "read fewer of its grids or raise --max-memory");
  openvdb::GridPtrVec grids = context.timed("read", [&] { return readVdb(path, settings).grids; });
  if (context.page()) addGrids(*context.page(), grids);
  return grids;
}

MappedSolid readMapFile(const std::string& path, Context& context) {
  throwIfCancelled();
  MappedSolid mapped = readMap(path);
  reportBoundaries(mapped.boundary, context);
  if (context.page()) showMap(*context.page(), mapped);
  return mapped;
}

Solid targetSolid(const MappedSolid& mapped, Context& context) {
  return context.timed("solid", [&] { return makeTargetSolid(mapped.boundary); });
}

}  // namespace innermap::tool

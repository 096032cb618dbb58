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
  context.requireMemory({"reading " + path,
                         static_cast<std::uint64_t>(kMeshByte * static_cast<double>(size)),
                         "use a coarser mesh or raise {max_memory}"});
}

Mesh readMeshFile(const std::string& path, Context& context) {
  requireMeshMemory(path, context);
  for (const std::string& beside : filesBeside(path)) context.input(beside);
  Mesh mesh = context.timed("read", [&] { return readMesh(path, context.space()); });
  if (context.page()) addMesh(*context.page(), mesh);
  return mesh;
}

Mesh inOutput(const std::string& path, Mesh mesh, const Context& context) {
  move(mesh.vertices,
       isGltf(path) ? gltfToOutput(context.space()) : inputToOutput(context.space()));
  return mesh;
}

PointCarry fromInput(PointCarry carry, const Context& context) {
  const Similarity toOutput = inputToOutput(context.space());
  if (toOutput.isIdentity()) return carry;
  return [=, carry = std::move(carry)](const Points& points, bool jacobians) {
    Points there = points;
    move(there, toOutput);
    CarriedPoints out = carry(there, jacobians);
    for (Mat3& jacobian : out.jacobians) jacobian = product(jacobian, toOutput.matrix());
    return out;
  };
}

openvdb::GridPtrVec readGridFile(const std::string& path, const std::vector<std::string>& names,
                                 Context& context) {
  VdbReadSettings settings;
  settings.names = names;
  const Similarity toOutput = inputToOutput(context.space());
  context.requireMemory({"reading " + path,
                         (toOutput.isIdentity() ? 1 : 2) * readMemory(readVdbInfo(path), names),
                         "read fewer of its grids or raise {max_memory}"});
  openvdb::GridPtrVec grids = context.timed("read", [&] { return readVdb(path, settings).grids; });
  moveGrids(grids, toOutput);
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

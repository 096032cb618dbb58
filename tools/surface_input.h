// A mesh that is to be mapped onto another, read and laid out.
#pragma once

#include <optional>
#include <string>

#include "command.h"
#include "innermap/mesh/mesh.h"
#include "innermap/surface/correspond.h"

namespace innermap::tool {

// What is done with meshes that are no clean closed surfaces.
struct SurfaceOptions {
  bool close = false;
  std::optional<int> resolution;  // of the isosurface that stands in for such a mesh
};

void addSurfaceOptions(Command& command, SurfaceOptions& options);

struct SurfaceInput {
  Mesh mesh;  // as in the file
  // Laid out: the mesh's own shells, or an isosurface that stands in for it.
  EmbeddedSurface embedded;
  bool standIn = false;
  double voxelSize = 0;  // of the stand-in, world units

  const SurfaceShells& shells() const { return embedded.surfaces(); }
  // Whether vertex and triangle numbers of the file are those of shells().mesh.
  bool ownNumbers() const { return !standIn; }
};

// Lays the mesh out. Notes go to the context. Throws DataError for a mesh that is open, not
// manifold or of parts that overlap one another when the options do not say what to do with it.
SurfaceInput embedSurface(Mesh mesh, const SurfaceOptions& options, Context& context);

// For the report.
ReportMesh reportOf(const SurfaceInput& input);

// "genus 0", "genus 1 (3 shells)".
std::string topologyText(const SurfaceShells& shells);

}  // namespace innermap::tool

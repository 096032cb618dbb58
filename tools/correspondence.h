// What the commands that lay surfaces out share: options, and results in the report.
#pragma once

#include <optional>
#include <string>

#include "command.h"
#include "innermap/boundary/mesh_correspondence.h"

namespace innermap::tool {

// What is done with meshes that are no clean closed surfaces.
struct SurfaceOptions {
  bool close = false;
  std::optional<int> resolution;  // of the isosurface that stands in for such a mesh
};

struct CorrespondOptions {
  SurfaceOptions surfaces;
  std::string landmarks;
  bool aligned = false, noRefine = false;
  int candidates = MeshCorrespondenceSettings().candidates;
  std::optional<double> subdivide;
};

void addSurfaceOptions(Command& command, SurfaceOptions& options);
void addCorrespondOptions(Command& command, CorrespondOptions& options);

// Expected time of laying one of `a` vertices on one of `b`.
double correspondSeconds(std::size_t a, std::size_t b, const CorrespondOptions& options);

// Throws UsageError unless `path`, the value of `option`, ends in .ply.
void requirePly(const std::string& option, const std::string& path);

// Lays the mesh out and tells: notes, seconds. DataErrors name the options that would help.
LaidOutMesh layOut(Mesh mesh, const SurfaceOptions& options, Context& context);

// For the report.
ReportMesh reportOf(const LaidOutMesh& mesh);

// Maps A onto B and tells: notes, the report's "correspondence" and "seconds", a text for the
// terminal.
MeshCorrespondence correspondMeshes(Mesh a, Mesh b, const CorrespondOptions& options,
                                    std::uint64_t seed, Context& context);

}  // namespace innermap::tool

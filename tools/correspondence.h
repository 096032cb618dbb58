// One mesh on another: what `correspond` and `map` share.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "command.h"
#include "innermap/mesh/mesh.h"
#include "innermap/surface/correspond.h"
#include "surface_input.h"

namespace innermap::tool {

struct CorrespondOptions {
  SurfaceOptions surfaces;
  std::string landmarks;
  bool aligned = false, noRefine = false;
  int candidates = CorrespondSettings().candidates;
  std::optional<double> subdivide;
};

void addCorrespondOptions(Command& command, CorrespondOptions& options);

// A's vertices on B.
struct MovedMesh {
  Mesh source;           // A as in its file, or subdivided
  bool changed = false;  // source is not as in the file: subdivided, or parts cut apart
  Points positions;      // #vertices of source: on B
  std::vector<SurfacePoint> onTarget;  // of each, triangle of B's file. On a cap, or where an
                                       // isosurface stood in for B, the closest point of B's mesh

  Mesh target(const std::string& name) const;  // source with its vertices moved

  std::function<void(const std::string&)> drawPicture;  // to a .png; throws FileError
};

// Expected seconds and bytes of mapping surfaces of so many vertices.
double correspondSeconds(std::size_t verticesA, std::size_t verticesB,
                         const CorrespondOptions& options);
std::uint64_t correspondMemory(std::size_t verticesA, std::size_t verticesB,
                               const CorrespondOptions& options);

// Bytes of laying one surface out.
std::uint64_t layOutMemory(std::size_t vertices);

// Throws UsageError unless `path`, the value of `option`, ends in .ply.
void requirePly(const std::string& option, const std::string& path);

// Maps A onto B, measures the map and tells: notes, the report's "correspondence" and "seconds",
// a text for the terminal. The context must outlive the result. Throws what correspond() and
// embedSurface() throw, FileError.
MovedMesh correspondMeshes(Mesh a, Mesh b, const CorrespondOptions& options, std::uint64_t seed,
                           Context& context);

}  // namespace innermap::tool

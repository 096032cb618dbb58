// One mesh on another that was never related to it: from two files' meshes to a target with the
// first one's vertices.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "innermap/boundary/laid_out_mesh.h"
#include "innermap/boundary/landmarks.h"
#include "innermap/mesh/mesh.h"
#include "innermap/mesh/read.h"
#include "innermap/surface/correspond.h"
#include "innermap/surface/map_quality.h"

namespace innermap {

struct MeshCorrespondenceSettings {
  LayOutSettings layOut;  // of both meshes
  // Where A's outer surface was laid on B: values at A's own vertices, as at the closest points of
  // the outer surface; otherwise the source is the outer surface itself, which is what maps fit.
  bool carryBack = true;
  LandmarkList landmarks;  // kept exactly
  bool aligned = false;
  int candidates = 3;    // ways to lay A on B that are refined
  bool byInside = true;  // choose by a coarse harmonic map of the inside; otherwise, and where
                         // there is none, by the surfaces' energy
  WantedWay way;         // which of the ways to lay A on B that differ; needs byInside
  bool refine = true;    // false: fast, rough
  double subdivide = 0;  // split A until it follows B within this fraction of B's diagonal
  std::uint64_t seed = 1;
};

// Without the landmarks.
std::vector<Setting> describe(MeshCorrespondenceSettings& settings);

struct MeshCorrespondence {
  MeshCorrespondence(LaidOutMesh first, LaidOutMesh second)
      : a(std::move(first)), b(std::move(second)) {}

  // A as given, or with its triangles split or its touching parts cut apart: its vertices stay
  // first, in order. Without carryBack, A's outer surface where that was laid on B.
  Mesh source;
  bool changed = false;                // source is not as given
  Points positions;                    // #vertices of source, on B, world units
  std::vector<SurfacePoint> onTarget;  // of each, triangle of b.mesh. On a cap, or where an outer
                                       // surface was mapped, the closest point of the mesh

  LaidOutMesh a, b;
  Correspondence map;  // between the shells of a and b
  MapQuality quality;  // of map: of outer surfaces, where there are any

  std::size_t landmarks = 0;
  double landmarkError = 0;  // greatest distance of a landmark from its place on B, fraction of
                             // B's diagonal
  // Where values were carried back from A's outer surface: A's vertex farthest from it, fraction of
  // A's diagonal.
  std::optional<double> farthestFromOuter;

  std::vector<std::string> notes;     // choices worth telling, a line each; beside a.notes, b.notes
  std::vector<std::string> warnings;  // what makes the result doubtful
  std::vector<std::pair<std::string, double>> seconds;  // by stage; beside a.seconds, b.seconds

  // source with its vertices on B.
  Mesh target(const std::string& name) const;

  // The other way to lay A's first shell on B that is about as good, where there is one: `map` with
  // a coarse surface in place of that shell, for preimagesOf() and pictures alone.
  std::optional<MeshCorrespondence> otherWay() const;
};

// Whether each vertex of the one is its like's of the other: the same number of them, and the same
// polygons or triangles. Otherwise the one has to be laid onto the other first.
bool sameConnectivity(const Mesh& a, const Mesh& b);

// MeshCorrespondenceSettings::subdivide where a map is fitted to the result, unless told otherwise.
// A fraction of B's diagonal.
constexpr double kLaidOnSubdivide = 5e-3;

// Of the seconds until a deadline, what laying a surface on another may spend on trying and
// refining where a map is fitted to the result.
constexpr double kLayingTimeShare = 0.4;

// Lays both out, maps A onto B (surface/correspond.h), carries that back to the meshes as given and
// measures it. Throws what layOutMesh(), placeLandmarks() and correspond() throw; MemoryError
// before anything is done; SettingError, Cancelled. Same result for any number of threads.
MeshCorrespondence correspondMeshes(Mesh a, Mesh b,
                                    const MeshCorrespondenceSettings& settings = {});

// For meshes that are laid out: outerResolution and handles do not count.
MeshCorrespondence correspondMeshes(LaidOutMesh a, LaidOutMesh b,
                                    const MeshCorrespondenceSettings& settings = {});

// Bytes, for meshes of so many vertices: about what is needed, with a picture of both.
std::uint64_t correspondMemory(std::size_t verticesA, std::size_t verticesB);

// PLY, binary little endian: vertices x y z (double), `triangle` (int, of B, counted from 0) and
// `b0 b1 b2` (double, barycentric coordinates there); source's triangles. The file appears whole or
// not at all. Throws FileError.
void writeCorrespondence(const std::string& path, const MeshCorrespondence& map);

void writeCorrespondence(const std::string& path, const Mesh& source, const Points& positions,
                         const std::vector<SurfacePoint>& onTarget);

// Where that file, or any mesh of its connectivity, puts the vertices of `source`. Throws as
// readMeshLike does.
Mesh readCorrespondence(const std::string& path, const Mesh& source);

// Throws DataError when half of the vertices of `moved` are farther from `target` than a hundredth
// of its diagonal: the two do not belong together.
void requireOnTarget(const Mesh& moved, const Mesh& target);

}  // namespace innermap

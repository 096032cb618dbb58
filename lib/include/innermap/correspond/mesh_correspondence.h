// Lays one mesh on another of any connectivity: from two files' meshes to a target with the first
// one's vertices.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "innermap/core/setting.h"
#include "innermap/lattice/outer_surface.h"
#include "innermap/mesh/mesh.h"
#include "innermap/mesh/mesh_file.h"
#include "innermap/surface/correspond.h"

namespace innermap {

// A mesh that is to be mapped onto others, laid out: its own surface, holes capped, or the outer
// surface of its solid where the mesh runs through itself, overlaps or is not manifold.

struct LayOutSettings {
  // Of the outer surface, where it is taken: OuterSurfaceSettings::resolution, and handles instead
  // of the mesh's own.
  int outerResolution = 0;
  std::optional<int> handles;
};

std::vector<Setting> describe(LayOutSettings& settings);

struct LaidOutMesh {
  LaidOutMesh(Mesh given, EmbeddedSurface laidOut)
      : mesh(std::move(given)), embedded(std::move(laidOut)) {}

  Mesh mesh;                 // as given
  EmbeddedSurface embedded;  // the mesh's own shells, or those of the outer surface
  // Where it was taken instead of the mesh; its mesh is shells().mesh.
  std::optional<OuterSurface> outer;
  std::vector<std::string> notes;                       // what was done, a line each
  std::vector<std::pair<std::string, double>> seconds;  // by stage

  const SurfaceShells& shells() const { return embedded.surfaces(); }
  // Whether vertex and triangle numbers of the mesh are those of shells().mesh.
  bool ownNumbers() const { return !outer; }
  std::vector<Box3> caps() const;  // that close the mesh where it is open; world units
  int handles() const;             // of all shells
  double volume() const;           // inside the shells, world units cubed
};

// What stands for a mesh wherever a clean closed surface is needed.
struct CleanSurface {
  std::optional<OuterSurface> outer;  // without: the mesh itself, holes capped
  std::vector<std::string> notes;     // why the outer surface, and what was done, a line each
  std::optional<int> handles;         // of a surface of one piece
  bool handlesOfUnion =
      false;  // nobody asked for them, and the mesh has none: it has several pieces
};

// Throws as layOutMesh().
CleanSurface cleanSurface(const Mesh& mesh, const LayOutSettings& settings = {});

// Throws DataError where there is no solid at all, and what outerSurface() throws; SettingError,
// MemoryError, Cancelled.
LaidOutMesh layOutMesh(Mesh mesh, const LayOutSettings& settings = {});

// Two meshes that are to be mapped onto each other. An outer surface that has the handles of a
// union is given those of the other mesh where these are fewer: it is cut further, as is the one
// piece of a body whose parts touch. Throws as layOutMesh().
std::pair<LaidOutMesh, LaidOutMesh> layOutMeshes(Mesh a, Mesh b,
                                                 const LayOutSettings& settings = {});

// Throws what laying the two out and onto each other throws because of what they are: no solid,
// nothing but crossings, different topology. Takes the seconds of their outer surfaces, if any.
void requireLayable(const Mesh& a, const Mesh& b, const LayOutSettings& settings = {});

// Bytes of laying out surfaces of so many vertices in all: about what is needed.
std::uint64_t layOutMemory(std::size_t vertices);

// Throws what laying it out on the sphere throws because of what it is, as requireLayable() does.
void requireSphere(const Mesh& mesh, const LayOutSettings& settings = {});

struct MeshOnSphere {
  Mesh mesh;              // vertices on the unit sphere about the origin
  LayoutQuality quality;  // of all shells together; the degree farthest from 1
};

// Each shell covers the sphere by itself. The mesh's own triangles where they hold together as they
// are, else those of the shells; vertices in no shell lie where the nearest point of the shells
// lies. Throws DataError for a mesh with handles.
MeshOnSphere onSphere(const LaidOutMesh& mesh);

// Landmarks: pairs of places on two surfaces that a correspondence must keep.

struct LandmarkPlace {
  std::optional<int> vertex;  // of the mesh, from 0
  Vec3 point;                 // world units, when there is no vertex
};

struct LandmarkPair {
  LandmarkPlace onA, onB;
  std::size_t line = 0;  // of the file, from 1; 0: from no file, messages then count the pairs
};

struct LandmarkList {
  std::string name = "landmarks";  // the file, or what messages should call the list
  std::vector<LandmarkPair> pairs;
};

// The file's format, in words for users.
extern const char kLandmarkFormat[];

// Throws FileError with the line for what is no pair of places, also for a file without any.
LandmarkList readLandmarks(const std::string& path);

struct PlacedLandmarks {
  std::vector<Landmark> landmarks;  // #pairs
  std::string note;  // that points on A were taken as the nearest vertices; empty: none was
  bool far = false;  // one of them by more than 0.02 of the diagonal, so the note is a warning
};

// Finds the places on the surfaces. A point on A becomes A's nearest vertex. Throws FileError with
// the name and the line for vertices out of range or that no shell uses, points farther than 0.001
// of the diagonal from the surface, places that are given twice.
PlacedLandmarks placeLandmarks(const LandmarkList& list, const LaidOutMesh& a,
                               const LaidOutMesh& b);

struct MeshCorrespondenceSettings {
  LayOutSettings layOut;  // of both meshes
  // Where A's outer surface was laid on B: values at A's own vertices, as at the closest points of
  // the outer surface; otherwise the source is the outer surface itself, which is what maps fit.
  bool carryBack = true;
  LandmarkList landmarks;  // kept exactly
  bool aligned = false;
  int candidates = 3;    // ways to lay A on B that are refined; a coarse harmonic map of the inside
                         // chooses, or the surfaces' energy where there is none
  WantedWay way;         // which of the ways to lay A on B that differ
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

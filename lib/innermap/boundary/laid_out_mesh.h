// A mesh that is to be mapped onto others, laid out: its own surface, holes capped, or the outer
// surface of its solid where the mesh runs through itself, overlaps or is not manifold.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "innermap/core/setting.h"
#include "innermap/lattice/outer_surface.h"
#include "innermap/mesh/mesh.h"
#include "innermap/surface/correspond.h"

namespace innermap {

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

}  // namespace innermap

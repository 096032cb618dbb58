// A mesh that is to be mapped onto others, laid out: its own surface, or an isosurface of its solid
// where that is no clean closed one.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "innermap/core/error.h"
#include "innermap/core/progress.h"
#include "innermap/mesh/mesh.h"
#include "innermap/surface/correspond.h"

namespace innermap {

struct LayOutSettings {
  bool closeHoles = false;    // cap the holes of an open mesh
  int standInResolution = 0;  // for a mesh that is open, not manifold or of overlapping parts: an
                              // isosurface of its solid at so many voxels across stands in for it,
                              // in [8, 2048]; 0: such a mesh is refused
  std::uint64_t maxMemory = 0;  // bytes; 0 means no limit
  Progress* progress = nullptr;
};

// The mesh itself cannot be laid out, and the settings ask for nothing else.
class UnfitMesh : public DataError {
 public:
  UnfitMesh(const std::string& what, bool closingHelps)
      : DataError(what), closingHelps_(closingHelps) {}
  bool closingHelps() const { return closingHelps_; }  // closeHoles would do; or else a stand-in

 private:
  bool closingHelps_;
};

struct LaidOutMesh {
  LaidOutMesh(Mesh given, EmbeddedSurface laidOut)
      : mesh(std::move(given)), embedded(std::move(laidOut)) {}

  Mesh mesh;                 // as given
  EmbeddedSurface embedded;  // the mesh's own shells, or those of the stand-in
  bool standIn = false;
  double voxelSize = 0;                                 // of the stand-in, world units
  std::vector<std::string> notes;                       // what was done, a line each
  std::vector<std::pair<std::string, double>> seconds;  // by stage

  const SurfaceShells& shells() const { return embedded.surfaces(); }
  // Whether vertex and triangle numbers of the mesh are those of shells().mesh.
  bool ownNumbers() const { return !standIn; }
  int handles() const;    // of all shells
  double volume() const;  // inside the shells, world units cubed
};

// Throws UnfitMesh; DataError where there is no solid at all; SettingError, MemoryError, Cancelled.
LaidOutMesh layOutMesh(Mesh mesh, const LayOutSettings& settings = {});

// Bytes of laying out surfaces of so many vertices in all: about what is needed.
std::uint64_t layOutMemory(std::size_t vertices);

struct MeshOnSphere {
  Mesh mesh;              // vertices on the unit sphere about the origin
  LayoutQuality quality;  // of all shells together; the degree farthest from 1
};

// Each shell covers the sphere by itself. The mesh's own triangles where they hold together as they
// are, else those of the shells; vertices in no shell lie where the nearest point of the shells
// lies. Throws DataError for a mesh with handles.
MeshOnSphere onSphere(const LaidOutMesh& mesh);

}  // namespace innermap

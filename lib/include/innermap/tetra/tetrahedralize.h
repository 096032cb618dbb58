// Solids filled with well-shaped tetrahedra.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "innermap/core/setting.h"
#include "innermap/lattice/cell_mesh.h"
#include "innermap/lattice/outer_surface.h"
#include "innermap/levelset/solid.h"

namespace innermap {

struct TetrahedralizeSettings {
  int resolution = 64;  // cells of the lattice along the longest side of the box, in [4, 1024]
  double edge = 0;      // a cell's side, world units; 0 means: resolution decides
  // Edges of the surface sharper than this angle between their triangles' normals are kept as paths
  // of the mesh's edges, degrees, in (0, 180); then dihedral angles lie in 5 to 170 degrees.
  std::optional<double> features;
  // Whether to throw where the solid's topology cannot be kept; else there is a warning.
  bool keepTopology = true;
};

std::vector<Setting> describe(TetrahedralizeSettings& settings);

struct Tetrahedralization {
  CellMesh mesh;
  double edge = 0;         // world units; of the lattice's cells
  SolidTopology topology;  // of the mesh
  // The solid's own, where its surface is closed, manifold and free of overlaps.
  std::optional<SolidTopology> solidTopology;
  std::size_t changedNodes = 0;  // taken to be inside or outside against their distance
  // With `features`: the surface's sharp curves, those that have a path, and how far all curves are
  // from the paths, world units.
  std::size_t sharpCurves = 0, keptCurves = 0;
  double sharpRms = 0, sharpMax = 0;
  std::vector<std::string> notes, warnings;
};

// Isosurface stuffing (Labelle and Shewchuk, SIGGRAPH 2007) on a uniform body-centred cubic
// lattice: all dihedral angles lie in 10 to 165 degrees, every tetrahedron has a vertex inside, the
// boundary is manifold. Its vertices are moved to the closest points of the solid's surface as far
// as the angles allow.
//
// The mesh has the components, cavities and handles of the solid: where the lattice is too coarse
// for a wall, a gap or a handle, nodes there are taken to be inside or outside all the same, and
// where that does not help, a resolution that would do is named. A solid whose own surface does not
// tell them is compared with a lattice twice as fine, and a difference is a warning.
//
// Deterministic. Throws SettingError, MemoryError (before allocating), Cancelled, DataError when
// the topology is not kept or nothing is inside.
Tetrahedralization tetrahedralization(const Solid& solid,
                                      const TetrahedralizeSettings& settings = {});

// Its mesh alone.
CellMesh tetrahedralize(const Solid& solid, const TetrahedralizeSettings& settings = {});

StuffingNeed tetrahedralizeNeed(const Solid& solid, const TetrahedralizeSettings& settings);

}  // namespace innermap

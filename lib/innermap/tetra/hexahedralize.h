// A solid filled with hexahedra, by way of a polycube: its blocks are cut into hexahedra, a layer
// is laid around them, and a map of the polycube onto the solid carries all of them there, where
// they are turned right side out, evened out, and proven so.
//
// After Li, Guo, Wang, He, Gu and Qin, "Meshless Harmonic Volumetric Mapping Using Fundamental
// Solution Methods" (IEEE T-ASE 6(3), 2009), who map polycubes, and Gregson, Sheffer and Zhang,
// "All-hex mesh generation via volumetric polycube deformation" (SGP 2011).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "innermap/core/setting.h"
#include "innermap/core/stage_seconds.h"
#include "innermap/lattice/cell_mesh.h"
#include "innermap/mesh/mesh.h"
#include "innermap/surface/map_quality.h"
#include "innermap/tetra/boundary_fit.h"
#include "innermap/tetra/cell_quality.h"
#include "innermap/tetra/hexahedron_check.h"
#include "innermap/tetra/polycube.h"

namespace innermap {

struct HexahedralizeSettings {
  PolycubeSettings polycube;
  int pieces = 2;
  double featureAngle = 30;
  std::uint64_t seed = 1;
};

std::vector<Setting> describe(HexahedralizeSettings& settings);

struct Hexahedralization {
  CellMesh mesh;      // hexahedra of the blocks first, in their order, then those of the layer
  CellMesh inBlocks;  // the same hexahedra where they are in the polycube
  Polycube polycube;
  int pieces = 0;
  MapQuality boundaryMap;  // of the polycube's surface onto the solid's
  HexahedronCheck before;  // as carried
  HexahedronCheck after;
  CellQuality quality;                       // of mesh
  BoundaryFit boundary;                      // fractions of the solid's diagonal
  double featureLength = 0;                  // of the solid's sharp edges, world units
  SurfaceDistance fromFeatures;              // of those from the hexahedra's surface
  std::vector<std::string> notes, warnings;  // a line each
  StageSeconds seconds;
};

// Where some hexahedra cannot be turned right and the number of blocks was not given, more blocks
// are tried; what is left is told by `after` and a warning. Throws as makePolycube() and
// correspondMeshes(); SettingError, MemoryError (before anything is done), Cancelled.
// Deterministic for a seed, whatever the number of threads.
Hexahedralization hexahedralize(const Mesh& mesh, const HexahedralizeSettings& settings = {});

// Peak need in bytes, about.
std::uint64_t hexahedralizeMemory(const Mesh& mesh, const HexahedralizeSettings& settings = {});

}  // namespace innermap

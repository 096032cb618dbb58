// The main job in one call: from two boundaries to the harmonic map of the inside, with its
// certificate.
//
// Charges are placed just outside the source and their weights solved for, so that the map meets
// the target at boundary points (the method of fundamental solutions: Li, Guo, Wang, He, Gu and
// Qin, "Meshless harmonic volumetric mapping using fundamental solution methods", IEEE T-ASE 6(3),
// 2009). By default charges are added where the error is until 99% of the boundary lies within a
// tolerance; see field/adaptive_fit.h. FitMapSettings::shell asks for a number of charges on one
// shell instead, as in the paper; see field/fit.h.
//
// In space one harmonic map may fold, and between unrelated solids most do. Such a map is made in
// steps through intermediate shapes, each harmonic; see ComposedMap.
#pragma once

#include <cstdint>

#include "innermap/boundary/map_fit.h"

namespace innermap {

// Need in bytes of a fit to so many vertices of the source, beside their boundaries, and of looking
// at what it gives; with a tolerance, of its first level of charges. How many follow, and whether
// the map goes in steps, is not known beforehand: charges are added while the process stays within
// the limit on memory, and where steps do not fit the single map is kept.
std::uint64_t fitMapMemory(const FitMapSettings& settings, std::size_t vertices);

// A tolerance that cannot be met is no error: see MapFit::tolerance. Throws SettingError, DataError
// (no inside, another connectivity, no room for charges), MemoryError, Cancelled. Deterministic for
// a seed, whatever the number of threads.
MapFit fitMap(BoundaryPair boundary, const FitMapSettings& settings = {});

// The same from two meshes of one connectivity (see readMeshLike); others are laid onto one another
// first, see mesh_correspondence.h.
MapFit fitMap(const Mesh& source, const Mesh& target, const FitMapSettings& settings = {});

}  // namespace innermap

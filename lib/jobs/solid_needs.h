// What finite elements on a solid, and its texture, need of memory.
#pragma once

#include <string>
#include <vector>

#include "innermap/io/pictures.h"
#include "innermap/tetra/compare_fem.h"
#include "innermap/texture/solid_texture.h"
#include "jobs/needs.h"

namespace innermap {

// mapped: vertices of the solid whose map is compared; 0: known functions are.
MemoryNeed compareFemNeed(const Solid& solid, const CompareFemSettings& settings,
                          std::size_t mapped);

// image: a path, whose tiles are read; empty: the texture is in the mesh's own colours.
MemoryNeed textureNeed(const SolidTexturePlan& plan, const std::string& image,
                       const std::vector<UdimTile>& tiles);

}  // namespace innermap

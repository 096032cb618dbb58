// What the texture of a solid needs of memory.
#pragma once

#include <string>
#include <vector>

#include "innermap/io/pictures.h"
#include "innermap/texture/solid_texture.h"
#include "jobs/needs.h"

namespace innermap {

// image: a path, whose tiles are read; empty: the texture is in the mesh's own colours.
MemoryNeed textureNeed(const SolidTexturePlan& plan, const std::string& image,
                       const std::vector<UdimTile>& tiles);

}  // namespace innermap

// Textures as functions of texture coordinates. Images of files: io/picture/texture_images.h.
#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "innermap/core/vec3.h"
#include "innermap/mesh/mesh.h"

namespace innermap {

// The texture's linear colour at uv, averaged over about the parallelogram that a and b span about
// it. Called from many threads.
using TextureLookup = std::function<Vec3(const Vec2& uv, const Vec2& a, const Vec2& b)>;

// The UDIM tiles (column, row), ascending, in which triangles that have texture coordinates lie, by
// their middles: corners may lie on a tile's border. Throws DataError for a triangle outside the
// columns 0 to 9 and rows 0 to 899 that tiles can have.
std::vector<std::pair<int, int>> udimTiles(const Mesh& mesh);

}  // namespace innermap

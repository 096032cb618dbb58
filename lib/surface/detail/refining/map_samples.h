// Points spread over a surface, to judge candidates for maps by.
#pragma once

#include <cstdint>
#include <vector>

#include "innermap/core/vec3.h"
#include "innermap/surface/correspond.h"
#include "surface/detail/refining/target_metric.h"

namespace innermap {

// A point of the source in its layout, with the images there of two orthonormal tangent vectors of
// the source scaled to unit area.
struct MapSample {
  Vec3 x, e, f;
  Vec3 normal;  // outward of the source, unit
};

// `count` samples, each of the same area, stratified; the same for a seed.
std::vector<MapSample> sampleSource(const ClosedSurface& surface, const Layout& layout,
                                    std::size_t count, std::uint64_t seed);

// Unit normals of a surface's triangles.
Points unitNormals(const ClosedSurface& surface);

}  // namespace innermap

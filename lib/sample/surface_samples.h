// Samples of triangle meshes, by address.
#pragma once

#include <cstdint>
#include <vector>

#include "innermap/mesh/mesh.h"

namespace innermap {

struct SampleSettings {
  std::uint64_t seed = 1;
};

// Exactly `count` independent samples, uniform by area. Sample i depends on (seed, i) alone.
// Throws DataError when the mesh has no area, SettingError when count is over 1e8.
std::vector<SurfacePoint> randomSamples(const Mesh& mesh, std::size_t count,
                                        const SampleSettings& settings = {});

// Exactly `count` blue-noise samples: random ones thinned by weighted sample elimination (Yuksel,
// "Sample Elimination for Generating Poisson Disk Sample Sets", Eurographics 2015). The result is
// the same for any number of threads.
std::vector<SurfacePoint> blueNoiseSamples(const Mesh& mesh, std::size_t count,
                                           const SampleSettings& settings = {});

}  // namespace innermap

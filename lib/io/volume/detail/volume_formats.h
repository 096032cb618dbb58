// The writers behind volumeFormats().
#pragma once

#include <cstdint>
#include <string>

#include "innermap/io/volume_texture.h"

namespace innermap {

// What a format does with grids; settings are those that it heeds, others have their defaults.
// write: the file appears whole or not at all; memory: its peak need beside the grids, bytes; plan:
// what write would return, but for the counts. All throw as writeVolumeTexture does.
struct VolumeWriter {
  using Write = VolumeTextureResult (*)(const std::string& path, const openvdb::GridPtrVec& grids,
                                        const VolumeTextureSettings& settings);
  using Memory = std::uint64_t (*)(const openvdb::GridPtrVec& grids,
                                   const VolumeTextureSettings& settings);
  Write write, plan;
  Memory memory;
};

VolumeTextureResult writeExrVolume(const std::string& path, const openvdb::GridPtrVec& grids,
                                   const VolumeTextureSettings& settings);
VolumeTextureResult planExrVolume(const std::string& path, const openvdb::GridPtrVec& grids,
                                  const VolumeTextureSettings& settings);
std::uint64_t exrVolumeMemory(const openvdb::GridPtrVec& grids,
                              const VolumeTextureSettings& settings);

VolumeTextureResult writeNanoVdb(const std::string& path, const openvdb::GridPtrVec& grids,
                                 const VolumeTextureSettings& settings);
VolumeTextureResult planNanoVdb(const std::string& path, const openvdb::GridPtrVec& grids,
                                const VolumeTextureSettings& settings);
std::uint64_t nanoVdbMemory(const openvdb::GridPtrVec& grids,
                            const VolumeTextureSettings& settings);

VolumeTextureResult writeVti(const std::string& path, const openvdb::GridPtrVec& grids,
                             const VolumeTextureSettings& settings);
VolumeTextureResult planVti(const std::string& path, const openvdb::GridPtrVec& grids,
                            const VolumeTextureSettings& settings);
std::uint64_t vtiMemory(const openvdb::GridPtrVec& grids, const VolumeTextureSettings& settings);

VolumeTextureResult writeDds(const std::string& path, const openvdb::GridPtrVec& grids,
                             const VolumeTextureSettings& settings);
VolumeTextureResult planDds(const std::string& path, const openvdb::GridPtrVec& grids,
                            const VolumeTextureSettings& settings);
std::uint64_t ddsMemory(const openvdb::GridPtrVec& grids, const VolumeTextureSettings& settings);

}  // namespace innermap

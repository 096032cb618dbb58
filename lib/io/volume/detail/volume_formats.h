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
  Write write = nullptr, plan = nullptr;
  Memory memory = nullptr;
};

struct VolumeReader {
  VolumeTextureContents (*read)(const std::string& path,
                                const VolumeTextureReadSettings& settings) =
      nullptr;  // null: files of this kind are not read
  VolumeTextureNeed (*need)(const std::string& path,
                            const VolumeTextureReadSettings& settings) = nullptr;
  // Those of VolumeTextureReadSettings that it heeds, by the names in describe(); "tiles", "rows".
  std::vector<std::string> settings;
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

VolumeTextureResult writeNifti(const std::string& path, const openvdb::GridPtrVec& grids,
                               const VolumeTextureSettings& settings);
VolumeTextureResult planNifti(const std::string& path, const openvdb::GridPtrVec& grids,
                              const VolumeTextureSettings& settings);
std::uint64_t niftiMemory(const openvdb::GridPtrVec& grids, const VolumeTextureSettings& settings);

// The readers, as readVolumeTexture and volumeTextureReadNeed.
VolumeTextureContents readExrVolume(const std::string& path,
                                    const VolumeTextureReadSettings& settings);
VolumeTextureNeed exrVolumeNeed(const std::string& path, const VolumeTextureReadSettings& settings);
VolumeTextureContents readNifti(const std::string& path, const VolumeTextureReadSettings& settings);
VolumeTextureNeed niftiNeed(const std::string& path, const VolumeTextureReadSettings& settings);

}  // namespace innermap

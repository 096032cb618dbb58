// The pictures of a volume texture: found, described, checked, and read slice by slice.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/frame_files.h"
#include "innermap/io/volume_texture.h"
#include "io/exr/detail/exr_reader.h"
#include "io/volume/detail/volume_attributes.h"
#include "io/volume/detail/volume_lattice.h"

namespace innermap {

class VolumeSource {
 public:
  // Opens the first picture, fixes lattice and grids and checks them against it. Throws as
  // readVolumeTexture does.
  VolumeSource(const std::string& path, const VolumeTextureReadSettings& settings);

  VolumeLayout layout() const { return layout_; }
  const VolumeLattice& lattice() const { return lattice_; }
  const std::vector<VolumeGrid>& grids() const { return grids_; }
  bool half(const VolumeGrid& grid) const;  // whether its channels are half floats

  // Peak need of reading slices, beside `outputs`; bytes.
  std::uint64_t memory() const;

  // All channels of the grids, grid after grid, active ones last of each: slice `slice` to
  // `outputs`, height * width floats each. Slices in order. Throws FileError, Cancelled.
  void read(int slice, const std::vector<float*>& outputs);
  const std::vector<std::string>& channels() const { return channels_; }

 private:
  void findFiles(const std::string& path, const VolumeAttributes& attributes);
  void openFirst(const std::string& path);
  void fixLayout(const VolumeAttributes& attributes);
  void fixTiles(const VolumeAttributes& attributes);
  int fixCount(const VolumeAttributes& attributes) const;
  void fixPlace(const VolumeAttributes& attributes);
  void fixGrids(const VolumeAttributes& attributes);
  void checkSlice(int slice, int part) const;
  void readTile(int slice, const std::vector<float*>& outputs);
  int countFiles() const;

  const VolumeTextureReadSettings& settings_;
  VolumeLayout layout_ = VolumeLayout::atlas;
  VolumeLattice lattice_;
  std::vector<VolumeGrid> grids_;
  std::vector<std::string> channels_;
  std::unique_ptr<ExrReader> reader_;
  std::optional<FramePattern> files_;  // of slices
  int firstFile_ = 0;
  bool patternGiven_ = false;
  std::vector<std::vector<float>> tileRow_;  // the row of tiles that was read last
  int tileRowAt_ = -1;
};

// The grids that a picture without attributes holds, named by the user. Throws FileError when the
// names do not match the channels.
std::vector<VolumeGrid> gridsOfChannels(const std::string& path, const Imf::Header& header,
                                        const std::vector<std::string>& names);

}  // namespace innermap

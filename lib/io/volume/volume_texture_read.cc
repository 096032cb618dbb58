
#include <algorithm>

#include "innermap/core/memory.h"
#include "innermap/core/run.h"
#include "innermap/io/volume_texture.h"
#include "io/exr/detail/exr_stream.h"
#include "io/volume/detail/volume_builder.h"
#include "io/volume/detail/volume_formats.h"
#include "io/volume/detail/volume_source.h"

namespace innermap {
namespace {

constexpr int kLeaf = 8;

// The slices of one layer of leaves, all channels.
class Slab {
 public:
  Slab(const VolumeLattice& lattice, std::size_t channels)
      : layer_(static_cast<std::size_t>(lattice.width()) *
               static_cast<std::size_t>(lattice.height())),
        values_(channels) {
    const auto slices = static_cast<std::size_t>(std::min(kLeaf, lattice.slices()));
    for (std::vector<float>& channel : values_) channel.resize(layer_ * slices);
  }

  static std::uint64_t memory(const VolumeLattice& lattice, std::size_t channels) {
    return std::uint64_t(lattice.width()) * std::uint64_t(lattice.height()) *
           std::uint64_t(std::min(kLeaf, lattice.slices())) * channels * sizeof(float);
  }

  std::vector<float*> slice(int index) {
    std::vector<float*> result;
    for (std::vector<float>& channel : values_)
      result.push_back(channel.data() + layer_ * static_cast<std::size_t>(index));
    return result;
  }

  // Of `count` channels from `first` on.
  std::vector<const float*> channels(std::size_t first, std::size_t count) const {
    std::vector<const float*> result;
    for (std::size_t c = first; c < first + count; ++c) result.push_back(values_[c].data());
    return result;
  }

 private:
  std::size_t layer_;
  std::vector<std::vector<float>> values_;
};

// Slices from `first` on that lie in the same layer of leaves.
int slabEnd(const VolumeLattice& lattice, int first) {
  const int at = lattice.origin[lattice.axis] + first;
  const int next = (at & ~(kLeaf - 1)) + kLeaf;
  return std::min(lattice.slices(), first + next - at);
}

class Reading {
 public:
  Reading(const std::string& path, VolumeSource& source) : path_(path), source_(source) {
    const std::uint64_t fixed =
        source.memory() + Slab::memory(source.lattice(), source.channels().size());
    need(fixed);
    fixed_ = fixed;
    for (const VolumeGrid& grid : source.grids())
      builders_.push_back(makeVolumeBuilder(grid, source.lattice(), source.half(grid)));
  }

  std::size_t run() {
    const VolumeLattice& lattice = source_.lattice();
    Slab slab(lattice, source_.channels().size());
    for (int first = 0; first < lattice.slices(); first = slabEnd(lattice, first)) {
      const int end = slabEnd(lattice, first);
      for (int slice = first; slice < end; ++slice) {
        reportProgress("reading the volume texture", static_cast<double>(slice) / lattice.slices());
        source_.read(slice, slab.slice(slice - first));
      }
      build(slab, first, end - first);
    }
    reportProgress("reading the volume texture", 1);
    return notFinite_;
  }

  openvdb::GridPtrVec finish() {
    openvdb::GridPtrVec grids;
    for (const auto& builder : builders_) grids.push_back(builder->finish());
    return grids;
  }

 private:
  void need(std::uint64_t bytes) const {
    requireMemory("reading " + path_, bytes, room_,
                  "read fewer grids by --grids or raise --max-memory");
  }

  void build(const Slab& slab, int first, int count) {
    const VolumeLattice& lattice = source_.lattice();
    const std::uint64_t leaves = (std::uint64_t(lattice.width()) / kLeaf + 2) *
                                 (std::uint64_t(lattice.height()) / kLeaf + 2);
    std::size_t channel = 0;
    for (std::size_t g = 0; g < builders_.size(); ++g) {
      std::uint64_t bytes = fixed_ + leaves * builders_[g]->leafBytes();
      for (const auto& builder : builders_) bytes += builder->memory();
      need(bytes);
      const std::size_t channels = source_.grids()[g].channelCount();
      notFinite_ += builders_[g]->add({first, count, slab.channels(channel, channels)});
      channel += channels;
    }
  }

  const std::string& path_;
  VolumeSource& source_;
  const std::uint64_t room_ = memoryLeft();  // bytes: the grids grow as they are read
  std::uint64_t fixed_ = 0;
  std::vector<std::unique_ptr<VolumeBuilder>> builders_;
  std::size_t notFinite_ = 0;
};

}  // namespace

VolumeTextureNeed exrVolumeNeed(const std::string& path,
                                const VolumeTextureReadSettings& settings) {
  openvdb::initialize();
  const VolumeSource source(path, settings);
  const VolumeLattice& lattice = source.lattice();
  std::uint64_t leaves = 1;
  for (int a = 0; a < 3; ++a) leaves *= static_cast<std::uint64_t>(lattice.size[a]) / kLeaf + 2;
  VolumeTextureNeed need;
  need.resolution = lattice.size;
  need.memory = source.memory() + Slab::memory(lattice, source.channels().size());
  for (const VolumeGrid& grid : source.grids())
    need.memory += leaves * makeVolumeBuilder(grid, lattice, source.half(grid))->leafBytes();
  return need;
}

VolumeTextureContents readExrVolume(const std::string& path,
                                    const VolumeTextureReadSettings& settings) {
  openvdb::initialize();
  const ExrThreads threads;
  VolumeSource source(path, settings);
  Reading reading(path, source);
  VolumeTextureContents contents;
  contents.notFinite = reading.run();
  contents.grids = reading.finish();
  contents.layout = source.layout();
  contents.resolution = source.lattice().size;
  return contents;
}

}  // namespace innermap

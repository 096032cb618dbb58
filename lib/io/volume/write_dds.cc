// DDS volume textures: Microsoft, "DDS_HEADER structure" and "DDS_HEADER_DXT10 structure".
#include <Imath/half.h>
#include <fmt/format.h>

#include <cstring>
#include <ostream>

#include "core/file.h"
#include "core/output_buffer.h"
#include "innermap/core/error.h"
#include "io/volume/detail/dense_types.h"
#include "io/volume/detail/volume_formats.h"

namespace innermap {
namespace {

// Pixels of so many channels, DXGI_FORMAT_...: R16_FLOAT, R32G32_FLOAT and so on. Three channels
// have no 16-bit format and become four.
struct PixelFormat {
  std::size_t channels;
  std::uint32_t half, single;
};
constexpr PixelFormat kFormats[] = {{1, 54, 41}, {2, 34, 16}, {4, 10, 2}};

const PixelFormat& formatOf(const VolumePlan& plan) {
  for (const PixelFormat& format : kFormats)
    if (plan.channels.size() <= format.channels) return format;
  throw DataError(
      fmt::format("the grids have {} components; a DDS texture holds four at most, "
                  "choose fewer grids by --grids",
                  plan.channels.size()));
}

// Where each channel stands in a pixel.
std::vector<std::size_t> slotsOf(const VolumePlan& plan) {
  std::vector<std::size_t> slots;
  for (const std::string& name : plan.channels)
    slots.push_back(name == "Y" ? 0 : std::string("RGBA").find(name));
  return slots;
}

VolumePlan planOf(const openvdb::GridPtrVec& grids, const VolumeTextureSettings& settings) {
  VolumeTextureSettings dense = settings;
  dense.layout = VolumeLayout::parts;  // no tiles
  VolumePlan plan = makeVolumePlan(grids, dense);
  formatOf(plan);
  return plan;
}

void putHeader(OutputBuffer& out, const VolumePlan& plan) {
  const PixelFormat& format = formatOf(plan);
  const auto number = [](int n) { return static_cast<std::uint32_t>(n); };
  const std::uint32_t width = number(plan.lattice.width());
  const auto bytes = static_cast<std::uint32_t>(format.channels * (plan.half ? 2 : 4));
  constexpr std::uint32_t kCapsHeightWidthPitchFormatDepth =
      0x1 | 0x2 | 0x4 | 0x8 | 0x1000 | 0x800000;
  constexpr std::uint32_t kFourCc = 4, kTexture = 0x1000 | 0x8, kVolume = 0x200000, kTexture3d = 4;
  std::uint32_t words[37] = {};
  std::memcpy(&words[0], "DDS ", 4);
  words[1] = 124;
  words[2] = kCapsHeightWidthPitchFormatDepth;
  words[3] = number(plan.lattice.height());
  words[4] = width;
  words[5] = width * bytes;
  words[6] = number(plan.lattice.slices());
  words[7] = 1;    // levels
  words[19] = 32;  // of the pixel format
  words[20] = kFourCc;
  std::memcpy(&words[21], "DX10", 4);
  words[27] = kTexture;
  words[28] = kVolume;
  words[32] = plan.half ? format.half : format.single;
  words[33] = kTexture3d;
  words[35] = 1;  // textures
  out.raw({reinterpret_cast<const char*>(words), sizeof(words)});
}

void putNumber(OutputBuffer& out, double value, bool asHalf) {
  const auto single = static_cast<float>(value);
  asHalf ? out.number(half(single)) : out.number(single);
}

}  // namespace

VolumeTextureResult planDds(const std::string& path, const openvdb::GridPtrVec& grids,
                            const VolumeTextureSettings& settings) {
  const VolumePlan plan = planOf(grids, settings);
  VolumeTextureResult result = denseResult(path, plan);
  result.channels = plan.channels;
  return result;
}

std::uint64_t ddsMemory(const openvdb::GridPtrVec& grids, const VolumeTextureSettings& settings) {
  return sliceMemory(planOf(grids, settings)) + (std::uint64_t(4) << 20);
}

VolumeTextureResult writeDds(const std::string& path, const openvdb::GridPtrVec& grids,
                             const VolumeTextureSettings& settings) {
  const VolumePlan plan = planOf(grids, settings);
  const std::size_t channels = formatOf(plan).channels;
  VolumeTextureResult result = planDds(path, grids, settings);
  writeWholeFile(path, [&](std::ostream& stream) {
    OutputBuffer out(stream);
    putHeader(out, plan);
    const std::vector<std::size_t> slots = slotsOf(plan);
    const auto put = [&](int, const SliceValues& values) {
      for (std::size_t i = 0; i < values[0].size(); ++i) {
        // What is missing is 0, alpha 1, as where a shader samples fewer channels.
        double pixel[4] = {0, 0, 0, 1};
        for (std::size_t c = 0; c < values.size(); ++c) pixel[slots[c]] = values[c][i];
        for (std::size_t c = 0; c < channels; ++c) putNumber(out, pixel[c], plan.half);
      }
    };
    const PixelCounts counts = forSlices(plan, 0, plan.grids.size(), "writing the DDS file", put);
    result.clamped = counts.clamped;
    result.inexact = counts.inexact;
  });
  return result;
}

}  // namespace innermap

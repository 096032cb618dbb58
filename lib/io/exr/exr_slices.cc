#include "innermap/io/exr_slices.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <ostream>
#include <set>

#include "core/file.h"
#include "innermap/core/error.h"
#include "innermap/core/memory.h"
#include "innermap/core/run.h"
#include "innermap/core/version.h"
#include "innermap/io/pictures.h"
#include "io/exr/detail/exr_stream.h"

namespace innermap {
namespace {

constexpr float kLargestHalf = 65504.0f;

bool tellsSolid(const openvdb::GridPtrVec& grids) {
  return std::any_of(grids.begin(), grids.end(), [](const auto& grid) {
    return grid->getName() == "surface" || grid->getName() == "density";
  });
}

std::vector<std::string> allChannels(const openvdb::GridPtrVec& grids) {
  std::vector<std::string> names;
  for (const auto& grid : grids)
    for (const std::string& name : channelNames(*grid)) names.push_back(name);
  if (!tellsSolid(grids)) names.push_back("mask.V");
  if (std::set<std::string>(names.begin(), names.end()).size() != names.size())
    throw DataError("two grids have the same name; rename one");
  for (const std::string& name : names)
    if (name.size() > 255)
      throw DataError("the grid name '" + name + "' is too long for an EXR channel; shorten it");
  return names;
}

Imath::M44d imageToWorld(const SliceFrame& frame, int layer) {
  const Vec3 o = frame.world(0, 0, layer);
  const Vec3 c = frame.world(1, 0, layer) - o, r = frame.world(0, 1, layer) - o;
  Vec3 n = cross(c, r);
  n = n * (norm(c) / std::max(norm(n), 1e-300));
  return {c.x, c.y, c.z, 0, r.x, r.y, r.z, 0, n.x, n.y, n.z, 0, o.x, o.y, o.z, 1};
}

Imf::Header headerFor(const SliceFrame& frame, int layer, std::size_t number, std::size_t count,
                      const std::vector<std::string>& channels, Imf::PixelType type) {
  Imf::Header header(static_cast<int>(frame.columns()), static_cast<int>(frame.rows()));
  header.setName(fmt::format("{}_{:04}", axisName(frame.axis), number));
  header.setType(Imf::SCANLINEIMAGE);
  header.compression() = Imf::ZIP_COMPRESSION;
  for (const std::string& name : channels) header.channels().insert(name, Imf::Channel(type));
  header.insert("sliceAxis", Imf::StringAttribute(std::string(1, axisName(frame.axis))));
  header.insert("sliceIndex", Imf::IntAttribute(layer));
  header.insert("sliceCount", Imf::IntAttribute(static_cast<int>(count)));
  header.insert("slicePosition", Imf::DoubleAttribute(frame.position(layer)));
  header.insert("voxelSize", Imf::DoubleAttribute(frame.transform->voxelSize()[frame.axis]));
  header.insert("imageToWorld", Imf::M44dAttribute(imageToWorld(frame, layer)));
  header.insert("software", Imf::StringAttribute(std::string("innermap ") + versionText()));
  return header;
}

// The pixels of one part.
class SlicePixels {
 public:
  SlicePixels(const SliceFrame& frame, bool asHalf) : frame_(frame), half_(asHalf) {}

  void add(const std::string& name, std::vector<float> values) {
    if (half_) {
      std::vector<half> halves(values.size());
      for (std::size_t i = 0; i < values.size(); ++i) {
        const float v = values[i];
        if (std::isfinite(v) && std::abs(v) > kLargestHalf) ++clamped_;
        halves[i] = half(std::isfinite(v) ? std::clamp(v, -kLargestHalf, kLargestHalf) : v);
      }
      halves_.push_back(std::move(halves));
      insert(name, reinterpret_cast<char*>(halves_.back().data()), sizeof(half));
    } else {
      floats_.push_back(std::move(values));
      insert(name, reinterpret_cast<char*>(floats_.back().data()), sizeof(float));
    }
  }

  const Imf::FrameBuffer& buffer() const { return buffer_; }
  std::size_t clamped() const { return clamped_; }

 private:
  void insert(const std::string& name, char* data, std::size_t size) {
    buffer_.insert(name,
                   Imf::Slice(half_ ? Imf::HALF : Imf::FLOAT, data, size, size * frame_.columns()));
  }

  const SliceFrame& frame_;
  const bool half_;
  Imf::FrameBuffer buffer_;
  std::vector<std::vector<float>> floats_;
  std::vector<std::vector<half>> halves_;
  std::size_t clamped_ = 0;
};

SlicePixels pixelsOf(const openvdb::GridPtrVec& grids, const SliceFrame& frame, int layer,
                     bool asHalf) {
  SlicePixels pixels(frame, asHalf);
  for (const auto& grid : grids) {
    throwIfCancelled();
    for (SliceChannel& channel : sliceGrid(*grid, frame, layer))
      pixels.add(channel.name, std::move(channel.values));
  }
  if (!tellsSolid(grids)) pixels.add("mask.V", sliceMask(grids, frame, layer));
  return pixels;
}

std::uint64_t memoryFor(const SliceFrame& frame, std::size_t channels, int slices) {
  // The values of a slice, a grid's more while they are turned to halves; of each part its header
  // and OpenEXR's buffer of 16 lines, raw and compressed.
  constexpr std::uint64_t kHeader = 16384, kLines = 40;
  return frame.rows() * frame.columns() * (channels + 3) * sizeof(float) +
         static_cast<std::uint64_t>(slices) *
             (kHeader + frame.columns() * channels * sizeof(float) * kLines);
}

}  // namespace

std::uint64_t exrSliceMemory(const openvdb::GridPtrVec& grids, const ExrSliceSettings& settings) {
  return memoryFor(sliceFrame(grids, settings.axis), allChannels(grids).size(), settings.count);
}

ExrSliceResult writeExrSlices(const std::string& path, const openvdb::GridPtrVec& grids,
                              const ExrSliceSettings& settings) {
  if (settings.axis < 0 || settings.axis > 2) throw SettingError("axis", "is not one of x, y, z");
  requireDescribed(settings);
  const SliceFrame frame = sliceFrame(grids, settings.axis);
  const std::vector<std::string> channels = allChannels(grids);
  requireMemory("slicing to " + path, memoryFor(frame, channels.size(), settings.count),
                "slice fewer grids or along another axis");
  const std::vector<int> layers = sliceLayers(frame, settings.count);
  std::vector<Imf::Header> headers;
  for (std::size_t i = 0; i < layers.size(); ++i)
    headers.push_back(headerFor(frame, layers[i], i, layers.size(), channels,
                                settings.half ? Imf::HALF : Imf::FLOAT));
  ExrSliceResult result;
  result.slices = static_cast<int>(layers.size());
  result.columns = frame.columns();
  result.rows = frame.rows();
  writeWholeFile(path, [&](std::ostream& file) {
    withExrErrors(path, "written", "; free some space", [&] {
      ExrOutputStream stream(path, file);
      auto output = std::make_unique<Imf::MultiPartOutputFile>(stream, headers.data(),
                                                               static_cast<int>(headers.size()));
      for (std::size_t i = 0; i < layers.size(); ++i) {
        reportProgress("writing slices",
                       static_cast<double>(i) / static_cast<double>(layers.size()));
        const SlicePixels pixels = pixelsOf(grids, frame, layers[i], settings.half);
        Imf::OutputPart part(*output, static_cast<int>(i));
        part.setFrameBuffer(pixels.buffer());
        part.writePixels(static_cast<int>(frame.rows()));
        result.clamped += pixels.clamped();
      }
      output.reset();
      stream.requireComplete();
    });
    reportProgress("writing slices", 1);
  });
  return result;
}

std::vector<Setting> describe(ExrSliceSettings& s) {
  return {axisSetting("axis", &s.axis, "direction across the slices"),
          Setting("slices", "N", &s.count, "number of slices, evenly spaced")
              .from(1, 65536)
              .was("count"),
          Setting("half", &s.half, "half floats: half the size, three digits")};
}

}  // namespace innermap

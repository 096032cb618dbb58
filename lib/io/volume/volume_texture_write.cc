#include <Imath/half.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <ostream>

#include "core/file.h"
#include "core/frame_files.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "innermap/io/pictures.h"
#include "innermap/io/volume_texture.h"
#include "io/exr/detail/exr_stream.h"
#include "io/volume/detail/volume_formats.h"
#include "io/volume/detail/volume_plan.h"

namespace innermap {
namespace {

constexpr int kStripe = 64;  // rows of pixels that are made at once; compression takes 16

// Makes rows of pixels, a stripe at a time, and hands them to OpenEXR.
class StripeWriter {
 public:
  StripeWriter(const VolumePlan& plan)
      : plan_(plan),
        bytes_(plan.half ? sizeof(half) : sizeof(float)),
        total_(double(plan.lattice.slices()) * plan.lattice.height()),
        buffers_(plan.channels.size()) {
    for (std::vector<char>& buffer : buffers_)
      buffer.resize(bytes_ * static_cast<std::size_t>(plan.width()) *
                    static_cast<std::size_t>(std::min(kStripe, plan.height())));
  }

  // The picture whose first tile is slice `first`. Output: Imf::OutputFile or Imf::OutputPart.
  template <class Output>
  void write(Output& output, int first) {
    const int height = plan_.height();
    for (int begin = 0; begin < height; begin += kStripe) {
      const int end = std::min(begin + kStripe, height);
      make(first, begin, end);
      output.setFrameBuffer(frameBuffer(begin));
      output.writePixels(end - begin);
      done_ += double(end - begin) * plan_.lattice.tileColumns;
      reportProgress("writing the volume texture", std::min(1.0, done_ / total_));
    }
  }

  std::size_t clamped() const { return clamped_; }
  std::size_t inexact() const { return inexact_; }

 private:
  void make(int first, int begin, int end) {
    const auto columns = static_cast<std::size_t>(plan_.lattice.tileColumns);
    // Blocks of a row of tiles at least, so that short rows are not work of their own.
    const std::size_t block = std::max<std::size_t>(
        1, 4096 / static_cast<std::size_t>(std::max(1, plan_.lattice.width())));
    parallelBlocks(static_cast<std::size_t>(end - begin) * columns, block,
                   [&](std::size_t from, std::size_t to) {
                     PixelCounts counts;
                     std::vector<double> row(static_cast<std::size_t>(plan_.lattice.width()) *
                                             plan_.channels.size());
                     for (std::size_t i = from; i < to; ++i)
                       makeRow(first, begin, static_cast<int>(i / columns),
                               static_cast<int>(i % columns), row, counts);
                     clamped_ += counts.clamped;
                     inexact_ += counts.inexact;
                   });
  }

  // One row of one tile, to all channels.
  void makeRow(int first, int begin, int line, int tile, std::vector<double>& values,
               PixelCounts& counts) {
    const VolumeLattice& lattice = plan_.lattice;
    const auto width = static_cast<std::size_t>(lattice.width());
    const int y = begin + line;
    const int slice = first + y / lattice.height() * lattice.tileColumns + tile;
    if (slice < lattice.slices()) {
      sampleRow(slice, y % lattice.height(), values, counts);
    } else {
      for (std::size_t c = 0; c < plan_.channels.size(); ++c)
        std::fill_n(values.begin() + static_cast<std::ptrdiff_t>(c * width), width, plan_.fill[c]);
    }
    const std::size_t at =
        static_cast<std::size_t>(line) * static_cast<std::size_t>(plan_.width()) +
        static_cast<std::size_t>(tile) * width;
    for (std::size_t c = 0; c < plan_.channels.size(); ++c) {
      const double* from = values.data() + c * width;
      if (plan_.half)
        std::copy_n(from, width, reinterpret_cast<half*>(buffers_[c].data()) + at);
      else
        std::copy_n(from, width, reinterpret_cast<float*>(buffers_[c].data()) + at);
    }
  }

  void sampleRow(int slice, int row, std::vector<double>& values, PixelCounts& counts) const {
    const auto width = static_cast<std::size_t>(plan_.lattice.width());
    double* next = values.data();
    for (std::size_t g = 0; g < plan_.grids.size(); ++g) {
      const VolumeGrid& grid = plan_.grids[g];
      double* outputs[3] = {next, next + width, next + 2 * width};
      next += width * grid.channels.size();
      double* active = grid.activeChannel.empty() ? nullptr : next;
      if (active) next += width;
      const PixelCounts c = plan_.samplers[g]->row(plan_.lattice, slice, row, outputs, active);
      counts.clamped += c.clamped;
      counts.inexact += c.inexact;
    }
  }

  // Row `begin` of the picture is the first of the buffers.
  Imf::FrameBuffer frameBuffer(int begin) {
    Imf::FrameBuffer frame;
    const std::size_t stride = bytes_ * static_cast<std::size_t>(plan_.width());
    for (std::size_t c = 0; c < buffers_.size(); ++c)
      frame.insert(plan_.channels[c],
                   Imf::Slice::Make(plan_.half ? Imf::HALF : Imf::FLOAT, buffers_[c].data(),
                                    Imath::V2i(0, begin), plan_.width(), plan_.height() - begin,
                                    bytes_, stride));
    return frame;
  }

  const VolumePlan& plan_;
  std::size_t bytes_;
  double total_, done_ = 0;  // rows of tiles
  std::vector<std::vector<char>> buffers_;
  std::atomic<std::size_t> clamped_{0}, inexact_{0};
};

Imf::Header headerFor(const VolumePlan& plan, VolumeLayout layout) {
  Imf::Header header(plan.width(), plan.height());
  header.setType(Imf::SCANLINEIMAGE);
  header.compression() = Imf::ZIP_COMPRESSION;
  for (const std::string& name : plan.channels)
    header.channels().insert(name, Imf::Channel(plan.half ? Imf::HALF : Imf::FLOAT));
  insertVolumeAttributes(header, volumeLayoutName(layout), plan.lattice, plan.grids);
  return header;
}

Imf::Header sliceHeader(Imf::Header header, const VolumeLattice& lattice, int slice) {
  header.setName(fmt::format("{}_{:04}", axisName(lattice.axis), slice));
  header.insert("volumeSliceIndex", Imf::IntAttribute(slice));
  return header;
}

void withStream(const std::string& path, const std::function<void(Imf::OStream&)>& body) {
  writeWholeFile(path, [&](std::ostream& file) {
    withExrErrors(path, "written", "; free some space", [&] {
      ExrOutputStream stream(path, file);
      body(stream);
      stream.requireComplete();
    });
  });
}

void writeAtlas(const std::string& path, const VolumePlan& plan, StripeWriter& writer) {
  withStream(path, [&](Imf::OStream& stream) {
    Imf::OutputFile output(stream, headerFor(plan, VolumeLayout::atlas));
    writer.write(output, 0);
  });
}

void writeParts(const std::string& path, const VolumePlan& plan, StripeWriter& writer) {
  const Imf::Header common = headerFor(plan, VolumeLayout::parts);
  std::vector<Imf::Header> headers;
  for (int i = 0; i < plan.lattice.slices(); ++i)
    headers.push_back(sliceHeader(common, plan.lattice, i));
  withStream(path, [&](Imf::OStream& stream) {
    Imf::MultiPartOutputFile output(stream, headers.data(), static_cast<int>(headers.size()));
    for (int i = 0; i < plan.lattice.slices(); ++i) {
      Imf::OutputPart part(output, i);
      writer.write(part, i);
    }
  });
}

void writeSliceFiles(const std::vector<std::string>& paths, const VolumePlan& plan,
                     StripeWriter& writer) {
  const Imf::Header common = headerFor(plan, VolumeLayout::slices);
  const std::filesystem::path parent = std::filesystem::path(paths.front()).parent_path();
  PendingFolder folder(parent.empty() ? "." : parent.string());
  for (int i = 0; i < plan.lattice.slices(); ++i) {
    throwIfCancelled();
    const auto name = std::filesystem::path(paths[static_cast<std::size_t>(i)]).filename();
    folder.write(name.string(), [&](const std::string& temporary) {
      withStream(temporary, [&](Imf::OStream& stream) {
        Imf::OutputFile output(stream, sliceHeader(common, plan.lattice, i));
        writer.write(output, i);
      });
    });
  }
  folder.commit();
}

VolumeTextureResult resultOf(const std::string& path, const VolumePlan& plan, VolumeLayout layout) {
  VolumeTextureResult r;
  r.files = {path};
  if (layout == VolumeLayout::slices) {
    r.files.clear();
    const FramePattern numbered("output", path);
    for (int i = 0; i < plan.lattice.slices(); ++i) r.files.push_back(numbered.path(i));
  }
  r.channels = plan.channels;
  r.width = plan.width();
  r.height = plan.height();
  r.tileColumns = plan.lattice.tileColumns;
  r.tileRows = plan.lattice.tileRows;
  r.slices = plan.lattice.slices();
  r.tileWidth = plan.lattice.width();
  r.tileHeight = plan.lattice.height();
  r.resolution = plan.lattice.size;
  r.worldBox = plan.lattice.worldBox();
  return r;
}

std::uint64_t memoryFor(const VolumePlan& plan, VolumeLayout layout) {
  // A stripe, and OpenEXR's line buffers, raw and compressed: measured, 5.5 stripes of an atlas of
  // 4096 slices; headers of parts.
  const std::uint64_t rows = static_cast<std::uint64_t>(std::min(plan.height(), kStripe));
  const std::uint64_t bytes = std::uint64_t(plan.width()) * rows * plan.channels.size() * 4;
  // Each part has its header, and two buffers of 16 lines a thread, raw and compressed.
  const std::uint64_t part =
      16384 + ExrThreads::allowed() * 2 * bytes / std::max<std::uint64_t>(rows, 1) * 40;
  return 6 * bytes +
         (layout == VolumeLayout::parts ? std::uint64_t(plan.lattice.slices()) * part : 0);
}

}  // namespace

VolumeLayout parseVolumeLayout(const std::string& setting, const std::string& text) {
  for (const VolumeLayout layout : {VolumeLayout::atlas, VolumeLayout::slices, VolumeLayout::parts})
    if (text == volumeLayoutName(layout)) return layout;
  throw SettingError(setting, "'" + text + "' is not one of atlas, slices, parts");
}

std::string volumeLayoutName(VolumeLayout layout) {
  return layout == VolumeLayout::atlas    ? "atlas"
         : layout == VolumeLayout::slices ? "slices"
                                          : "parts";
}

std::uint64_t exrVolumeMemory(const openvdb::GridPtrVec& grids,
                              const VolumeTextureSettings& settings) {
  return memoryFor(makeVolumePlan(grids, settings), settings.layout);
}

VolumeTextureResult planExrVolume(const std::string& path, const openvdb::GridPtrVec& grids,
                                  const VolumeTextureSettings& settings) {
  return resultOf(path, makeVolumePlan(grids, settings), settings.layout);
}

VolumeTextureResult writeExrVolume(const std::string& path, const openvdb::GridPtrVec& grids,
                                   const VolumeTextureSettings& settings) {
  const VolumePlan plan = makeVolumePlan(grids, settings);
  VolumeTextureResult result = resultOf(path, plan, settings.layout);
  reportProgress("writing the volume texture", 0);
  const ExrThreads threads;
  StripeWriter writer(plan);
  if (settings.layout == VolumeLayout::atlas)
    writeAtlas(path, plan, writer);
  else if (settings.layout == VolumeLayout::parts)
    writeParts(path, plan, writer);
  else
    writeSliceFiles(result.files, plan, writer);
  result.clamped = writer.clamped();
  result.inexact = writer.inexact();
  return result;
}

}  // namespace innermap

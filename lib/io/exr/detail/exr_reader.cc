#include "io/exr/detail/exr_reader.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfThreading.h>
#include <OpenEXR/ImfTileDescription.h>
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "innermap/core/error.h"

namespace innermap {
namespace {

constexpr std::uint64_t kMostLines = 256;  // that a compression takes together

}  // namespace

ExrReader::ExrReader(const std::string& path) : path_(path) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored))
    throw FileError(path, "does not exist; give the path of an .exr file");
  if (std::filesystem::is_directory(path, ignored))
    throw FileError(path, "is a folder; give the path of an .exr file");
  withExrErrors(path, "read", "", [&] {
    stream_ = std::make_unique<ExrInputStream>(path);
    file_ = std::make_unique<Imf::MultiPartInputFile>(*stream_, Imf::globalThreadCount(),
                                                      /*reconstructChunkOffsetTable=*/false);
  });
}

int ExrReader::width(int part) const {
  const Imath::Box2i window = header(part).dataWindow();
  return window.max.x - window.min.x + 1;
}

int ExrReader::height(int part) const {
  const Imath::Box2i window = header(part).dataWindow();
  return window.max.y - window.min.y + 1;
}

void ExrReader::check(int part, const std::vector<std::string>& channels) const {
  const Imf::Header& h = header(part);
  if (h.hasType() && Imf::isDeepData(h.type()))
    throw FileError(path_, "has deep samples; a volume texture has one a pixel");
  if (h.dataWindow() != h.displayWindow())
    throw FileError(path_, "is cropped: its data window is not the display window; write it whole");
  for (const std::string& name : channels) {
    const Imf::Channel* channel = h.channels().findChannel(name);
    if (!channel) {
      std::vector<std::string> there;
      for (auto c = h.channels().begin(); c != h.channels().end(); ++c) there.push_back(c.name());
      throw FileError(path_,
                      fmt::format("has no channel '{}'; it has {}", name, fmt::join(there, ", ")));
    }
    if (channel->xSampling != 1 || channel->ySampling != 1)
      throw FileError(path_, fmt::format("its channel '{}' is subsampled; write it whole", name));
  }
}

std::uint64_t ExrReader::memory(int part) const {
  const Imf::Header& h = header(part);
  std::uint64_t columns = static_cast<std::uint64_t>(width(part));
  std::uint64_t lines = std::min(kMostLines, static_cast<std::uint64_t>(height(part)));
  double bytes = 0;
  if (h.hasTileDescription()) {
    columns = std::max<std::uint64_t>(columns, h.tileDescription().xSize);
    lines = h.tileDescription().ySize;
  }
  for (auto c = h.channels().begin(); c != h.channels().end(); ++c) bytes += 4;
  // Compressed and plain data of a chunk for each that is decoded at the same time.
  bytes *= static_cast<double>(columns) * static_cast<double>(lines) *
           (2 + 2 * static_cast<double>(Imf::globalThreadCount()));
  // What a damaged file says need not fit 64 bits.
  return static_cast<std::uint64_t>(std::min(bytes, 1e18));
}

void ExrReader::read(int part, int begin, int count, const std::vector<std::string>& channels,
                     const std::vector<float*>& outputs) {
  withExrErrors(path_, "read", "", [&] {
    if (openPart_ != part) {
      open_ = std::make_unique<Imf::InputPart>(*file_, part);
      openPart_ = part;
    }
    const Imath::Box2i window = header(part).dataWindow();
    Imf::FrameBuffer frame;
    for (std::size_t c = 0; c < channels.size(); ++c)
      frame.insert(
          channels[c],
          Imf::Slice::Make(Imf::FLOAT, outputs[c], Imath::V2i(window.min.x, window.min.y + begin),
                           width(part), count, sizeof(float),
                           sizeof(float) * static_cast<std::size_t>(width(part))));
    open_->setFrameBuffer(frame);
    open_->readPixels(window.min.y + begin, window.min.y + begin + count - 1);
  });
}

}  // namespace innermap

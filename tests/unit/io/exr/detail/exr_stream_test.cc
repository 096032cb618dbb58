#include "io/exr/detail/exr_stream.h"

#include <OpenEXR/ImfArray.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfOutputFile.h>
#include <gtest/gtest.h>

#include <memory>
#include <sstream>
#include <vector>

#include "innermap/core/error.h"

namespace innermap {
namespace {

// A picture of which `rows` of 64 are written: those that are not have no place in the file.
void writeRows(ExrOutputStream& stream, int rows) {
  Imf::Header header(8, 64);
  header.compression() = Imf::ZIPS_COMPRESSION;
  header.channels().insert("Y", Imf::Channel(Imf::FLOAT));
  std::vector<float> pixels(8 * 64, 0.5f);
  Imf::FrameBuffer buffer;
  buffer.insert("Y", Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(pixels.data()), sizeof(float),
                                8 * sizeof(float)));
  const auto output = std::make_unique<Imf::OutputFile>(stream, header);
  output->setFrameBuffer(buffer);
  output->writePixels(rows);
}

TEST(ExrOutputStream, KnowsWhenAChunkIsMissing) {
  std::ostringstream whole, part;
  ExrOutputStream first("whole.exr", whole), second("part.exr", part);
  writeRows(first, 64);
  EXPECT_NO_THROW(first.requireComplete());
  writeRows(second, 63);
  EXPECT_THROW(second.requireComplete(), FileError);
}

}  // namespace
}  // namespace innermap

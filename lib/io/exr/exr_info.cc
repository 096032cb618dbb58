#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "innermap/core/error.h"
#include "innermap/io/exr_slices.h"
#include "io/exr/detail/exr_stream.h"

namespace innermap {

std::vector<ExrPart> readExrInfo(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored))
    throw FileError(path, "does not exist; give the path of an .exr file");
  if (!std::ifstream(path))
    throw FileError(path, std::string("cannot be opened (") + std::strerror(errno) + ")");
  std::vector<ExrPart> parts;
  withExrErrors(path, "read", "", [&] {
    ExrInputStream stream(path);
    const Imf::MultiPartInputFile file(stream, 0, /*reconstructChunkOffsetTable=*/false);
    for (int i = 0; i < file.parts(); ++i) {
      const Imf::Header& header = file.header(i);
      const Imath::Box2i& window = header.dataWindow();
      ExrPart part;
      if (header.hasName()) part.name = header.name();
      part.width = window.max.x - window.min.x + 1;
      part.height = window.max.y - window.min.y + 1;
      for (auto c = header.channels().begin(); c != header.channels().end(); ++c)
        part.channels.push_back(c.name());
      parts.push_back(std::move(part));
    }
  });
  return parts;
}

std::string describe(const std::vector<ExrPart>& parts, const std::string& path) {
  std::string text =
      fmt::format("{}: EXR, {} part{}\n", path, parts.size(), parts.size() == 1 ? "" : "s");
  for (const ExrPart& part : parts)
    text += fmt::format("  {}{}{} x {}: {}\n", part.name, part.name.empty() ? "" : ": ", part.width,
                        part.height, fmt::join(part.channels, ", "));
  return text;
}

}  // namespace innermap

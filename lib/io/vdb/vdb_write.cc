#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <ios>
#include <ostream>
#include <set>

#include "core/file.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "innermap/core/version.h"
#include "innermap/io/vdb_file.h"
#include "io/vdb/detail/vdb_stream.h"
#include "levelset/set_metadata.h"

namespace innermap {
namespace {

// openvdb::io::File does not notice a full disk; an archive over our own stream does.
class OutputArchive : public openvdb::io::Archive {
 public:
  explicit OutputArchive(VdbCompression compression) {
    std::uint32_t flags = openvdb::io::COMPRESS_ACTIVE_MASK;
    if (compression == VdbCompression::zip) flags |= openvdb::io::COMPRESS_ZIP;
    if (compression == VdbCompression::blosc)
      flags |= hasBloscCompression() ? openvdb::io::COMPRESS_BLOSC : openvdb::io::COMPRESS_ZIP;
    setCompression(flags);
    setInstancingEnabled(false);
    setGridStatsMetadataEnabled(true);
  }

  void writeTo(std::ostream& stream, const openvdb::GridCPtrVec& grids,
               const openvdb::MetaMap& metadata) const {
    Archive::write(stream, grids, /*seekable=*/true, metadata);
  }
};

std::string creator() { return std::string("innermap ") + versionText(); }

// Shallow copies under the names of the file; the voxels are shared.
openvdb::GridCPtrVec named(const std::string& path, const openvdb::GridPtrVec& grids,
                           NamingScheme scheme) {
  openvdb::GridCPtrVec copies;
  std::set<std::string> seen;
  for (const openvdb::GridBase::Ptr& grid : grids) {
    if (!grid) throw DataError(path + ": a grid to write does not exist");
    const openvdb::GridBase::Ptr copy = grid->copyGrid();
    const std::string name = gridName(grid->getName(), scheme);
    if (name.empty()) throw DataError(path + ": a grid has no name; name it");
    if (name.size() > 63)
      throw DataError(
          fmt::format("{}: the grid name '{}' is over 63 characters; shorten it", path, name));
    if (!seen.insert(name).second)
      throw DataError(fmt::format("{}: two grids are named '{}'; rename one", path, name));
    copy->setName(name);
    if (copy->getCreator().empty()) copy->setCreator(creator());
    copies.push_back(copy);
  }
  return copies;
}

}  // namespace

std::string gridName(const std::string& own, NamingScheme scheme) {
  if (scheme == NamingScheme::blender && own == "Cd") return "color";
  if (scheme == NamingScheme::houdini && own == "velocity") return "v";
  return own;
}

void writeVdb(const std::string& path, const openvdb::GridPtrVec& grids,
              const openvdb::MetaMap& fileMetadata, const VdbWriteSettings& settings) {
  openvdb::initialize();
  const openvdb::GridCPtrVec copies = named(path, grids, settings.names);
  openvdb::MetaMap metadata(fileMetadata);
  setMetadata(metadata, "creator", openvdb::StringMetadata(creator()));
  reportProgress("writing the VDB file", 0);
  writeWholeFile(path, [&](std::ostream& file) {
    PollingOutputBuffer buffer(*file.rdbuf());
    std::ostream stream(&buffer);
    stream.exceptions(std::ios::badbit | std::ios::failbit);
    errno = 0;
    try {
      OutputArchive(settings.compression).writeTo(stream, copies, metadata);
      const std::string uuid = buffer.contentUuid();
      stream.seekp(kUuidPlace);
      stream.write(uuid.data(), static_cast<std::streamsize>(uuid.size()));
    } catch (const std::ios_base::failure&) {
      throw FileError(path, fmt::format("cannot be written ({}); free some space",
                                        errno ? std::strerror(errno) : "write error"));
    } catch (const openvdb::Exception& error) {
      throw FileError(path, fmt::format("cannot be written ({})", error.what()));
    }
    reportProgress("writing the VDB file", 1);
  });
}

Setting namesSetting(NamingScheme* names) {
  return {"names", "SCHEME",
          choiceOf<NamingScheme>(names, {{"innermap", NamingScheme::innermap},
                                         {"blender", NamingScheme::blender},
                                         {"houdini", NamingScheme::houdini}}),
          "names of the grids in the file"};
}

}  // namespace innermap

#include <fmt/format.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/io/io.h>

#include <algorithm>
#include <istream>

#include "innermap/core/error.h"
#include "innermap/core/memory.h"
#include "innermap/core/run.h"
#include "innermap/io/vdb_file.h"
#include "io/vdb/detail/vdb_stream.h"
#include "io/vdb/detail/vdb_verify.h"

namespace innermap {
namespace {

using openvdb::io::GridDescriptor;

std::string listed(const std::vector<GridDescriptor>& grids) {
  std::vector<std::string> names;
  for (const GridDescriptor& g : grids)
    names.push_back(GridDescriptor::nameAsString(g.uniqueName()));
  return names.empty() ? "no grids" : fmt::format("{}", fmt::join(names, ", "));
}

// Reads through our own stream: io::File would map the file, and trust it.
class InputArchive : public openvdb::io::Archive {
 public:
  explicit InputArchive(const std::string& path) : path_(path), buffer_(path), stream_(&buffer_) {
    stream_.exceptions(std::ios::badbit | std::ios::failbit | std::ios::eofbit);
    verified_ = verifyVdb(path, stream_, buffer_.size());
    stream_.seekg(0);
    openvdb::io::setStreamMetadataPtr(stream_, streamMetadata_, /*transfer=*/false);
    readHeader(stream_);
    setFormatVersion(stream_);
    setLibraryVersion(stream_);
    setDataCompression(stream_);
    metadata_.readMeta(stream_);
    const std::int32_t count = readGridCount(stream_);
    for (std::int32_t i = 0; i < count; ++i) {
      GridDescriptor descriptor;
      descriptor.read(stream_);
      descriptors_.push_back(descriptor);
      stream_.seekg(static_cast<std::streamoff>(verified_.at(i).end));
    }
  }

  const std::vector<GridDescriptor>& descriptors() const { return descriptors_; }
  const std::vector<VerifiedGrid>& verified() const { return verified_; }
  const openvdb::MetaMap& metadata() const { return metadata_; }

  openvdb::GridBase::Ptr emptyGrid(std::size_t i) {
    const GridDescriptor& d = descriptors_[i];
    if (!openvdb::GridBase::isRegistered(d.gridType())) return nullptr;
    openvdb::GridBase::Ptr grid = openvdb::GridBase::createGrid(d.gridType());
    stream_.seekg(static_cast<std::streamoff>(verified_[i].begin));
    readGridCompression(stream_);
    grid->readMeta(stream_);
    grid->readTransform(stream_);
    finish(*grid, d);
    return grid;
  }

  openvdb::GridBase::Ptr grid(std::size_t i) {
    const GridDescriptor& d = descriptors_[i];
    const std::size_t parent = d.isInstance() ? parentOf(d) : i;
    openvdb::GridBase::Ptr grid = readAt(parent);
    if (parent != i) {
      const openvdb::GridBase::Ptr own = emptyGrid(i);
      own->setTree(grid->baseTreePtr());
      grid = own;
    }
    finish(*grid, d);
    return grid;
  }

  std::size_t parentOf(const GridDescriptor& d) const {
    for (std::size_t i = 0; i < descriptors_.size(); ++i)
      if (descriptors_[i].uniqueName() == d.instanceParentName() && !descriptors_[i].isInstance() &&
          descriptors_[i].gridType() == d.gridType())
        return i;
    throw FileError(path_, "is damaged: grid '" + d.gridName() + "' shares a grid that is missing");
  }

 private:
  openvdb::GridBase::Ptr readAt(std::size_t i) {
    const GridDescriptor& d = descriptors_[i];
    if (!verified_[i].readable)
      throw FileError(path_, fmt::format("grid '{}' has the type {}, which innermap does not read",
                                         d.gridName(), d.gridType()));
    openvdb::GridBase::Ptr grid = openvdb::GridBase::createGrid(d.gridType());
    stream_.seekg(static_cast<std::streamoff>(verified_[i].begin));
    readGrid(grid, d, stream_);
    return grid;
  }

  static void finish(openvdb::GridBase& grid, const GridDescriptor& d) {
    grid.setSaveFloatAsHalf(d.saveFloatAsHalf());
    if (grid.getName().empty()) grid.setName(d.gridName());
  }

  std::string path_;
  CheckedInputBuffer buffer_;
  std::istream stream_;
  openvdb::io::StreamMetadata::Ptr streamMetadata_ =
      std::make_shared<openvdb::io::StreamMetadata>();
  std::vector<VerifiedGrid> verified_;
  std::vector<GridDescriptor> descriptors_;
  openvdb::MetaMap metadata_;
};

std::vector<std::size_t> chosen(const std::string& path, const InputArchive& archive,
                                const std::vector<std::string>& names) {
  const auto& all = archive.descriptors();
  std::vector<std::size_t> result;
  for (const std::string& name : names) {
    const auto found = std::find_if(all.begin(), all.end(), [&](const GridDescriptor& d) {
      return d.gridName() == name || GridDescriptor::nameAsString(d.uniqueName()) == name;
    });
    if (found == all.end())
      throw FileError(path, fmt::format("has no grid '{}'; it has {}", name, listed(all)));
    result.push_back(static_cast<std::size_t>(found - all.begin()));
  }
  if (names.empty())
    for (std::size_t i = 0; i < all.size(); ++i) result.push_back(i);
  std::sort(result.begin(), result.end());
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

// OpenVDB's exceptions become FileErrors; ours pass.
template <class Body>
auto translating(const std::string& path, const Body& body) {
  try {
    openvdb::initialize();
    return body();
  } catch (const openvdb::Exception& error) {
    throw FileError(path, fmt::format("cannot be read ({})", error.what()));
  } catch (const std::ios_base::failure&) {
    throw FileError(path, "is truncated or damaged; write it again");
  } catch (const std::length_error&) {
    throw FileError(path, "is damaged; write it again");
  }
}

}  // namespace

VdbContents readVdb(const std::string& path, const VdbReadSettings& settings) {
  return translating(path, [&] {
    InputArchive archive(path);
    VdbContents contents;
    contents.metadata = archive.metadata();
    const std::vector<std::size_t> indices = chosen(path, archive, settings.names);
    std::uint64_t need = 0;
    for (std::size_t i : indices) need += archive.verified()[i].memory;
    requireMemory("reading " + path, need, "read fewer of its grids or raise the limit");
    for (std::size_t i : indices) {
      reportProgress("reading the VDB file",
                     static_cast<double>(contents.grids.size()) / indices.size());
      contents.grids.push_back(archive.grid(i));
    }
    reportProgress("reading the VDB file", 1);
    return contents;
  });
}

VdbInfo readVdbInfo(const std::string& path) {
  return translating(path, [&] {
    InputArchive archive(path);
    VdbInfo info;
    info.metadata = archive.metadata();
    info.version = archive.version();
    for (std::size_t i = 0; i < archive.descriptors().size(); ++i) {
      const GridDescriptor& d = archive.descriptors()[i];
      const VerifiedGrid& v = archive.verified()[i];
      VdbGridInfo grid;
      grid.name = GridDescriptor::nameAsString(d.uniqueName());
      grid.grid = archive.emptyGrid(i);
      grid.type = grid.grid ? grid.grid->valueType() : d.gridType();
      if (d.saveFloatAsHalf()) grid.type += " (half)";
      if (grid.grid)
        grid.gridClass = openvdb::GridBase::gridClassToString(grid.grid->getGridClass());
      grid.bytes = v.end - v.begin;
      grid.memory = v.memory;
      info.grids.push_back(std::move(grid));
    }
    return info;
  });
}

}  // namespace innermap

#include "io/volume/detail/volume_attributes.h"

#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfVecAttribute.h>
#include <fmt/format.h>

#include <cmath>

#include "innermap/core/error.h"
#include "innermap/core/version.h"
#include "innermap/io/pictures.h"

namespace innermap {
namespace {

constexpr int kMostGrids = 1024;
constexpr const char* kComponents[] = {"channelX", "channelY", "channelZ"};

Imath::V3d v3d(const openvdb::Vec3d& v) { return {v.x(), v.y(), v.z()}; }
Imath::V3i v3i(const openvdb::Coord& c) { return {c.x(), c.y(), c.z()}; }

Imath::M44d m44d(const openvdb::Mat4d& m) {
  Imath::M44d result;
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) result[row][column] = m(row, column);
  return result;
}

void insertGrid(Imf::Header& header, std::size_t number, const VolumeGrid& grid) {
  const std::string prefix = fmt::format("grid{}.", number);
  const auto text = [&](const char* key, const std::string& value) {
    header.insert(prefix + key, Imf::StringAttribute(value));
  };
  text("name", grid.name);
  text("type", grid.type);
  text("class", grid.gridClass);
  if (grid.isVector()) {
    text("vectorType", grid.vectorType);
    header.insert(prefix + "background", Imf::V3dAttribute(v3d(grid.background)));
    for (std::size_t c = 0; c < 3; ++c) text(kComponents[c], grid.channels[c]);
  } else {
    header.insert(prefix + "background", Imf::DoubleAttribute(grid.background[0]));
    text("channel", grid.channels[0]);
  }
  if (!grid.activeChannel.empty()) text("activeChannel", grid.activeChannel);
}

// Attributes of a header by name and type.
class Reader {
 public:
  Reader(const std::string& path, const Imf::Header& header) : path_(path), header_(header) {}

  template <class Attribute,
            class Value = typename std::decay_t<decltype(std::declval<Attribute&>().value())>>
  std::optional<Value> get(const std::string& key) const {
    const auto found = header_.find(key);
    if (found == header_.end()) return std::nullopt;
    const auto* attribute = dynamic_cast<const Attribute*>(&found.attribute());
    if (!attribute)
      fail(key, fmt::format("is of type {}, not {}", found.attribute().typeName(),
                            Attribute::staticTypeName()));
    return attribute->value();
  }

  std::optional<openvdb::Coord> coord(const std::string& key) const {
    const auto v = get<Imf::V3iAttribute>(key);
    return v ? std::optional<openvdb::Coord>({v->x, v->y, v->z}) : std::nullopt;
  }

  std::optional<openvdb::Vec2i> pair(const std::string& key) const {
    const auto v = get<Imf::V2iAttribute>(key);
    return v ? std::optional<openvdb::Vec2i>({v->x, v->y}) : std::nullopt;
  }

  [[noreturn]] void fail(const std::string& key, const std::string& what) const {
    throw FileError(path_, fmt::format("attribute '{}' {}", key, what));
  }

 private:
  const std::string& path_;
  const Imf::Header& header_;
};

std::optional<openvdb::Mat4d> readMatrix(const Reader& reader) {
  const auto m = reader.get<Imf::M44dAttribute>("indexToWorld");
  if (!m) return std::nullopt;
  openvdb::Mat4d result;
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) {
      if (!std::isfinite((*m)[row][column]))
        reader.fail("indexToWorld", "has numbers that are not finite; give --voxel-size instead");
      result(row, column) = (*m)[row][column];
    }
  return result;
}

VolumeGrid readGrid(const Reader& reader, int number) {
  const std::string prefix = fmt::format("grid{}.", number);
  const auto text = [&](const char* key) { return reader.get<Imf::StringAttribute>(prefix + key); };
  VolumeGrid grid;
  const auto name = text("name");
  if (!name || name->empty())
    reader.fail(prefix + "name", "is missing though gridCount counts that grid");
  grid.name = *name;
  grid.type = text("type").value_or(grid.type);
  grid.gridClass = text("class").value_or(grid.gridClass);
  grid.vectorType = text("vectorType").value_or(grid.vectorType);
  grid.activeChannel = text("activeChannel").value_or("");
  if (const auto channel = text("channel")) {
    grid.channels = {*channel};
    grid.background[0] = reader.get<Imf::DoubleAttribute>(prefix + "background").value_or(0.0);
  } else {
    for (const char* key : kComponents) {
      const auto part = text(key);
      if (!part)
        reader.fail(prefix + key, "is missing: nothing says where the grid's values stand");
      grid.channels.push_back(*part);
    }
    const auto b = reader.get<Imf::V3dAttribute>(prefix + "background").value_or(Imath::V3d(0.0));
    grid.background = {b.x, b.y, b.z};
  }
  return grid;
}

std::vector<VolumeGrid> readGrids(const Reader& reader) {
  std::vector<VolumeGrid> grids;
  const int count = reader.get<Imf::IntAttribute>("gridCount").value_or(0);
  if (count < 0 || count > kMostGrids)
    reader.fail("gridCount", fmt::format("is {}; at most {} grids are read", count, kMostGrids));
  for (int i = 0; i < count; ++i) grids.push_back(readGrid(reader, i));
  return grids;
}

}  // namespace

void insertVolumeAttributes(Imf::Header& header, const std::string& layout,
                            const VolumeLattice& lattice, const std::vector<VolumeGrid>& grids) {
  const auto text = [&](const char* key, const std::string& value) {
    header.insert(key, Imf::StringAttribute(value));
  };
  text("volumeLayout", layout);
  text("volumeAxis", std::string(1, axisName(lattice.axis)));
  text("volumeColumnAxis", std::string(1, axisName(lattice.columnAxis)));
  text("volumeRowAxis", std::string(1, axisName(lattice.rowAxis)));
  text("volumeRowOrder", lattice.rowsUp ? "up" : "down");
  text("volumeTileOrder", "row-major");
  header.insert("volumeTiles",
                Imf::V2iAttribute(Imath::V2i(lattice.tileColumns, lattice.tileRows)));
  header.insert("volumeTileSize", Imf::V2iAttribute(Imath::V2i(lattice.width(), lattice.height())));
  header.insert("volumeSliceCount", Imf::IntAttribute(lattice.slices()));
  header.insert("volumeResolution", Imf::V3iAttribute(v3i(lattice.size)));
  header.insert("volumeIndexMin", Imf::V3iAttribute(v3i(lattice.box().min())));
  header.insert("volumeIndexMax", Imf::V3iAttribute(v3i(lattice.box().max())));
  const openvdb::BBoxd world = lattice.worldBox();
  header.insert("volumeWorldMin", Imf::V3dAttribute(v3d(world.min())));
  header.insert("volumeWorldMax", Imf::V3dAttribute(v3d(world.max())));
  const openvdb::Mat4d& m = lattice.indexToWorld;
  openvdb::Vec3d voxel;
  for (int a = 0; a < 3; ++a) voxel[a] = openvdb::Vec3d(m(a, 0), m(a, 1), m(a, 2)).length();
  header.insert("volumeVoxelSize", Imf::V3dAttribute(v3d(voxel)));
  header.insert("indexToWorld", Imf::M44dAttribute(m44d(m)));
  header.insert("textureToWorld", Imf::M44dAttribute(m44d(lattice.textureToWorld())));
  header.insert("gridCount", Imf::IntAttribute(static_cast<int>(grids.size())));
  for (std::size_t i = 0; i < grids.size(); ++i) insertGrid(header, i, grids[i]);
  text("software", std::string("innermap ") + versionText());
}

VolumeAttributes readVolumeAttributes(const std::string& path, const Imf::Header& header) {
  const Reader reader(path, header);
  VolumeAttributes a;
  a.layout = reader.get<Imf::StringAttribute>("volumeLayout");
  if (const auto axis = reader.get<Imf::StringAttribute>("volumeAxis")) {
    if (*axis != "x" && *axis != "y" && *axis != "z")
      reader.fail("volumeAxis", fmt::format("is '{}', not x, y or z", *axis));
    a.axis = parseAxis("volumeAxis", *axis);
  }
  if (const auto order = reader.get<Imf::StringAttribute>("volumeRowOrder")) {
    if (*order != "up" && *order != "down")
      reader.fail("volumeRowOrder", fmt::format("is '{}', not up or down", *order));
    a.rowsUp = *order == "up";
  }
  const auto order = reader.get<Imf::StringAttribute>("volumeTileOrder");
  if (order && *order != "row-major")
    reader.fail("volumeTileOrder", fmt::format("is '{}'; only row-major tiles are read", *order));
  a.tiles = reader.pair("volumeTiles");
  a.tileSize = reader.pair("volumeTileSize");
  a.sliceCount = reader.get<Imf::IntAttribute>("volumeSliceCount");
  a.sliceIndex = reader.get<Imf::IntAttribute>("volumeSliceIndex");
  a.resolution = reader.coord("volumeResolution");
  a.indexMin = reader.coord("volumeIndexMin");
  a.indexMax = reader.coord("volumeIndexMax");
  a.indexToWorld = readMatrix(reader);
  a.grids = readGrids(reader);
  return a;
}

}  // namespace innermap

#include <fmt/format.h>

#include <cmath>
#include <set>

#include "core/require_number.h"
#include "evaluate/active_region.h"
#include "evaluate/topology.h"
#include "evaluate/visit_field.h"
#include "innermap/core/error.h"
#include "innermap/evaluate/grids.h"
#include "innermap/levelset/level_set.h"
#include "levelset/level_set_settings.h"
#include "levelset/set_metadata.h"

namespace innermap {
namespace {

constexpr double kSkin = 2;  // voxels

std::uint64_t bytesPerVoxel(std::size_t channels, const HarmonicGridSettings& settings) {
  return channels * ((settings.values ? 4 : 0) + (settings.gradients ? 12 : 0) +
                     (settings.directions ? 12 : 0) + (settings.magnitudes ? 4 : 0));
}

// The grids of one channel; null where they were not asked for.
struct ChannelGrids {
  openvdb::FloatGrid::Ptr value, magnitude;
  openvdb::Vec3SGrid::Ptr gradient, direction;

  ChannelGrids(const openvdb::MaskGrid& region, const std::string& name,
               const HarmonicGridSettings& settings) {
    if (settings.values) value = named(floatGridOn(region), name);
    if (settings.gradients) gradient = vector(region, name + "_gradient", openvdb::VEC_COVARIANT);
    if (settings.directions)
      direction = vector(region, name + "_direction", openvdb::VEC_COVARIANT_NORMALIZE);
    if (settings.magnitudes) magnitude = named(floatGridOn(region), name + "_magnitude");
  }

  void append(openvdb::GridPtrVec& to) const {
    if (value) to.push_back(value);
    if (gradient) to.push_back(gradient);
    if (direction) to.push_back(direction);
    if (magnitude) to.push_back(magnitude);
  }

  void store(const openvdb::Coord& leaf, std::uint16_t offset, double v, const Vec3& g) const {
    const double length = norm(g);
    const Vec3 unit = length > 0 ? g / length : Vec3{};
    set(value, leaf, offset, static_cast<float>(v));
    set(gradient, leaf, offset, vec3f(g));
    set(direction, leaf, offset, vec3f(unit));
    set(magnitude, leaf, offset, static_cast<float>(length));
  }

 private:
  static openvdb::Vec3f vec3f(const Vec3& v) {
    return openvdb::Vec3f(openvdb::Vec3d(v.x, v.y, v.z));
  }

  template <class GridPtr>
  static GridPtr named(GridPtr grid, const std::string& name) {
    grid->setName(name);
    return grid;
  }

  static openvdb::Vec3SGrid::Ptr vector(const openvdb::MaskGrid& region, const std::string& name,
                                        openvdb::VecType type) {
    openvdb::Vec3SGrid::Ptr out = named(vectorGridOn(region), name);
    out->setVectorType(type);
    return out;
  }

  template <class GridPtr, class Value>
  static void set(const GridPtr& grid, const openvdb::Coord& leaf, std::uint16_t offset,
                  const Value& value) {
    if (grid) grid->tree().probeLeaf(leaf)->setValueOnly(offset, value);
  }
};

void check(const HarmonicField& field, const std::vector<std::string>& names,
           const HarmonicGridSettings& settings) {
  if (names.size() != field.channels())
    throw SettingError("channels",
                       fmt::format("{} names for {} channels", names.size(), field.channels()));
  std::set<std::string> known{"surface", "density"};
  for (const std::string& name : names)
    if (name.empty() || !known.insert(name).second)
      throw SettingError("channels", fmt::format("the name '{}' is {}", name,
                                                 name.empty() ? "empty" : "taken already"));
  requireNumber("accuracy", settings.accuracy, {1e-12, 1e-3}, "of the values' span");
  requireNumber("span", settings.span, above(0));
}

}  // namespace

openvdb::GridPtrVec HarmonicGrids::all() const {
  openvdb::GridPtrVec out{surface, density};
  out.insert(out.end(), fields.begin(), fields.end());
  return out;
}

HarmonicGrids evaluateHarmonic(const HarmonicField& field, const Solid& solid,
                               const std::vector<std::string>& names,
                               const HarmonicGridSettings& settings) {
  check(field, names, settings);
  HarmonicGrids out;
  timed(out.seconds, "voxelize", [&] {
    out.surface = makeLevelSet(solid, levelSetSettings(settings));
    out.density = makeFog(*out.surface);
    out.warnings = checkLevelSet(*out.surface, solid).warnings;
  });
  out.voxelSize = out.surface->voxelSize()[0];
  out.interiorVoxels = interiorVoxels(*out.surface);
  requireInterior(out.interiorVoxels, solid, solid.repaired().mesh.name);
  RegionSettings where;
  where.skin = kSkin;
  where.bytesPerVoxel = 1 + bytesPerVoxel(names.size(), settings);
  timed(out.seconds, "evaluate", [&] {
    const openvdb::MaskGrid::Ptr region = activeRegion(*out.surface, where);
    out.activeVoxels = region->activeVoxelCount();
    std::vector<ChannelGrids> channels;
    for (const std::string& name : names) channels.emplace_back(*region, name, settings);
    const auto store = [&](std::size_t, const LeafValues& leaf) {
      for (std::size_t i = 0; i < leaf.count; ++i)
        for (std::size_t k = 0; k < channels.size(); ++k) {
          const double* g = leaf.gradients + 3 * (leaf.channels * i + k);
          channels[k].store(leaf.origin, leaf.offset[i], leaf.values[leaf.channels * i + k],
                            {g[0], g[1], g[2]});
        }
    };
    visitField(field, FieldRegion(solid, *out.surface, *region), store,
               {settings.accuracy * settings.span, "evaluating the field"});
    for (const ChannelGrids& grids : channels) grids.append(out.fields);
  });
  return out;
}

void describeField(const openvdb::GridPtrVec& grids, const Facts& facts) {
  for (const openvdb::GridBase::Ptr& grid : grids)
    for (const auto& [key, value] : facts)
      setMetadata(*grid, "innermap_" + key, openvdb::StringMetadata(value));
}

std::uint64_t harmonicGridMemory(const Solid& solid, std::size_t channels,
                                 const HarmonicGridSettings& settings) {
  // As mapGridMemory: leaves are allocated whole, about 6 voxels to either side of the surface.
  constexpr double kReach = 12, kFog = 8, kOther = 25e6;
  const LevelSetSettings levelSet = levelSetSettings(settings);
  const double voxel = voxelSizeFor(solid, levelSet), area = solid.area() / (voxel * voxel);
  const double voxels = solid.volume() / std::pow(voxel, 3) + kReach * area;
  const double bytes = kFog + 1 + static_cast<double>(bytesPerVoxel(channels, settings));
  return 2 * levelSetMemory(solid, levelSet) + static_cast<std::uint64_t>(bytes * voxels + kOther);
}

}  // namespace innermap

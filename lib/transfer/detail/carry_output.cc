#include "transfer/detail/carry_output.h"

#include <fmt/format.h>

#include "evaluate/topology.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "levelset/set_metadata.h"

namespace innermap {
namespace {

// Outputs have no active tiles.
template <class Grid>
bool movePositionsOf(openvdb::GridBase& base,
                     const std::function<Points(const Points&)>& movePositions) {
  if (!base.isType<Grid>()) return false;
  auto& grid = static_cast<Grid&>(base);
  Points points;
  for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf)
    for (auto value = leaf->cbeginValueOn(); value; ++value) {
      const openvdb::Vec3d v(*value);
      points.push_back({v.x(), v.y(), v.z()});
    }
  const Points moved = movePositions(points);
  std::size_t i = 0;
  for (auto leaf = grid.tree().beginLeaf(); leaf; ++leaf)
    for (auto value = leaf->beginValueOn(); value; ++value, ++i)
      value.setValue(typename Grid::ValueType(openvdb::Vec3d(moved[i].x, moved[i].y, moved[i].z)));
  return true;
}

// Whether an active voxel lies in the solid or within its level set's band.
bool meets(const openvdb::GridBase& grid, const openvdb::FloatGrid& solid) {
  auto distances = solid.getConstAccessor();
  const openvdb::math::Transform &from = grid.transform(), &to = solid.transform();
  const auto isNear = [&](const openvdb::Vec3d& ijk) {
    const openvdb::Coord at = to.worldToIndexNodeCentered(from.indexToWorld(ijk));
    return distances.getValue(at) < solid.background();
  };
  std::uint64_t polled = 0;
  const openvdb::MaskTree active = activeTopology(grid);
  for (auto value = active.cbeginValueOn(); value; ++value) {
    if ((++polled & 0xffff) == 0) throwIfCancelled();
    openvdb::CoordBBox box;
    value.getBoundingBox(box);
    if (value.isVoxelValue() ? isNear(box.min().asVec3d()) : [&] {
          // A tile may hold the solid: it is tried at every fourth voxel.
          for (int x = box.min().x(); x <= box.max().x(); x += 4)
            for (int y = box.min().y(); y <= box.max().y(); y += 4)
              for (int z = box.min().z(); z <= box.max().z(); z += 4)
                if (isNear(openvdb::Vec3d(x, y, z))) return true;
          return false;
        }())
      return true;
  }
  return false;
}

}  // namespace

CarryOutput::CarryOutput(const Carriers& carriers, const openvdb::MaskGrid& region,
                         const openvdb::FloatGrid& levelSet)
    : carriers_(carriers), levelSet_(levelSet) {
  for (const auto& carrier : carriers) outputs_.push_back(carrier->makeOutput(region));
}

void CarryOutput::carry(const openvdb::Coord& origin, const Site* sites) const {
  for (std::size_t c = 0; c < carriers_.size(); ++c)
    carriers_[c]->carry(origin, sites, levelSet_, outputs_[c]);
}

// By number: names of input grids may be the same, or none.
openvdb::GridPtrVec CarryOutput::blockGrids() const {
  openvdb::GridPtrVec out;
  for (const openvdb::GridPtrVec& grids : outputs_)
    for (const openvdb::GridBase::Ptr& grid : grids) {
      out.push_back(grid->copyGrid());
      out.back()->setName(std::to_string(out.size()));
      out.back()->setSaveFloatAsHalf(false);
    }
  return out;
}

void CarryOutput::take(GridBlocks& blocks) const {
  std::size_t number = 0;
  for (const openvdb::GridPtrVec& grids : outputs_)
    for (const openvdb::GridBase::Ptr& grid : grids)
      blocks.mergeInto(*grid, std::to_string(++number));
}

void CarryOutput::finish(const std::function<Points(const Points&)>& movePositions,
                         openvdb::GridPtrVec& grids) {
  for (std::size_t c = 0; c < carriers_.size(); ++c) {
    throwIfCancelled();
    if (openvdb::GridBase* positions = carriers_[c]->positions(outputs_[c]))
      movePositionsOf<openvdb::Vec3SGrid>(*positions, movePositions) ||
          movePositionsOf<openvdb::Vec3DGrid>(*positions, movePositions);
    carriers_[c]->finish(outputs_[c]);
    for (std::size_t k = 0; k < outputs_[c].size(); ++k)
      grids[carriers_[c]->places()[k]] = outputs_[c][k];
  }
}

void requireMeeting(const openvdb::GridPtrVec& grids, const openvdb::FloatGrid& solid,
                    const std::string& solidName, std::vector<std::string>& warnings) {
  std::string apart;
  std::size_t count = 0;
  for (const openvdb::GridBase::Ptr& grid : grids) {
    if (meets(*grid, solid)) continue;
    ++count;
    apart += (apart.empty() ? "" : ", ") + grid->getName();
  }
  if (count == 0) return;
  if (count == grids.size())
    throw DataError(
        fmt::format("volume: none of its grids ({}) has an active "
                    "voxel in the solid {}; they must be given in "
                    "the same world space",
                    apart, solidName));
  warnings.push_back("no active voxel lies in the solid: " + apart);
}

void noteOutside(const openvdb::GridPtrVec& grids, const OutsideSettings& outside) {
  if (!(outside.distance > 0)) return;
  const std::string text = fmt::format(
      "extended from the closest boundary point to {} of the diagonal outside, "
      "{}",
      outside.distance, outside.fadeTo ? "fading to a rigid motion" : "cut off there");
  for (const openvdb::GridBase::Ptr& grid : grids)
    setMetadata(*grid, "innermap_outside", openvdb::StringMetadata(text));
}

std::uint64_t outputBytesPerVoxel(const openvdb::GridPtrVec& grids) {
  std::uint64_t bytes = 0;
  for (const openvdb::GridBase::Ptr& grid : grids) {
    const std::string type = grid->valueType();
    bytes += type == "vec3s" || type == "vec3i" ? 12
             : type == "vec3d"                  ? 24
             : type == "bool"                   ? 1
                                                : 8;
  }
  return bytes;
}

}  // namespace innermap

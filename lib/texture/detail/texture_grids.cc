#include "texture/detail/texture_grids.h"

#include <openvdb/tree/LeafManager.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "innermap/core/error.h"
#include "innermap/core/run.h"

namespace innermap {
namespace {

using openvdb::Coord;
using openvdb::Vec3f;
using openvdb::Vec3fGrid;
using Accessor = Vec3fGrid::ConstAccessor;
using Leaves = openvdb::tree::LeafManager<const openvdb::Vec3STree>;

struct VoxelAxes {
  Vec2 a, b;
};

double squared(const Vec2& d) { return d.x * d.x + d.y * d.y; }

// Axes of the ellipse whose second moments are those of the three steps.
VoxelAxes axesOf(const Vec2 (&steps)[3]) {
  double xx = 0, yy = 0, xy = 0;
  for (const Vec2& d : steps) {
    xx += d.x * d.x;
    yy += d.y * d.y;
    xy += d.x * d.y;
  }
  const double mean = 0.5 * (xx + yy), spread = std::hypot(0.5 * (xx - yy), xy);
  const double longer = std::sqrt(mean + spread), shorter = std::sqrt(std::max(0.0, mean - spread));
  const double angle = 0.5 * std::atan2(2 * xy, xx - yy), c = std::cos(angle), s = std::sin(angle);
  return {{longer * c, longer * s}, {-shorter * s, shorter * c}};
}

// at(coord): the coordinates at a voxel, nothing where there are none.
template <class At>
VoxelAxes footprint(const Coord& ijk, const Vec2& uv, const At& at) {
  Vec2 steps[3];
  for (int axis = 0; axis < 3; ++axis) {
    std::optional<Vec2> nearest;
    for (const int side : {-1, 1}) {
      Coord neighbour = ijk;
      neighbour[axis] += side;
      const std::optional<Vec2> there = at(neighbour);
      if (!there) continue;
      const Vec2 step{there->x - uv.x, there->y - uv.y};
      if (!nearest || squared(step) < squared(*nearest)) nearest = step;
    }
    steps[axis] = nearest.value_or(Vec2{});
  }
  return axesOf(steps);
}

Vec3f toVec3f(const Vec3& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

Vec3fGrid::Ptr gridLike(const Vec3fGrid& grid, const char* name) {
  auto out = Vec3fGrid::create();
  out->setTree(
      std::make_shared<openvdb::Vec3STree>(grid.tree(), Vec3f(0), openvdb::TopologyCopy()));
  out->setTransform(grid.transform().copy());
  out->setVectorType(openvdb::VEC_INVARIANT);
  out->setName(name);
  return out;
}

struct GroupValue {
  double weight = 0;
  Vec2 uv;
};

// One group's coordinates from its weighted ones.
struct GroupReader {
  explicit GroupReader(const ChartGroupGrid& group)
      : accessor(group.weighted->getConstAccessor()), centre(group.centre) {}

  GroupValue value(const Coord& ijk) const {
    const Vec3f v = accessor.getValue(ijk);
    return {v[0], {centre.x + v[1] / v[0], centre.y + v[2] / v[0]}};
  }
  std::optional<Vec2> uvAt(const Coord& ijk) const {
    Vec3f v;
    if (!accessor.probeValue(ijk, v) || !(v[0] > kLeastChartWeight)) return {};
    return Vec2{centre.x + v[1] / v[0], centre.y + v[2] / v[0]};
  }

  Accessor accessor;
  Vec2 centre;
};

struct Mixture {
  Vec3 colour;
  Vec2 uv;
};

Mixture mixture(const Coord& ijk, const std::vector<GroupReader>& groups,
                const TextureLookup& texture) {
  Mixture out;
  double sum = 0, most = -1;
  for (const GroupReader& g : groups) {
    const GroupValue v = g.value(ijk);
    if (v.weight > most && v.weight > 0) {
      most = v.weight;
      out.uv = v.uv;
    }
    const double w = v.weight - kLeastChartWeight;
    if (!(w > 0)) continue;
    const VoxelAxes axes = footprint(ijk, v.uv, [&](const Coord& c) { return g.uvAt(c); });
    out.colour += w * texture(v.uv, axes.a, axes.b);
    sum += w;
  }
  out.colour = sum > 0 ? out.colour / sum : texture(out.uv, {}, {});
  return out;
}

}  // namespace

Vec3fGrid::Ptr lookUpColours(const Vec3fGrid& uv, const TextureLookup& texture) {
  const Vec3fGrid::Ptr out = gridLike(uv, "Cd");
  const Leaves leaves(uv.tree());
  parallelBlocks(
      leaves.leafCount(), 8,
      [&](std::size_t begin, std::size_t end) {
        const Accessor accessor = uv.getConstAccessor();
        const auto at = [&](const Coord& c) -> std::optional<Vec2> {
          Vec3f v;
          if (!accessor.probeValue(c, v)) return {};
          return Vec2{v[0], v[1]};
        };
        for (std::size_t l = begin; l < end; ++l) {
          auto* leaf = out->tree().probeLeaf(leaves.leaf(l).origin());
          for (auto it = leaves.leaf(l).cbeginValueOn(); it; ++it) {
            const Vec2 here{(*it)[0], (*it)[1]};
            const VoxelAxes axes = footprint(it.getCoord(), here, at);
            leaf->setValueOnly(it.pos(), toVec3f(texture(here, axes.a, axes.b)));
          }
        }
      },
      "looking up colours");
  return out;
}

BlendedTexture blendChartGroups(const std::vector<ChartGroupGrid>& groups,
                                const TextureLookup& texture) {
  if (groups.empty()) throw DataError("texture: there is no group of charts");
  const Vec3fGrid& first = *groups.front().weighted;
  for (const ChartGroupGrid& g : groups)
    if (!g.weighted->tree().hasSameTopology(first.tree()))
      throw DataError("texture: the groups' voxels are not the same");
  const BlendedTexture out{gridLike(first, "Cd"), gridLike(first, "uv")};
  const Leaves leaves(first.tree());
  parallelBlocks(
      leaves.leafCount(), 4,
      [&](std::size_t begin, std::size_t end) {
        const std::vector<GroupReader> readers(groups.begin(), groups.end());
        for (std::size_t l = begin; l < end; ++l) {
          const Coord origin = leaves.leaf(l).origin();
          auto *colour = out.colour->tree().probeLeaf(origin),
               *uv = out.uv->tree().probeLeaf(origin);
          for (auto it = leaves.leaf(l).cbeginValueOn(); it; ++it) {
            const Mixture m = mixture(it.getCoord(), readers, texture);
            colour->setValueOnly(it.pos(), toVec3f(m.colour));
            uv->setValueOnly(it.pos(), toVec3f({m.uv.x, m.uv.y, 0}));
          }
        }
      },
      "blending charts");
  return out;
}

}  // namespace innermap

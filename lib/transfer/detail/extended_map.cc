#include "transfer/detail/extended_map.h"

#include <algorithm>

#include "innermap/core/run.h"

namespace innermap {

// w = 1 at the solid, 0 from the reach on, smooth at both ends: F = w E + (1 - w) R.
void ExtendedMap::fade(const Vec3& p, const Vec3& beyond, PointImage& sample) const {
  sample.outside = norm(beyond);
  if (!outside_.fadeTo || sample.outside == 0) return;
  const double reach = this->reach(), t = std::min(sample.outside / reach, 1.0);
  const double w = 1 - t * t * (3 - 2 * t), slope = t < 1 ? -6 * t * (1 - t) / reach : 0;
  const RigidMotion& rigid = *outside_.fadeTo;
  const Vec3 moved = rigid(p), away = beyond / sample.outside, apart = sample.image - moved;
  for (int r = 0; r < 3; ++r)
    for (int a = 0; a < 3; ++a)
      sample.jacobian[r][a] =
          w * sample.jacobian[r][a] + (1 - w) * rigid.rotation[r][a] + slope * apart[r] * away[a];
  sample.image = moved + w * apart;
}

bool ExtendedMap::isRigidAt(const Vec3& p) const {
  if (!outside_.fadeTo) return false;
  const Box3& box = solid_.box();
  double squared = 0;
  for (int a = 0; a < 3; ++a) {
    const double beyond = std::max({box.lower[a] - p[a], p[a] - box.upper[a], 0.0});
    squared += beyond * beyond;
  }
  return squared > reach() * reach();
}

std::vector<PointImage> ExtendedMap::at(const Points& points) const {
  if (map_.pointwise()) return map_.push(points);
  std::vector<PointImage> out(points.size());
  Points near;
  std::vector<std::size_t> index;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (isRigidAt(points[i])) {
      out[i] = {(*outside_.fadeTo)(points[i]), outside_.fadeTo->rotation, 2 * reach()};
    } else {
      near.push_back(points[i]);
      index.push_back(i);
    }
  }
  const std::vector<PointImage> found = at(near, placeExtended(solid_, levelSet_, near));
  for (std::size_t n = 0; n < index.size(); ++n) out[index[n]] = found[n];
  return out;
}

Points ExtendedMap::imagesInside(const Points& points) const {
  return map_.images(points, accuracy_);
}

std::vector<PointImage> ExtendedMap::at(const Points& points, const ExtendedPlaces& places) const {
  const FieldSamples samples = sampleExtended(harmonic(), places, {accuracy_, {}});
  std::vector<PointImage> out(points.size());
  constexpr std::size_t kBlock = 4096;
  parallelBlocks(points.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      for (int r = 0; r < 3; ++r) {
        out[i].image[r] = samples.values(i, r);
        for (int a = 0; a < 3; ++a) out[i].jacobian[r][a] = samples.gradients(i, 3 * r + a);
      }
      fade(points[i], places.beyond[i], out[i]);
    }
  });
  return out;
}

void ExtendedMap::visitPointwise(const openvdb::MaskGrid& region, const Visitor& visit,
                                 std::string_view stage) const {
  constexpr std::size_t kLeaves = 64;  // that are mapped together
  std::vector<const openvdb::MaskTree::LeafNodeType*> leaves;
  region.tree().getNodes(leaves);
  parallelBlocks(
      leaves.size(), kLeaves,
      [&](std::size_t begin, std::size_t end) {
        const auto distance = levelSet_.getConstAccessor();
        for (std::size_t l = begin; l < end; ++l) {
          Points at;
          std::vector<std::uint8_t> inside;
          for (auto voxel = leaves[l]->cbeginValueOn(); voxel; ++voxel) {
            const openvdb::Vec3d p = region.indexToWorld(voxel.getCoord());
            at.push_back({p.x(), p.y(), p.z()});
            inside.push_back(distance.getValue(voxel.getCoord()) < 0);
          }
          LeafValues values;
          values.origin = leaves[l]->origin();
          values.count = at.size();
          values.inside = inside.data();
          visit(l, values, map_.push(at));
        }
      },
      stage);
}

void ExtendedMap::visit(const openvdb::MaskGrid& region, const Visitor& visit,
                        std::string_view stage) const {
  if (map_.pointwise()) return visitPointwise(region, visit, stage);
  visitField(harmonic(), FieldRegion(solid_, levelSet_, region),
             [&](std::size_t leaf, const LeafValues& values) {
               std::vector<PointImage> samples(values.count);
               for (std::size_t i = 0; i < values.count; ++i) {
                 const openvdb::Coord ijk =
                     values.origin +
                     openvdb::MaskTree::LeafNodeType::offsetToLocalCoord(values.offset[i]);
                 const openvdb::Vec3d p = levelSet_.transform().indexToWorld(ijk);
                 for (int r = 0; r < 3; ++r) {
                   samples[i].image[r] = values.values[3 * i + r];
                   for (int a = 0; a < 3; ++a)
                     samples[i].jacobian[r][a] = values.gradients[9 * i + 3 * r + a];
                 }
                 fade({p.x(), p.y(), p.z()}, values.beyond[i], samples[i]);
               }
               visit(leaf, values, samples);
             },
             {accuracy_, stage});
}

}  // namespace innermap

#include "transfer/detail/cell_nodes.h"

#include <algorithm>
#include <limits>

#include "innermap/core/run.h"

namespace innermap {
namespace {

using openvdb::Coord;
using Leaf = openvdb::MaskTree::LeafNodeType;

constexpr std::size_t kTogether = std::size_t{1} << 18;  // points that are mapped together

// Corners of the cells of some voxels.
openvdb::MaskTree nodesOf(const openvdb::MaskTree& voxels, int parts) {
  openvdb::MaskTree out;
  for (auto leaf = voxels.cbeginLeaf(); leaf; ++leaf) {
    openvdb::CoordBBox box;
    leaf->evalActiveBoundingBox(box, false);
    if (box.empty()) continue;
    const Coord lower = leaf->origin(), upper = lower.offsetBy(Leaf::DIM);
    for (int x = parts * lower.x() & ~7; x <= parts * upper.x(); x += 8)
      for (int y = parts * lower.y() & ~7; y <= parts * upper.y(); y += 8)
        for (int z = parts * lower.z() & ~7; z <= parts * upper.z(); z += 8)
          out.touchLeaf(Coord(x, y, z));
  }
  std::vector<Leaf*> leaves;
  out.getNodes(leaves);
  parallelBlocks(leaves.size(), 8, [&](std::size_t begin, std::size_t end) {
    const openvdb::tree::ValueAccessor<const openvdb::MaskTree, false> at(voxels);
    const auto isNode = [&](const Coord& n) {
      Coord from, to;
      for (int a = 0; a < 3; ++a) {
        from[a] = floorDivide(n[a] - 1, parts);
        to[a] = floorDivide(n[a], parts);
      }
      for (int x = from.x(); x <= to.x(); ++x)
        for (int y = from.y(); y <= to.y(); ++y)
          for (int z = from.z(); z <= to.z(); ++z)
            if (at.isValueOn(Coord(x, y, z))) return true;
      return false;
    };
    for (std::size_t l = begin; l < end; ++l)
      for (openvdb::Index i = 0; i < Leaf::SIZE; ++i)
        leaves[l]->setActiveState(i, isNode(leaves[l]->offsetToGlobalCoord(i)));
  });
  return out;
}

// Whether points are farther inside a solid than a margin (world units) and a voxel of its level
// set, where that tells.
class DeepInside {
 public:
  DeepInside(const openvdb::FloatGrid& levelSet, double margin)
      : distances_(levelSet.getConstAccessor()),
        transform_(levelSet.transform()),
        deepest_(-margin - levelSet.voxelSize()[0]) {}

  bool operator()(const Vec3& p) const {
    const openvdb::Vec3d at(p.x, p.y, p.z);
    return distances_.getValue(transform_.worldToIndexNodeCentered(at)) < deepest_;
  }

 private:
  openvdb::FloatGrid::ConstAccessor distances_;
  const openvdb::math::Transform& transform_;
  double deepest_;
};

// As CellNodes::map has images.
Vec3 shifted(const Lattice& target, const Vec3& image) {
  return target.toIndex(image) + Vec3{0.5, 0.5, 0.5};
}

}  // namespace

Lattice::Lattice(const openvdb::math::Transform& transform) {
  const auto at = [&](const openvdb::Vec3d& p) {
    const openvdb::Vec3d ijk = transform.worldToIndex(p);
    return Vec3{ijk.x(), ijk.y(), ijk.z()};
  };
  shift = at(openvdb::Vec3d(0));
  for (int a = 0; a < 3; ++a) {
    openvdb::Vec3d unit(0);
    unit[a] = 1;
    const Vec3 column = at(unit) - shift;
    for (int r = 0; r < 3; ++r)
      linear[static_cast<std::size_t>(r)][static_cast<std::size_t>(a)] = column[r];
  }
}

CellNodes::CellNodes(const openvdb::MaskTree& voxels, const openvdb::math::Transform& grid,
                     int parts)
    : grid_(grid), parts_(parts), nodes_(nodesOf(voxels, parts)), leaves_(nodes_), first_{0} {
  for (std::size_t l = 0; l < leaves_.size(); ++l)
    first_.push_back(first_.back() + leaves_[l].onVoxelCount());
  for (int a = 0; a < 3; ++a) {
    openvdb::Vec3d unit(0);
    unit[a] = 1;
    edges_[static_cast<std::size_t>(a)] = worldOf(unit) - worldOf(openvdb::Vec3d(0));
  }
}

std::uint64_t CellNodes::memory(std::size_t nodes) {
  // Samples of one batch: the map's values and derivatives, twice, and where they are taken.
  constexpr std::uint64_t kSample = 2 * sizeof(PointImage) + 3 * sizeof(Vec3);
  return nodes * (sizeof(Vec3) + sizeof(float)) + std::min(nodes, kTogether) * kSample;
}

openvdb::Coord CellNodes::voxelOf(const Coord& cell) const {
  return {floorDivide(cell.x(), parts_), floorDivide(cell.y(), parts_),
          floorDivide(cell.z(), parts_)};
}

Vec3 CellNodes::worldOf(const openvdb::Vec3d& node) const {
  const openvdb::Vec3d p = grid_.indexToWorld(node / parts_ - openvdb::Vec3d(0.5));
  return {p.x(), p.y(), p.z()};
}

void CellNodes::map(const ExtendedMap& map, const Lattice& target, std::string_view stage) {
  images_.resize(size());
  stretch_.assign(size(), std::numeric_limits<float>::infinity());
  // From there no edge of a cell leads out of the solid.
  const DeepInside isDeep(map.levelSet(),
                          std::max({norm(edges_[0]), norm(edges_[1]), norm(edges_[2])}));
  std::size_t l = 0, i = 0;
  while (l < leaves_.size()) {
    std::array<Points, 2> points;  // deep inside, and others
    std::array<std::vector<std::size_t>, 2> places;
    for (; l < leaves_.size() && points[0].size() + points[1].size() < kTogether; ++l)
      for (auto node = leaves_[l].cbeginValueOn(); node; ++node) {
        const Vec3 p = worldOf(node.getCoord().asVec3d());
        const std::size_t which = isDeep(p) ? 0 : 1;
        points[which].push_back(p);
        places[which].push_back(i++);
      }
    const Points deep = map.imagesInside(points[0]);
    for (std::size_t n = 0; n < deep.size(); ++n) images_[places[0][n]] = shifted(target, deep[n]);
    const std::vector<PointImage> samples = map.at(points[1]);
    for (std::size_t n = 0; n < samples.size(); ++n) {
      images_[places[1][n]] = shifted(target, samples[n].image);
      double longest = 0;
      for (const Vec3& edge : edges_)
        longest = std::max(longest, norm(target.linear * (samples[n].jacobian * edge)));
      stretch_[places[1][n]] = static_cast<float>(longest);
    }
    reportProgress(stage, static_cast<double>(l) / static_cast<double>(leaves_.size()));
  }
}

void CellNodes::corners(std::size_t leaf, Corners& out) const {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  out.images.fill({kNone, kNone, kNone});
  out.stretch.fill(kNone);
  const Coord origin = leaves_[leaf].origin();
  for (int c = 0; c < 8; ++c) {
    const Coord step(c & 4 ? 8 : 0, c & 2 ? 8 : 0, c & 1 ? 8 : 0);
    const std::uint32_t other = leaves_.find(origin + step);
    if (other == LeafIndex::kNone) continue;
    std::size_t i = first_[other];
    for (auto node = leaves_[other].cbeginValueOn(); node; ++node, ++i) {
      const Coord at = Leaf::offsetToLocalCoord(node.pos()) + step;
      if (std::max({at.x(), at.y(), at.z()}) >= kSide) continue;
      const auto n = static_cast<std::size_t>((at.x() * kSide + at.y()) * kSide + at.z());
      out.images[n] = images_[i];
      out.stretch[n] = stretch_[i];
    }
  }
}

}  // namespace innermap

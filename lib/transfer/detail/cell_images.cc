#include "transfer/detail/cell_images.h"

#include <algorithm>
#include <cmath>

#include "core/kuhn_cells.h"
#include "evaluate/topology.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"

namespace innermap {
namespace {

constexpr int kSide = 9;  // corners of the cells of one leaf
// A cell that is stretched over more voxels than this starts nothing: it lies across a jump.
constexpr int kWidestImage = 64;
constexpr double kLeafDepth = 1e-6;  // barycentric coordinates: neighbours share their faces

struct Corner {
  openvdb::Vec3f image;
  float outside = 0;
  bool active = false;
};

// The corners of the cells whose lowest corner is in one leaf of the source's lattice.
class LeafCorners {
 public:
  LeafCorners(const LatticeImages& lattice, const openvdb::Coord& origin) : origin_(origin) {
    auto images = lattice.images->getConstAccessor();
    auto outside = lattice.outside->getConstAccessor();
    for (int n = 0; n < kSide * kSide * kSide; ++n) {
      const openvdb::Coord ijk = origin.offsetBy(n / (kSide * kSide), n / kSide % kSide, n % kSide);
      Corner& c = corners_[static_cast<std::size_t>(n)];
      c.active = images.probeValue(ijk, c.image);
      c.outside = outside.getValue(ijk);
    }
  }

  // The 8 corners of a cube; false when one is not active.
  bool cell(const openvdb::Coord& cube, std::array<const Corner*, 8>& out) const {
    for (int c = 0; c < 8; ++c) {
      const openvdb::Coord at = cornerOf(cube, c);
      const int n = (at.x() * kSide + at.y()) * kSide + at.z();
      out[static_cast<std::size_t>(c)] = &corners_[static_cast<std::size_t>(n)];
      if (!out[static_cast<std::size_t>(c)]->active) return false;
    }
    return true;
  }

  const openvdb::Coord& origin() const { return origin_; }

 private:
  openvdb::Coord origin_;
  std::array<Corner, kSide * kSide * kSide> corners_;
};

// The voxels that a cell's image may cover; empty for one that is too wide or not finite.
openvdb::CoordBBox voxelsOf(const std::array<const Corner*, 8>& cell) {
  openvdb::Vec3f lower = cell[0]->image, upper = lower;
  for (const Corner* corner : cell)
    for (int a = 0; a < 3; ++a) {
      lower[a] = std::min(lower[a], corner->image[a]);
      upper[a] = std::max(upper[a], corner->image[a]);
    }
  openvdb::CoordBBox box;
  for (int a = 0; a < 3; ++a) {
    if (!(std::abs(lower[a]) < 1e6f && upper[a] - lower[a] < kWidestImage)) return {};
    box.min()[a] = static_cast<int>(std::ceil(lower[a] - 1e-3f));
    box.max()[a] = static_cast<int>(std::floor(upper[a] + 1e-3f));
  }
  return box;
}

// A cell whose image may touch a leaf of the target.
struct Touch {
  std::uint32_t target = 0, source = 0;  // leaves
  std::uint16_t cell = 0;                // place of its lowest corner
};

template <class Visit>
void forEachLeaf(const openvdb::CoordBBox& box, const Visit& visit) {
  for (int x = box.min().x() & ~7; x <= box.max().x(); x += 8)
    for (int y = box.min().y() & ~7; y <= box.max().y(); y += 8)
      for (int z = box.min().z() & ~7; z <= box.max().z(); z += 8) visit(openvdb::Coord(x, y, z));
}

using Leaves = std::vector<const openvdb::Vec3STree::LeafNodeType*>;

Leaves leavesOf(const LatticeImages& lattice) {
  Leaves out;
  lattice.images->tree().getNodes(out);
  return out;
}

// Calls visit(place, voxels) for the cells of a leaf of the lattice that are whole.
template <class Visit>
void forEachCell(const LatticeImages& lattice, const openvdb::Vec3STree::LeafNodeType& leaf,
                 const Visit& visit) {
  const LeafCorners corners(lattice, leaf.origin());
  std::array<const Corner*, 8> cell;
  for (auto voxel = leaf.cbeginValueOn(); voxel; ++voxel) {
    const auto place = static_cast<std::uint16_t>(voxel.pos());
    if (!corners.cell(openvdb::Vec3STree::LeafNodeType::offsetToLocalCoord(place), cell)) continue;
    const openvdb::CoordBBox voxels = voxelsOf(cell);
    if (!voxels.empty()) visit(place, cell, voxels);
  }
}

// Sorted by target leaf, then by cell.
std::vector<Touch> touchesOf(const LatticeImages& lattice, const Leaves& leaves,
                             const LeafIndex& target) {
  std::vector<std::vector<Touch>> found(leaves.size());
  parallelBlocks(
      leaves.size(), 8,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t s = begin; s < end; ++s)
          forEachCell(lattice, *leaves[s], [&](std::uint16_t place, const auto&, const auto& box) {
            forEachLeaf(box, [&](const openvdb::Coord& origin) {
              const std::uint32_t t = target.find(origin);
              if (t != LeafIndex::kNone)
                found[s].push_back({t, static_cast<std::uint32_t>(s), place});
            });
          });
      },
      "mapping the lattice");
  std::vector<std::size_t> start(target.size() + 1, 0);
  for (const auto& touches : found)
    for (const Touch& t : touches) ++start[t.target + 1];
  for (std::size_t t = 0; t < target.size(); ++t) start[t + 1] += start[t];
  std::vector<Touch> sorted(start.back());
  for (auto& touches : found) {
    for (const Touch& t : touches) sorted[start[t.target]++] = t;
    std::vector<Touch>().swap(touches);
  }
  return sorted;
}

// Chooses a start for the voxels of one leaf of the target.
class LeafRaster {
 public:
  LeafRaster(const LeafIndex::Leaf& leaf, bool mirrored, LeafStarts& out)
      : leaf_(leaf), mirrored_(mirrored), out_(out) {
    turned_.reset();
  }

  void add(const std::array<const Corner*, 8>& cell, const openvdb::Vec3f& at) {
    for (const KuhnCell& kuhn : kKuhnCells) {
      std::array<const Corner*, 4> corners;
      std::array<openvdb::Vec3f, 4> sources;
      for (std::size_t k = 0; k < 4; ++k) {
        corners[k] = cell[static_cast<std::size_t>(kuhn[k])];
        sources[k] = at + cornerOf(openvdb::Coord(), kuhn[k]).asVec3s();
      }
      addTetrahedron(corners, sources);
    }
  }

 private:
  void addTetrahedron(const std::array<const Corner*, 4>& c,
                      const std::array<openvdb::Vec3f, 4>& sources) {
    const openvdb::Vec3d a(c[0]->image);
    const openvdb::Mat3d edges(openvdb::Vec3d(c[1]->image) - a, openvdb::Vec3d(c[2]->image) - a,
                               openvdb::Vec3d(c[3]->image) - a, false);  // columns
    const double volume = edges.det();
    if (!(std::abs(volume) > 1e-12)) return;
    const openvdb::Mat3d inverse = edges.inverse(0);
    const bool turned = (volume < 0) != mirrored_;
    const openvdb::CoordBBox box = voxelsOf(c);
    for (auto voxel = box.begin(); voxel; ++voxel) {
      const openvdb::Vec3d u = inverse * ((*voxel).asVec3d() - a);
      const double w0 = 1 - u[0] - u[1] - u[2];
      if (std::min({w0, u[0], u[1], u[2]}) < -kLeafDepth) continue;
      const std::array<float, 4> w{static_cast<float>(w0), static_cast<float>(u[0]),
                                   static_cast<float>(u[1]), static_cast<float>(u[2])};
      openvdb::Vec3f source(0);
      float outside = 0;
      for (std::size_t k = 0; k < 4; ++k) {
        source += w[k] * sources[k];
        outside += w[k] * c[k]->outside;
      }
      offer(LeafIndex::Leaf::coordToOffset(*voxel), source, std::max(outside, 0.f), turned);
    }
  }

  openvdb::CoordBBox voxelsOf(const std::array<const Corner*, 4>& c) const {
    openvdb::CoordBBox box = leaf_.getNodeBoundingBox();
    for (int a = 0; a < 3; ++a) {
      const auto [lower, upper] =
          std::minmax({c[0]->image[a], c[1]->image[a], c[2]->image[a], c[3]->image[a]});
      box.min()[a] = std::max(box.min()[a], static_cast<int>(std::ceil(lower - 1e-3f)));
      box.max()[a] = std::min(box.max()[a], static_cast<int>(std::floor(upper + 1e-3f)));
    }
    return box;
  }

  void offer(openvdb::Index place, const openvdb::Vec3f& source, float outside, bool turned) {
    if (!leaf_.isValueOn(place)) return;
    const bool better = !out_.covered[place] || outside < out_.outside[place] ||
                        (!(outside > out_.outside[place]) && turned && !turned_[place]);
    if (!better) return;
    out_.covered.set(place);
    out_.source[place] = source;
    out_.outside[place] = outside;
    turned_.set(place, turned);
  }

  const LeafIndex::Leaf& leaf_;
  bool mirrored_;
  LeafStarts& out_;
  std::bitset<512> turned_;
};

}  // namespace

LatticeImages imagesOf(const ExtendedMap& map, const openvdb::MaskGrid& region,
                       const openvdb::math::Transform& target) {
  LatticeImages out;
  out.images = vectorGridOn(region);
  out.outside = floatGridOn(region);
  std::vector<std::array<std::uint64_t, 2>> turned(region.tree().leafCount());
  map.visit(
      region,
      [&](std::size_t leaf, const LeafValues& values, const std::vector<PointImage>& samples) {
        auto* images = out.images->tree().probeLeaf(values.origin);
        auto* outside = out.outside->tree().probeLeaf(values.origin);
        for (std::size_t i = 0; i < samples.size(); ++i) {
          const Vec3& q = samples[i].image;
          images->setValueOnly(values.offset[i],
                               openvdb::Vec3f(target.worldToIndex(openvdb::Vec3d(q.x, q.y, q.z))));
          outside->setValueOnly(values.offset[i], static_cast<float>(samples[i].outside));
          if (values.inside[i]) ++turned[leaf][determinant(samples[i].jacobian) < 0];
        }
      },
      "mapping the lattice");
  std::uint64_t kept = 0, mirrored = 0;
  for (const auto& [plus, minus] : turned) {
    kept += plus;
    mirrored += minus;
  }
  out.mirrored = mirrored > kept;
  return out;
}

openvdb::MaskGrid::Ptr touchedLeaves(const LatticeImages& lattice, double mostOutside,
                                     std::uint64_t mostLeaves) {
  auto out = openvdb::MaskGrid::create();
  for (const auto* leaf : leavesOf(lattice))
    forEachCell(lattice, *leaf, [&](std::uint16_t, const auto& cell, const auto& box) {
      for (const Corner* corner : cell)
        if (corner->outside > mostOutside) return;
      forEachLeaf(box, [&](const openvdb::Coord& origin) { out->tree().touchLeaf(origin); });
    });
  if (out->tree().leafCount() > mostLeaves)
    throw MemoryError("push: the volume around the solid reaches " +
                      std::to_string(out->tree().leafCount()) +
                      " blocks of 8^3 voxels; use larger voxels or a smaller --outside");
  for (auto leaf = out->tree().beginLeaf(); leaf; ++leaf) leaf->setValuesOn();
  return out;
}

std::vector<LeafStarts> findStarts(const LatticeImages& lattice, const openvdb::MaskGrid& region) {
  const LeafIndex target(region.tree());
  const Leaves leaves = leavesOf(lattice);
  const std::vector<Touch> touches = touchesOf(lattice, leaves, target);
  std::vector<LeafStarts> out(target.size());
  parallelBlocks(
      target.size(), 4,
      [&](std::size_t begin, std::size_t end) {
        const auto before = [](const Touch& t, std::size_t leaf) { return t.target < leaf; };
        auto touch = std::lower_bound(touches.begin(), touches.end(), begin, before);
        std::array<const Corner*, 8> cell;
        for (std::size_t t = begin; t < end; ++t) {
          LeafRaster raster(target[t], lattice.mirrored, out[t]);
          while (touch != touches.end() && touch->target == t) {
            const std::uint32_t source = touch->source;
            const LeafCorners corners(lattice, leaves[source]->origin());
            for (; touch != touches.end() && touch->target == t && touch->source == source;
                 ++touch) {
              const openvdb::Coord local =
                  openvdb::Vec3STree::LeafNodeType::offsetToLocalCoord(touch->cell);
              corners.cell(local, cell);
              raster.add(cell, openvdb::Vec3f((corners.origin() + local).asVec3s()));
            }
          }
        }
      },
      "covering the target");
  return out;
}

void spreadStarts(const LeafIndex& leaves, LeafStarts* starts) {
  std::vector<std::bitset<512>> has;
  for (std::size_t l = 0; l < leaves.size(); ++l) has.push_back(starts[l].covered);
  spreadToNeighbours(leaves, has, [&](LeafPlace from, LeafPlace to) {
    starts[to.leaf].source[to.offset] = starts[from.leaf].source[from.offset];
    starts[to.leaf].outside[to.offset] = starts[from.leaf].outside[from.offset];
  });
}

}  // namespace innermap

#include "evaluate/detail/outside_voxels.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "innermap/core/run.h"

namespace innermap {
namespace {

using openvdb::Coord;
using Images = std::vector<std::pair<Coord, Vec3>>;  // of the voxels inside

constexpr std::size_t kFew = 4;  // images that are looked at one by one

class Search {
 public:
  Search(const TargetShape& target, double slack) : target_(target), slack_(slack) {}

  // found: the voxels and how far outside they are. from, edge: of a cube of voxels.
  void look(const Images& images, const Coord& from, int edge,
            std::vector<std::pair<Coord, double>>& found) const {
    if (images.empty()) return;
    if (images.size() > kFew && edge > 1) {
      if (allInside(images)) return;
      const int half = edge / 2;
      Images parts[8];
      for (const auto& image : images) {
        const Coord at = image.first - from;
        parts[4 * (at.x() >= half) + 2 * (at.y() >= half) + (at.z() >= half)].push_back(image);
      }
      for (int p = 0; p < 8; ++p)
        look(parts[p], from + Coord(p / 4 * half, p / 2 % 2 * half, p % 2 * half), half, found);
      return;
    }
    for (const auto& [voxel, image] : images)
      if (!target_.inside(image) && !target_.near(image, slack_))
        found.emplace_back(voxel, target_.distance(image));
  }

 private:
  // The surface winds about all points of a ball alike that it does not enter.
  bool allInside(const Images& images) const {
    Box3 box;
    for (const auto& image : images) box.add(image.second);
    const Vec3 middle = box.center();
    double radius = 0;
    for (const auto& image : images) radius = std::max(radius, norm(image.second - middle));
    return !target_.near(middle, 1.0001 * radius) && target_.inside(middle);
  }

  const TargetShape& target_;
  double slack_;
};

}  // namespace

openvdb::FloatGrid::Ptr outsideVoxels(const openvdb::Vec3fGrid& map,
                                      const openvdb::FloatGrid& levelSet, const TargetShape& target,
                                      const OutsideVoxelsSettings& settings) {
  if (!(target.volume() > 0)) return nullptr;
  std::vector<const openvdb::Vec3fTree::LeafNodeType*> leaves;
  map.tree().getNodes(leaves);
  std::vector<std::vector<std::pair<Coord, double>>> found(leaves.size());
  const Search search(target, settings.slack);
  parallelBlocks(
      leaves.size(), 8,
      [&](std::size_t begin, std::size_t end) {
        const auto distance = levelSet.getConstUnsafeAccessor();
        Images images;
        for (std::size_t l = begin; l < end; ++l) {
          images.clear();
          for (auto voxel = leaves[l]->cbeginValueOn(); voxel; ++voxel) {
            const Coord at = voxel.getCoord();
            if (!(distance.getValue(at) < 0)) continue;
            const openvdb::Vec3f p = *voxel;
            images.emplace_back(at, settings.origin + Vec3{p.x(), p.y(), p.z()});
          }
          search.look(images, leaves[l]->origin(), 8, found[l]);
        }
      },
      "looking outside the target");
  openvdb::FloatGrid::Ptr out;
  for (const auto& ofLeaf : found)
    for (const auto& [voxel, distance] : ofLeaf) {
      if (!out) {
        out = openvdb::FloatGrid::create();
        out->setName("outside");
        out->setTransform(map.transform().copy());
      }
      out->tree().setValue(voxel, static_cast<float>(distance));
    }
  return out;
}

}  // namespace innermap

#include <openvdb/tree/LeafManager.h>

#include <functional>
#include <optional>

#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "innermap/levelset/level_set.h"
#include "levelset/level_set_settings.h"
#include "mesh/triangle_tree.h"

namespace innermap {
namespace {

using openvdb::FloatGrid;
using openvdb::Vec3f;
using openvdb::Vec3SGrid;

// The attribute at a point of a triangle of the mesh that the solid was made of; the weights are
// those of its corners. Nothing when a corner lacks it.
using AttributeAt = std::function<std::optional<Vec3>(int, const std::array<double, 3>&)>;

// Surface pieces and the weights of the input triangle's corners on them.
class Carrier {
 public:
  Carrier(const Solid& solid, const Mesh& mesh, const AttributeAt& attribute)
      : solid_(solid), mesh_(mesh), attribute_(attribute) {
    const Mesh& surface = solid.surface();
    const std::array<double, 3> middle{1.0 / 3, 1.0 / 3, 1.0 / 3};
    std::vector<Triangle> bearing;
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
      if (!valueAt({static_cast<int>(t), middle})) continue;
      bearing.push_back(surface.triangles[t]);
      bearers_.push_back(static_cast<int>(t));
    }
    if (bearing.size() == surface.triangles.size()) bearers_.clear();
    if (!bearers_.empty()) tree_.emplace(surface.vertices, bearing);
    any_ = !bearing.empty();
  }

  bool any() const { return any_; }

  Vec3f at(const Vec3& p) const {
    const Solid::Closest found = solid_.closest(p, std::numeric_limits<double>::infinity());
    std::optional<Vec3> value = valueAt(found.onSurface);
    if (!value && tree_) {
      SurfacePoint address = tree_->closest(p).address;
      if (address.triangle >= 0) {
        address.triangle = bearers_[address.triangle];
        value = valueAt(address);
      }
    }
    if (!value) return Vec3f(0);
    return {static_cast<float>(value->x), static_cast<float>(value->y),
            static_cast<float>(value->z)};
  }

 private:
  std::optional<Vec3> valueAt(const SurfacePoint& onSurface) const {
    if (onSurface.triangle < 0) return {};
    const SurfacePoint s = solid_.address(onSurface);
    const RepairedMesh& repaired = solid_.repaired();
    const int parent = repaired.parent[s.triangle];
    if (parent < 0) return {};
    // Repair may have turned the triangle: corners are told by their vertices.
    const Triangle& turned = repaired.mesh.triangles[s.triangle];
    const Triangle& original = mesh_.triangles[parent];
    std::array<double, 3> weights{};
    for (int k = 0; k < 3; ++k) {
      for (int j = 0; j < 3; ++j) {
        if (turned[k] == original[j]) weights[j] = s.barycentric[k];
      }
    }
    return attribute_(parent, weights);
  }

  const Solid& solid_;
  const Mesh& mesh_;
  const AttributeAt& attribute_;
  std::optional<TriangleTree> tree_;  // of the pieces that have the attribute, when not all do
  std::vector<int> bearers_;
  bool any_ = false;
};

openvdb::GridBase::Ptr carry(const FloatGrid& levelSet, const Carrier& carrier, const char* name) {
  auto tree = std::make_shared<Vec3SGrid::TreeType>(levelSet.tree(), Vec3f(0), Vec3f(0),
                                                    openvdb::TopologyCopy());
  openvdb::tree::LeafManager<Vec3SGrid::TreeType> leaves(*tree);
  parallelBlocks(
      leaves.leafCount(), 16,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t l = begin; l < end; ++l) {
          for (auto value = leaves.leaf(l).beginValueOn(); value; ++value) {
            const openvdb::Vec3d p = levelSet.indexToWorld(value.getCoord());
            value.setValue(carrier.at({p[0], p[1], p[2]}));
          }
        }
      },
      "attributes");
  const Vec3SGrid::Ptr grid = attributeGrid(levelSet, name);
  grid->setTree(tree);
  return grid;
}

void checkFits(const Solid& solid, const Mesh& mesh) {
  validate(mesh);
  for (const int parent : solid.repaired().parent) {
    if (parent >= static_cast<int>(mesh.triangles.size())) {
      throw DataError(mesh.name + ": is not the mesh that the solid was made of");
    }
  }
}

}  // namespace

Vec3SGrid::Ptr attributeGrid(const FloatGrid& levelSet, const std::string& name) {
  auto grid = Vec3SGrid::create();
  grid->setTransform(levelSet.transform().copy());
  grid->setName(name);
  grid->setVectorType(openvdb::VEC_INVARIANT);
  return grid;
}

std::vector<openvdb::GridBase::Ptr> makeAttributeGrids(const FloatGrid& levelSet,
                                                       const Solid& solid, const Mesh& mesh) {
  checkFits(solid, mesh);
  std::vector<openvdb::GridBase::Ptr> grids;
  const AttributeAt uv = [&](int t, const std::array<double, 3>& w) -> std::optional<Vec3> {
    Vec3 sum;
    for (int k = 0; k < 3; ++k) {
      const int corner = mesh.uvTriangles[t][k];
      if (corner < 0) return {};
      sum += w[k] * Vec3{mesh.uvs[corner].x, mesh.uvs[corner].y, 0};
    }
    return sum;
  };
  const AttributeAt colour = [&](int t, const std::array<double, 3>& w) -> std::optional<Vec3> {
    Vec3 sum;
    for (int k = 0; k < 3; ++k) {
      const auto& c = mesh.colours[mesh.triangles[t][k]];
      sum += w[k] * Vec3{c[0], c[1], c[2]};
    }
    return sum;
  };
  const auto add = [&](const AttributeAt& attribute, const char* name) {
    const Carrier carrier(solid, mesh, attribute);
    if (carrier.any()) grids.push_back(carry(levelSet, carrier, name));
  };
  if (!mesh.uvTriangles.empty()) add(uv, "uv");
  if (!mesh.colours.empty()) add(colour, "Cd");
  return grids;
}

std::uint64_t voxelizeMemory(const Solid& solid, const LevelSetSettings& settings, const Mesh& mesh,
                             bool fog, bool attributes) {
  const int vectors = attributes ? !mesh.uvs.empty() + !mesh.colours.empty() : 0;
  return levelSetMemory(solid, settings) * (1 + fog + 3 * vectors);
}

}  // namespace innermap

// Labels of scans as surfaces.
#include <fmt/format.h>
#include <openvdb/tools/Morphology.h>
#include <openvdb/tools/VolumeToMesh.h>

#include <cmath>
#include <map>
#include <set>
#include <type_traits>
#include <utility>

#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "innermap/io/volume_texture.h"

namespace innermap {
namespace {

constexpr std::size_t kMostLabels = 4096;  // a scan of grey values has more

struct Voxels {
  openvdb::FloatGrid::Ptr inside = openvdb::FloatGrid::create(0);  // 1 there
  std::uint64_t count = 0;
};

// The voxels of each label but 0.
template <class Grid>
std::map<std::int64_t, Voxels> voxelsOf(const Grid& grid) {
  std::map<std::int64_t, Voxels> out;
  std::uint64_t done = 0;
  for (auto value = grid.cbeginValueOn(); value; ++value) {
    if (done++ % 65536 == 0) throwIfCancelled();
    if constexpr (std::is_floating_point_v<typename Grid::ValueType>)
      if (!(std::abs(*value) < 1e9f) || std::rint(*value) != *value)
        throw DataError(
            fmt::format("grid '{}' has the value {}, which is no label; give a scan of "
                        "whole numbers",
                        grid.getName(), *value));
    const auto label = static_cast<std::int64_t>(*value);
    if (label == 0) continue;
    Voxels& voxels = out[label];
    if (out.size() > kMostLabels)
      throw DataError(
          fmt::format("grid '{}' has over {} different values: a scan, no labels; give "
                      "a segmentation",
                      grid.getName(), kMostLabels));
    voxels.count += value.getVoxelCount();
    if (value.isVoxelValue())
      voxels.inside->tree().setValueOn(value.getCoord(), 1);
    else
      voxels.inside->tree().fill(value.getBoundingBox(), 1, true);
  }
  return out;
}

Mesh surfaceOf(const Voxels& voxels, const openvdb::math::Transform& place) {
  openvdb::FloatGrid& grid = *voxels.inside;
  grid.setTransform(place.copy());
  // Meshing looks at active voxels alone, and both sides of the surface are wanted.
  grid.tree().voxelizeActiveTiles();
  openvdb::tools::dilateActiveValues(grid.tree(), 1, openvdb::tools::NN_FACE_EDGE_VERTEX);
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(grid, points, quads, 0.5);
  Mesh mesh;
  for (const openvdb::Vec3s& p : points) mesh.vertices.push_back({p.x(), p.y(), p.z()});
  for (const openvdb::Vec4I& q : quads) {
    const int a = int(q[0]), b = int(q[1]), c = int(q[2]), d = int(q[3]);
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  }
  if (signedVolume(mesh) < 0)
    for (Triangle& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  return mesh;
}

std::string listOf(const std::map<std::int64_t, Voxels>& all) {
  constexpr std::size_t kShown = 20;
  std::string text;
  std::size_t shown = 0;
  for (const auto& [label, voxels] : all) {
    if (++shown > kShown) return text + ", ...";
    text += fmt::format("{}{}", shown > 1 ? ", " : "", label);
  }
  return text.empty() ? "none but 0" : text;
}

void unite(std::map<std::int64_t, Voxels>& all) {
  Voxels& first = all.begin()->second;
  for (auto other = std::next(all.begin()); other != all.end(); other = all.erase(other)) {
    first.count += other->second.count;
    for (auto value = other->second.inside->cbeginValueOn(); value; ++value)
      first.inside->tree().fill(value.getBoundingBox(), 1, true);
  }
}

}  // namespace

std::vector<LabelMesh> labelMeshes(const openvdb::GridBase& grid,
                                   const std::vector<std::int64_t>& labels, bool together) {
  std::map<std::int64_t, Voxels> all;
  using Types = openvdb::TypeList<openvdb::FloatGrid, openvdb::Int32Grid, openvdb::Int64Grid>;
  if (!grid.apply<Types>([&](const auto& typed) { all = voxelsOf(typed); }))
    throw DataError("grid '" + grid.getName() + "' has no whole numbers, so no labels");
  const std::set<std::int64_t> wanted(labels.begin(), labels.end());
  for (const std::int64_t label : wanted)
    if (!all.count(label))
      throw DataError(fmt::format("no voxel has the label {}; there are {}", label, listOf(all)));
  for (auto entry = all.begin(); !wanted.empty() && entry != all.end();)
    entry = wanted.count(entry->first) ? std::next(entry) : all.erase(entry);
  if (all.empty()) throw DataError("grid '" + grid.getName() + "' has no label but 0");
  if (together) unite(all);
  std::vector<LabelMesh> out;
  for (const auto& [label, voxels] : all) {
    reportProgress("labels", static_cast<double>(out.size()) / static_cast<double>(all.size()));
    out.push_back({label, voxels.count, surfaceOf(voxels, grid.transform())});
    out.back().mesh.name = fmt::format("label {}", label);
  }
  return out;
}

}  // namespace innermap

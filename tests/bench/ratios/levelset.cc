// Level sets beside OpenVDB's meshToVolume, by resolution and by the number of triangles.
#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>

#include <algorithm>
#include <ctime>
#include <map>

#include "innermap/levelset/level_set.h"
#include "innermap/mesh/mesh_file.h"
#include "section.h"

namespace innermap::bench {
namespace {

constexpr int kRounds = 3;
constexpr double kHalfWidth = 3;  // voxels

struct Cost {
  double seconds = 0, cpu = 0;
};

// Processor time of all threads beside wall time.
template <class Do>
Cost costOf(const Do& work) {
  const std::clock_t before = std::clock();
  Stopwatch watch;
  work();
  return {watch.lap(), static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC};
}

double median(std::vector<Cost> costs, double Cost::*figure) {
  const auto middle = costs.begin() + static_cast<std::ptrdiff_t>(costs.size() / 2);
  std::nth_element(costs.begin(), middle, costs.end(),
                   [&](const Cost& a, const Cost& b) { return a.*figure < b.*figure; });
  return (*middle).*figure;
}

// Each triangle as four.
Mesh split(const Mesh& mesh) {
  Mesh out;
  out.vertices = mesh.vertices;
  std::map<std::pair<int, int>, int> middles;
  const auto middle = [&](int i, int j) {
    const auto [at, added] =
        middles.try_emplace(std::minmax(i, j), static_cast<int>(out.vertices.size()));
    if (added) out.vertices.push_back(0.5 * (mesh.vertices[i] + mesh.vertices[j]));
    return at->second;
  };
  for (const auto& [a, b, c] : mesh.triangles) {
    const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    out.triangles.insert(out.triangles.end(),
                         {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
  }
  return out;
}

// What OpenVDB takes: places in voxels.
openvdb::FloatGrid::Ptr theirs(const Mesh& mesh, const openvdb::math::Transform& transform) {
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  for (const Vec3& p : mesh.vertices)
    points.emplace_back(transform.worldToIndex(openvdb::Vec3d(p.x, p.y, p.z)));
  for (const auto& [a, b, c] : mesh.triangles)
    triangles.emplace_back(static_cast<openvdb::Index32>(a), static_cast<openvdb::Index32>(b),
                           static_cast<openvdb::Index32>(c));
  const openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec3I> adapter(
      points, triangles);
  return openvdb::tools::meshToVolume<openvdb::FloatGrid>(
      adapter, transform, static_cast<float>(kHalfWidth), static_cast<float>(kHalfWidth));
}

Json row(const Mesh& mesh, int across, const Options& options) {
  Stopwatch watch;
  const Solid solid(mesh);
  const double solidSeconds = watch.lap();
  LevelSetSettings settings;
  settings.resolution = across;
  settings.halfWidth = kHalfWidth;
  const auto transform = transformFor(solid, voxelSizeFor(solid, settings));
  std::vector<Cost> ours, others;
  std::uint64_t voxels = 0;
  for (int round = 0; round < (options.quick ? 1 : kRounds); ++round) {
    ours.push_back(costOf([&] { voxels = makeLevelSet(solid, settings)->activeVoxelCount(); }));
    others.push_back(costOf([&] { theirs(mesh, *transform); }));
  }
  const double seconds = median(ours, &Cost::seconds), cpu = median(ours, &Cost::cpu),
               otherCpu = median(others, &Cost::cpu);
  Json out{{"across", across},
           {"triangles", mesh.triangles.size()},
           {"voxels", voxels},
           {"solid s", solidSeconds},
           {"level set s", seconds},
           {"cpu s", cpu},
           {"meshToVolume s", median(others, &Cost::seconds)},
           {"meshToVolume cpu s", otherCpu},
           {"cpu / theirs", cpu / otherCpu}};
  Work work;
  work.bytes =
      static_cast<double>(sizeof(float) * voxels + sizeof(Triangle) * mesh.triangles.size() +
                          sizeof(Vec3) * mesh.vertices.size());
  out.update(besideLimit(options.limits, work, seconds));
  return out;
}

}  // namespace

Tables levelset(const Options& options) {
  Table table("Level set of spot, 3 voxels to either side, beside OpenVDB's meshToVolume");
  std::vector<Mesh> meshes{readMesh(options.model("spot.obj"))};
  while (meshes.size() < (options.quick ? 2 : 4)) meshes.push_back(split(meshes.back()));
  const std::vector<int> sizes =
      options.quick ? std::vector<int>{32} : std::vector<int>{128, 256, 512};
  for (const int across : sizes) table.add(row(meshes[1], across, options));
  const int across = sizes[sizes.size() / 2];
  for (std::size_t i = 0; i < meshes.size(); ++i)
    if (i != 1) table.add(row(meshes[i], across, options));
  table.note(
      "spot's triangles, and each split into 4, 16 and 64; medians of " + std::to_string(kRounds) +
      " rounds in turn; solid s: cleaning, trees and winding numbers, which meshToVolume has not");
  return {table.json()};
}

}  // namespace innermap::bench

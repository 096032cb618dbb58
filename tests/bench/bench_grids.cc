// Evaluation on voxels, and voxelisation beside OpenVDB's plain meshToVolume.
#include <benchmark/benchmark.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>

#include "innermap/evaluate/evaluate_map.h"
#include "innermap/levelset/level_set.h"
#include "sample/source_points.h"
#include "shapes.h"

namespace innermap {
namespace {

constexpr int kMesh = 100;  // 20,000 triangles

void evaluation(benchmark::State& state) {
  const Solid solid(bench::wavyTorus(kMesh));
  LevelSetSettings settings;
  settings.resolution = static_cast<int>(state.range(0));
  const auto surface = makeLevelSet(solid, settings);
  SourceSettings source;
  source.count = 1000;
  Points sources = sourceShell(solid, 0.05, source);
  Affine affine;
  affine.coefficients = Matrix(4, 3);
  const HarmonicMap map(HarmonicField(sources, bench::randomMatrix(sources.size(), 3, 1), affine));
  double voxels = 0;
  for (auto _ : state)
    voxels += static_cast<double>(evaluateMap(map, solid, *surface).activeVoxels);
  state.counters["voxels/s"] = benchmark::Counter(voxels, benchmark::Counter::kIsRate);
}
BENCHMARK(evaluation)->Arg(64)->Arg(128)->UseRealTime()->Unit(benchmark::kMillisecond);

void voxelizeOurs(benchmark::State& state) {
  const Mesh mesh = bench::wavyTorus(kMesh);
  LevelSetSettings settings;
  settings.resolution = static_cast<int>(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(makeLevelSet(Solid(mesh), settings));
}
BENCHMARK(voxelizeOurs)->Arg(128)->Arg(256)->UseRealTime()->Unit(benchmark::kMillisecond);

void voxelizeOpenVdb(benchmark::State& state) {
  const Mesh mesh = bench::wavyTorus(kMesh);
  LevelSetSettings settings;
  settings.resolution = static_cast<int>(state.range(0));
  const Solid solid(mesh);
  const auto transform = transformFor(solid, voxelSizeFor(solid, settings));
  for (auto _ : state) {
    std::vector<openvdb::Vec3s> points;
    std::vector<openvdb::Vec3I> triangles;
    for (const Vec3& v : mesh.vertices)
      points.emplace_back(transform->worldToIndex(openvdb::Vec3d(v.x, v.y, v.z)));
    for (const Triangle& t : mesh.triangles) triangles.emplace_back(t[0], t[1], t[2]);
    openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec3I> adapter(points,
                                                                                       triangles);
    benchmark::DoNotOptimize(
        openvdb::tools::meshToVolume<openvdb::FloatGrid>(adapter, *transform, 3, 3));
  }
}
BENCHMARK(voxelizeOpenVdb)->Arg(128)->Arg(256)->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace innermap

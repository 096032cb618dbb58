#include "innermap/levelset/isosurface.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/Interpolation.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>

#include "innermap/core/detail/disjoint_sets.h"
#include "innermap/core/error.h"
#include "innermap/core/parallel.h"
#include "innermap/levelset/level_set.h"

namespace innermap {
namespace {

constexpr char kStage[] = "meshing the level set";
constexpr int kEveningPasses = 6;
constexpr double kLongestMove = 0.7;  // voxels, while evening out

// Corner c of a cell stands at (c & 1, c >> 1 & 1, c >> 2). Its faces, counter-clockwise from
// outside.
constexpr int kFaces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                              {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};

openvdb::Coord cornerOf(const openvdb::Coord& cell, int corner) {
  return cell.offsetBy(corner & 1, corner >> 1 & 1, corner >> 2);
}

// 0..11: the edge between two corners of a cell; its axis is the number over 4.
int edgeBetween(int a, int b) {
  const int difference = a ^ b, low = std::min(a, b);
  if (difference == 1) return low >> 1;
  if (difference == 2) return 4 + ((low & 1) | (low >> 2) << 1);
  return 8 + low;
}

std::array<int, 2> endsOf(int edge) {
  const int k = edge & 3;
  switch (edge >> 2) {
    case 0:
      return {2 * k, 2 * k + 1};
    case 1:
      return {(k & 1) | (k >> 1) << 2, (k & 1) | (k >> 1) << 2 | 2};
    default:
      return {k, k + 4};
  }
}

bool onOneFace(int edgeA, int edgeB) {
  const auto a = endsOf(edgeA), b = endsOf(edgeB);
  for (const auto& face : kFaces) {
    int found = 0;
    for (const int c : face) found += (c == a[0]) + (c == a[1]) + (c == b[0]) + (c == b[1]);
    if (found == 4) return true;
  }
  return false;
}

// Where the surface leaves each cut edge of the cell for the next one, around the inside.
std::array<int, 12> segmentsOf(const std::array<double, 8>& value) {
  std::array<int, 12> next;
  next.fill(-1);
  for (const auto& face : kFaces) {
    std::array<int, 2> enters{-1, -1}, leaves{-1, -1};  // of the runs of corners inside
    int runs = 0;
    for (int m = 0; m < 4; ++m) {
      if (!(value[face[m]] >= 0 && value[face[(m + 1) % 4]] < 0)) continue;
      enters[runs] = edgeBetween(face[m], face[(m + 1) % 4]);
      int n = m + 1;
      while (value[face[n % 4]] < 0) ++n;
      leaves[runs++] = edgeBetween(face[(n - 1) % 4], face[n % 4]);
    }
    const auto product = [&](int i) { return value[face[i]] * value[face[i + 2]]; };
    const int inside = value[face[0]] < 0 ? 0 : 1;
    const bool joined = runs == 2 && product(inside) > product(1 - inside);
    for (int r = 0; r < runs; ++r) next[enters[r]] = leaves[joined ? 1 - r : r];
  }
  return next;
}

class Mesher {
 public:
  Mesher(const openvdb::FloatGrid& grid, Progress* progress)
      : grid_(grid), progress_(progress), access_(grid.getConstAccessor()) {}

  void run() {
    std::size_t done = 0;
    const double leaves = static_cast<double>(grid_.tree().leafCount());
    for (auto leaf = grid_.tree().cbeginLeaf(); leaf; ++leaf) {
      if (done++ % 64 == 0)
        reportProgress(progress_, kStage, 0.5 * static_cast<double>(done) / leaves);
      for (auto voxel = leaf->cbeginValueOn(); voxel; ++voxel) addCell(voxel.getCoord());
    }
    used_.clear();
    evenOut();
  }

  Points points;  // index space
  std::vector<Triangle> triangles;

 private:
  struct EdgeHash {
    std::size_t operator()(const std::array<int, 4>& e) const {
      std::uint64_t h = 0;
      for (const int x : e)
        h = (h ^ static_cast<std::uint32_t>(x)) * 0x9e3779b97f4a7c15u, h ^= h >> 29;
      return h;
    }
  };

  void addCell(const openvdb::Coord& cell) {
    std::array<double, 8> value;
    int inside = 0;
    for (int c = 0; c < 8; ++c) {
      value[c] = static_cast<double>(access_.getValue(cornerOf(cell, c)));
      inside += value[c] < 0;
    }
    if (inside == 0 || inside == 8) return;
    std::array<int, 12> next = segmentsOf(value);
    for (int start = 0; start < 12; ++start) {
      if (next[start] < 0) continue;
      std::vector<int> edges;
      for (int e = start; next[e] >= 0;) {
        edges.push_back(e);
        e = std::exchange(next[e], -1);
      }
      addLoop(cell, edges, value);
    }
  }

  // No diagonal runs between two edges of one face: the neighbour might have the same.
  void addLoop(const openvdb::Coord& cell, const std::vector<int>& edges,
               const std::array<double, 8>& value) {
    std::vector<int> v;
    for (const int e : edges) v.push_back(vertexOn(cell, e, value));
    if (v.size() == 3) {
      triangles.push_back({v[0], v[1], v[2]});
      return;
    }
    if (v.size() == 4) {
      const bool first = norm(points[v[2]] - points[v[0]]) <= norm(points[v[3]] - points[v[1]]);
      for (const int k : {first ? 0 : 1, first ? 1 : 0}) {
        if (onOneFace(edges[k], edges[k + 2])) continue;
        triangles.push_back({v[k], v[k + 1], v[k + 2]});
        triangles.push_back({v[k], v[k + 2], v[(k + 3) % 4]});
        return;
      }
    }
    Vec3 sum;
    for (const int i : v) sum += points[i];
    const int middle = static_cast<int>(points.size());
    points.push_back(sum / static_cast<double>(v.size()));
    for (std::size_t k = 0; k < v.size(); ++k)
      triangles.push_back({v[k], v[(k + 1) % v.size()], middle});
  }

  int vertexOn(const openvdb::Coord& cell, int edge, const std::array<double, 8>& value) {
    const auto [a, b] = endsOf(edge);
    const openvdb::Coord low = cornerOf(cell, a);
    const int number = static_cast<int>(points.size());
    const auto [found, isNew] = used_.try_emplace({low.x(), low.y(), low.z(), edge >> 2}, number);
    if (isNew) {
      Vec3 p{static_cast<double>(low.x()), static_cast<double>(low.y()),
             static_cast<double>(low.z())};
      p[edge >> 2] += std::clamp(value[a] / (value[a] - value[b]), 0.02, 0.98);
      points.push_back(p);
    }
    return found->second;
  }

  // Towards the middle of the neighbours, then back onto the surface.
  void evenOut() {
    const Points start = points;
    for (int pass = 0; pass < kEveningPasses; ++pass) {
      Points sum(points.size());
      std::vector<int> count(points.size(), 0);
      for (const Triangle& t : triangles)
        for (int k = 0; k < 3; ++k) {
          sum[t[k]] += points[t[(k + 1) % 3]] + points[t[(k + 2) % 3]];
          count[t[k]] += 2;
        }
      parallelBlocks(
          points.size(), 4096,
          [&](std::size_t begin, std::size_t end) {
            const openvdb::FloatGrid::ConstAccessor access = grid_.getConstAccessor();
            for (std::size_t i = begin; i < end; ++i) {
              Vec3 p = 0.5 * (points[i] + sum[i] / static_cast<double>(count[i]));
              for (int n = 0; n < 2; ++n) p = ontoSurface(access, p);
              if (norm(p - start[i]) < kLongestMove) points[i] = p;
            }
          },
          progress_);
      reportProgress(progress_, kStage, 0.5 + 0.5 * (pass + 1) / kEveningPasses);
    }
  }

  Vec3 ontoSurface(const openvdb::FloatGrid::ConstAccessor& access, const Vec3& p) const {
    const auto at = [&](double x, double y, double z) {
      return static_cast<double>(
          openvdb::tools::BoxSampler::sample(access, openvdb::Vec3d(x, y, z)));
    };
    const double h = 0.5;
    const Vec3 slope{at(p.x + h, p.y, p.z) - at(p.x - h, p.y, p.z),
                     at(p.x, p.y + h, p.z) - at(p.x, p.y - h, p.z),
                     at(p.x, p.y, p.z + h) - at(p.x, p.y, p.z - h)};
    const double voxel = grid_.voxelSize()[0], steep = squaredNorm(slope);
    if (steep < 0.01 * voxel * voxel) return p;  // between close sheets
    return p - (std::clamp(at(p.x, p.y, p.z) / steep, -1 / voxel, 1 / voxel)) * slope;
  }

  const openvdb::FloatGrid& grid_;
  Progress* progress_;
  openvdb::FloatGrid::ConstAccessor access_;
  std::unordered_map<std::array<int, 4>, int, EdgeHash> used_;
};

// Leaves out small shells and the vertices that nothing uses then.
void keepLargeShells(Mesh& mesh, double least, Isosurface& result) {
  DisjointSets sets(mesh.vertices.size());
  for (const Triangle& t : mesh.triangles)
    for (int k = 1; k < 3; ++k) sets.unite(t[0], t[k]);
  const std::vector<int> shell = sets.representatives();
  std::vector<double> volume(shell.size(), 0);
  const Vec3 center = boundingBox(mesh.vertices).center();
  for (const Triangle& t : mesh.triangles)
    volume[shell[t[0]]] += dot(mesh.vertices[t[0]] - center,
                               cross(mesh.vertices[t[1]] - center, mesh.vertices[t[2]] - center));
  double largest = 0;
  for (const double v : volume) largest = std::max(largest, std::abs(v));
  std::vector<int> number(shell.size(), -1);
  Points kept;
  for (std::size_t v = 0; v < shell.size(); ++v) {
    const int root = shell[v];
    const bool large = std::abs(volume[root]) > 0 && std::abs(volume[root]) >= least * largest;
    if (root == static_cast<int>(v)) ++(large ? result.shells : result.leftOut);
    if (!large) continue;
    number[v] = static_cast<int>(kept.size());
    kept.push_back(mesh.vertices[v]);
  }
  std::vector<Triangle> triangles;
  for (const Triangle& t : mesh.triangles)
    if (number[t[0]] >= 0) triangles.push_back({number[t[0]], number[t[1]], number[t[2]]});
  mesh.vertices = std::move(kept);
  mesh.triangles = std::move(triangles);
}

}  // namespace

Isosurface isosurfaceOf(const Solid& solid, const IsosurfaceSettings& settings) {
  if (settings.resolution < 8 || settings.resolution > 2048)
    throw SettingError("resolution", "must be from 8 to 2048 voxels across");
  if (!(settings.leastShell >= 0 && settings.leastShell < 1))
    throw SettingError("leastShell", "must be at least 0 and below 1");
  LevelSetSettings levelSet;
  levelSet.resolution = settings.resolution;
  levelSet.maxMemory = settings.maxMemory;
  levelSet.progress = settings.progress;
  const openvdb::FloatGrid::Ptr grid = makeLevelSet(solid, levelSet);
  Mesher mesher(*grid, settings.progress);
  mesher.run();
  Isosurface result;
  result.voxelSize = grid->voxelSize()[0];
  result.mesh.name = solid.repaired().mesh.name;
  result.mesh.triangles = std::move(mesher.triangles);
  result.mesh.vertices.reserve(mesher.points.size());
  for (const Vec3& p : mesher.points) {
    const openvdb::Vec3d world = grid->indexToWorld(openvdb::Vec3d(p.x, p.y, p.z));
    result.mesh.vertices.push_back({world.x(), world.y(), world.z()});
  }
  keepLargeShells(result.mesh, settings.leastShell, result);
  if (result.mesh.triangles.empty())
    throw DataError(result.mesh.name +
                    ": its level set has no surface, all parts are thinner than a voxel; give a "
                    "higher resolution");
  return result;
}

}  // namespace innermap

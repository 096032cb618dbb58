#include <algorithm>

#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "innermap/tetra/cells.h"

namespace innermap {
namespace {

constexpr std::size_t kBlock = 512;
constexpr double kApart = 0.1;     // of the diagonal, boxes of the mesh and of the solid
constexpr double kOutside = 1e-6;  // of the diagonal: counted as outside

std::vector<LinearSample> samplesOf(const LinearCellMap& map, bool push, const Points& points) {
  std::vector<LinearSample> out(points.size());
  parallelBlocks(points.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      out[i] = push ? map.push(points[i]) : map.pull(points[i]);
  });
  return out;
}

bool apart(const Box3& mesh, const Box3& solid) {
  const double most = kApart * solid.diagonal();
  return norm(mesh.lower - solid.lower) > most || norm(mesh.upper - solid.upper) > most;
}

}  // namespace

LinearCellMap linearMapOf(const CellMesh& carried, const MappedSolid& mapped) {
  if (apart(boundingBox(carried.vertices), boundingBox(mapped.boundary.target.moved)))
    throw DataError(carried.name +
                    ": does not fill the map's target; give the mesh that remesh made with "
                    "this map");
  return LinearCellMap(carried);
}

ThroughMap throughMap(const LinearCellMap& map) {
  const auto way = [map](bool push) {
    return [map, push](const Points& points, Points& images, std::vector<Mat3>& jacobians) {
      for (const LinearSample& s : samplesOf(map, push, points)) {
        images.push_back(s.image);
        jacobians.push_back(s.jacobian);
      }
    };
  };
  return {way(true), way(false)};
}

PointCarry carryThrough(const LinearCellMap& map, bool push, const CarryPointsSettings& settings) {
  const double diagonal = push ? map.sourceDiagonal() : map.targetDiagonal();
  const double most = std::max(settings.skin, settings.outside.distance) * diagonal;
  return [=](const Points& points, bool jacobians) {
    CarriedPoints out;
    for (const LinearSample& s : samplesOf(map, push, points)) {
      const bool cut = s.outside > most;
      out.points.push_back(s.image);
      out.fates.push_back(cut ? PointFate::cut : PointFate::carried);
      if (jacobians) out.jacobians.push_back(s.jacobian);
      out.outside += s.outside > kOutside * diagonal;
      out.cut += cut;
      if (!cut) out.farthest = std::max(out.farthest, s.outside / diagonal);
    }
    return out;
  };
}

}  // namespace innermap

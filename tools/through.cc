#include "through.h"

#include <fmt/format.h>

#include <algorithm>

#include "innermap/core/error.h"
#include "innermap/core/parallel.h"
#include "innermap/io/cells/cell_file.h"

namespace innermap::tool {
namespace {

constexpr std::size_t kBlock = 512;
constexpr double kApart = 0.1;     // of the diagonal, boxes of the mesh and of the solid
constexpr double kOutside = 1e-6;  // of the diagonal: counted as outside

std::vector<LinearSample> samplesOf(const LinearCellMap& map, bool push, const Points& points,
                                    Progress* progress) {
  std::vector<LinearSample> out(points.size());
  parallelBlocks(
      points.size(), kBlock,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
          out[i] = push ? map.push(points[i]) : map.pull(points[i]);
      },
      progress);
  return out;
}

bool apart(const Box3& mesh, const Box3& solid) {
  const double most = kApart * solid.diagonal();
  return norm(mesh.lower - solid.lower) > most || norm(mesh.upper - solid.upper) > most;
}

}  // namespace

LinearCellMap readThrough(const std::string& path, const MappedSolid& mapped, Context& context) {
  const CellMesh mesh = context.timed(
      "read", [&] { return readCells(path, context.settings<ReadCellsSettings>()).mesh; });
  if (apart(boundingBox(mesh.vertices), boundingBox(mapped.boundary.target.moved)))
    throw DataError(path +
                    ": does not fill the map's target; give the mesh that remesh made with "
                    "this map");
  return LinearCellMap(mesh);
}

ThroughMap throughMap(const LinearCellMap& map) {
  const auto way = [map](bool push) {
    return [map, push](const Points& points, Points& images, std::vector<Mat3>& jacobians) {
      for (const LinearSample& s : samplesOf(map, push, points, nullptr)) {
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
  Progress* progress = settings.progress;
  return [=](const Points& points, bool jacobians) {
    CarriedPoints out;
    for (const LinearSample& s : samplesOf(map, push, points, progress)) {
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

}  // namespace innermap::tool

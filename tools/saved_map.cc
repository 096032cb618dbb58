#include "saved_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "innermap/core/error.h"
#include "innermap/evaluate/evaluate_map.h"

namespace innermap::tool {
namespace {

constexpr double kFinestSum = 1e-9;

}  // namespace

FieldFile readMap(const std::string& path, Context& context) {
  std::optional<FieldFile> file;
  context.timed("read", [&] { file.emplace(readField(path)); });
  if (file->field.channels() != 3)
    throw FileError(path, fmt::format("has {} channels; a map has 3", file->field.channels()));
  if (file->boundaryTriangles.empty())
    throw FileError(path, "holds no boundary; write it with innermap fit or map");
  return *std::move(file);
}

BoundaryPair boundaryOf(const FieldFile& file, const std::string& path, Context& context) {
  Mesh source;
  source.name = path;
  source.vertices = file.boundary;
  source.triangles = file.boundaryTriangles;
  Mesh target = source;
  target.vertices = file.boundaryTarget;
  for (const auto& [key, value] : file.settings) {
    if (key == "source") source.name = value;
    if (key == "target") target.name = value;
  }
  validate(source);
  validate(target);
  return makeBoundaryPair(std::move(source), std::move(target), context);
}

Solid targetSolid(const BoundaryPair& pair, Context& context) {
  Mesh target = pair.solid.repaired().mesh;
  target.vertices = pair.moved;
  target.name = pair.target.name;
  SolidSettings settings;
  settings.progress = context.progress();
  return Solid(target, settings);
}

void describeMap(const openvdb::GridPtrVec& grids, const FieldFile& file) {
  for (const openvdb::GridBase::Ptr& grid : grids)
    for (const auto& [key, value] : file.settings)
      grid->insertMeta("innermap_" + key, openvdb::StringMetadata(value));
}

double sumAccuracy(const FieldFile& file) {
  double error = 0;
  for (const auto& [key, value] : file.settings) {
    // Fitted to the vertices alone, a map is far more exact than its error on triangles says.
    if (key == "interpolation" && value == "smooth") return kFinestSum;
    if (key == "boundary_error_rms") error = std::strtod(value.c_str(), nullptr);
  }
  return error > 0 ? sumAccuracy(error) : EvaluateSettings().accuracy;
}

double sumAccuracy(double boundaryErrorRms) {
  constexpr double kShare = 0.02, kCoarsest = 1e-5;
  return std::clamp(kShare * boundaryErrorRms, kFinestSum, kCoarsest);
}

}  // namespace innermap::tool

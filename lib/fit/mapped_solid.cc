#include "innermap/fit/mapped_solid.h"

#include <fmt/format.h>

#include <algorithm>

#include "fit/detail/boundary_check.h"
#include "innermap/core/error.h"
#include "innermap/field/field_file.h"

namespace innermap {
namespace {

constexpr double kFinestSum = 1e-9, kCoarsestSum = 1e-5;
constexpr double kDefaultSum = 1e-7;  // of a file that states no error: what float grids hold

}  // namespace

void writeMap(const std::string& path, const MappedSolid& mapped) {
  FieldFile file;
  for (const HarmonicMap& step : mapped.map.steps()) file.steps.push_back(step.field());
  file.facts = mapped.facts;
  file.boundary = mapped.boundary.source.mesh.vertices;
  file.boundaryTarget = mapped.boundary.targetMesh.vertices;
  file.boundaryTriangles = mapped.boundary.source.mesh.triangles;
  writeField(path, file);
}

MappedSolid readMap(const std::string& path) {
  StageSeconds seconds;
  FieldFile file = timed(seconds, "read", [&] { return readField(path); });
  if (file.steps.front().channels() != 3)
    throw FileError(path,
                    fmt::format("has {} channels; a map has 3", file.steps.front().channels()));
  if (file.boundaryTriangles.empty())
    throw FileError(path, "holds no boundary; write it with innermap fit or map");
  Mesh source;
  source.name = path;
  source.vertices = std::move(file.boundary);
  source.triangles = std::move(file.boundaryTriangles);
  Mesh target = source;
  target.vertices = std::move(file.boundaryTarget);
  source.name = factText(file.facts, "source").value_or(source.name);
  target.name = factText(file.facts, "target").value_or(target.name);
  validate(source);
  validate(target);
  BoundaryPair pair = makeBoundaryPair(std::move(source), std::move(target));
  addSeconds(seconds, pair.seconds);
  pair.seconds = std::move(seconds);
  std::vector<HarmonicMap> steps;
  for (HarmonicField& step : file.steps) steps.emplace_back(std::move(step));
  Injectivity known = injectivityOf(pair);
  readInjectivity(file.facts, known);
  return {ComposedMap(std::move(steps)), std::move(pair), std::move(file.facts), std::move(known)};
}

double sumAccuracy(const MappedSolid& mapped) {
  // Fitted to the vertices alone, a map is far more exact than its error on triangles says.
  if (factText(mapped.facts, "interpolation") == "smooth") return kFinestSum;
  const double error = fitFacts(mapped.facts).error.rms;
  return error > 0 ? sumAccuracy(error) : kDefaultSum;
}

double sumAccuracy(double boundaryErrorRms) {
  constexpr double kShare = 0.02;
  return std::clamp(kShare * boundaryErrorRms, kFinestSum, kCoarsestSum);
}

}  // namespace innermap

#include "transfer/detail/field_grid.h"

#include <algorithm>
#include <cmath>

#include "evaluate/topology.h"
#include "evaluate/visit_field.h"
#include "innermap/core/error.h"
#include "transfer/detail/continue_values.h"

namespace innermap {
namespace {

// The largest value at some boundary points: the unit of the sums' accuracy.
double sizeOf(const HarmonicField& field, const Solid& solid) {
  constexpr std::size_t kSamples = 500;
  const Points& vertices = solid.surface().vertices;
  const std::size_t count = std::min(kSamples, vertices.size());
  Points some(count);
  for (std::size_t i = 0; i < count; ++i) some[i] = vertices[i * vertices.size() / count];
  std::vector<double> values(count * field.channels());
  field.evaluate(some.data(), count, values.data(), nullptr);
  double largest = 0;
  for (const double v : values) largest = std::max(largest, std::abs(v));
  return largest > 0 ? largest : 1;
}

template <class Grid, class ValueOf>
openvdb::GridBase::Ptr filled(const std::shared_ptr<Grid>& grid, const std::string& name,
                              const ValueOf& valueOf) {
  grid->setName(name);
  std::size_t i = 0;
  for (auto leaf = grid->tree().beginLeaf(); leaf; ++leaf)
    for (auto voxel = leaf->beginValueOn(); voxel; ++voxel, ++i) voxel.setValue(valueOf(i));
  return grid;
}

}  // namespace

openvdb::GridBase::Ptr fieldGrid(const CarriedField& field, const Solid& source,
                                 const SourceLattice& lattice, const InvertedMap& inverted,
                                 double accuracy) {
  if (field.field.channels() != 1 && field.field.channels() != 3)
    throw DataError("field \"" + field.name + "\": must have one channel or three");
  const ExtendedSamples found =
      sampleExtended(field.field, source, *lattice.levelSet, inverted.sources,
                     {accuracy * sizeOf(field.field, source), {}});
  const Matrix& v = found.samples.values;
  if (field.field.channels() == 1)
    return filled(floatGridOn(*inverted.region), field.name,
                  [&](std::size_t i) { return static_cast<float>(v(i, 0)); });
  const openvdb::Vec3SGrid::Ptr vectors = vectorGridOn(*inverted.region);
  const openvdb::GridBase::Ptr grid = filled(vectors, field.name, [&](std::size_t i) {
    return openvdb::Vec3f(openvdb::Vec3d(v(i, 0), v(i, 1), v(i, 2)));
  });
  grid->setVectorType(field.vectorType);
  if (field.shutter > 0) continueBySpeed(*vectors, field.shutter);
  return grid;
}

}  // namespace innermap

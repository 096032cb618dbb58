// Maps and grids of known values for the tests of transfer/.
#pragma once

#include <openvdb/openvdb.h>

#include <cmath>

#include "core/pi.h"
#include "core/random.h"
#include "field/affine_map.h"
#include "innermap/field/fit.h"
#include "innermap/field/harmonic_field.h"
#include "innermap/levelset/level_set.h"
#include "innermap/levelset/solid.h"
#include "mesh/shapes.h"

namespace innermap::test {

// Uniform numbers in [0, 1), one after the other.
class Draws {
 public:
  explicit Draws(std::uint64_t seed) : random_(seed, 0) {}
  double operator()() { return random_.uniform(next_++); }

 private:
  CounterRandom random_;
  std::uint64_t next_ = 0;
};

inline Mat3 rotation(double a, double b) {
  const Mat3 z{{{std::cos(a), -std::sin(a), 0}, {std::sin(a), std::cos(a), 0}, {0, 0, 1}}};
  const Mat3 x{{{1, 0, 0}, {0, std::cos(b), -std::sin(b)}, {0, std::sin(b), std::cos(b)}}};
  return product(x, z);
}

// Evenly spread points of a sphere about the origin.
inline Points spherePoints(std::size_t count, double radius) {
  Points out(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double z = 1 - (2.0 * i + 1) / count, r = std::sqrt(1 - z * z), a = 2.399963229728653 * i;
    out[i] = radius * Vec3{r * std::cos(a), r * std::sin(a), z};
  }
  return out;
}

// The map of the unit ball that has the boundary values of `function`; that itself, to about
// 1e-9, where it is harmonic.
template <class Function>
HarmonicMap fittedMap(const Function& function) {
  const auto valuesAt = [&](const Points& points) {
    Matrix values(points.size(), 3);
    for (std::size_t i = 0; i < points.size(); ++i)
      for (int a = 0; a < 3; ++a) values(i, a) = function(points[i])[a];
    return values;
  };
  FitProblem problem;
  problem.surface.points = spherePoints(1200, 1);
  problem.surface.heldOut = spherePoints(300, 1);
  problem.surface.values = valuesAt(problem.surface.points);
  problem.surface.heldOutValues = valuesAt(problem.surface.heldOut);
  problem.diagonal = 2 * std::sqrt(3.0);
  problem.area = 4 * kPi;
  problem.placeSources = [](std::size_t count, double distance) {
    return spherePoints(count, 1 + distance * 2 * std::sqrt(3.0));
  };
  FitSettings settings;
  settings.sources = 300;
  settings.distance = 0.3;
  return HarmonicMap(fitField(problem, settings).field);
}

inline Mesh ball(double radius = 1, int subdivisions = 4) {
  Mesh mesh = shapes::icosphere(subdivisions);
  for (Vec3& v : mesh.vertices) v = radius * v;
  return mesh;
}

// A mesh whose vertices the map has moved.
inline Mesh moved(Mesh mesh, const ComposedMap& map) {
  for (Vec3& v : mesh.vertices) v = map(v);
  return mesh;
}

inline openvdb::FloatGrid::Ptr levelSetOf(const Solid& solid, int resolution) {
  LevelSetSettings settings;
  settings.resolution = resolution;
  return makeLevelSet(solid, settings);
}

// The point that the map brings to q, by Newton's method from `start`, to rounding.
inline Vec3 preimage(const HarmonicMap& map, const Vec3& q, Vec3 p) {
  for (int i = 0; i < 6; ++i) p += inverse(map.jacobian(p)) * (q - map(p));
  return p;
}

inline double smooth(const Vec3& p) { return std::sin(2 * p.x) + std::cos(3 * p.y) * p.z + 2; }
inline Vec3 smoothVector(const Vec3& p) {
  return {smooth(p), smooth({p.y, p.z, p.x}), smooth({p.z, p.x, p.y}) - 1};
}

inline Vec3 toVec3(const openvdb::Vec3d& v) { return {v.x(), v.y(), v.z()}; }

// Values of a function at all voxels of a level set's inside and three voxels beyond.
template <class Grid, class Function>
typename Grid::Ptr sampled(const openvdb::FloatGrid& levelSet, const std::string& name,
                           const Function& function) {
  auto grid = Grid::create();
  grid->setTransform(levelSet.transform().copy());
  grid->setName(name);
  auto accessor = grid->getAccessor();
  auto distance = levelSet.getConstAccessor();
  const openvdb::CoordBBox box = levelSet.evalActiveVoxelBoundingBox();
  for (auto ijk = box.begin(); ijk; ++ijk)
    if (distance.getValue(*ijk) < levelSet.background())
      accessor.setValue(*ijk, function(toVec3(levelSet.transform().indexToWorld(*ijk))));
  return grid;
}

inline openvdb::FloatGrid::Ptr sampledScalar(const openvdb::FloatGrid& levelSet,
                                             const std::string& name) {
  return sampled<openvdb::FloatGrid>(levelSet, name,
                                     [](const Vec3& p) { return static_cast<float>(smooth(p)); });
}

inline openvdb::Vec3SGrid::Ptr sampledVector(const openvdb::FloatGrid& levelSet,
                                             const std::string& name, openvdb::VecType type) {
  auto grid = sampled<openvdb::Vec3SGrid>(levelSet, name, [](const Vec3& p) {
    const Vec3 v = smoothVector(p);
    return openvdb::Vec3f(openvdb::Vec3d(v.x, v.y, v.z));
  });
  grid->setVectorType(type);
  return grid;
}

// Calls visit(world position, value) for the voxels of `grid` that are well inside the solid.
template <class Grid, class Visit>
std::size_t forInside(const openvdb::GridBase& grid, const openvdb::FloatGrid& levelSet,
                      const Visit& visit) {
  auto distance = levelSet.getConstAccessor();
  std::size_t count = 0;
  for (auto value = static_cast<const Grid&>(grid).cbeginValueOn(); value; ++value) {
    if (!(distance.getValue(value.getCoord()) < -levelSet.voxelSize()[0])) continue;
    visit(toVec3(grid.transform().indexToWorld(value.getCoord())), *value);
    ++count;
  }
  return count;
}

}  // namespace innermap::test

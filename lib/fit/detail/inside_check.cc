#include "fit/detail/inside_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/random.h"
#include "innermap/core/run.h"

namespace innermap {

namespace {

using Cube = std::array<std::uint64_t, 3>;  // its number along each axis

std::vector<Cube> halved(const std::vector<Cube>& cubes) {
  std::vector<Cube> out;
  out.reserve(8 * cubes.size());
  for (const auto& [i, j, k] : cubes)
    for (std::uint64_t part = 0; part < 8; ++part)
      out.push_back({2 * i + (part >> 2), 2 * j + (part >> 1 & 1), 2 * k + (part & 1)});
  return out;
}

std::vector<Cube> chosen(const std::vector<Cube>& cubes,
                         const std::function<bool(const Cube&)>& wanted) {
  std::vector<char> keep(cubes.size(), 0);
  parallelBlocks(cubes.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) keep[c] = wanted(cubes[c]);
  });
  std::vector<Cube> out;
  for (std::size_t c = 0; c < cubes.size(); ++c)
    if (keep[c]) out.push_back(cubes[c]);
  return out;
}

}  // namespace

Points stratifiedPoints(const Box3& box, double step, const PointRegion& region) {
  Cube count;
  for (int a = 0; a < 3; ++a)
    count[static_cast<std::size_t>(a)] =
        static_cast<std::uint64_t>(std::ceil(box.extent()[a] / step));
  const CounterRandom random(1, 83);
  const auto place = [&](const Cube& cube) {
    const std::uint64_t draw = 3 * ((cube[0] * count[1] + cube[1]) * count[2] + cube[2]);
    Vec3 p = box.lower;
    for (int a = 0; a < 3; ++a) {
      const auto axis = static_cast<std::size_t>(a);
      p[a] += step * (static_cast<double>(cube[axis]) + random.uniform(draw + axis));
    }
    return p;
  };
  std::uint64_t side = 1;
  while (side < *std::max_element(count.begin(), count.end())) side *= 2;
  std::vector<Cube> cubes{{0, 0, 0}};
  for (; side > 1; side /= 2)
    cubes = halved(chosen(cubes, [&](const Cube& cube) {
      const double size = static_cast<double>(side) * step;
      Vec3 centre = box.lower;
      for (int a = 0; a < 3; ++a)
        centre[a] += size * (static_cast<double>(cube[static_cast<std::size_t>(a)]) + 0.5);
      return region.inside(centre) || region.near(centre, 0.5 * std::sqrt(3.0) * size);
    }));
  cubes = chosen(cubes, [&](const Cube& cube) {
    for (std::size_t a = 0; a < 3; ++a)
      if (cube[a] >= count[a]) return false;
    return region.inside(place(cube));
  });
  std::sort(cubes.begin(), cubes.end());
  Points out;
  for (const Cube& cube : cubes) out.push_back(place(cube));
  return out;
}

Points pointsInside(const Solid& solid, std::size_t count) {
  const double volume = std::max(solid.volume(), 1e-9 * std::pow(solid.diagonal(), 3));
  return stratifiedPoints(solid.box(), std::cbrt(volume / static_cast<double>(count)),
                          {[&](const Vec3& p) { return solid.inside(p); },
                           [&](const Vec3& p, double distance) {
                             return solid.distance(p) <= distance + solid.gap();
                           }});
}

MappedPoints mapPoints(const HarmonicMap& step, const MappedPoints& before, double accuracy) {
  EvaluateFieldSettings settings;
  settings.accuracy = accuracy;
  settings.gradients = true;
  const FieldSamples samples = step.field().evaluate(before.points, settings);
  MappedPoints out;
  out.points.resize(before.points.size());
  out.determinants.resize(before.points.size());
  for (std::size_t i = 0; i < out.points.size(); ++i) {
    Mat3 j;
    for (std::size_t r = 0; r < 3; ++r) {
      out.points[i][static_cast<int>(r)] = samples.values(i, r);
      for (std::size_t a = 0; a < 3; ++a) j[r][a] = samples.gradients(i, 3 * r + a);
    }
    out.determinants[i] =
        determinant(j) * (before.determinants.empty() ? 1 : before.determinants[i]);
  }
  return out;
}

MappedPoints mapPoints(const ComposedMap& map, Points points, double accuracy) {
  MappedPoints here{std::move(points), {}};
  for (const HarmonicMap& step : map.steps()) here = mapPoints(step, here, accuracy);
  return here;
}

DeterminantFigures determinantsOf(const MappedPoints& mapped, const TargetShape& target,
                                  double error) {
  DeterminantFigures out;
  for (std::size_t i = 0; i < mapped.points.size(); ++i) {
    const double determinant = target.orientation() * mapped.determinants[i];
    out.add(determinant, !(determinant > 0) && target.runsThroughItself(mapped.points[i], error));
  }
  return out;
}

double foldedShare(const std::vector<double>& determinants, int orientation) {
  if (determinants.empty()) return 0;
  const auto folded = std::count_if(determinants.begin(), determinants.end(),
                                    [&](double d) { return !(orientation * d > 0); });
  return static_cast<double>(folded) / static_cast<double>(determinants.size());
}

double outsideShare(const Points& points, const TargetShape& target, double slack) {
  if (points.empty() || !(target.volume() > 0)) return 0;
  std::vector<char> outside(points.size(), 0);
  parallelBlocks(points.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      outside[i] = !target.inside(points[i]) && !target.near(points[i], slack);
  });
  return static_cast<double>(std::count(outside.begin(), outside.end(), 1)) /
         static_cast<double>(points.size());
}

}  // namespace innermap

#include "fit/detail/inside_check.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/random.h"
#include "innermap/core/run.h"

namespace innermap {

Points stratifiedPoints(const Box3& box, double step,
                        const std::function<bool(const Vec3&)>& wanted) {
  const auto cells = [&](int axis) {
    return static_cast<std::size_t>(std::ceil(box.extent()[axis] / step));
  };
  const std::size_t nx = cells(0), ny = cells(1), nz = cells(2);
  const CounterRandom random(1, 83);
  std::vector<Points> columns(nx * ny);
  parallelBlocks(columns.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      const std::size_t i = c / ny, j = c % ny;
      for (std::size_t k = 0; k < nz; ++k) {
        const std::uint64_t draw = 3 * (c * nz + k);
        const Vec3 p = box.lower + step * Vec3{static_cast<double>(i) + random.uniform(draw),
                                               static_cast<double>(j) + random.uniform(draw + 1),
                                               static_cast<double>(k) + random.uniform(draw + 2)};
        if (wanted(p)) columns[c].push_back(p);
      }
    }
  });
  Points out;
  for (const Points& column : columns) out.insert(out.end(), column.begin(), column.end());
  return out;
}

Points pointsInside(const Solid& solid, std::size_t count) {
  const double volume = std::max(solid.volume(), 1e-9 * std::pow(solid.diagonal(), 3));
  return stratifiedPoints(solid.box(), std::cbrt(volume / static_cast<double>(count)),
                          [&](const Vec3& p) { return solid.inside(p); });
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
    const double determinant = mapped.determinants[i];
    out.add(determinant, !(determinant > 0) && target.runsThroughItself(mapped.points[i], error));
  }
  return out;
}

double foldedShare(const std::vector<double>& determinants) {
  if (determinants.empty()) return 0;
  const auto folded =
      std::count_if(determinants.begin(), determinants.end(), [](double d) { return !(d > 0); });
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

#include "mesh/detail/shells.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/pi.h"
#include "innermap/core/run.h"
#include "mesh/detail/topology.h"
#include "mesh/winding_number.h"

namespace innermap {
namespace {

Box3 boxOf(const ClosedShells& shells) {
  Box3 box;
  for (const Triangle& t : shells.triangles)
    for (const int v : t) box.add(shells.positions[v]);
  return box;
}

// Van Oosterom and Strackee (1983), as share of the full sphere.
double solidAngle(Vec3 a, Vec3 b, Vec3 c, const Vec3& p) {
  a = a - p;
  b = b - p;
  c = c - p;
  const double la = norm(a), lb = norm(b), lc = norm(c);
  return std::atan2(dot(a, cross(b, c)),
                    la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb) /
         (2 * kPi);
}

// Points just beside some of the shell's larger triangles.
Points probes(const ClosedShells& shells, const std::vector<int>& members) {
  std::vector<std::pair<double, int>> byArea;
  for (const int t : members) {
    const Triangle& triangle = shells.triangles[t];
    const Vec3& a = shells.positions[triangle[0]];
    byArea.push_back(
        {-norm(cross(shells.positions[triangle[1]] - a, shells.positions[triangle[2]] - a)), t});
  }
  // The larger half, evenly: no needle, and not all in one corner of the shell.
  const std::size_t half = (members.size() + 1) / 2, count = std::min<std::size_t>(5, half);
  std::nth_element(byArea.begin(), byArea.begin() + (half - 1), byArea.end());
  byArea.resize(half);
  std::sort(byArea.begin(), byArea.end(),
            [](const auto& x, const auto& y) { return x.second < y.second; });
  Points points;
  for (std::size_t k = 0; k < count; ++k) {
    const Triangle& t = shells.triangles[byArea[k * half / count].second];
    const Vec3 &a = shells.positions[t[0]], &b = shells.positions[t[1]],
               &c = shells.positions[t[2]];
    const Vec3 normal = cross(b - a, c - a);
    const double twiceArea = norm(normal);
    if (!(twiceArea > 0)) continue;
    points.push_back((a + b + c) / 3 - (1e-3 / std::sqrt(twiceArea)) * normal);
  }
  return points;
}

// Whether most probes lie inside the other shells.
bool insideOthers(const ClosedShells& shells, const std::vector<int>& members,
                  const WindingNumber& all) {
  int inside = 0, outside = 0;
  for (const Vec3& p : probes(shells, members)) {
    double own = 0;
    for (const int t : members) {
      const Triangle& triangle = shells.triangles[t];
      own += solidAngle(shells.positions[triangle[0]], shells.positions[triangle[1]],
                        shells.positions[triangle[2]], p);
    }
    ++(all.at(p) - own > 0.5 ? inside : outside);
  }
  return inside > outside;
}

}  // namespace

std::vector<double> shellVolumes(const ClosedShells& shells) {
  std::vector<double> volumes(static_cast<std::size_t>(shells.shells), 0);
  const Vec3 center = boxOf(shells).center();
  for (std::size_t t = 0; t < shells.triangles.size(); ++t) {
    const Triangle& triangle = shells.triangles[t];
    volumes[shells.shell[t]] +=
        coneVolume6(center, shells.positions[triangle[0]], shells.positions[triangle[1]],
                    shells.positions[triangle[2]]) /
        6;
  }
  return volumes;
}

std::vector<bool> invertedShells(const ClosedShells& shells) {
  std::vector<double> volumes = shellVolumes(shells);
  const double total = std::accumulate(volumes.begin(), volumes.end(), 0.0);
  std::vector<bool> inverted(volumes.size(), total < 0);
  if (total < 0)
    for (double& volume : volumes) volume = -volume;
  // Below this a shell is a sheet, whose sign is rounding.
  const double size = boxOf(shells).diagonal(), least = 1e-14 * size * size * size;
  if (std::none_of(volumes.begin(), volumes.end(), [&](double v) { return v < -least; }))
    return inverted;

  std::vector<std::vector<int>> members(volumes.size());
  std::vector<Triangle> triangles = shells.triangles;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    members[shells.shell[t]].push_back(static_cast<int>(t));
    if (total < 0) std::swap(triangles[t][1], triangles[t][2]);
  }
  const ClosedShells upright{shells.positions, triangles, shells.shell, shells.shells};
  const WindingNumber all(upright.positions, upright.triangles);
  for (std::size_t s = 0; s < volumes.size(); ++s) {
    throwIfCancelled();
    if (volumes[s] < -least && !insideOthers(upright, members[s], all)) inverted[s] = !inverted[s];
  }
  return inverted;
}

}  // namespace innermap

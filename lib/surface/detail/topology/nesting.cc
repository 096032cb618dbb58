#include "surface/detail/topology/nesting.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "innermap/core/run.h"
#include "mesh/winding_number.h"

namespace innermap {
namespace {

constexpr std::size_t kProbes = 15;

// Middles of some of the larger half of the triangles, evenly.
Points probesOf(const ClosedSurface& shell) {
  const auto at = [&](int t, int k) { return shell.vertices[shell.triangles[t][k]]; };
  std::vector<std::pair<double, int>> byArea;
  for (int t = 0; t < static_cast<int>(shell.triangles.size()); ++t)
    byArea.emplace_back(-norm(cross(at(t, 1) - at(t, 0), at(t, 2) - at(t, 0))), t);
  const std::size_t half = (byArea.size() + 1) / 2;
  std::nth_element(byArea.begin(), byArea.begin() + static_cast<long>(half - 1), byArea.end());
  byArea.resize(half);
  std::sort(byArea.begin(), byArea.end(),
            [](const auto& a, const auto& b) { return a.second < b.second; });
  Points probes;
  const std::size_t count = std::min(kProbes, half);
  for (std::size_t i = 0; i < count; ++i) {
    const int t = byArea[i * half / count].second;
    probes.push_back((at(t, 0) + at(t, 1) + at(t, 2)) / 3);
  }
  return probes;
}

bool contains(const Box3& outer, const Box3& inner) {
  for (int a = 0; a < 3; ++a)
    if (inner.lower[a] < outer.lower[a] || inner.upper[a] > outer.upper[a]) return false;
  return true;
}

}  // namespace

std::vector<int> parentShells(const std::vector<ClosedSurface>& shells) {
  const std::size_t count = shells.size();
  std::vector<int> parent(count, -1);
  if (count < 2) return parent;
  std::vector<Box3> boxes;
  std::vector<double> volumes;
  std::vector<Points> probes;
  for (const ClosedSurface& shell : shells) {
    boxes.push_back(boundingBox(shell.vertices));
    volumes.push_back(std::abs(signedVolume(shell.vertices, shell.triangles)));
    probes.push_back(probesOf(shell));
  }
  // Outermost first: the last that contains a shell is the one directly around it.
  std::vector<std::size_t> order(count);
  for (std::size_t s = 0; s < count; ++s) order[s] = s;
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return volumes[a] > volumes[b]; });
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t outer = order[i];
    std::optional<WindingNumber> winding;
    for (std::size_t j = i + 1; j < count; ++j) {
      const std::size_t inner = order[j];
      if (!contains(boxes[outer], boxes[inner])) continue;
      throwIfCancelled();
      if (!winding) winding.emplace(shells[outer].vertices, shells[outer].triangles);
      std::size_t inside = 0;
      for (const Vec3& p : probes[inner])
        if (std::abs(winding->at(p)) > 0.5) ++inside;
      if (2 * inside > probes[inner].size()) parent[inner] = static_cast<int>(outer);
    }
  }
  return parent;
}

}  // namespace innermap

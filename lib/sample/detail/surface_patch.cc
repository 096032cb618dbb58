#include "sample/detail/surface_patch.h"

#include <algorithm>
#include <cmath>

#include "innermap/core/run.h"

namespace innermap {
namespace {

constexpr double kCoarser = 4;
constexpr std::size_t kMostGrids = 4;  // cells up to 64 times as wide

}  // namespace

SurfacePatch::SurfacePatch(const Mesh& surface, const Points& marks, double reach, double fine)
    : surface_(surface), reach_(reach), fine_(fine), all_(marks.empty()) {
  for (double cell = 2 * reach; !all_ && marks_.size() < kMostGrids; cell *= kCoarser)
    marks_.emplace_back(marks, cell);
  constexpr std::size_t kBlock = 1024;
  constexpr Corners kWhole{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  const std::size_t count = surface.triangles.size();
  std::vector<std::vector<Part>> parts((count + kBlock - 1) / kBlock);
  parallelBlocks(count, kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      Box3 box;
      for (const int v : surface.triangles[t]) box.add(surface.vertices[v]);
      addNear(static_cast<int>(t), kWhole, 0.5 * box.diagonal(), parts[begin / kBlock]);
    }
  });
  double sum = 0;
  for (const std::vector<Part>& some : parts)
    for (const Part& part : some) {
      if (!(part.area > 0)) continue;
      parts_.push_back(part);
      cumulative_.push_back(sum += part.area);
    }
}

bool SurfacePatch::anyMarkNearer(const Vec3& p, double radius) const {
  std::size_t grid = 0;
  for (double cell = 2 * reach_; cell < radius && grid + 1 < marks_.size(); cell *= kCoarser)
    ++grid;
  return marks_[grid].anyNearer(p, radius);
}

SurfacePatch::Barycentric SurfacePatch::at(const Corners& corners, const Barycentric& inside) {
  Barycentric out{};
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t k = 0; k < 3; ++k) out[k] += inside[c] * corners[c][k];
  return out;
}

void SurfacePatch::addNear(int triangle, const Corners& corners, double half,
                           std::vector<Part>& parts) const {
  Vec3 p[3];
  Box3 box;
  for (std::size_t c = 0; c < 3; ++c) box.add(p[c] = positionOf(surface_, {triangle, corners[c]}));
  if (!all_ && !anyMarkNearer(box.center(), reach_ + half)) return;
  if (all_ || 2 * half <= fine_ || anyMarkNearer(box.center(), std::max(0.0, reach_ - half))) {
    parts.push_back({triangle, corners, norm(cross(p[1] - p[0], p[2] - p[0]))});
    return;
  }
  Corners middle{};
  for (std::size_t c = 0; c < 3; ++c) {
    Barycentric opposite{0.5, 0.5, 0.5};
    opposite[c] = 0;
    middle[c] = at(corners, opposite);
  }
  addNear(triangle, middle, 0.5 * half, parts);
  for (std::size_t c = 0; c < 3; ++c) {
    Corners part = middle;
    part[c] = corners[c];
    addNear(triangle, part, 0.5 * half, parts);
  }
}

SurfacePoint SurfacePatch::sample(double share, double u, double v) const {
  const auto found = std::upper_bound(cumulative_.begin(), cumulative_.end(), share * area());
  const Part& part =
      parts_[std::min(static_cast<std::size_t>(found - cumulative_.begin()), parts_.size() - 1)];
  const double r = std::sqrt(u);
  return {part.triangle, at(part.corners, {1 - r, r * (1 - v), r * v})};
}

}  // namespace innermap

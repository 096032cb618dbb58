#include "innermap/core/run.h"
#include "innermap/evaluate/evaluate_map.h"
#include "innermap/transfer/inverse_map.h"

namespace innermap {
namespace {

std::vector<PointImage> samplesOf(const std::function<PointImage(const Vec3&)>& way,
                                  const Points& points) {
  constexpr std::size_t kBlock = 512;
  std::vector<PointImage> out(points.size());
  parallelBlocks(points.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) out[i] = way(points[i]);
  });
  return out;
}

}  // namespace

double SolidMap::targetDiagonal(const Solid& source) const {
  return harmonic_ ? targetExtent(*harmonic_, source) : pointwise_->targetDiagonal;
}

Points SolidMap::images(const Points& points, double accuracy) const {
  if (harmonic_) return pointsOf(harmonic_->evaluate(points, {accuracy, false}).values);
  Points out;
  for (const PointImage& s : push(points)) out.push_back(s.image);
  return out;
}

std::vector<PointImage> SolidMap::push(const Points& points) const {
  return samplesOf(pointwise_->push, points);
}

std::vector<PointImage> SolidMap::pull(const Points& points) const {
  return samplesOf(pointwise_->pull, points);
}

}  // namespace innermap

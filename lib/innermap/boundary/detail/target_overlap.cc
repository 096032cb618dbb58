#include "innermap/boundary/detail/target_overlap.h"

#include <cmath>

#include "innermap/boundary/detail/refined_surface.h"

namespace innermap {
namespace {

constexpr double kNear = 0.01;  // of the target's diagonal

}  // namespace

TargetOverlap::TargetOverlap(const BoundaryPair& pair, double error)
    : reach_(kNear * pair.target.diagonal + error) {
  const std::vector<Crossing>& crossings = pair.targetCheck.crossings;
  if (crossings.empty()) return;
  Points places;
  std::vector<Triangle> points;  // without extent: the tree is of triangles
  for (const Crossing& crossing : crossings) {
    const int v = static_cast<int>(places.size());
    places.push_back(crossing.place);
    points.push_back({v, v, v});
  }
  places_.emplace(places, points);
  winding_.emplace(targetSurface(pair), pair.solid().surface().triangles);
}

bool TargetOverlap::at(const Vec3& p) const {
  if (!places_) return false;
  if (places_->closest(p, reach_).address.triangle >= 0) return true;
  const long winding = std::lround(winding_->at(p));
  return winding < 0 || winding > 1;
}

Points targetSurface(const BoundaryPair& pair) {
  const Matrix targets = pair.targetsOf(RefinedSurface(pair.solid().surface()).vertices);
  Points out(targets.rows());
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = {targets(i, 0), targets(i, 1), targets(i, 2)};
  return out;
}

}  // namespace innermap

#include "fit/target_shape.h"

#include <limits>

#include "fit/detail/refined_surface.h"

namespace innermap {
namespace {

constexpr double kNear = 0.01;  // of the target's diagonal

TriangleTree treeOf(const std::vector<Crossing>& crossings) {
  Points places;
  std::vector<Triangle> points;  // without extent
  for (const Crossing& crossing : crossings) {
    const int v = static_cast<int>(places.size());
    places.push_back(crossing.place);
    points.push_back({v, v, v});
  }
  return {places, points};
}

}  // namespace

int orientationOf(const Solid& source, const TargetBoundary& target) {
  return signedVolume(target.moved, source.repaired().mesh.triangles) < 0 ? -1 : 1;
}

TargetShape::TargetShape(const Solid& source, const TargetBoundary& target)
    : orientation_(orientationOf(source, target)),
      volume_(target.volume),
      reach_(kNear * target.diagonal),
      tree_(target.moved, source.repaired().mesh.triangles),
      winding_(tree_, source.repaired().mesh.triangles) {}

TargetShape::TargetShape(const BoundaryPair& pair) : TargetShape(pair.solid(), pair.target) {
  if (pair.targetCheck.crossings.empty()) return;
  crossings_.emplace(treeOf(pair.targetCheck.crossings));
  if (pair.solid().overlaps())
    exposed_.emplace(targetSurface(pair), pair.solid().surface().triangles);
}

bool TargetShape::inside(const Vec3& p) const {
  return volume_ > 0 && orientation_ * winding_.wholeAt(p) > 0;
}

double TargetShape::distance(const Vec3& p) const {
  return tree_.closest(p, std::numeric_limits<double>::infinity()).distance;
}

bool TargetShape::near(const Vec3& p, double distance) const {
  return tree_.closest(p, distance).address.triangle >= 0;
}

bool TargetShape::runsThroughItself(const Vec3& p, double error) const {
  if (!crossings_) return false;
  if (crossings_->closest(p, reach_ + error).address.triangle >= 0) return true;
  const double winding = orientation_ * (exposed_ ? exposed_->at(p) : winding_.at(p));
  return winding < -0.5 || winding > 1.5;
}

Points targetSurface(const BoundaryPair& pair) {
  const Matrix targets = pair.targetsOf(RefinedSurface(pair.solid().surface()).vertices);
  Points out(targets.rows());
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = {targets(i, 0), targets(i, 1), targets(i, 2)};
  return out;
}

}  // namespace innermap

#include "innermap/lattice/detail/shown_sharp_edges.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace innermap {
namespace {

// Spacings: curves are at least so long, and points no farther from what shows belong to it.
constexpr double kLeastCurve = 3, kOnSurface = 1e-3;

class ShownSharpEdges {
 public:
  ShownSharpEdges(const Solid& solid, double angle, double spacing)
      : solid_(solid),
        spacing_(spacing),
        all_(sharpEdges(solid.repaired().mesh, angle)),
        corner_(all_.corners.size(), -1) {}

  SharpEdges run(Progress* progress) {
    for (const SharpCurve& curve : all_.curves) {
      throwIfCancelled(progress);
      if (curve.length >= kLeastCurve * spacing_) addShown(curve, finer(curve.points));
    }
    return std::move(out_);
  }

 private:
  // Each run of points that show.
  void addShown(const SharpCurve& curve, const Points& points) {
    for (std::size_t begin = 0, end = 0; begin < points.size(); begin = end + 1) {
      for (end = begin; end < points.size() && shows(points[end]);) ++end;
      if (end > begin) addPart(curve, points, begin, end);
    }
  }

  void addPart(const SharpCurve& curve, const Points& points, std::size_t begin, std::size_t end) {
    SharpCurve part;
    for (std::size_t i = begin; i < end; ++i) {
      part.points.push_back(points[i]);
      if (i > begin) part.length += norm(points[i] - points[i - 1]);
    }
    if (part.length < kLeastCurve * spacing_) return;
    const bool first = begin == 0, last = end == points.size();
    if (!(first && last && curve.corners[0] < 0))
      part.corners = {cornerAt(points[begin], first ? curve.corners[0] : -1),
                      cornerAt(points[end - 1], last ? curve.corners[1] : -1)};
    out_.curves.push_back(std::move(part));
  }

  Points finer(const Points& curve) const {
    Points out{curve.front()};
    for (std::size_t i = 1; i < curve.size(); ++i) {
      const Vec3 way = curve[i] - curve[i - 1];
      const int n = std::max(1, static_cast<int>(std::ceil(norm(way) / spacing_)));
      for (int k = 1; k <= n; ++k) out.push_back(curve[i - 1] + (static_cast<double>(k) / n) * way);
    }
    return out;
  }

  bool shows(const Vec3& p) const {
    return solid_.closest(p, kOnSurface * spacing_).onSurface.triangle >= 0;
  }

  // known: the corner of all_, or -1 for one where a curve goes under.
  int cornerAt(const Vec3& p, int known) {
    if (known >= 0 && corner_[known] >= 0) return corner_[known];
    out_.corners.push_back(p);
    const int corner = static_cast<int>(out_.corners.size()) - 1;
    if (known >= 0) corner_[known] = corner;
    return corner;
  }

  const Solid& solid_;
  double spacing_;
  SharpEdges all_, out_;
  std::vector<int> corner_;  // of all_, in out_
};

}  // namespace

SharpEdges shownSharpEdges(const Solid& solid, double angle, double spacing, Progress* progress) {
  return ShownSharpEdges(solid, angle, spacing).run(progress);
}

}  // namespace innermap

#include "io/picture/detail/stroke.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace innermap {
namespace {

double distanceTo(const PicturePoint& p, const PicturePoint& a, const PicturePoint& b) {
  const double dx = b.x - a.x, dy = b.y - a.y, length2 = dx * dx + dy * dy;
  const double t =
      length2 > 0 ? std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / length2, 0.0, 1.0) : 0.0;
  return std::hypot(p.x - a.x - t * dx, p.y - a.y - t * dy);
}

// The share of each pixel that is covered, row by row.
using Coverage = std::map<std::pair<int, int>, double>;

void cover(const Picture& picture, const PicturePoint& a, const PicturePoint& b, double radius,
           Coverage& coverage) {
  const double reach = radius + 1;
  const int x0 = std::max(0, static_cast<int>(std::floor(std::min(a.x, b.x) - reach))),
            x1 = std::min(picture.width() - 1,
                          static_cast<int>(std::ceil(std::max(a.x, b.x) + reach))),
            y0 = std::max(0, static_cast<int>(std::floor(std::min(a.y, b.y) - reach))),
            y1 = std::min(picture.height() - 1,
                          static_cast<int>(std::ceil(std::max(a.y, b.y) + reach)));
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x) {
      const double c = std::clamp(radius + 0.5 - distanceTo({x + 0.5, y + 0.5}, a, b), 0.0, 1.0);
      if (c <= 0) continue;
      double& most = coverage[{y, x}];
      most = std::max(most, c);
    }
}

void lay(Picture& picture, const Coverage& coverage, Rgb colour) {
  for (const auto& [place, share] : coverage)
    picture.blend(place.second, place.first, colour, static_cast<float>(share));
}

}  // namespace

void strokeLine(Picture& picture, const std::vector<PicturePoint>& points, double width,
                Rgb colour) {
  Coverage coverage;
  if (points.size() == 1) cover(picture, points[0], points[0], width / 2, coverage);
  for (std::size_t i = 1; i < points.size(); ++i)
    cover(picture, points[i - 1], points[i], width / 2, coverage);
  lay(picture, coverage, colour);
}

void strokeDot(Picture& picture, PicturePoint centre, double radius, Rgb colour) {
  Coverage coverage;
  cover(picture, centre, centre, radius, coverage);
  lay(picture, coverage, colour);
}

}  // namespace innermap

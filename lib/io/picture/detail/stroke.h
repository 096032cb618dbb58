// Anti-aliased lines and dots.
#pragma once

#include <vector>

#include "io/picture/detail/picture.h"

namespace innermap {

struct PicturePoint {
  double x = 0, y = 0;  // pixels; the middle of the upper left one is (0.5, 0.5)
};

// A line of `width` pixels through the points, with round ends and joins: each pixel by its
// distance to the whole line, so nothing is laid twice where its parts meet. One point gives a dot.
void strokeLine(Picture& picture, const std::vector<PicturePoint>& points, double width,
                Rgb colour);

// A filled circle.
void strokeDot(Picture& picture, PicturePoint centre, double radius, Rgb colour);

}  // namespace innermap

// Points spread over triangles for integrals.
#pragma once

#include <array>
#include <vector>

#include "innermap/surface/correspond.h"

namespace innermap {

struct AreaSample {
  int triangle = 0;
  double area = 0;  // that it stands for
  std::array<double, 3> barycentric{};
};

// `shares` (#triangles, not negative): each triangle gets samples by its share of their sum, one at
// least. Evenly spread inside each (R2 sequence of Roberts, 2018); one alone is in the middle.
std::vector<AreaSample> areaSamples(const ClosedSurface& surface, const std::vector<double>& shares,
                                    double count);

std::vector<double> triangleAreas(const Points& vertices, const std::vector<Triangle>& triangles);

}  // namespace innermap

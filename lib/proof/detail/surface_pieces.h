// A surface in pieces: its triangles, and parts of them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "innermap/mesh/mesh.h"
#include "proof/detail/lane_kernels.h"

namespace innermap::proof {

// A triangle or a part of one, and where its corners go; scaled.
struct SurfacePiece {
  std::array<Vec3, 3> at, to;
  int halvings = 0;                                       // of the triangle, until it
  double most = std::numeric_limits<double>::infinity();  // no error on it is larger
};

inline Vec3 centroid(const std::array<Vec3, 3>& corners) {
  return (corners[0] + corners[1] + corners[2]) / 3;
}

// Halves across the longest edge, `times` times; 2^times are added.
void cut(const SurfacePiece& piece, int times, std::vector<SurfacePiece>& out);

// Of up to eight pieces; the last one fills what is left.
LaneSets setsOf(const SurfacePiece* pieces, std::size_t count);

// Along a curve of Morton through the box: points whose keys are near lie near one another.
std::uint32_t curveKey(const Vec3& p, const Box3& box);

Box3 boxOf(const std::vector<SurfacePiece>& pieces);

// In the order of that curve.
void sortAlongCurve(const Box3& box, std::vector<SurfacePiece>& pieces);

// All triangles.
std::vector<SurfacePiece> piecesOf(const Mesh& surface, const Points& target, double scale);

double largestCoordinate(const Vec3& v);

}  // namespace innermap::proof

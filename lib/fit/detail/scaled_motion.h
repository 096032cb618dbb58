// Motions that also scale, and what they do to shapes and fields.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "innermap/field/harmonic_field.h"
#include "innermap/mesh/mesh.h"

namespace innermap {

// p -> scale rotation p + translation. The rotation has a reflection in it where a path leads to a
// mirror's image.
struct ScaledMotion {
  double scale = 1;
  Mat3 rotation{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  Vec3 translation;

  Vec3 operator()(const Vec3& p) const { return scale * (rotation * p) + translation; }
};

inline Eigen::Vector3d vector(const Vec3& p) { return {p.x, p.y, p.z}; }
inline Vec3 point(const Eigen::Vector3d& v) { return {v[0], v[1], v[2]}; }

// The rotation nearest to m (Kabsch, 1976), or the rotation with a reflection: sign of its
// determinant.
Eigen::Matrix3d rotationOf(const Eigen::Matrix3d& m, int sign = 1);

// What lays `to` on `from` best by least squares over the vertices, weighted by area, when scaled
// by 1 / growth. As the way back, from there to `to`. Throws DataError if `from` has no area.
ScaledMotion alignment(const Points& from, const Points& to, const std::vector<Triangle>& triangles,
                       double growth);

// Where the motion comes from: each p with motion(p) among `points`.
Points movedBack(const ScaledMotion& motion, const Points& points);

// The field p -> motion(field(p)). Three channels.
HarmonicField movedBy(const ScaledMotion& motion, const HarmonicField& field);

}  // namespace innermap

#include "fit/detail/scaled_motion.h"

#include <cmath>

#include "innermap/core/error.h"

namespace innermap {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Matrix3d rotationOf(const Matrix3d& m, int sign) {
  const Eigen::JacobiSVD<Matrix3d> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Matrix3d flip = Matrix3d::Identity();
  flip(2, 2) = sign * (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  return svd.matrixU() * flip * svd.matrixV().transpose();
}

ScaledMotion alignment(const Points& from, const Points& to, const std::vector<Triangle>& triangles,
                       double growth) {
  std::vector<double> weight(from.size(), 0);
  for (const Triangle& t : triangles)
    for (const int v : t)
      weight[v] += norm(cross(from[t[1]] - from[t[0]], from[t[2]] - from[t[0]]));
  double sum = 0;
  Vector3d a = Vector3d::Zero(), b = a;
  for (std::size_t v = 0; v < from.size(); ++v) {
    sum += weight[v];
    a += weight[v] * vector(from[v]);
    b += weight[v] * vector(to[v]);
  }
  if (!(sum > 0)) throw DataError("the surface has no area");
  a /= sum;
  b /= sum;
  Matrix3d covariance = Matrix3d::Zero();
  for (std::size_t v = 0; v < from.size(); ++v)
    covariance += weight[v] * (vector(to[v]) - b) * (vector(from[v]) - a).transpose();
  const bool mirrored = signedVolume(from, triangles) * signedVolume(to, triangles) < 0;
  const Matrix3d r = rotationOf(covariance, mirrored ? -1 : 1);
  ScaledMotion out;
  out.scale = growth;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) out.rotation[i][k] = r(i, k);
  out.translation = point(b - growth * (r * a));
  return out;
}

Points movedBack(const ScaledMotion& motion, const Points& points) {
  const Mat3 back = transposed(motion.rotation);
  Points out;
  out.reserve(points.size());
  for (const Vec3& p : points)
    out.push_back((1 / motion.scale) * (back * (p - motion.translation)));
  return out;
}

HarmonicField movedBy(const ScaledMotion& motion, const HarmonicField& field) {
  const auto turned = [&](const Matrix& rows, std::size_t r) {
    return motion.scale * (motion.rotation * Vec3{rows(r, 0), rows(r, 1), rows(r, 2)});
  };
  const auto turnAll = [&](const Matrix& rows) {
    Matrix out(rows.rows(), 3);
    for (std::size_t r = 0; r < rows.rows(); ++r) {
      const Vec3 row = turned(rows, r);
      for (int k = 0; k < 3; ++k) out(r, static_cast<std::size_t>(k)) = row[k];
    }
    return out;
  };
  Affine affine{field.affine().center, turnAll(field.affine().coefficients)};
  for (int k = 0; k < 3; ++k)
    affine.coefficients(0, static_cast<std::size_t>(k)) += motion.translation[k];
  return HarmonicField(field.sources(), turnAll(field.weights()), std::move(affine));
}

}  // namespace innermap

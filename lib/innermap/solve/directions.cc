#include "innermap/solve/directions.h"

#include <cmath>
#include <cstddef>

namespace innermap {
namespace {

constexpr double kDependent = 1e-8;  // of a column's length left: rounding and little else
constexpr double kLittleGain = 3e-3, kLargeChange = 0.3;

double dot(const double* a, const double* b, std::size_t n) {
  double sum = 0;
  for (std::size_t i = 0; i < n; ++i) sum += a[i] * b[i];
  return sum;
}

void addScaled(double* to, double factor, const double* from, std::size_t n) {
  for (std::size_t i = 0; i < n; ++i) to[i] += factor * from[i];
}

}  // namespace

void OrthogonalDirections::add(const Matrix& directions, const Matrix& images) {
  for (std::size_t c = 0; c < images.columns(); ++c) {
    Column z(directions.column(c), directions.column(c) + unknowns_),
        q(images.column(c), images.column(c) + images_);
    const double before = std::sqrt(dot(q.data(), q.data(), images_));
    for (int pass = 0; pass < 2; ++pass)
      for (std::size_t i = 0; i < image_.size(); ++i) {
        const double part = dot(image_[i].data(), q.data(), images_);
        addScaled(q.data(), -part, image_[i].data(), images_);
        addScaled(z.data(), -part, direction_[i].data(), unknowns_);
      }
    const double length = std::sqrt(dot(q.data(), q.data(), images_));
    if (!(length > kDependent * before)) continue;
    for (double& v : q) v /= length;
    for (double& v : z) v /= length;
    direction_.push_back(std::move(z));
    image_.push_back(std::move(q));
  }
}

void OrthogonalDirections::project(Matrix& residual, Matrix& x) {
  for (; projected_ < image_.size(); ++projected_) {
    const Column &q = image_[projected_], &z = direction_[projected_];
    const double step = std::sqrt(dot(z.data(), z.data(), unknowns_));
    for (std::size_t k = 0; k < residual.columns(); ++k) {
      double* r = residual.column(k);
      const double part = dot(q.data(), r, images_), all = std::sqrt(dot(r, r, images_)),
                   size = std::sqrt(dot(x.column(k), x.column(k), unknowns_));
      if (std::abs(part) < kLittleGain * all && size > 0 &&
          std::abs(part) * step > kLargeChange * size)
        continue;
      addScaled(r, -part, q.data(), images_);
      addScaled(x.column(k), part, z.data(), unknowns_);
    }
  }
}

}  // namespace innermap

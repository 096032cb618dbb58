#include "solve/detail/directions.h"

#include <cblas.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "innermap/core/run.h"
#include "solve/detail/blocked_qr.h"

namespace innermap {
namespace {

constexpr double kLittleGain = 3e-3, kLargeChange = 0.3;
constexpr double kDependent = 1e-8;  // share of a column's length that is left
constexpr std::size_t kRows = 4096;

double dot(const double* a, const double* b, std::size_t n) {
  return cblas_ddot(static_cast<int>(n), a, 1, b, 1);
}

void addScaled(double* to, double factor, const double* from, std::size_t n) {
  cblas_daxpy(static_cast<int>(n), factor, from, 1, to, 1);
}

// a^T b over fixed blocks of rows, summed in their order.
Matrix innerProducts(const Matrix& a, const Matrix& b) {
  const std::size_t blocks = (a.rows() + kRows - 1) / kRows;
  std::vector<Matrix> parts(blocks, Matrix(a.columns(), b.columns()));
  parallelBlocks(a.rows(), kRows, [&](std::size_t begin, std::size_t end) {
    Matrix& part = parts[begin / kRows];
    cblas_dgemm(CblasColMajor, CblasTrans, CblasNoTrans, static_cast<int>(a.columns()),
                static_cast<int>(b.columns()), static_cast<int>(end - begin), 1, a.data() + begin,
                static_cast<int>(a.rows()), b.data() + begin, static_cast<int>(b.rows()), 0,
                part.data(), static_cast<int>(part.rows()));
  });
  Matrix sum(a.columns(), b.columns());
  for (const Matrix& part : parts)
    for (std::size_t i = 0; i < sum.rows() * sum.columns(); ++i) sum.data()[i] += part.data()[i];
  return sum;
}

// b -= a c.
void subtractProduct(const Matrix& a, const Matrix& c, Matrix& b) {
  parallelBlocks(a.rows(), kRows, [&](std::size_t begin, std::size_t end) {
    cblas_dgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, static_cast<int>(end - begin),
                static_cast<int>(c.columns()), static_cast<int>(c.rows()), -1, a.data() + begin,
                static_cast<int>(a.rows()), c.data(), static_cast<int>(c.rows()), 1,
                b.data() + begin, static_cast<int>(b.rows()));
  });
}

}  // namespace

void OrthogonalDirections::removeParts(const Block& old, Block& fresh) const {
  const Matrix parts = innerProducts(old.images, fresh.images);
  subtractProduct(old.images, parts, fresh.images);
  subtractProduct(old.directions, parts, fresh.directions);
}

// Makes a column orthogonal to those before it in its block; false when little else is left.
bool OrthogonalDirections::normalise(Block& block, std::size_t column) const {
  double *q = block.images.column(column), *z = block.directions.column(column);
  const double before = std::sqrt(dot(q, q, images_));
  for (int pass = 0; pass < 2; ++pass)
    for (std::size_t i = 0; i < column; ++i) {
      const double part = dot(block.images.column(i), q, images_);
      addScaled(q, -part, block.images.column(i), images_);
      addScaled(z, -part, block.directions.column(i), unknowns_);
    }
  const double length = std::sqrt(dot(q, q, images_));
  const bool kept = length > kDependent * before;
  const double factor = kept ? 1 / length : 0;
  cblas_dscal(static_cast<int>(images_), factor, q, 1);
  cblas_dscal(static_cast<int>(unknowns_), factor, z, 1);
  return kept;
}

void OrthogonalDirections::add(Matrix directions, Matrix images) {
  const SingleThreadedBlas guard;
  Block fresh{std::move(directions), std::move(images)};
  const std::size_t columns = fresh.images.columns();
  std::vector<double> before(columns);
  for (std::size_t c = 0; c < columns; ++c)
    before[c] = std::sqrt(dot(fresh.images.column(c), fresh.images.column(c), images_));
  for (int pass = 0; pass < 2; ++pass)
    for (const Block& old : blocks_) removeParts(old, fresh);
  for (std::size_t c = 0; c < columns; ++c) {
    double* q = fresh.images.column(c);
    const bool dependent = !(std::sqrt(dot(q, q, images_)) > kDependent * before[c]);
    if (dependent) std::fill_n(q, images_, 0.0);
    if (!normalise(fresh, c)) continue;
    const double* z = fresh.directions.column(c);
    column_.push_back({blocks_.size(), c, std::sqrt(dot(z, z, unknowns_))});
  }
  blocks_.push_back(std::move(fresh));
}

void OrthogonalDirections::project(std::size_t first, Matrix& residual, Matrix& x) const {
  const SingleThreadedBlas guard;
  parallelBlocks(residual.columns(), 1, [&](std::size_t k, std::size_t) {
    double *r = residual.column(k), *to = x.column(k);
    const auto little = [&](double part) {
      return std::abs(part) < kLittleGain * std::sqrt(dot(r, r, images_));
    };
    const auto large = [&](double change) {
      const double size = std::sqrt(dot(to, to, unknowns_));
      return size > 0 && std::abs(change) > kLargeChange * size;
    };
    // What is little is judged when all else has been taken: then x has its size, and a direction
    // is little of what is left.
    for (const bool last : {false, true})
      for (std::size_t c = first; c < column_.size(); ++c) {
        const Column& at = column_[c];
        const double* q = blocks_[at.block].images.column(at.index);
        const double part = dot(q, r, images_);
        if (little(part) && (!last || large(part * at.step))) continue;
        addScaled(r, -part, q, images_);
        addScaled(to, part, blocks_[at.block].directions.column(at.index), unknowns_);
      }
  });
}

}  // namespace innermap

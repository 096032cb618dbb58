#include "innermap/solve/kernel_sum.h"

#include <algorithm>
#include <cmath>

#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "solve/detail/kernel_simd.h"

namespace innermap {
namespace {

constexpr std::size_t kBlock = 512;  // targets worked on together: one leaf of a grid
// Few targets go in so many parts, that all threads have some, each of so many at least.
constexpr std::size_t kParts = 32, kLeastBlock = 64;
constexpr std::size_t kGroup = 3;  // channels summed together: what fits the registers

// Coordinates of targets as the kernels read them, padded with copies of the last one.
struct TargetBlock {
  std::vector<double> x, y, z;

  TargetBlock(const Vec3* points, std::size_t count, const Vec3& center, double inverseScale) {
    const std::size_t size = simd::padded(count);
    x.resize(size);
    y.resize(size);
    z.resize(size);
    for (std::size_t i = 0; i < size; ++i) {
      const Vec3 p = inverseScale * (points[std::min(i, count - 1)] - center);
      x[i] = p.x;
      y[i] = p.y;
      z[i] = p.z;
    }
  }
};

}  // namespace

Charges::Charges(const Points& sources, const Matrix& weights)
    : count_(sources.size()), channels_(weights.columns()) {
  if (weights.rows() != sources.size())
    throw DataError("charges: " + std::to_string(sources.size()) + " sources but " +
                    std::to_string(weights.rows()) + " rows of weights; give one row a source");
  const Box3 box = boundingBox(sources);
  if (!box.empty()) center_ = box.center();
  if (box.diagonal() > 0) inverseScale_ = 1 / box.diagonal();
  for (std::size_t first = 0; first < channels_; first += kGroup) {
    const std::size_t width = std::min(kGroup, channels_ - first);
    std::vector<double> group;
    group.reserve(count_ * (3 + width));
    for (std::size_t j = 0; j < count_; ++j) {
      const Vec3 q = inverseScale_ * (sources[j] - center_);
      if (!isFinite(q)) throw DataError("charges: source " + std::to_string(j) + " is not finite");
      group.insert(group.end(), {q.x, q.y, q.z});
      for (std::size_t k = 0; k < width; ++k) {
        const double w = weights(j, first + k) * inverseScale_;
        if (!std::isfinite(w))
          throw DataError("charges: weight of source " + std::to_string(j) + " is not finite");
        group.push_back(w);
      }
    }
    groups_.push_back(std::move(group));
  }
}

Charges Charges::magnitudes() const {
  Charges out = *this;
  for (std::size_t g = 0; g < out.groups_.size(); ++g) {
    const std::size_t width = 3 + std::min(kGroup, channels_ - g * kGroup);
    for (std::size_t i = 0; i < out.groups_[g].size(); ++i)
      if (i % width >= 3) out.groups_[g][i] = std::abs(out.groups_[g][i]);
  }
  return out;
}

void Charges::addTo(const Vec3* points, std::size_t count, double* values,
                    double* gradients) const {
  if (count == 0 || count_ == 0) return;
  for (std::size_t begin = 0; begin < count; begin += kBlock) {
    const std::size_t size = std::min(kBlock, count - begin), stride = simd::padded(size);
    const TargetBlock targets(points + begin, size, center_, inverseScale_);
    std::vector<double> sums(kGroup * stride), slopes(gradients ? 3 * kGroup * stride : 0);
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      const std::size_t first = g * kGroup, width = std::min(kGroup, channels_ - first);
      simd::sumCharges(groups_[g].data(), count_, static_cast<int>(width), targets.x.data(),
                       targets.y.data(), targets.z.data(), size, stride, sums.data(),
                       gradients ? slopes.data() : nullptr);
      for (std::size_t k = 0; k < width; ++k)
        for (std::size_t i = 0; i < size; ++i)
          values[(first + k) * count + begin + i] += sums[k * stride + i];
      if (!gradients) continue;
      for (std::size_t k = 0; k < 3 * width; ++k)
        for (std::size_t i = 0; i < size; ++i)
          gradients[(3 * first + k) * count + begin + i] += inverseScale_ * slopes[k * stride + i];
    }
  }
}

FieldSamples sumCharges(const Charges& charges, const Points& points, bool gradients) {
  const std::size_t n = points.size(), channels = charges.channels();
  FieldSamples out;
  out.values = Matrix(n, channels);
  if (gradients) out.gradients = Matrix(n, 3 * channels);
  const std::size_t block = std::clamp(n / kParts, kLeastBlock, kBlock);
  parallelBlocks(n, block, [&](std::size_t begin, std::size_t end) {
    const std::size_t size = end - begin;
    std::vector<double> values(size * channels), slopes(gradients ? size * 3 * channels : 0);
    charges.addTo(points.data() + begin, size, values.data(), gradients ? slopes.data() : nullptr);
    for (std::size_t k = 0; k < channels; ++k)
      std::copy_n(values.data() + k * size, size, out.values.column(k) + begin);
    for (std::size_t k = 0; gradients && k < 3 * channels; ++k)
      std::copy_n(slopes.data() + k * size, size, out.gradients.column(k) + begin);
  });
  return out;
}

void fillKernelMatrix(const Points& points, const Points& sources, double scale, double* out,
                      std::size_t rowStride) {
  if (points.empty() || sources.empty()) return;
  const TargetBlock targets(points.data(), points.size(), Vec3{}, 1);
  parallelBlocks(
      sources.size(), 16,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t j = begin; j < end; ++j)
          simd::kernelColumn(targets.x.data(), targets.y.data(), targets.z.data(), points.size(),
                             sources[j].x, sources[j].y, sources[j].z, scale, out + j * rowStride);
      },
      "filling the kernel matrix");
}

const char* instructionSet() { return simd::targetName(); }

}  // namespace innermap

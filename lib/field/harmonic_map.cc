#include <string>

#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "innermap/field/harmonic_field.h"

namespace innermap {
namespace {

constexpr std::size_t kBlock = 4096;

Points rowsOf(const Matrix& values) {
  Points out(values.rows());
  for (std::size_t i = 0; i < out.size(); ++i)
    for (int r = 0; r < 3; ++r) out[i][r] = values(i, static_cast<std::size_t>(r));
  return out;
}

// gradients (of `before`) become those of `after` o before.
void chain(const Matrix& after, Matrix& gradients) {
  parallelBlocks(gradients.rows(), kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      double product[9];
      for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t a = 0; a < 3; ++a) {
          double sum = 0;
          for (std::size_t m = 0; m < 3; ++m) sum += after(i, 3 * r + m) * gradients(i, 3 * m + a);
          product[3 * r + a] = sum;
        }
      for (std::size_t k = 0; k < 9; ++k) gradients(i, k) = product[k];
    }
  });
}

}  // namespace

HarmonicMap::HarmonicMap(HarmonicField field) : field_(std::move(field)) {
  if (field_.channels() != 3)
    throw DataError("map: the field has " + std::to_string(field_.channels()) +
                    " channels; a map needs 3, the target's x, y and z");
}

void HarmonicMap::evaluate(const Vec3* points, std::size_t count, Vec3* positions,
                           Mat3* jacobians) const {
  std::vector<double> values(3 * count), gradients(jacobians ? 9 * count : 0);
  field_.evaluate(points, count, values.data(), jacobians ? gradients.data() : nullptr);
  for (std::size_t i = 0; i < count; ++i)
    for (int r = 0; r < 3; ++r) {
      if (positions) positions[i][r] = values[r * count + i];
      for (int a = 0; jacobians && a < 3; ++a)
        jacobians[i][r][a] = gradients[(3 * r + a) * count + i];
    }
}

Vec3 HarmonicMap::operator()(const Vec3& p) const {
  Vec3 q;
  evaluate(&p, 1, &q, nullptr);
  return q;
}

Mat3 HarmonicMap::jacobian(const Vec3& p) const {
  Mat3 j;
  evaluate(&p, 1, nullptr, &j);
  return j;
}

ComposedMap::ComposedMap(std::vector<HarmonicMap> steps) : steps_(std::move(steps)) {
  if (steps_.empty()) throw DataError("map: has no step");
}

std::size_t ComposedMap::sources() const {
  std::size_t sum = 0;
  for (const HarmonicMap& step : steps_) sum += step.field().sources().size();
  return sum;
}

void ComposedMap::evaluate(const Vec3* points, std::size_t count, Vec3* positions,
                           Mat3* jacobians) const {
  Points at(points, points + count), next(count);
  std::vector<Mat3> own(jacobians ? count : 0);
  for (std::size_t s = 0; s < steps_.size(); ++s) {
    steps_[s].evaluate(at.data(), count, next.data(), jacobians ? own.data() : nullptr);
    for (std::size_t i = 0; jacobians && i < count; ++i)
      jacobians[i] = s == 0 ? own[i] : product(own[i], jacobians[i]);
    at.swap(next);
  }
  for (std::size_t i = 0; positions && i < count; ++i) positions[i] = at[i];
}

Vec3 ComposedMap::operator()(const Vec3& p) const {
  Vec3 q;
  evaluate(&p, 1, &q, nullptr);
  return q;
}

Mat3 ComposedMap::jacobian(const Vec3& p) const {
  Mat3 j;
  evaluate(&p, 1, nullptr, &j);
  return j;
}

FieldSamples ComposedMap::evaluate(const Points& points,
                                   const EvaluateFieldSettings& settings) const {
  FieldSamples out = steps_.front().field().evaluate(points, settings);
  finish(out, settings);
  return out;
}

void ComposedMap::finish(FieldSamples& samples, const EvaluateFieldSettings& settings) const {
  for (std::size_t s = 1; s < steps_.size(); ++s) {
    FieldSamples next = steps_[s].field().evaluate(rowsOf(samples.values), settings);
    samples.values = std::move(next.values);
    if (settings.gradients) chain(next.gradients, samples.gradients);
  }
}

}  // namespace innermap

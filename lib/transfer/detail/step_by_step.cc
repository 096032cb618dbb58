#include "transfer/detail/step_by_step.h"

#include <cstddef>
#include <limits>
#include <optional>

#include "innermap/core/run.h"

namespace innermap {
namespace {

constexpr int kMostTrials = 40;

std::optional<Vec3> inverted(const HarmonicMap& step, const Vec3& target, const Vec3& start,
                             double tolerance) {
  Vec3 best = start, trial = start, way;
  double residual = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kMostTrials; ++i) {
    Vec3 image;
    Mat3 jacobian;
    step.evaluate(&trial, 1, &image, &jacobian);
    const Vec3 away = target - image;
    if (norm(away) < residual) {
      best = trial;
      residual = norm(away);
      if (residual <= tolerance) return best;
      way = inverse(jacobian) * away;
    } else {
      way = 0.5 * way;
    }
    trial = best + way;
    if (!isFinite(trial)) break;
  }
  return std::nullopt;
}

Vec3 invertedAll(const ComposedMap& map, const Vec3& target, const Vec3& start, double tolerance) {
  Points reached{start};
  for (const HarmonicMap& step : map.steps()) reached.push_back(step(reached.back()));
  Vec3 at = target;
  for (std::size_t s = map.steps().size(); s-- > 0;) {
    const std::optional<Vec3> found = inverted(map.steps()[s], at, reached[s], tolerance);
    if (!found) return start;
    at = *found;
  }
  return at;
}

}  // namespace

Points invertStepByStep(const ComposedMap& map, const Points& targets, const Points& starts,
                        const StepByStepSettings& settings) {
  Points out(targets.size());
  parallelBlocks(targets.size(), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      out[i] = invertedAll(map, targets[i], starts[i], settings.tolerance);
  });
  return out;
}

}  // namespace innermap

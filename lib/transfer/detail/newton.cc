#include "transfer/detail/newton.h"

#include <cmath>
#include <limits>

#include "innermap/core/run.h"

namespace innermap {
namespace {

// Starts are good to second order, so nearly all points take one or two steps; the rest is along
// folds and kinks, where halved steps creep.
constexpr int kMostSteps = 12;
// A point within the tolerance is moved by the step that is known by then, which costs nothing and
// squares the error, unless it is a long one: there the Jacobian is nearly singular.
constexpr double kPolish = 0.01;
constexpr std::size_t kBlock = 1024;

class Newton {
 public:
  Newton(const ExtendedMap& map, const Points& targets, Points& points,
         const NewtonSettings& settings)
      : map_(map),
        targets_(targets),
        best_(points),
        settings_(settings),
        steps_(points.size()),
        open_(points.size()) {
    out_.at.resize(points.size());
    out_.residuals.assign(points.size(), std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < open_.size(); ++i) open_[i] = i;
  }

  NewtonResult run() {
    for (int step = 0; step <= kMostSteps && !open_.empty(); ++step) {
      Points trial(open_.size());
      for (std::size_t n = 0; n < open_.size(); ++n) trial[n] = best_[open_[n]] + steps_[open_[n]];
      const std::vector<PointImage> samples = map_.at(trial);
      parallelBlocks(open_.size(), kBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t n = begin; n < end; ++n) judge(open_[n], trial[n], samples[n]);
      });
      std::vector<std::size_t> open;
      for (const std::size_t i : open_)
        if (out_.residuals[i] > settings_.tolerance && squaredNorm(steps_[i]) > 0)
          open.push_back(i);
      open_ = std::move(open);
    }
    return std::move(out_);
  }

 private:
  void judge(std::size_t i, const Vec3& trial, const PointImage& sample) {
    const Vec3 away = targets_[i] - sample.image;
    const double residual = norm(away);
    if (!(residual < out_.residuals[i])) {
      steps_[i] = 0.5 * steps_[i];
      return;
    }
    best_[i] = trial;
    out_.at[i] = sample;
    out_.residuals[i] = residual;
    const Vec3 step = inverse(sample.jacobian) * away;
    const double length = norm(step);
    if (!std::isfinite(length))
      steps_[i] = {};
    else if (residual > settings_.tolerance)
      steps_[i] = (length > settings_.longestStep ? settings_.longestStep / length : 1) * step;
    else if (length < kPolish * settings_.longestStep)
      best_[i] += step;
  }

  const ExtendedMap& map_;
  const Points& targets_;
  Points& best_;
  const NewtonSettings& settings_;
  Points steps_;
  std::vector<std::size_t> open_;
  NewtonResult out_;
};

}  // namespace

NewtonResult solveNewton(const ExtendedMap& map, const Points& targets, Points& points,
                         const NewtonSettings& settings) {
  return Newton(map, targets, points, settings).run();
}

}  // namespace innermap

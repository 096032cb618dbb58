#include "field/detail/refinement_marks.h"

#include <algorithm>
#include <cmath>

namespace innermap {
namespace {

constexpr double kMarkReach = 0.8;  // spacings of the level above
// Marks are points over the tolerance, or over a little less as it comes near. Marking from 1.5
// times the tolerance on takes about as many charges, in twice the rounds.
constexpr double kMarkLeast = 0.93, kMarkMost = 1;
// When the tolerance holds but the largest error is over kWorstRatio of the rms: what is marked.
constexpr double kWorstRatio = 17, kOutlier = 10;
// Once this level has been tried about a jump, errors nearer to it than so many spacings of the
// finest level tried there are left; where they are few, a tolerance for 99% may yet be met, and
// finer levels are tried. Measured on a clothed body, sheets 2e-2 apart, tolerance 1e-3: a reach of
// 1, and level 3, take 5 and 2.5 times the charges of reach 2 and level 2, for 0.8 and 0.9 of the
// error at 99%.
constexpr std::size_t kJumpLevel = 2, kJumpLevelOfFew = 4;
constexpr double kJumpReach = 2, kFewAtJumps = 0.03;

}  // namespace

RefinementMarks::RefinementMarks(const Points& jumps, double spacing, double tolerance)
    : spacing_(spacing), tolerance_(tolerance), jumps_(jumps, spacing) {}

double RefinementMarks::spacing(std::size_t level) const {
  return spacing_ * std::pow(0.5, static_cast<double>(level));
}

double RefinementMarks::reach(std::size_t level) const { return kMarkReach * spacing(level - 1); }

void RefinementMarks::tried(std::size_t level, const Points& marks) {
  while (tried_.size() < level) tried_.emplace_back(reach(tried_.size() + 1));
  for (const Vec3& p : marks) tried_[level - 1].add(p);
}

bool RefinementMarks::isTame(const BoundaryError& error) {
  return error.max <= kWorstRatio * error.rms;
}

// The finest level that was tried around p.
std::size_t RefinementMarks::levelOf(const Vec3& p) const {
  for (std::size_t l = tried_.size(); l > 0; --l)
    if (tried_[l - 1].anyNearer(p, reach(l))) return l;
  return 0;
}

// Points over the tolerance beside jumps about which this level has been tried.
std::vector<std::size_t> RefinementMarks::atJumps(const Points& points,
                                                  const std::vector<double>& errors,
                                                  std::size_t leastLevel) const {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    if (!(errors[i] > kMarkLeast * tolerance_)) continue;
    const std::size_t l = levelOf(points[i]);
    if (l >= leastLevel && jumps_.anyNearer(points[i], kJumpReach * spacing(l))) out.push_back(i);
  }
  return out;
}

BoundaryError RefinementMarks::awayFromJumps(const Points& points,
                                             std::vector<double>& errors) const {
  if (jumps_.size() == 0) return summarizeErrors(errors);
  std::vector<std::size_t> left = atJumps(points, errors, kJumpLevel);
  if (static_cast<double>(left.size()) < kFewAtJumps * static_cast<double>(errors.size()))
    left = atJumps(points, errors, kJumpLevelOfFew);
  std::vector<double> rest;
  std::size_t next = 0;
  for (std::size_t i = 0; i < errors.size(); ++i)
    if (next < left.size() && left[next] == i)
      ++next;
    else
      rest.push_back(errors[i]);
  for (const std::size_t i : left) errors[i] = 0;
  return summarizeErrors(std::move(rest));
}

std::vector<Points> RefinementMarks::byLevel(const Points& points,
                                             const std::vector<double>& errors,
                                             const BoundaryError& error) const {
  double over = tolerance_ * std::clamp(kMarkLeast * error.p99 / tolerance_, kMarkLeast, kMarkMost);
  if (error.p99 <= kMarkLeast * tolerance_ && !isTame(error)) over = kOutlier * error.rms;
  std::vector<Points> marks(tried_.size() + 2);
  for (std::size_t i = 0; i < errors.size(); ++i)
    if (errors[i] > over) marks[levelOf(points[i]) + 1].push_back(points[i]);
  return marks;
}

}  // namespace innermap

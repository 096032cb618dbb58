#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <numeric>
#include <optional>

#include "core/point_grid.h"
#include "core/require_number.h"
#include "field/detail/refinement_marks.h"
#include "innermap/core/error.h"
#include "innermap/core/memory.h"
#include "innermap/core/run.h"
#include "innermap/field/fit.h"
#include "innermap/solve/solver.h"

namespace innermap {
namespace {

constexpr double kDistance = 1.0;           // spacings
constexpr double kSourceDarts = 0.83;       // spacings; fills to one charge a spacing squared
constexpr double kCollocationDarts = 0.46;  // spacings; three points a charge
// Distances, from a new charge: what is nearer to its foot than other charges' feet, which stand
// kSourceDarts apart or a little more, is within sqrt(1 + kSourceDarts^2) = 1.3. With 2, single
// charges had six points each.
constexpr double kCollocationReach = 1.35;
// Points a charge, of all, before the darts of a level get closer: where a part is thinner than the
// charges' distance, their shell is larger than its surface.
constexpr double kLeastPoints = 1.5;
constexpr int kCloserDarts = 4;
constexpr int kMostLevels = 14;
constexpr double kNearest = 1e-6;  // of the diagonal
constexpr std::size_t kMarkSamples = 30000;
// Of the tolerance; other points than those that were looked at differ a little.
constexpr double kMargin = 0.97;
constexpr double kAccuracy = 1e-3;  // of the solution, of the tolerance
// Of the errors that are marked, and of those that decide; of the tolerance.
constexpr double kMarkAccuracy = 1e-2, kCheckAccuracy = 1e-3;
constexpr double kLeastGain = 0.97;  // of the score in the rounds of patience
// Of the most charges: a round for the few that are left costs as much as the one before.
constexpr double kFull = 0.97;
constexpr double kForNothing = 4;     // times the charges that did as well, by score and by excess
constexpr double kMostRounds = 20;    // that are looked ahead
constexpr std::size_t kLookBack = 2;  // rounds, for how the next will go
constexpr double kOfOutlierRounds = 0.5;
constexpr double kNextRound = 1.5;  // seconds, of the one before; for a deadline

void append(Matrix& a, const Matrix& b) {
  Matrix out(a.rows() + b.rows(), b.columns());
  for (std::size_t k = 0; k < b.columns(); ++k) {
    if (a.rows() > 0) std::copy_n(a.column(k), a.rows(), out.column(k));
    std::copy_n(b.column(k), b.rows(), out.column(k) + a.rows());
  }
  a = std::move(out);
}

double secondsSince(std::chrono::steady_clock::time_point then) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - then).count();
}

class AdaptiveFitting {
 public:
  AdaptiveFitting(const AdaptiveProblem& problem, const AdaptiveSettings& settings)
      : problem_(problem), settings_(settings) {}

  AdaptiveResult run();

 private:
  struct Level {
    double spacing, distance;  // fractions of the diagonal
    Points sources;
  };

  void check() const;
  void first();
  Level& level(std::size_t l);
  bool refine(const std::vector<Points>& marks);
  bool refineOnce(std::vector<Points> marks);
  void collocate(PlacementRequest request, Matrix& values);
  Points dropLoose(Level& level, std::size_t last) const;
  Points withoutCharge(const Level& level, const Points& marks) const;
  void solve();
  double score(const BoundaryError& error) const;
  double excess(const std::vector<double>& errors) const;
  double sourcesThatDid(const std::vector<double>& measures) const;
  void keepIfBest();
  double workDone() const;
  bool gains() const;
  std::size_t sourceCount() const;
  bool isFull() const;
  std::uint64_t memory() const;

  const AdaptiveProblem& problem_;
  const AdaptiveSettings& settings_;
  std::optional<RefinementMarks> marks_;
  std::optional<IterativeSolver> solver_;
  std::vector<Level> levels_;
  Collocation collocation_;
  Matrix values_;
  IterativeSolution solution_;
  std::optional<HarmonicField> field_;
  std::optional<AdaptiveResult> best_;
  double bestScore_ = 0;
  std::size_t bestRound_ = 0;  // from 1
  std::vector<AdaptiveRound> rounds_;
  std::vector<double> excesses_;  // of the rounds
  AdaptiveEnd end_ = AdaptiveEnd::met;
  std::uint64_t requests_ = 0;
  const std::uint64_t room_ = memoryLeft();  // bytes
};

void AdaptiveFitting::check() const {
  if (!(settings_.tolerance >= kSmallestTolerance && settings_.tolerance <= 1))
    throw SettingError("tolerance",
                       "must lie in 1e-12 (double precision holds no less) to 1 of the diagonal");
  requireNumber("first sources", settings_.firstSources, {10, 5000});
  requireNumber("max sources", settings_.maxSources, {double(settings_.firstSources), kMaxCharges});
  requireNumber("patience", settings_.patience, {1});
  if (!(problem_.diagonal > 0) || !(problem_.area > 0) || !(problem_.unit > 0))
    throw DataError("fit: the boundary has no extent");
}

AdaptiveFitting::Level& AdaptiveFitting::level(std::size_t l) {
  while (levels_.size() <= l) {
    const double first =
        std::sqrt(problem_.area / static_cast<double>(settings_.firstSources)) / problem_.diagonal;
    const double spacing = first * std::pow(0.5, static_cast<double>(levels_.size()));
    levels_.push_back({spacing, kDistance * spacing, {}});
  }
  return levels_[l];
}

std::size_t AdaptiveFitting::sourceCount() const {
  std::size_t count = 0;
  for (const Level& l : levels_) count += l.sources.size();
  return count;
}

bool AdaptiveFitting::isFull() const {
  return static_cast<double>(sourceCount()) >= kFull * static_cast<double>(settings_.maxSources);
}

std::uint64_t AdaptiveFitting::memory() const {
  const std::size_t coarse = levels_.front().sources.size();
  return iterativeSolverMemory(collocation_.size(), sourceCount() - coarse, coarse, true);
}

void AdaptiveFitting::first() {
  Level& coarse = level(0);
  marks_.emplace(problem_.jumps, coarse.spacing * problem_.diagonal, settings_.tolerance);
  PlacementRequest request;
  request.spacing = kSourceDarts * coarse.spacing;
  request.reach = coarse.spacing;
  request.most = settings_.maxSources;
  request.index = requests_++;
  coarse.sources = problem_.placeSources(request, coarse.distance);
  if (coarse.sources.empty())
    throw DataError("fit: there is no room for charges around the boundary");
  // The shell is larger than the boundary: by charges, not by area.
  request.spacing = kCollocationDarts *
                    std::sqrt(problem_.area / static_cast<double>(coarse.sources.size())) /
                    problem_.diagonal;
  request.most = 100 * settings_.firstSources;
  collocate(request, values_);
  requireMemory("the first level of charges", memory(), room_, "raise the limit of memory");
  IterativeSettings s;
  s.accuracy = std::clamp(kAccuracy * settings_.tolerance, 1e-12, s.accuracy);
  solver_.emplace(collocation_,
                  std::vector<SourceLevel>{{coarse.sources, coarse.spacing * problem_.diagonal,
                                            coarse.distance * problem_.diagonal}},
                  s);
}

// Adds boundary points, and their values to `values`; the darts closer where they are few for the
// charges.
void AdaptiveFitting::collocate(PlacementRequest request, Matrix& values) {
  for (int tries = 0; tries < kCloserDarts; ++tries, request.spacing /= 2) {
    request.existing = collocation_.points;
    request.index = requests_++;
    const BoundarySamples more = problem_.placeCollocation(request);
    collocation_.append(more.collocation());
    append(values, more.values);
    const double wanted = kLeastPoints * static_cast<double>(sourceCount());
    if (static_cast<double>(collocation_.size()) >= wanted) return;
  }
}

// Drops those of the level's last charges that no point is near, as at the tips of needles: they
// could take any weight. (One of 12,597 left a point 1.7 diagonals off.) Returns the others.
Points AdaptiveFitting::dropLoose(Level& level, std::size_t last) const {
  const double reach = kCollocationReach * level.distance * problem_.diagonal;
  const PointGrid points(collocation_.points, 2 * reach);
  const auto first = static_cast<std::ptrdiff_t>(level.sources.size() - last);
  const auto loose = [&](const Vec3& q) { return !points.anyNearer(q, reach); };
  level.sources.erase(std::remove_if(level.sources.begin() + first, level.sources.end(), loose),
                      level.sources.end());
  return {level.sources.begin() + first, level.sources.end()};
}

// Those of the marks that no charge of the level is near: there was no room.
Points AdaptiveFitting::withoutCharge(const Level& level, const Points& marks) const {
  const double reach = kCollocationReach * level.distance * problem_.diagonal;
  const PointGrid charges(level.sources, 2 * reach);
  Points out;
  std::copy_if(marks.begin(), marks.end(), std::back_inserter(out),
               [&](const Vec3& p) { return !charges.anyNearer(p, reach); });
  return out;
}

// Adds charges around the marks, and boundary points around the charges; false when there is room
// for none. Marks where a level finds no room are tried on the next one, up to one that is finer
// than all before.
bool AdaptiveFitting::refineOnce(std::vector<Points> marks) {
  const std::size_t before = collocation_.size();
  std::vector<SourceLevel> added;
  Matrix values;
  for (std::size_t l = 1; l < marks.size(); ++l) {
    if (marks[l].empty()) continue;
    Level& fine = level(l);
    marks_->tried(l, marks[l]);
    const std::size_t there = sourceCount();
    if (fine.distance < kNearest || there >= settings_.maxSources) continue;
    const Points fresh = problem_.placeSources(
        {marks[l], marks_->reach(l) / problem_.diagonal, kSourceDarts * fine.spacing, fine.sources,
         settings_.maxSources - there, requests_++},
        fine.distance);
    fine.sources.insert(fine.sources.end(), fresh.begin(), fresh.end());
    if (l + 1 < marks.size()) {
      const Points down = withoutCharge(fine, marks[l]);
      marks[l + 1].insert(marks[l + 1].end(), down.begin(), down.end());
    }
    if (fresh.empty()) continue;
    collocate({fresh,
               kCollocationReach * fine.distance,
               kCollocationDarts * fine.spacing,
               {},
               100 * fresh.size() + 1000},
              values);
    const Points held = dropLoose(fine, fresh.size());
    if (held.empty()) continue;
    added.push_back({held, fine.spacing * problem_.diagonal, fine.distance * problem_.diagonal});
  }
  if (added.empty()) {
    // Points whose charges were all dropped have no values in the solver.
    std::vector<std::size_t> solved(before);
    std::iota(solved.begin(), solved.end(), std::size_t{0});
    if (collocation_.size() > before) collocation_ = collocation_.subset(solved);
    return false;
  }
  if (collocation_.size() < sourceCount()) {
    end_ = AdaptiveEnd::noGain;
    return false;
  }
  if (memory() > room_) {
    end_ = AdaptiveEnd::maxMemory;
    return false;
  }
  append(values_, values);
  std::vector<std::size_t> points(collocation_.size() - before);
  std::iota(points.begin(), points.end(), before);
  solver_->add(collocation_.subset(points), added);
  return true;
}

// Where a gap is too narrow for a level, the next finer one is tried.
bool AdaptiveFitting::refine(const std::vector<Points>& marks) {
  std::vector<Points> wanted = marks;
  for (int tries = 0; tries < kMostLevels; ++tries) {
    if (isFull()) {
      end_ = AdaptiveEnd::maxSources;
      return false;
    }
    if (refineOnce(wanted)) return true;
    if (end_ != AdaptiveEnd::met) return false;
    wanted.insert(wanted.begin(), Points());
    if (wanted.size() > kMostLevels) break;
  }
  end_ = AdaptiveEnd::noGain;
  return false;
}

void AdaptiveFitting::solve() {
  const bool warm = solution_.weights.rows() > 0;
  solution_ = solver_->solve(values_, warm ? &solution_ : nullptr);
  field_.emplace(solver_->sources(), solution_.weights, solution_.affine);
}

// Share of the work, if the rounds to come go on as those so far did: each with so many times the
// charges and so much of the error of the one before.
double AdaptiveFitting::workDone() const {
  if (rounds_.size() < 2) return 0;
  const std::size_t look = std::min<std::size_t>(rounds_.size() - 1, kLookBack);
  const AdaptiveRound &now = rounds_.back(), &then = rounds_[rounds_.size() - 1 - look];
  const double goal = kMargin * settings_.tolerance;
  const auto steps = static_cast<double>(look);
  double rounds = 0;
  if (now.error.p99 > goal)
    rounds = now.error.p99 < then.error.p99
                 ? steps * std::log(goal / now.error.p99) / std::log(now.error.p99 / then.error.p99)
                 : kMostRounds;
  // What stands out needs some more, seldom as many as it may.
  if (!RefinementMarks::isTame(now.error)) rounds += kOfOutlierRounds * settings_.outlierRounds;
  double done = 0;
  for (const AdaptiveRound& round : rounds_) done += static_cast<double>(round.sources);
  const auto last = static_cast<double>(now.sources);
  const double growth = std::pow(last / static_cast<double>(then.sources), 1 / steps);
  double left = 0, next = last;
  for (double r = 0; r < std::min<double>(rounds, kMostRounds); ++r) {
    next = std::min(growth * next, static_cast<double>(settings_.maxSources));
    left += std::min(1.0, rounds - r) * next;
  }
  return done / (done + left);
}

// The less the better: the error as long as the tolerance does not hold, then how far the largest
// error stands out.
double AdaptiveFitting::score(const BoundaryError& error) const {
  if (error.p99 > kMargin * settings_.tolerance) return 1 + error.p99 / settings_.tolerance;
  return error.rms > 0 ? std::min(1.0, 1e-3 * error.max / error.rms) : 0;
}

// How far the errors are beyond the goal, of all points. Where a hundredth of the boundary is thin,
// the error at 99% stays until charges are as fine as that part, while this falls in each round.
double AdaptiveFitting::excess(const std::vector<double>& errors) const {
  double sum = 0;
  for (const double error : errors)
    sum += std::max(0.0, std::log(error / (kMargin * settings_.tolerance)));
  return sum / static_cast<double>(errors.size());
}

// The least charges with which a measure of the rounds was as good as it ever was, or nearly.
double AdaptiveFitting::sourcesThatDid(const std::vector<double>& measures) const {
  const double best = *std::min_element(measures.begin(), measures.end());
  const auto good = std::find_if(measures.begin(), measures.end(),
                                 [&](double m) { return !(kLeastGain * m > best); });
  return static_cast<double>(rounds_[static_cast<std::size_t>(good - measures.begin())].sources);
}

void AdaptiveFitting::keepIfBest() {
  const double now = score(rounds_.back().error);
  if (best_ && !(now < bestScore_)) return;
  bestScore_ = now;
  bestRound_ = rounds_.size();
  best_.emplace(AdaptiveResult{*field_,
                               {},
                               AdaptiveEnd::met,
                               {},
                               {},
                               collocation_.size(),
                               solution_.residuals,
                               solution_.weightNorm,
                               solution_.productError});
  for (const Level& l : levels_) best_->levels.push_back({l.distance, l.spacing, l.sources.size()});
}

// Whether one of the last rounds was better than all before, and charges have not grown too much
// since the score or the excess last became so.
bool AdaptiveFitting::gains() const {
  std::vector<double> scores;
  for (const AdaptiveRound& round : rounds_) scores.push_back(score(round.error));
  if (static_cast<double>(rounds_.back().sources) >
      kForNothing * std::max(sourcesThatDid(scores), sourcesThatDid(excesses_)))
    return false;
  const auto patience = static_cast<std::size_t>(settings_.patience);
  if (rounds_.size() <= patience) return true;
  const auto late = scores.end() - static_cast<std::ptrdiff_t>(patience);
  return *std::min_element(late, scores.end()) <
         kLeastGain * *std::min_element(scores.begin(), late);
}

AdaptiveResult AdaptiveFitting::run() {
  check();
  first();
  const BoundarySamples checks = problem_.draw(settings_.checkSamples, 0);
  const auto errorsAtChecks = [&](const HarmonicField& field) {
    return boundaryErrors(field, checks.collocation(), checks.values, problem_.unit,
                          {kCheckAccuracy * settings_.tolerance * problem_.unit});
  };
  std::vector<double> checked;   // errors at the checks
  std::size_t checkedRound = 0;  // of the field that has them
  int outliers = 0;
  for (std::uint64_t round = 1;; ++round) {
    const auto began = std::chrono::steady_clock::now();
    solve();
    const BoundarySamples fresh = problem_.draw(kMarkSamples, round);
    std::vector<double> errors =
        boundaryErrors(*field_, fresh.collocation(), fresh.values, problem_.unit,
                       {kMarkAccuracy * settings_.tolerance * problem_.unit});
    const BoundaryError error = marks_->awayFromJumps(fresh.points, errors);
    rounds_.push_back(
        {solver_->sources().size(), collocation_.size(), solution_.iterations, error});
    excesses_.push_back(excess(errors));
    keepIfBest();
    reportProgress("meeting the tolerance", workDone());
    if (settings_.goOn && !settings_.goOn(*field_, static_cast<int>(round))) {
      end_ = AdaptiveEnd::stopped;
      break;
    }
    if (error.p99 <= kMargin * settings_.tolerance && RefinementMarks::isTame(error)) {
      std::vector<double> others = checked = errorsAtChecks(*field_);
      checkedRound = rounds_.size();
      const BoundaryError other = marks_->awayFromJumps(checks.points, others);
      if (other.p99 <= kMargin * settings_.tolerance && RefinementMarks::isTame(other)) break;
    }
    if (error.p99 <= kMargin * settings_.tolerance && ++outliers > settings_.outlierRounds) break;
    if (!gains()) {
      end_ = isFull() ? AdaptiveEnd::maxSources : AdaptiveEnd::noGain;
      break;
    }
    if (outOfTime(kNextRound * secondsSince(began))) {
      end_ = AdaptiveEnd::time;
      break;
    }
    if (!refine(marks_->byLevel(fresh.points, errors, error))) break;
  }
  AdaptiveResult out = std::move(*best_);
  out.error =
      summarizeErrors(checkedRound == bestRound_ ? std::move(checked) : errorsAtChecks(out.field));
  if (end_ != AdaptiveEnd::stopped && out.error.p99 <= settings_.tolerance)
    out.end = AdaptiveEnd::met;
  else
    out.end = end_ == AdaptiveEnd::met && !problem_.jumps.empty() ? AdaptiveEnd::jumps : end_;
  out.rounds = std::move(rounds_);
  return out;
}

}  // namespace

AdaptiveResult fitToTolerance(const AdaptiveProblem& problem, const AdaptiveSettings& settings) {
  return AdaptiveFitting(problem, settings).run();
}

}  // namespace innermap

#include "fit/detail/step_fit.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <utility>

#include "fit/detail/carried_boundary.h"
#include "fit/detail/inside_check.h"
#include "fit/detail/shape_path.h"
#include "innermap/core/error.h"
#include "innermap/core/run.h"
#include "innermap/fit/fit_map.h"
#include "innermap/mesh/check.h"
#include "innermap/proof/prove.h"

namespace innermap {
namespace {

// Of the way: halves that are made where a coarse fit folds, and where only the full one does,
// whose folds beside the surface smaller steps cure more seldom. The way through smoothed shapes is
// longer, so that the same step is a smaller part of it.
constexpr double kShortest = 1.0 / 128, kShortestFitted = 1.0 / 32, kOfSmoothed = 0.25;
// Of the tolerance: what a step before the last may leave, however short it is; what the last one
// may. Each step also mends what those before it left, so that errors do not add up. Where only
// the last one mended, the others had to leave less the shorter they were: half of a step at half
// its tolerance takes as many charges as the whole, and ways of many steps took 1.5 to 2 times the
// charges in all, to end as far off.
constexpr double kShare = 0.4, kLastShare = 0.6;
// Through smoothed shapes the length tells little of the work. A step may leave the usual share at
// first; while steps take fewer charges than kUsualSources the next may leave less, down to the
// least, and after one that missed it more, up to the most. A tenth all the way took half as long
// again, and left hardly less in the end: charges that follow the least detail roughen the surface
// for the steps after them.
constexpr double kLeastShare = 0.05, kUsualShare = 0.25, kMostShare = 0.5;
constexpr double kUsualSources = 3000, kSharePower = 0.5, kShareChange = 2;
// Times its tolerance, or the usual one where that is more, that a step through smoothed shapes
// leaves although it takes fewer charges than usual: the surface is crumpled there, and charges
// find no room. Each step after it takes many seconds, and leaves as much.
constexpr double kCrumpled = 1.3;
// Of the tolerance: what is left of a point's error, as mending all of it makes the map rough, with
// many times the volume whose sense is undecided; by how much a step mends a point at most, and how
// far off points are that it leaves as they are. Those lie in creases, where charges do not help:
// steps that brought them nearer missed their tolerance all around (cheburashka onto spot: 2.7e-3
// at 99%, not 1.7e-3). The last step mends all points, and more of each: over six pairs, a
// quarter left in place of three eighths made the error at 99% 0.8 times as large, for 1.1 times
// the processor time. Through smoothed shapes it alone mends: the others are so many and so short
// that mending would take most of their charges.
constexpr double kKept = 0.375, kMended = 0.5, kFar = 2, kLastKept = 0.25, kLastMended = 1.25;
// Times its own tolerance that a step leaves, and of the whole that steps leave beyond their own in
// all: beyond that, or where the map folds many points, the way is lost. In maps that were kept,
// steps that missed left 1.8 times what they may (2.2 through smoothed shapes). Where an
// intermediate shape runs through itself a step leaves much more, and so do those after it.
constexpr double kLeap = 2.5, kSmoothedLeap = 4, kLost = 6;
// Pieces that a mesh is cut into where it runs through itself: where the shape that the steps have
// made has so many times those of the source, the way is lost. Each step misses then, folds the
// surface further, and takes longer than the one before. Ways that arrived had up to 1.13, one
// had 1.42; one that crawled through smoothed shapes had 2.
constexpr double kMostPieces = 1.15, kMostSmoothedPieces = 1.6;
// Steps in a row through smoothed shapes that did not fold, before one twice as long is tried. If
// that folds, twice as many come before the next trial: near the target longer steps keep folding,
// and each trial costs a fit.
constexpr int kStepsInRow = 2;
constexpr double kLengthSlack = 1.01;  // for rounding
// Of the folds that are left: after a step, and after its first charges.
constexpr double kFoldShare = 0.5, kCoarseFoldShare = 0.25;
// The way goes through smoothed shapes at once where one of the others has more crossings a
// triangle than that, and each of the smoothed ones at most so many times as many. Ways that
// arrived had up to 0.033, and their maps are closer than those through smoothed shapes; ways that
// were lost had 0.009 to 0.064.
constexpr double kManyCrossings = 0.04, kFewerCrossings = 0.1;
constexpr int kLooks = 8;
// With fewer steps allowed the usual way is better: limbs and pits take more to shrink, turn and
// grow again.
constexpr int kFewestSmoothed = 12;
// Of the work until there to the work in all, by the way until there: the nearer to the target, the
// shorter the steps and the more charges they take.
constexpr double kWorkPower = 2.4;
constexpr int kOutlierRounds = 3, kPatience = 1;
constexpr int kLastPatience = 3;  // what the last step does not reach is missed
// Charges of one step, at most, at the tolerance of surfaces that were laid on one another; more in
// proportion at a smaller one. Steps that can be met take 4,000 to 19,000; jumps across slits take
// all there are. With 15,000 cheburashka's way to fandisk takes one step more, and as long. Through
// smoothed shapes only the last step wants more, and is no better for it.
constexpr double kStepSources = 24000, kSmoothedSources = 15000;
// Of the target's diagonal: sums, and where points inside go (a share of the tolerance where that
// is less); the mesh about an intermediate shape.
constexpr double kSumShare = 2e-3;
constexpr double kStepSumAccuracy = 3e-6, kChord = 1e-3;

struct Step {
  MapStep record;
  AdaptiveResult fit;
  HarmonicMap map;
  MappedPoints inside;  // at its end
};

// How long a step through smoothed shapes may be, of the way: half of what folded last, and twice
// as long after some that did not fold.
class LongestStep {
 public:
  double length() const { return length_; }

  void folded(double half) {
    if (doubled_) wait_ *= 2;
    length_ = kLengthSlack * half;
    doubled_ = false;
    inRow_ = 0;
  }

  void taken() {
    if (doubled_) wait_ = kStepsInRow;
    doubled_ = ++inRow_ >= wait_;
    if (!doubled_) return;
    length_ *= 2;
    inRow_ = 0;
  }

 private:
  double length_ = 1;
  int wait_ = kStepsInRow, inRow_ = 0;
  bool doubled_ = false;  // and no step has been taken or folded since then
};

double growthOf(const BoundaryPair& pair) {
  const double volume = pair.target.volume;
  return volume > 0 ? std::cbrt(volume / pair.solid().volume())
                    : pair.target.diagonal / pair.solid().diagonal();
}

class StepFitter {
 public:
  StepFitter(const BoundaryPair& pair, const Points& inside, const StepFitSettings& settings,
             Between between)
      : settings_(settings),
        smoothed_(between == Between::smoothed),
        vertices_(pair.solid().repaired().mesh.vertices),
        triangles_(pair.solid().repaired().mesh.triangles),
        path_(vertices_, pair.target.moved, triangles_, growthOf(pair), between),
        unit_(pair.target.diagonal / path_.rest().scale),
        boundary_(pair.solid(), carrySettings()),
        piecesAtFirst_(boundary_.pieces()),
        inside_{inside, {}},
        share_(smoothed_ ? kUsualShare : kShare) {}

  // False once the way is lost, where its end is not reached.
  bool go() {
    std::vector<double> ends{1};  // the next one last
    if (settings_.maxSteps > 1) ends.push_back(0.5);
    bool hurries = false;  // one step does the rest of the way, for lack of time or charges
    double seconds = 0;    // of the last step, taken or not
    while (!ends.empty()) {
      reportGoing();
      if (!hurries && (outOfTime(seconds) || spent_ > sourcesAt(settings_.waySources))) {
        hurries = true;
        ends = {1};
      }
      const auto mayHalve = [&] {
        return !hurries && static_cast<int>(records_.size() + ends.size()) < settings_.maxSteps;
      };
      while (mayHalve() && ends.back() - at_ > longest_.length())
        ends.push_back((at_ + ends.back()) / 2);
      const double end = ends.back();
      const bool may = mayHalve();
      const double half = (end - at_) / 2;
      const auto began = std::chrono::steady_clock::now();
      Step step = fitStep(end, may);
      seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
      if (step.fit.end == AdaptiveEnd::stopped ||
          (may && half >= shortest(kShortestFitted) && foldsTooMuch(step))) {
        ends.push_back((at_ + end) / 2);
        if (smoothed_) longest_.folded(half);
        continue;
      }
      longest_.taken();
      ends.pop_back();
      take(std::move(step), ends.empty());
      if (isLost() && !ends.empty()) return false;
    }
    return true;
  }

  // Pairs of triangles that run through one another in the worst of the shapes on the way; over the
  // number of triangles.
  double mostCrossings() const {
    std::size_t most = 0;
    for (int i = 1; i < kLooks; ++i) {
      std::size_t count = 0;
      forEachSelfIntersection(path_.at(static_cast<double>(i) / kLooks), triangles_,
                              [&](const Crossing&) { ++count; });
      most = std::max(most, count);
    }
    return static_cast<double>(most) / static_cast<double>(triangles_.size());
  }

  bool foldsMany() const { return folded_ > kManyFolds; }

  // Whether smoothed shapes may help: they do not where charges are missing.
  bool runsThroughItself() const { return leapt_ || foldsMany() || isCrumpled(); }

  // The rest of the way at once.
  void jump() {
    reportGoing();
    take(fitStep(1, false), true);
  }

  StepFit result() {
    std::vector<HarmonicMap> steps = boundary_.steps();
    steps.back() = HarmonicMap(movedBy(path_.rest(), steps.back().field()));
    return {ComposedMap(std::move(steps)), std::move(records_), boundary_.errorFrom(now_, unit_),
            end_};
  }

 private:
  CarriedSettings carrySettings() const {
    CarriedSettings s;
    s.accuracy = std::min(kStepSumAccuracy, kSumShare * settings_.tolerance) * unit_;
    s.chord = std::min(kChord, settings_.tolerance) * unit_;
    s.seed = settings_.seed;
    return s;
  }

  void reportGoing() const {
    reportProgress(smoothed_ ? "going by smoothed shapes" : "going in steps",
                   std::pow(at_, kWorkPower));
  }

  double shortest(double share) const { return smoothed_ ? kOfSmoothed * share : share; }

  // Share of the points inside that may be folded after a step, if that gets so much of what is
  // left.
  double allowed(double share) const {
    return folded_ + share * std::max(0.0, settings_.folds - folded_);
  }

  double toleranceUntil(double end) const {
    return std::max((end < 1 ? share_ : kLastShare) * settings_.tolerance, kSmallestTolerance);
  }

  // From that at the tolerance of surfaces that were laid on one another.
  double sourcesAt(double usual) const {
    return usual * std::max(1.0, kLaidOnTolerance / settings_.tolerance);
  }

  std::size_t mostSources() const {
    const double most = sourcesAt(smoothed_ ? kSmoothedSources : kStepSources);
    return static_cast<std::size_t>(std::min(most, static_cast<double>(settings_.maxSources)));
  }

  // mayHalve: stops where a round folds too many points that are not folded yet. Folds of the first
  // level of charges are few or none where those of the whole fit are none.
  Step fitStep(double to, bool mayHalve) {
    const bool last = !(to < 1);
    Points ways = path_.at(to);
    for (std::size_t v = 0; v < ways.size(); ++v) ways[v] = ways[v] - now_[v];
    std::optional<Mending> mending;
    if (at_ > 0 && (last || !smoothed_)) {
      const double tolerance = settings_.tolerance * unit_;
      mending = last ? Mending{now_, kLastKept * tolerance, kLastMended * tolerance}
                     : Mending{now_, kKept * tolerance, kMended * tolerance, kFar * tolerance};
    }
    AdaptiveSettings s;
    s.tolerance = toleranceUntil(to);
    s.maxSources = mostSources();
    s.outlierRounds = last ? kOutlierRounds : 0;
    s.patience = last ? kLastPatience : kPatience;
    const double half = (to - at_) / 2;
    InsideAfter inside(*this);
    if (mayHalve && half >= shortest(kShortest))
      s.goOn = [this, half, &inside](const HarmonicField& field, int round) {
        if (round > 1 && half < shortest(kShortestFitted)) return true;
        return foldedShare(inside.of(field).determinants, 1) <=
               allowed(round == 1 ? kCoarseFoldShare : kFoldShare);
      };
    AdaptiveResult fit = fitToTolerance(boundary_.problem(ways, unit_, mending, last), s);
    spent_ += static_cast<double>(fit.field.sources().size());
    if (fit.end == AdaptiveEnd::maxSources && s.maxSources < settings_.maxSources)
      fit.end = AdaptiveEnd::noGain;
    MappedPoints ends = inside.of(fit.field);
    const MapStep record{at_, to, fit.field.sources().size(), fit.error.p99,
                         foldedShare(ends.determinants, 1)};
    HarmonicMap map(fit.field);
    return {record, std::move(fit), std::move(map), std::move(ends)};
  }

  bool foldsTooMuch(const Step& step) const {
    return step.record.folded > allowed(kFoldShare) ||
           (settings_.proofCells && isProvenToFold(step));
  }

  // On the mesh about the present solid. Where that allows no proof, or memory, the points decide.
  bool isProvenToFold(const Step& step) const {
    ProofSettings s;
    s.cellsPerCharge = *settings_.proofCells;
    try {
      return proveSense(step.map, boundary_.mesh(), s).negative.count > 0;
    } catch (const MemoryError&) {
      return false;
    } catch (const DataError&) {
      return false;
    }
  }

  // Where a step takes the points inside. The field that is asked for last is kept: the one that a
  // fit gives is mostly that of its last round.
  class InsideAfter {
   public:
    explicit InsideAfter(const StepFitter& fitter) : fitter_(fitter) {}

    const MappedPoints& of(const HarmonicField& field) {
      if (!field_ || field_->sources().data() != field.sources().data()) {
        field_ = field;
        points_ = mapPoints(HarmonicMap(field), fitter_.inside_, kStepSumAccuracy * fitter_.unit_);
      }
      return points_;
    }

   private:
    const StepFitter& fitter_;
    std::optional<HarmonicField> field_;
    MappedPoints points_;
  };

  // Whether what is left of the way cannot make the map good.
  bool isLost() const {
    return (!smoothed_ && missed_ > kLost * settings_.tolerance) || runsThroughItself();
  }

  bool isCrumpled() const {
    return boundary_.pieces() > (smoothed_ ? kMostSmoothedPieces : kMostPieces) * piecesAtFirst_;
  }

  bool leaps(const MapStep& step) const {
    double tolerance = toleranceUntil(step.to);
    if (!smoothed_) return step.error > kLeap * tolerance;
    tolerance = std::max(tolerance, kUsualShare * settings_.tolerance);
    return step.error > (step.sources < kUsualSources ? kCrumpled : kSmoothedLeap) * tolerance;
  }

  void changeShare(std::size_t sources, bool met) {
    if (!met) {
      share_ = std::min(kShareChange * share_, kMostShare);
      return;
    }
    const double change = std::pow(static_cast<double>(sources) / kUsualSources, kSharePower);
    share_ = std::clamp(share_ * std::clamp(change, 1 / kShareChange, kShareChange), kLeastShare,
                        std::max(kUsualShare, share_));
  }

  void take(Step step, bool last) {
    missed_ += std::max(0.0, step.fit.error.p99 - toleranceUntil(step.record.to));
    leapt_ = step.fit.end == AdaptiveEnd::noGain && leaps(step.record);
    if (smoothed_) changeShare(step.record.sources, step.fit.end == AdaptiveEnd::met);
    if (end_ == AdaptiveEnd::met) end_ = step.fit.end;
    at_ = step.record.to;
    now_ = path_.at(at_);
    folded_ = step.record.folded;
    records_.push_back(step.record);
    inside_ = std::move(step.inside);
    boundary_.advance(step.map, last);
  }

  const StepFitSettings& settings_;
  const bool smoothed_;
  const Points& vertices_;
  const std::vector<Triangle>& triangles_;
  const ShapePath path_;
  const double unit_;
  CarriedBoundary boundary_;
  const double piecesAtFirst_;
  MappedPoints inside_;
  std::vector<MapStep> records_;
  double at_ = 0;  // of the way
  Points now_ = path_.at(0);
  double folded_ = 0;    // share of the points inside, so far
  double missed_ = 0;    // what the steps left beyond their tolerances, added up
  bool leapt_ = false;   // the last step left much more than it may, though it had the charges
  LongestStep longest_;  // on the usual way long steps tell soonest that it is lost
  double share_;         // of the tolerance, that a step before the last may leave
  double spent_ = 0;     // charges of all fits, those that were thrown away included
  AdaptiveEnd end_ = AdaptiveEnd::met;
};

}  // namespace

StepFit fitInSteps(const BoundaryPair& pair, const Points& inside,
                   const StepFitSettings& settings) {
  StepFitter fitter(pair, inside, settings, Between::interpolated);
  std::optional<StepFitter> smoothed;
  const bool may = settings.maxSteps >= kFewestSmoothed;
  const double crossing = may ? fitter.mostCrossings() : 0;
  bool first = false;
  if (crossing > kManyCrossings) {
    smoothed.emplace(pair, inside, settings, Between::smoothed);
    first = smoothed->mostCrossings() <= kFewerCrossings * crossing;
  }
  bool arrived = first && smoothed->go();
  if (arrived && !smoothed->foldsMany()) return smoothed->result();
  if (fitter.go()) return fitter.result();
  if (may && !first && fitter.runsThroughItself() && !outOfTime()) {
    if (!smoothed) smoothed.emplace(pair, inside, settings, Between::smoothed);
    arrived = smoothed->go();
  }
  if (arrived) return smoothed->result();
  fitter.jump();
  return fitter.result();
}

}  // namespace innermap

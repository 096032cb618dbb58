#include "job_clock.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace innermap::tool {
namespace {

// Of the expected time: less than this says little yet of how the job goes.
constexpr double kPrior = 0.1;
// A phase that reports fractions is judged by them from here on, to this share at least.
constexpr double kTrusted = 0.25, kOfFraction = 0.6;
constexpr double kLeast = 1e-3;  // seconds
// One that is over its time is thought to need this share of what it took so far.
constexpr double kOverdue = 0.5;
// One that has reported nothing for a while, the same of that while.
constexpr double kSilent = 0.3;
constexpr double kTells = 0.08;
// A stage that is reported to have gone back this far has begun once more.
constexpr double kAgain = 0.5;

}  // namespace

void JobClock::expect(std::vector<JobPhase> phases, double now) {
  phases_ = std::move(phases);
  current_ = 0;
  begun_ = false;
  planned_ = since_ = reported_ = now;
  fraction_ = part_ = 0;
  time_ = 0;
}

void JobClock::report(std::string_view stage, double fraction, double now) {
  for (std::size_t i = current_; i < phases_.size(); ++i) {
    if (phases_[i].stage != stage) {
      if (phases_[i].gate && (i != current_ || !begun_)) return;
      continue;
    }
    if (i != current_ || !begun_) {
      current_ = i;
      // What came before the first phase counts as part of it.
      since_ = reported_ = begun_ ? now : planned_;
      fraction_ = part_ = 0;
      time_ = 0;
      begun_ = true;
    }
    phases_[i].perhaps = false;
    advance(std::isfinite(fraction) ? std::clamp(fraction, 0.0, 1.0) : 0.0, now);
    return;
  }
}

void JobClock::advance(double fraction, double now) {
  const int times = phases_[current_].times;
  if (fraction < part_ - kAgain && time_ + 1 < times) {
    ++time_;
    part_ = 0;
  }
  // What is reported may turn out to have been too much; one that begins once more unforeseen has
  // still done what it has.
  if (fraction < part_ - kAgain || fraction == part_) return;
  part_ = fraction;
  fraction_ = (time_ + part_) / times;
  reported_ = now;
}

const std::string& JobClock::title() const {
  static const std::string kNone;
  if (!begun_) return kNone;
  const JobPhase& phase = phases_[current_];
  return phase.title.empty() ? phase.stage : phase.title;
}

double JobClock::expectedUntil(std::size_t end) const {
  double seconds = 0;
  for (std::size_t i = 0; i < end; ++i)
    if (!phases_[i].perhaps) seconds += phases_[i].seconds;
  return seconds;
}

// Seconds that the current phase needs by what it reported; `otherwise` where it reported nothing.
double JobClock::leftByFraction(double now, double otherwise) const {
  if (!(fraction_ > 0)) return otherwise;
  const double then = (reported_ - since_) * (1 - fraction_) / fraction_, silent = now - reported_;
  return std::max(then - silent, kSilent * silent);
}

JobClock::State JobClock::at(double now) {
  State state;
  if (!known() || !begun_) return {shown_, 0, false};
  const double total = expectedUntil(phases_.size()), done = expectedUntil(current_);
  const double own = phases_[current_].seconds;
  const double prior = kPrior * total;
  const double spent = now - since_;
  const double over = (since_ - planned_ + prior) / (done + prior);
  // One that is over its time says that the job goes slower than was thought.
  const double speed = std::max(over, (since_ - planned_ + spent + prior) / (done + own + prior));
  const double byTime = std::max(speed * own - spent, kOverdue * spent);
  const double trust = phases_[current_].steady ? std::min(1.0, fraction_ / kTrusted) : 0;
  // Fractions seldom go quite as the time does: between the two, by their ratio.
  const double weight = trust * std::max(kOfFraction, fraction_);
  const double left = std::pow(std::max(leftByFraction(now, byTime), kLeast), weight) *
                      std::pow(std::max(byTime, kLeast), 1 - weight);
  // A phase that takes longer than was thought says that others will, too.
  const double phase = (spent + left) / std::max(own, 1e-9);
  const double share = trust * own / (done + own + prior);
  const double pace = (1 - share) * speed + share * phase;
  state.secondsLeft = left + pace * (total - done - own);
  const double fraction = now / std::max(now + state.secondsLeft, 1e-9);
  shown_ = std::max(shown_, std::min(fraction, 0.99));
  state.fraction = shown_;
  state.tellsTime = fraction > kTells && now > 1;
  return state;
}

double totalSeconds(const std::vector<JobPhase>& phases) {
  double total = 0;
  for (const JobPhase& p : phases)
    if (!p.perhaps) total += p.seconds;
  return total;
}

// As measured on samples/ and models of some ten thousand triangles: shares in percent, and the
// seconds that all take together on an idle machine.
std::vector<JobPhase> usualPhases(const std::string& command) {
  static const std::map<std::string, double> kSeconds = {
      {"map", 6},        {"fit", 3},  {"sequence", 12},         {"deform", 40},
      {"correspond", 9}, {"push", 2}, {"transfer-distance", 3}, {"texture", 16}};
  static const std::map<std::string, std::vector<JobPhase>> kPhases = {
      {"map", {{"reading", 1}, {"fitting", 5}}},  // until more is known
      {"fit", {{"reading", 1}, {"fitting", 5}}},
      {"sequence", {{"reading", 5}, {"level set", 5}, {"factoring", 20}, {"frames", 70}}},
      {"deform", {{"reading", 5}, {"level set", 5}, {"factoring", 20}, {"frames", 70}}},
      {"correspond",
       {{"repairing", 7, false, "reading"},
        {"trying rotations", 6},
        {"trying first maps", 45},
        {"judging first maps", 12},
        {"refining the map", 27},
        {"measuring the map", 3}}},
      {"evaluate",
       {{"checking", 30, false, "reading"},
        {"level set", 33},
        {"evaluating the map", 12},
        {"checking cells", 15},
        {"writing the VDB file", 10}}},
      {"texture",
       {{"placing samples", 3},
        {"offset surface", 3},
        {"filling the kernel matrix", 1},
        {"factoring", 9},
        {"factoring clusters", 11},
        {"solving", 8},
        {"level set", 4},
        {"continuing inwards", 40},
        {"meeting the surface", 18},
        {"writing the VDB file", 3}}},
      {"push",
       {{"checking", 15, false, "reading"},
        {"reading the VDB file", 4},
        {"level set", 30},
        {"covering the target", 12},
        {"inverting the map", 20},
        {"carrying the grids", 13},
        {"writing the VDB file", 6}}},
      {"transfer-distance",
       {{"checking", 30, false, "reading"},
        {"level set", 22},
        {"distances", 36},
        {"drawing the section", 12}}},
      {"tetrahedralize",
       {{"reading", 20},
        {"level set", 25},
        {"filling with tetrahedra", 20},
        {"measuring cells", 20},
        {"comparing the boundaries", 10},
        {"writing cells", 5}}},
      {"voxelize", {{"reading", 10}, {"level set", 70}, {"writing the VDB file", 20}}},
      {"slice", {{"reading the VDB file", 50}, {"drawing the section", 50}}}};
  const std::string name = command == "pull" ? "push" : command;
  const auto found = kPhases.find(name);
  if (found == kPhases.end()) return {};
  std::vector<JobPhase> phases = found->second;
  const auto seconds = kSeconds.find(name);
  const double scale = (seconds == kSeconds.end() ? 1.5 : seconds->second) / totalSeconds(phases);
  for (JobPhase& phase : phases) phase.seconds *= scale;
  return phases;
}

}  // namespace innermap::tool

#include "job_clock.h"

#include <algorithm>
#include <cmath>
#include <ctime>
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
// No time is told while more than this of what is left is doubtful.
constexpr double kDoubtful = 0.5;
constexpr double kLittle = 3;  // seconds: a plan may be out by that

double coreSeconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

}  // namespace

JobPhase& operator+=(JobPhase& phase, const JobPhase& other) {
  phase.seconds += other.seconds;
  phase.doubtful += other.doubtful;
  phase.works.insert(phase.works.end(), other.works.begin(), other.works.end());
  return phase;
}

JobPhase& operator*=(JobPhase& phase, double times) {
  phase.seconds *= times;
  phase.doubtful *= times;
  for (JobWork& work : phase.works) work.times *= times;
  return phase;
}

void JobClock::expect(std::vector<JobPhase> phases, double now) {
  phases_ = std::move(phases);
  current_ = 0;
  begun_ = false;
  taken_.clear();
  planned_ = since_ = reported_ = now;
  coresSince_ = coreSeconds();
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
      // What came before the first phase counts as part of it.
      if (begun_) {
        taken_.push_back(underWay(now));
        coresSince_ += taken_.back().coreSeconds;
      }
      current_ = i;
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

JobPhaseTaken JobClock::underWay(double now) const {
  return {phases_[current_], now - since_, coreSeconds() - coresSince_};
}

std::vector<JobPhaseTaken> JobClock::taken(double now) const {
  std::vector<JobPhaseTaken> out = taken_;
  if (begun_) out.push_back(underWay(now));
  return out;
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
  double doubtful = left * (1 - trust) * phases_[current_].doubtful / std::max(own, 1e-9);
  for (std::size_t i = current_ + 1; i < phases_.size(); ++i)
    if (!phases_[i].perhaps) doubtful += pace * phases_[i].doubtful;
  const double fraction = now / std::max(now + state.secondsLeft, 1e-9);
  shown_ = std::max(shown_, std::min(fraction, 0.99));
  state.fraction = shown_;
  state.tellsTime = fraction > kTells && now > 1 && doubtful <= kDoubtful * state.secondsLeft;
  return state;
}

double totalSeconds(const std::vector<JobPhase>& phases) {
  double total = 0;
  for (const JobPhase& p : phases)
    if (!p.perhaps) total += p.seconds;
  return total;
}

double tellableSeconds(const std::vector<JobPhase>& phases) {
  double doubtful = 0;
  for (const JobPhase& p : phases)
    if (!p.perhaps) doubtful += p.doubtful;
  const double total = totalSeconds(phases);
  return doubtful <= std::max(kLittle, kDoubtful * total) ? total : 0;
}

}  // namespace innermap::tool

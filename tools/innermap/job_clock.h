// How far a job has come, and how long it will still take.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace innermap::tool {

// What a stage works on.
struct JobSize {
  double inside = 0;   // voxels of the solid, millions
  double surface = 0;  // voxels that its surface runs through, millions
  double charges = 0;  // thousands
  double items = 0;    // whatever else the stage counts
};

// So often over that much: what a row of the table of weights is multiplied with.
struct JobWork {
  std::string row;
  JobSize size;
  double times = 1;
};

// A part of a job, in the order in which parts follow one another.
struct JobPhase {
  // As the library reports it, or as Context::phase() names it.
  std::string stage;
  // What it is expected to take here and now: only the ratios matter once some of them are over.
  double seconds = 0;
  // Counts only when it comes to it: steps where one map folds.
  bool perhaps = false;
  // Of stages that are passed at once and many times: the phase it stands for, when not itself.
  std::string title = "";
  // So often it is reported from 0 to 1, one time after another.
  int times = 1;
  // Later phases do not begin before this one: the library may report stages of their names until
  // then.
  bool gate = false;
  // Its fractions say how long it takes.
  bool steady = true;
  // Of its seconds, those that may be out by more than a factor of two.
  double doubtful = 0;
  // What its seconds are the sum of.
  std::vector<JobWork> works = {};
};

// Both at once; so many of it.
JobPhase& operator+=(JobPhase& phase, const JobPhase& other);
JobPhase& operator*=(JobPhase& phase, double times);

// A phase that is over: of the whole process.
struct JobPhaseTaken {
  JobPhase phase;
  double seconds, coreSeconds;
};

// Times are seconds since the job began. Phases that are over say how the job goes beside what was
// expected; the one under way is judged by the fraction it reports, or else by its time.
class JobClock {
 public:
  void expect(std::vector<JobPhase> phases, double now);

  // A stage goes on. Those that are no phase, and those that lie behind, play no part.
  void report(std::string_view stage, double fraction, double now);

  bool known() const { return !phases_.empty(); }
  // Of the phase under way; empty before the first.
  const std::string& title() const;

  // Those that are over; the one under way counts as over.
  std::vector<JobPhaseTaken> taken(double now) const;

  struct State {
    double fraction = 0;  // of the whole job; never less than before
    double secondsLeft = 0;
    bool tellsTime = false;  // enough has passed to tell, and most of what is left is known
  };
  State at(double now);

 private:
  JobPhaseTaken underWay(double now) const;
  double expectedUntil(std::size_t end) const;
  void advance(double fraction, double now);
  double leftByFraction(double now, double otherwise) const;

  std::vector<JobPhase> phases_;
  std::vector<JobPhaseTaken> taken_;
  std::size_t current_ = 0;
  bool begun_ = false;
  double planned_ = 0;     // when the phases became known
  double coresSince_ = 0;  // of the current phase: core seconds of the process when it began
  // Of the current phase: when it began, how much of it is done and when that was reported, and the
  // same of the time under way where it comes several times.
  double since_ = 0, fraction_ = 0, reported_ = 0;
  int time_ = 0;
  double part_ = 0;
  double shown_ = 0;
};

// Of the phases that are sure to come; 0 seconds may be told where most of it is doubtful.
double totalSeconds(const std::vector<JobPhase>& phases);
double tellableSeconds(const std::vector<JobPhase>& phases);

}  // namespace innermap::tool

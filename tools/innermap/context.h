// What a running command is given: progress, limits, timing, a place for messages.
#pragma once

#include <chrono>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/file.h"
#include "innermap/core/memory.h"
#include "innermap/core/run.h"
#include "innermap/mesh/mesh_file.h"
#include "job_clock.h"
#include "jobs/needs.h"
#include "report/report.h"
#include "report/verdict.h"

namespace innermap {
struct JoinedParts;
struct Page;
}  // namespace innermap

namespace innermap::tool {

class TerminalProgress;

// Bytes that making a page takes, which holds so many vertices and blocks at most; measured: 1 to
// 23 MB while grids had at most 96 blocks, and three times as many values now.
constexpr std::uint64_t kPageMemory = 60'000'000;
// What --html is without a file's name.
constexpr const char* kPageBesideOutputs = "report.html beside the outputs";

// The options that every command has.
struct CommonOptions {
  int threads = 0;
  std::string maxMemory;
  double maxTime = std::numeric_limits<double>::infinity();  // seconds
  SpaceSettings space;
  std::string cpuTarget;  // empty: the processor's best
  bool dryRun = false;
  bool strict = false;
  std::string report;
  std::string html;  // empty: none
  bool quiet = false, verbose = false;
  bool json = false;  // the report on stdout, in place of other text
  bool help = false, helpAll = false, version = false;
  // As they stood on the command line: all of them, and the last value of each option by its name.
  std::vector<std::string> arguments;
  std::map<std::string, std::string> given;
  std::vector<std::string> notes;  // of former names that were used
};

// A command calls it from one thread.
class Context {
 public:
  Context(const CommonOptions& options, TerminalProgress& progress);
  ~Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  // For commands that do the same for several things, say frames: which one is under way, shown
  // with the progress. Empty: none.
  void setPart(const std::string& part);

  // What the job consists of, when that becomes known: for the progress, and the time that plan()
  // tells.
  void expect(const std::vector<JobPhase>& phases);
  // One of those that the library does not report begins.
  void phase(const std::string& stage);

  // Beside measuring and writing, which take a tenth of what trying and refining do, or less.
  static constexpr double kMostOfTime = 0.9;
  // Of what --max-time leaves now, less `later` seconds for what has to come after, this share may
  // be spent on improving what comes next.
  void spend(double share, double later = 0);
  // Whether --max-time is over, so that no other part of the job is begun.
  bool timeIsUp();

  // Which axes and units input has and output shall have. All that is read is brought to output's,
  // by readMeshFile, readGridFile and inOutput (inputs.h) and the frames' AnimationSettings, and
  // what is computed is in that.
  const SpaceSettings& space() const { return space_; }

  // What workers left of this run, for `join`, which has the command conclude it: the command takes
  // these in place of what it would compute. Null in other runs.
  void joins(std::shared_ptr<const JoinedParts> parts, const SpaceSettings& space, double maxTime) {
    joined_ = std::move(parts);
    space_ = space;
    maxTime_ = maxTime;
  }
  const JoinedParts* joined() const { return joined_.get(); }

  bool dryRun() const { return options_.dryRun; }
  // What --dry-run says: a line for each thing that would be done, the seconds that expect() knows
  // of unless they are doubtful, and the peak of the process (also whether it is over the limit),
  // on stdout. bytes: the need beyond what the process has by now.
  void plan(const std::vector<std::string>& lines, std::uint64_t bytes);
  // A dry run: false, after plan() of the largest need. Else true, after requireMemory() of each.
  bool begins(const std::vector<std::string>& lines, const MemoryNeed& need) {
    return begins(lines, std::vector<MemoryNeed>{need});
  }
  bool begins(const std::vector<std::string>& lines, const std::vector<MemoryNeed>& needs);
  // Throws MemoryError when as many bytes more would be over the limit, as core/memory.h says. What
  // plan() says is the most that was asked for here: of a file that is read before it, too.
  void requireMemory(const MemoryNeed& need) const;

  // A file that is read. Arguments, and options that are marked with reads(), are told already;
  // this is for files that are found, say by a pattern. Throws FileError when it is an output.
  void input(const std::string& path);

  // All that a command writes passes here, before it reads or computes anything. Throws FileError
  // when `path` is an input, or another output, and unless a file can be created there. sure: it
  // will be written in any case.
  void output(const std::string& path, bool sure = true);
  // Files of one kind, of which only the first is tried out.
  void outputs(const std::vector<std::string>& paths);
  // A folder of files that appear together; `names` are those that may be written. Those of an
  // earlier run that this one does not write again, and its
  // page, go. Files of other names stay untouched. Says which files that are no earlier run's are
  // replaced, or stay; of those that `beside` names it says nothing. Null in a dry run.
  std::unique_ptr<PendingFolder> outputFolder(const std::string& path,
                                              const std::vector<std::string>& names,
                                              const std::vector<std::string>& beside = {});
  // A file that is an output of this run and in place already.
  void outputInPlace(const std::string& path);
  // Whether all outputs that are sure, but the report, are in place.
  bool allInPlace() const;

  // What `body` returns; adds its wall time to the report's "seconds" under `stage`.
  template <class Body>
  decltype(auto) timed(const std::string& stage, Body&& body) {
    throwIfCancelled();
    noteMemory();
    return innermap::timed(report_.seconds, stage, std::forward<Body>(body));
  }

  // One line each on stderr (nothing with --quiet), and in the report.
  void note(const std::string& text);     // what was repaired or chosen
  void warning(const std::string& text);  // what makes the result doubtful

  // Both, and the seconds, of a result of the library.
  template <class Result>
  void tell(const Result& result) {
    for (const std::string& text : result.notes) note(text);
    for (const std::string& text : result.warnings) warning(text);
    addSeconds(report_.seconds, result.seconds);
    noteMemory();
  }

  // The command goes on and writes its files, and its report; then the program ends with this line
  // on stderr and exit code 1.
  void failAfterwards(const std::string& text) { failure_ = text; }
  const std::string& failure() const { return failure_; }

  // A setting that was left to the command: what it took. option: "--tolerance". In the report.
  void used(const std::string& option, const ReportValue& value);

  // Adds to the verdict that the run ends with; warns of what is not met, unless that was told.
  void judge(const Verdict& verdict);
  // The verdict, on stdout, and what was written, on stderr; with --strict what is not met is a
  // failure. The last that a run says.
  void conclude();

  // What --html shows; null without.
  Page* page() { return page_.get(); }

  // Results, on stdout. Nothing else goes there.
  void print(const std::string& text);
  // The same, after the verdict.
  void detail(const std::string& text) { details_ += text; }

  // Sections that the command fills; the framework writes it to --report F afterwards.
  Report& report() { return report_; }
  // With peak memory as it now stands, and the outputs that are in place.
  const Report& finishedReport();
  // Adds report.json, and report.html where that goes there, and puts the files in place.
  void finish(PendingFolder& folder);
  // The page of a command that has no folder, when there is to be one.
  void finishPage();

 private:
  void inFolder(const std::string& folder, const std::vector<std::string>& names);
  void sayWhatIsThere(const std::string& path, const std::vector<std::string>& names,
                      const std::vector<std::string>& beside);
  void requireProgram() const;

  // What the process holds, with the page.
  std::uint64_t held() const;
  // The peak with so many bytes more, or with what was asked for before.
  std::uint64_t claimed(std::uint64_t bytes) const;

  void say(const std::string& kind, const std::string& text);

  void enter(const std::string& path);
  // When a picture is to be written: a note where it will have no labels for lack of a font.
  void notePictures();
  // Where --html goes when it is to stand beside this output.
  void placePage(const std::string& output);
  // The most memory so far, for the stages that ended since the last time.
  void noteMemory();
  // Says when the result depends on --max-time.
  void noteTime();
  std::vector<ReportOutput> outputsNow() const;

  const CommonOptions& options_;
  TerminalProgress& progress_;
  std::uint64_t maxMemory_ = 0;
  double maxTime_;  // seconds
  double secondsGone() const;

  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  bool timeNoted_ = false;
  mutable std::uint64_t most_ = 0;  // of claimed()
  Report report_;
  std::map<std::string, std::uint64_t> memoryAfter_;  // bytes, by stage
  std::unique_ptr<Page> page_;
  std::string pagePath_;
  std::string failure_, details_;
  std::shared_ptr<const JoinedParts> joined_;
  SpaceSettings space_;
  double expectedSeconds_ = 0;
  std::map<std::string, std::string> inputs_, outputs_;       // by fileKey
  std::vector<std::pair<std::string, std::string>> ordered_;  // outputs: key when told, path
  std::vector<ReportOutput> inFolders_;                       // that are in place, or will be
  // Names of files in outputFolder() that go when this run does not write them.
  std::vector<std::string> stale_;
};

}  // namespace innermap::tool

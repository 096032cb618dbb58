// `innermap study`: errors, energies and stability of a map by its settings.
#include "innermap/study/study.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "commands.h"
#include "core/share.h"
#include "innermap/core/memory.h"
#include "innermap/core/run.h"
#include "innermap/correspond/mesh_correspondence.h"
#include "innermap/mesh/mesh_file.h"
#include "inputs.h"
#include "job_cost.h"
#include "lists.h"
#include "map_report.h"
#include "report/figures.h"
#include "report/study/study_files.h"
#include "share.h"
#include "signals.h"

namespace innermap::tool {
namespace {

struct StudyOptions {
  std::string source, target, output, correspondence;
  std::string sources, collocation, distances, radiusRatios;
  ShareOptions farm;
  StudySettings settings;
};

template <class T>
std::string listText(const std::vector<T>& list) {
  return fmt::format("{}", fmt::join(list, ","));
}

// "a,b,c", each a number or "FROM:TO:COUNT", so many in equal ratios; "none".
std::vector<double> studyList(const std::string& option, const std::string& text) {
  constexpr double kMostInRange = 1000;
  if (text == "none") return {};
  const std::string what =
      "'none' or a list of numbers above 0 and ranges FROM:TO:COUNT, such as 100,200 or 100:3200:6";
  std::vector<double> out;
  for (std::string part : commaList(text)) {
    const auto colons = std::count(part.begin(), part.end(), ':');
    std::replace(part.begin(), part.end(), ':', ',');
    if (colons == 0) {
      out.push_back(parseNumbers(option, part, 1, what).front());
      continue;
    }
    const std::vector<double> range = parseNumbers(option, part, 3, what);
    if (!(range[0] > 0 && range[1] >= range[0] && range[2] >= 2 && range[2] <= kMostInRange))
      throw UsageError(
          fmt::format("{}: '{}' is no range: FROM above 0, TO at least that, COUNT "
                      "from 2 to {}",
                      option, text, kMostInRange));
    const int count = static_cast<int>(range[2]);
    for (int i = 0; i < count; ++i)
      out.push_back(range[0] * std::pow(range[1] / range[0], 1.0 * i / (count - 1)));
  }
  if (out.empty()) throw UsageError(option + ": '" + text + "' is not " + what);
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

StudySettings settingsOf(const StudyOptions& options) {
  StudySettings settings = options.settings;
  settings.sources.clear();
  for (const double n : studyList("--charges", options.sources)) {
    const auto count = static_cast<std::size_t>(std::round(std::clamp(n, 0.0, 1e9)));
    if (settings.sources.empty() || settings.sources.back() != count)
      settings.sources.push_back(count);
  }
  settings.collocation = studyList("--points", options.collocation);
  settings.distances = studyList("--distances", options.distances);
  settings.radiusRatios = studyList("--radius-ratios", options.radiusRatios);
  settings.folder = (std::filesystem::path(options.output) / "runs").string();
  if (!options.farm.share.empty()) {
    const Share share = parseShare("--share", options.farm.share);
    settings.share = share.number;
    settings.shares = share.of;
  }
  return settings;
}

BoundaryPair readPair(const StudyOptions& options, Context& context) {
  if (options.target.empty() == options.correspondence.empty())
    throw UsageError("give a TARGET of SOURCE's connectivity, or --correspond (not both)");
  Mesh source = readMeshFile(options.source, context);
  Mesh target = context.timed("read", [&] {
    return options.correspondence.empty() ? readMeshLike(options.target, source)
                                          : readCorrespondence(options.correspondence, source);
  });
  BoundaryPair pair = makeBoundaryPair(std::move(source), std::move(target));
  reportBoundaries(pair, context);
  return pair;
}

void plan(const StudyOptions& options, const BoundaryPair& pair, const StudySettings& settings,
          Context& context) {
  const std::vector<StudyRun> runs = studyRuns(pair.solid(), settings);
  std::vector<std::string> lines;
  std::uint64_t most = 0;
  const std::uint64_t room = memoryLeft();
  std::size_t kept = 0;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const std::uint64_t need = studyMemory(runs[i]);
    const bool isThere = isKept(pair, runs[i], settings), fits = need <= room;
    kept += isThere;
    if (!isThere && fits) most = std::max(most, need);
    lines.push_back(fmt::format("run {} of {}: {}: {}", i + 1, runs.size(), describeRun(runs[i]),
                                isThere ? "kept from before"
                                : fits
                                    ? "about " + formatBytes(need)
                                    : "about " + formatBytes(need) + ", over the limit: left out"));
  }
  lines.push_back(
      fmt::format("make {} runs, take {} from {}", runs.size() - kept, kept, settings.folder));
  lines.push_back(fmt::format("write study.csv, study.json, study.html, {} and report.json to {}",
                              fmt::join(studyChartNames(), ", "), options.output));
  context.plan(lines, most);
}

// Seconds of one core that the first n runs take, for each n; those that are kept take none.
std::vector<double> workOf(const BoundaryPair& pair, const StudySettings& settings) {
  constexpr double kSmall = 0.06, kThousandCubed = 0.25, kAPoint = 0.06;  // measured
  std::vector<double> work{0};
  const std::vector<StudyRun> runs = studyRuns(pair.solid(), settings);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const StudyRun& run = runs[i];
    const bool others = i % settings.shares != settings.share - 1;
    const double thousands = static_cast<double>(run.sources) / 1000;
    const double own =
        kSmall + std::pow(thousands, 3) * (kThousandCubed + kAPoint * run.collocation);
    work.push_back(work.back() + (others || isKept(pair, run, settings) ? 0 : own));
  }
  return work;
}

JobPhase runsPhase(const std::vector<double>& work) {
  JobSize size;
  size.items = work.back();
  return stageOf("runs", size);
}

void writeJobs(const StudyOptions& options, const BoundaryPair& pair, const StudySettings& settings,
               const std::vector<double>& work, Context& context) {
  const std::vector<StudyRun> runs = studyRuns(pair.solid(), settings);
  ShareRun all;
  all.unit = "run";
  all.units = runs.size();
  all.phases = {runsPhase(work)};
  for (const StudyRun& run : runs)
    if (const std::uint64_t need = studyMemory(run); need <= memoryLeft())
      all.bytes = std::max(all.bytes, need);
  all.sameCommand = true;
  writeShareJobs(options.farm, all, context);
}

void expectRuns(const std::vector<double>& work, Context& context) {
  JobPhase runs = runsPhase(work);
  runs.seconds = std::min(runs.seconds, currentRun()->secondsLeft());
  context.expect({runs});
}

// Finished runs stay when the others are not made.
Study makeRuns(const BoundaryPair& pair, const StudySettings& settings,
               const std::vector<double>& work, Context& context) {
  std::size_t finished = 0, runs = 0;
  context.print(studyHeader());
  try {
    Study study =
        runStudy(pair, settings, [&](const StudyRow* row, std::size_t done, std::size_t all) {
          if (row) context.print(studyLine(*row));
          std::fflush(stdout);
          finished = done;
          if (row) noteKeptWork();
          runs = all;
          if (work.back() > 0) reportProgress("runs", work[done] / work.back());
          context.setPart(done < all ? fmt::format("run {} of {}", done + 1, all) : std::string());
        });
    context.setPart("");
    return study;
  } catch (const Cancelled&) {
    if (finished == 0) throw;
    throw CancelledLate(fmt::format(
        "cancelled; {} of {} runs are kept in {}; the same command continues after them", finished,
        runs, settings.folder));
  }
}

void fillReport(const Study& study, const StudyFindings& findings, const StudySettings& settings,
                Report& report) {
  const auto text = [&](const std::optional<StudyRow>& row) {
    return row ? optionsOf(*row, settings) : std::string();
  };
  report.add("study", studyFigures(study, findings, text(findings.best), text(findings.cheapest)));
}

void sayFindings(const StudyFindings& findings, Context& context) {
  context.print("\n");
  for (const std::string& text : findings.advice) context.print(text + "\n");
  context.print("\nThe paper's statements:\n");
  for (const StudyStatement& s : findings.statements)
    context.print(fmt::format("  {}: {}\n", s.text, verdictText(s.verdict)));
}

void writeFiles(const Study& study, const StudyFindings& findings, const StudySettings& settings,
                const StudyNames& names, PendingFolder& folder) {
  const std::vector<StudyChart> charts =
      studyCharts(study, fileNameOf(names.source) + " to " + fileNameOf(names.target));
  folder.write("study.csv", [&](const std::string& path) { writeStudyTable(path, study); });
  folder.write("study.json", [&](const std::string& path) {
    writeStudyJson(path, study, findings, settings, names);
  });
  for (const StudyChart& c : charts)
    folder.write(c.file, [&](const std::string& path) { writeChart(path, c.chart); });
  folder.write("study.html", [&](const std::string& path) {
    writeStudyPage(path, study, findings, settings, charts, names);
  });
}

void concludeShare(const Study& study, const StudySettings& settings, Context& context) {
  context.print(fmt::format(
      "share {}/{}: {} runs made, {} there already, {} of others left; the same command without "
      "--share takes all from {}\n",
      settings.share, settings.shares, study.made, study.kept, study.left, settings.folder));
  const std::size_t here = study.rows.size() + study.left;
  const std::size_t own = (here - settings.share + settings.shares) / settings.shares;
  if (study.left > here - own)
    context.failAfterwards("runs of the share are left, as --max-time ended; start it again");
}

void run(const StudyOptions& options, Context& context) {
  const StudySettings settings = settingsOf(options);
  const bool asJobs = writesJobs(options.farm, context);
  std::vector<std::string> names{"study.csv", "study.json", "study.html", "report.json"};
  for (const std::string& name : studyChartNames()) names.push_back(name);
  std::unique_ptr<PendingFolder> folder;
  if (!inShares(options.farm))
    folder = context.outputFolder(options.output, names);
  else if (context.page())
    throw UsageError("--html: a share has no page of its own; give --html to the study without it");
  const BoundaryPair pair = readPair(options, context);
  LevelSetSettings grid;
  grid.resolution = settings.resolution;
  requireInterior(pair.solid(), grid);
  const std::vector<double> work = workOf(pair, settings);
  context.spend(1);
  expectRuns(work, context);
  if (asJobs) return writeJobs(options, pair, settings, work, context);
  if (context.dryRun()) return plan(options, pair, settings, context);
  Study study = context.timed("runs", [&] { return makeRuns(pair, settings, work, context); });
  if (!options.farm.share.empty()) return concludeShare(study, settings, context);
  const StudyFindings findings = studyFindings(study);
  if (study.left > 0)
    study.warnings.push_back(fmt::format(
        "--max-time ended: {} runs are left; the same command continues after those kept in {}",
        study.left, settings.folder));
  const auto failed = std::count_if(study.rows.begin(), study.rows.end(),
                                    [](const StudyRow& row) { return !row.failure.empty(); });
  if (failed > 0)
    study.warnings.push_back(
        fmt::format("{} of {} runs gave no map; the table says why", failed, study.rows.size()));
  if (failed > 0 && static_cast<std::size_t>(failed) == study.rows.size())
    throw DataError("none of the runs gave a map; the first: " + study.rows.front().failure);
  for (const std::string& warning : study.warnings) context.warning(warning);
  sayFindings(findings, context);
  fillReport(study, findings, settings, context.report());
  const bool laidOn = options.target.empty();
  const StudyNames meshes{options.source, laidOn ? options.correspondence : options.target, laidOn};
  context.timed("write", [&] { writeFiles(study, findings, settings, meshes, *folder); });
  context.finish(*folder);
}

void addListOptions(Command& c, StudyOptions& o) {
  const StudySettings& s = o.settings;
  o.sources = listText(s.sources);
  o.collocation = listText(s.collocation);
  o.distances = listText(s.distances);
  o.radiusRatios = listText(s.radiusRatios);
  c.option("--charges", "LIST", &o.sources,
           "numbers of charges, each 16 to 20000; all lists take numbers and ranges FROM:TO:COUNT "
           "(so many in equal ratios), or 'none'")
      .was("--sources");
  c.option("--points", "LIST", &o.collocation, "boundary points a charge, each 1 to 100");
  c.option("--distances", "LIST", &o.distances,
           "distances of the charges from the surface (O-Distance), as fractions of the source's "
           "diagonal, each 0.0001 to 2");
  c.option("--radius-ratios", "LIST", &o.radiusRatios,
           "of spheres of charges, multiples of half the diagonal (R-Ratio), each above 1 up to "
           "100");
}

void addFitOptions(Command& c, StudyOptions& o) {
  c.settings(describe(o.settings));
  c.limitTime("begin no run after this time; the same command continues later");
  addShareOptions(c, o.farm, "runs",
                  "A share makes every N-th run from the K-th on, in runs/. The same command "
                  "without --share then collects all runs and makes the missing ones");
}

}  // namespace

Command makeStudyCommand() {
  auto o = std::make_shared<StudyOptions>();
  Command c("study", "Study how a map's error and stability depend on its settings");
  c.description(
      "Fits the map from SOURCE to TARGET again and again, each time as one harmonic map by a "
      "dense solve. It varies the number of charges, the boundary points for each charge, the "
      "distance of the charges and the radius of a sphere of charges: each alone, and each two "
      "together. Writes study.csv and study.json (errors at the fit's own points and at fresh "
      "ones, energies, weights, condition, folds, seconds), charts (figure5.svg has the paper's "
      "C-Error over the paper's settings), study.html with all of it and the best settings in "
      "words, and report.json. The folder's runs/ keeps each finished run: a study that was "
      "stopped continues where it ended, and one with other lists makes only the new runs. study "
      "leaves out runs that need more than --max-memory.");
  c.positional("SOURCE", &o->source, "mesh file: .obj, .ply, .off or .stl");
  c.positional("TARGET", &o->target, "a pose of SOURCE; not with --correspond").optional();
  c.outputFolder(&o->output);
  c.option("--correspond", "FILE", &o->correspondence,
           "SOURCE's vertices on an unrelated target, as innermap correspond wrote them")
      .reads();
  addListOptions(c, *o);
  addFitOptions(c, *o);
  c.example("innermap study rest.obj pose.obj -o study");
  c.example("innermap study rest.obj pose.obj -o study --charges 100:3200:6 --max-time 600");
  return c.running(o, run);
}

}  // namespace innermap::tool

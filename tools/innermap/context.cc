#include "context.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "command.h"
#include "conclusion.h"
#include "innermap/core/error.h"
#include "innermap/core/memory.h"
#include "innermap/io/pictures.h"
#include "job_cost.h"
#include "report/page/page.h"
#include "report/report_figures.h"
#include "run_record.h"
#include "signals.h"
#include "terminal_progress.h"

namespace innermap::tool {

Context::Context(const CommonOptions& options, TerminalProgress& progress)
    : options_(options), progress_(progress), maxTime_(options.maxTime), space_(options.space) {
  maxMemory_ = options.maxMemory.empty() ? availableMemory() / 10 * 8
                                         : parseBytes("--max-memory", options.maxMemory);
  if (!options.html.empty()) page_ = std::make_unique<Page>();
  progress_.setMaxMemory(maxMemory_);
  if (maxMemory_ == 0) throw SettingError("--max-memory", "must be above 0; write for example 4GB");
}

Context::~Context() = default;

double Context::secondsGone() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

bool Context::timeIsUp() {
  if (secondsGone() < maxTime_) return false;
  progress_.endByTime();
  return true;
}

void Context::spend(double share, double later) {
  constexpr double kMargin = 3;  // what is expected of a solid's grids is that far out, at times
  progress_.setSecondsLeft(share * (maxTime_ - secondsGone() - kMargin * later));
}

void Context::noteTime() {
  if (!progress_.endedByTime() || timeNoted_) return;
  timeNoted_ = true;
  report_.add("", stoppedByTimeFigures());
  warning("stopped by --max-time: another run may differ");
}

void Context::setPart(const std::string& part) { progress_.setPart(part); }

void Context::expect(const std::vector<JobPhase>& phases) {
  expectedSeconds_ = tellableSeconds(phases);
  progress_.expect(phases);
}

void Context::phase(const std::string& stage) { progress_.report(stage, 0); }

void Context::plan(const std::vector<std::string>& lines, std::uint64_t need) {
  const std::uint64_t bytes = claimed(need);
  for (const std::string& line : lines) print(line + "\n");
  if (expectedSeconds_ > 0)
    print(fmt::format("time: about {:.0f} s\n", std::max(1.0, expectedSeconds_)));
  print(fmt::format("memory: about {} of at most {}{}\n", formatBytes(bytes),
                    formatBytes(maxMemory_),
                    bytes > maxMemory_ ? ", so this would be refused" : ""));
  report_.add("", planFigures(expectedSeconds_, bytes));
  if (bytes > maxMemory_)
    failAfterwards(fmt::format("{} of memory are more than the limit of {}; raise --max-memory",
                               formatBytes(bytes), formatBytes(maxMemory_)));
}

bool Context::begins(const std::vector<std::string>& lines, const std::vector<MemoryNeed>& needs) {
  std::uint64_t most = 0;
  for (const MemoryNeed& need : needs) {
    most = std::max(most, need.bytes);
    if (!dryRun()) requireMemory(need);
  }
  if (dryRun()) plan(lines, most);
  return !dryRun();
}

void Context::requireProgram() const {
  if (const std::uint64_t own = processMemory(0); own > maxMemory_)
    throw MemoryError(
        fmt::format("the program, its libraries and the files read so far take {} of memory, more "
                    "than the limit of {}; raise --max-memory",
                    formatBytes(own), formatBytes(maxMemory_)));
}

std::uint64_t Context::held() const { return processMemory(page_ ? kPageMemory : 0); }

std::uint64_t Context::claimed(std::uint64_t bytes) const {
  return most_ = std::max(most_, held() + bytes);
}

void Context::requireMemory(const MemoryNeed& need) const {
  requireProgram();
  claimed(need.bytes);
  innermap::requireMemory(need, held(), maxMemory_, optionName);
}

namespace {

std::string sameAs(const std::string& path, const std::string& other) {
  return path == other ? "" : " (it is the same file as " + other + ")";
}

[[noreturn]] void refuseReadAndWritten(const std::string& output, const std::string& input) {
  throw FileError(
      output, "is read as well as written; give the output another name" + sameAs(output, input));
}

}  // namespace

void Context::input(const std::string& path) {
  const std::string key = fileKey(path);
  if (key.empty()) return;
  if (outputs_.count(key)) refuseReadAndWritten(outputs_[key], path);
  inputs_.emplace(key, path);
}

void Context::enter(const std::string& path) {
  const std::string key = fileKey(path);
  if (key.empty()) return;
  if (inputs_.count(key)) refuseReadAndWritten(path, inputs_[key]);
  if (const auto [other, isNew] = outputs_.emplace(key, path); !isNew)
    throw FileError(path, "would be written twice; give each output a name of its own" +
                              sameAs(path, other->second));
  ordered_.emplace_back(key, path);
}

void Context::output(const std::string& path, bool sure) {
  enter(path);
  if (sure) expectOutputs(1);
  if (path != options_.report) placePage(path);
  requireWritable(path);
  if (std::filesystem::path(path).extension() == ".png") notePictures();
}

void Context::outputs(const std::vector<std::string>& paths) {
  for (const std::string& path : paths) enter(path);
  expectOutputs(static_cast<int>(paths.size()));
  if (paths.empty()) return;
  placePage(paths.front());
  // In a dry run the folder that a command would make for them may not be there.
  const std::filesystem::path parent = std::filesystem::path(paths.front()).parent_path();
  std::error_code ignored;
  if (!dryRun() || parent.empty() || std::filesystem::exists(parent, ignored))
    requireWritable(paths.front());
}

namespace {

constexpr const char* kPageName = "report.html";

// Whether a report of an earlier run stands there.
bool isOurs(const std::filesystem::path& folder) {
  constexpr std::streamsize kEnough = 4096;
  std::ifstream file(folder / "report.json", std::ios::binary);
  std::string head(kEnough, ' ');
  file.read(head.data(), kEnough);
  return head.compare(0, 1, "{") == 0 && head.find("\"command\"") != std::string::npos;
}

}  // namespace

void Context::outputInPlace(const std::string& path) { ordered_.emplace_back("", path); }

std::unique_ptr<PendingFolder> Context::outputFolder(const std::string& path,
                                                     const std::vector<std::string>& names,
                                                     const std::vector<std::string>& beside) {
  auto folder = std::make_unique<PendingFolder>(path);
  inFolder(path, names);
  sayWhatIsThere(path, names, beside);
  if (isOurs(path)) {
    stale_ = names;
    stale_.emplace_back(kPageName);
  }
  expectOutputs(1);
  placePage((std::filesystem::path(path) / kPageName).string());
  for (const std::string& name : names)
    if (std::filesystem::path(name).extension() == ".png") {
      notePictures();
      break;
    }
  return dryRun() ? nullptr : std::move(folder);
}

namespace {

// "a, b and 3 more"
std::string someOf(std::vector<std::string> names) {
  constexpr std::size_t kShown = 5;
  std::sort(names.begin(), names.end());
  const std::size_t more = names.size() > kShown ? names.size() - kShown : 0;
  names.resize(names.size() - more);
  return fmt::format("{}{}", fmt::join(names, ", "), more ? fmt::format(" and {} more", more) : "");
}

}  // namespace

void Context::sayWhatIsThere(const std::string& path, const std::vector<std::string>& names,
                             const std::vector<std::string>& beside) {
  const auto has = [](const std::vector<std::string>& list, const std::string& name) {
    return std::find(list.begin(), list.end(), name) != list.end();
  };
  std::vector<std::string> replaced, others;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(path, ignored)) {
    const std::string name = entry.path().filename().string();
    if (name.compare(0, 1, ".") == 0 || has(beside, name)) continue;
    (has(names, name) ? replaced : others).push_back(name);
  }
  if (!replaced.empty() && !isOurs(path))
    warning(fmt::format("{}: replaces {}, and no report.json says that an earlier run wrote {}",
                        path, someOf(replaced), replaced.size() == 1 ? "it" : "them"));
  if (!others.empty() && !isOurs(path))
    note(fmt::format("{} holds other files, which stay as they are: {}", path, someOf(others)));
}

void Context::inFolder(const std::string& folder, const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    const std::string path = (std::filesystem::path(folder) / name).string();
    enter(path);
    requireWritable(path);
  }
}

// The first output says where: most commands have one folder, or one file.
void Context::placePage(const std::string& output) {
  if (!page_ || !pagePath_.empty()) return;
  namespace fs = std::filesystem;
  pagePath_ = options_.html != kPageBesideOutputs
                  ? options_.html
                  : (fs::path(output).parent_path() / kPageName).string();
  enter(pagePath_);
  if (!dryRun()) requireWritable(pagePath_);
}

bool Context::allInPlace() const {
  const int sure = expectedOutputs() - (options_.report.empty() ? 0 : 1);
  return sure > 0 && outputsInPlace() >= static_cast<std::uint64_t>(sure);
}

void Context::notePictures() {
  // Asking for the font loads what draws, so from here on it counts as memory that the program
  // takes.
  if (labelFont().empty() && !dryRun())
    note(
        "no font is installed, so pictures have no labels; install DejaVu Sans (on Debian the "
        "package fonts-dejavu-core)");
}

void Context::say(const std::string& kind, const std::string& text) {
  if (options_.quiet) return;
  progress_.clear();
  const TerminalText style = TerminalText::of(stderr);
  std::string line = style.wrapped("innermap: " + kind + text, 10);
  if (!kind.empty()) line.replace(10, kind.size(), style.doubtful(kind));
  std::fprintf(stderr, "%s\n", line.c_str());
}

void Context::note(const std::string& text) {
  report_.notes.push_back(text);
  say("", text);
}

void Context::warning(const std::string& text) {
  report_.warnings.push_back(text);
  say("warning: ", text);
}

void Context::print(const std::string& text) {
  if (options_.json) return;
  progress_.clear();
  std::fwrite(text.data(), 1, text.size(), stdout);
}

void Context::used(const std::string& option, const ReportValue& value) {
  for (auto& [name, known] : report_.run->settings)
    if (name == settingKey(option)) known = value;
}

void Context::judge(const Verdict& verdict) {
  for (const auto& [section, figures] : verdict.figures) report_.add(section, figures);
  for (const auto& [finding, told] : verdict.findings) {
    if (!finding.met && !told) warning(finding.statement);
    report_.verdict.push_back(finding);
  }
}

void Context::conclude() {
  if (dryRun()) return;
  progress_.sayLongest();
  noteTime();
  std::vector<std::string> unmet;
  for (const ReportFinding& f : report_.verdict)
    if (!f.met) unmet.push_back(titleOf(f.name));
  const TerminalText style = TerminalText::of(stdout);
  if (!report_.verdict.empty()) print(verdictText(report_.verdict, unmet.size(), style));
  if (!details_.empty()) print(style.wrapped(details_, 2));
  std::vector<ReportOutput> outputs = outputsNow();
  std::error_code none;
  if (std::filesystem::is_regular_file(options_.report, none))
    outputs.push_back({options_.report, std::filesystem::file_size(options_.report, none)});
  for (const std::string& line : writtenLines(outputs)) say("", line);
  if (options_.strict && !unmet.empty() && failure_.empty())
    failAfterwards(
        fmt::format("--strict: the verdict is not met ({}); all files are written nevertheless",
                    fmt::join(unmet, ", ")));
}

// A file that is put in place is another than what stood there before, so its key has changed.
std::vector<ReportOutput> Context::outputsNow() const {
  std::vector<ReportOutput> out = inFolders_;
  for (const auto& told : ordered_) {
    const std::string &key = told.first, &path = told.second;
    std::error_code none;
    if (path == options_.report || !std::filesystem::is_regular_file(path, none)) continue;
    const bool listed =
        std::any_of(out.begin(), out.end(), [&](const ReportOutput& o) { return o.path == path; });
    if (!listed && fileKey(path) != key)
      out.push_back({path, std::filesystem::file_size(path, none)});
  }
  return out;
}

void Context::noteMemory() {
  const std::uint64_t most = peakMemory();
  for (const auto& [stage, seconds] : report_.seconds) memoryAfter_.emplace(stage, most);
}

const Report& Context::finishedReport() {
  noteTime();
  report_.peakMemory = peakMemory();
  report_.outputs = outputsNow();
  if (const auto taken = progress_.taken(); !taken.empty())
    report_.add("stages", figures(stageFigures(taken)));
  noteMemory();
  for (const auto& [stage, bytes] : memoryAfter_)
    report_.add("memory_after_bytes", memoryFigures(stage, bytes));
  return report_;
}

void Context::finish(PendingFolder& folder) {
  for (const auto& [path, bytes] : folder.written()) inFolders_.push_back({path, bytes});
  const std::filesystem::path page(pagePath_);
  if (page_ && options_.html == kPageBesideOutputs) {
    const std::string json = reportJson(finishedReport());
    folder.write(page.filename().string(),
                 [&](const std::string& path) { writePage(path, *page_, json); });
    page_.reset();
    inFolders_.push_back({pagePath_, folder.written().back().second});
  }
  folder.write("report.json",
               [&](const std::string& path) { writeReport(path, finishedReport()); });
  for (const std::string& name : stale_)
    if (const auto written = folder.written();
        std::none_of(written.begin(), written.end(), [&](const auto& file) {
          return std::filesystem::path(file.first).filename() == name;
        }))
      folder.remove(name);
  folder.commit();
}

void Context::finishPage() {
  if (!page_ || dryRun()) return;
  placePage("");
  writePage(pagePath_, *page_, reportJson(finishedReport()));
}

}  // namespace innermap::tool

#include "context.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "innermap/core/memory.h"
#include "innermap/io/picture/label_font.h"
#include "signals.h"
#include "terminal_progress.h"

namespace innermap::tool {

Context::Context(const CommonOptions& options, TerminalProgress& progress)
    : options_(options), progress_(progress) {
  maxMemory_ = options.maxMemory.empty() ? availableMemory() / 10 * 8
                                         : parseBytes("--max-memory", options.maxMemory);
  if (maxMemory_ == 0) throw SettingError("--max-memory", "must be above 0; write for example 4GB");
}

Progress* Context::progress() const { return &progress_; }

void Context::setPart(const std::string& part) { progress_.setPart(part); }

void Context::expect(const std::vector<JobPhase>& phases) {
  expectedSeconds_ = busyness() * totalSeconds(phases);
  progress_.expect(phases);
}

void Context::phase(const std::string& stage) { progress_.report(stage, 0); }

void Context::plan(const std::vector<std::string>& lines, std::uint64_t bytes) {
  for (const std::string& line : lines) print(line + "\n");
  if (expectedSeconds_ > 0) {
    print(fmt::format("time: about {:.0f} s\n", std::max(1.0, expectedSeconds_)));
    report_.set("seconds_expected", expectedSeconds_);
  }
  print(fmt::format("memory: about {} of at most {}{}\n", formatBytes(bytes),
                    formatBytes(maxMemory_),
                    bytes > maxMemory_ ? ", so this would be refused" : ""));
  report_.set("dry_run", true);
  report_.set("memory_needed_bytes", bytes);
  if (bytes > maxMemory_)
    failAfterwards(fmt::format("{} of memory are more than the limit of {}; raise --max-memory",
                               formatBytes(bytes), formatBytes(maxMemory_)));
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
}

void Context::output(const std::string& path, bool sure) {
  enter(path);
  if (sure) expectOutputs(1);
  requireWritable(path);
  if (!dryRun() && std::filesystem::path(path).extension() == ".png") notePictures();
}

void Context::outputs(const std::vector<std::string>& paths) {
  for (const std::string& path : paths) enter(path);
  expectOutputs(static_cast<int>(paths.size()));
  if (!paths.empty()) requireWritable(paths.front());
}

std::unique_ptr<PendingFolder> Context::outputFolder(const std::string& path,
                                                     const std::vector<std::string>& names) {
  auto folder = std::make_unique<PendingFolder>(path);
  inFolder(path, names);
  sayWhatIsThere(path, names);
  expectOutputs(1);
  if (dryRun()) return nullptr;
  for (const std::string& name : names)
    if (std::filesystem::path(name).extension() == ".png") {
      notePictures();
      break;
    }
  return folder;
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

// Whether a report of an earlier run stands there.
bool isOurs(const std::filesystem::path& folder) {
  constexpr std::streamsize kEnough = 4096;
  std::ifstream file(folder / "report.json", std::ios::binary);
  std::string head(kEnough, ' ');
  file.read(head.data(), kEnough);
  return head.compare(0, 1, "{") == 0 && head.find("\"command\"") != std::string::npos;
}

}  // namespace

void Context::sayWhatIsThere(const std::string& path, const std::vector<std::string>& names) {
  std::vector<std::string> replaced, others;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(path, ignored)) {
    const std::string name = entry.path().filename().string();
    if (name.compare(0, 1, ".") == 0) continue;
    const bool known = std::find(names.begin(), names.end(), name) != names.end();
    (known ? replaced : others).push_back(name);
  }
  if (!replaced.empty() && !isOurs(path))
    warning(fmt::format("{}: replaces {}, and no report.json says that an earlier run wrote {}",
                        path, someOf(replaced), replaced.size() == 1 ? "it" : "them"));
  if (!others.empty() && !isOurs(path))
    note(fmt::format("{} holds other things, which stay as they are: {}", path, someOf(others)));
}

void Context::inFolder(const std::string& folder, const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    const std::string path = (std::filesystem::path(folder) / name).string();
    enter(path);
    requireWritable(path);
  }
}

bool Context::allInPlace() const {
  const int sure = expectedOutputs() - (options_.report.empty() ? 0 : 1);
  return sure > 0 && outputsInPlace() >= static_cast<std::uint64_t>(sure);
}

void Context::notePictures() {
  if (labelFont().empty())
    note(
        "no font is installed, so pictures have no labels; install DejaVu Sans (on Debian the "
        "package fonts-dejavu-core)");
}

void Context::say(const std::string& kind, const std::string& text) {
  if (options_.quiet) return;
  progress_.clear();
  std::fprintf(stderr, "innermap: %s%s\n", kind.c_str(), text.c_str());
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
  progress_.clear();
  std::fwrite(text.data(), 1, text.size(), stdout);
}

const Report& Context::finishedReport() {
  report_.peakMemory = peakMemory();
  return report_;
}

void Context::finish(PendingFolder& folder) {
  folder.write("report.json",
               [&](const std::string& path) { writeReport(path, finishedReport()); });
  folder.commit();
}

}  // namespace innermap::tool

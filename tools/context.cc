#include "context.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "innermap/core/error.h"
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

void Context::plan(const std::vector<std::string>& lines, std::uint64_t need) {
  const std::uint64_t bytes = claimed(need);
  for (const std::string& line : lines) print(line + "\n");
  print(fmt::format("memory: about {} of at most {}{}\n", formatBytes(bytes),
                    formatBytes(maxMemory_),
                    bytes > maxMemory_ ? ", so this would be refused" : ""));
  report_.set("dry_run", true);
  report_.set("memory_needed_bytes", bytes);
}

void Context::requireProgram() const {
  if (const std::uint64_t own = processMemory(0); own > maxMemory_)
    throw MemoryError(
        fmt::format("the program, its libraries and what was read so far take {} of memory, more "
                    "than the limit of {}; raise --max-memory",
                    formatBytes(own), formatBytes(maxMemory_)));
}

std::uint64_t Context::claimed(std::uint64_t bytes) const {
  return most_ = std::max(most_, processMemory(bytes));
}

void Context::requireMemory(const std::string& what, std::uint64_t bytes,
                            const std::string& advice) const {
  requireProgram();
  innermap::requireMemory(what, claimed(bytes), maxMemory_, advice);
}

void Context::requireMemory(const std::string& what, std::uint64_t bytes, SizeOption size,
                            const std::string& otherwise) const {
  requireProgram();
  const std::uint64_t before = processMemory(0);
  size.need = [before, need = size.need](std::uint64_t value) { return before + need(value); };
  requireMemoryFor(what, claimed(bytes), maxMemory_, size, otherwise);
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
  if (dryRun()) return;
  requireWritable(path);
  if (std::filesystem::path(path).extension() == ".png") notePictures();
}

void Context::outputs(const std::vector<std::string>& paths) {
  for (const std::string& path : paths) enter(path);
  expectOutputs(static_cast<int>(paths.size()));
  if (!dryRun() && !paths.empty()) requireWritable(paths.front());
}

std::unique_ptr<PendingFolder> Context::outputFolder(const std::string& path,
                                                     const std::vector<std::string>& names) {
  auto folder = dryRun() ? nullptr : std::make_unique<PendingFolder>(path);
  inFolder(path, names);
  expectOutputs(1);
  for (const std::string& name : names)
    if (folder && std::filesystem::path(name).extension() == ".png") {
      notePictures();
      break;
    }
  return folder;
}

void Context::inFolder(const std::string& folder, const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    const std::string path = (std::filesystem::path(folder) / name).string();
    enter(path);
    if (!dryRun()) requireWritable(path);
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
